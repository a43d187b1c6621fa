// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "pkg/membrane/mechanics/RestState.hpp"
#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

/// Shapes, scales and rotations that the kernel tests share.
namespace shapes {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using membrane::Points;

constexpr double pi = 3.14159265358979323846;

/// Lengths are multiplied by these: what holds at 1 m must hold at any size.
constexpr double scales[] = {1e-8, 1., 1e8};

/// Random numbers from a fixed seed.
class Random {
public:
    explicit Random(unsigned seed) : generator_(seed) {}
    double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }
    /// Components in [-size, size].
    Vector3d vector(double size = 1.) { return {between(-size, size), between(-size, size), between(-size, size)}; }
    Matrix3d rotation() {
        return (Eigen::AngleAxisd(between(-pi, pi), Vector3d::UnitX()) *
                Eigen::AngleAxisd(between(-pi, pi), Vector3d::UnitY()) *
                Eigen::AngleAxisd(between(-pi, pi), Vector3d::UnitZ()))
            .toRotationMatrix();
    }

private:
    std::mt19937 generator_;
};

/// Two triangles ABC and BAD that enclose the angle theta.
struct Hinge {
    double length = 1.;                  ///< of AB
    double heightC = 0.8, heightD = 0.8; ///< of C and D over AB
    double footC = 0.4, footD = 0.7;     ///< where those heights meet AB: 0 at A, 1 at B
    double theta = 1.;                   ///< 0 closed, pi flat
    double sign = 1.;                    ///< +1 mountain, -1 valley, seen from +z when flat

    /// Rest data, for a law that acts in other states too.
    membrane::CreaseRest rest() const { return {length, heightC, heightD, sign}; }

    /// Positions of A, B, C, D: AB along x, ABC in the plane z = 0, D raised from -y by pi - theta.
    Points nodes() const {
        return {Vector3d(0., 0., 0.), Vector3d(length, 0., 0.), Vector3d(footC * length, heightC, 0.),
                Vector3d(footD * length, heightD * std::cos(theta), -sign * heightD * std::sin(theta))};
    }
};

/// Points scaled, rotated and shifted.
inline Points placed(const Points& points, double scale, const Matrix3d& rotation, const Vector3d& shift) {
    Points result;
    for (const Vector3d& p : points) result.push_back(scale * (rotation * p + shift));
    return result;
}

/// A sheet of nx x ny squares of side 0.1 m, each cut along a diagonal, with nodes moved at random by up to `disorder`
/// [m] in its plane. Creases, if wanted, lie on the inner rows, mountain and valley in turn.
inline membrane::MeshInput sheet(int nx, int ny, double disorder, unsigned seed, bool creased) {
    Random random(seed);
    membrane::MeshInput in;
    in.young = 3.2e9, in.poisson = 0.34, in.density = 1420., in.thickness = 1e-4;
    in.alpha = in.alphaCrease = 1.;
    for (int j = 0; j <= ny; ++j)
        for (int i = 0; i <= nx; ++i)
            in.nodes.emplace_back(0.1 * i + random.between(-disorder, disorder),
                                  0.1 * j + random.between(-disorder, disorder), 0.);
    const auto node = [nx](int i, int j) { return j * (nx + 1) + i; };
    for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
            in.triangles.emplace_back(node(i, j), node(i + 1, j), node(i + 1, j + 1));
            in.triangles.emplace_back(node(i, j), node(i + 1, j + 1), node(i, j + 1));
            if (creased && j > 0) {
                in.creases.emplace_back(node(i, j), node(i + 1, j));
                in.creaseSigns.push_back(j % 2 ? 1 : -1);
            }
        }
    }
    return in;
}

} // namespace shapes

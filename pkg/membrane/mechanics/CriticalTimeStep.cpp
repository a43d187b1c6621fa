// SPDX-License-Identifier: GPL-2.0-or-later
#include "CriticalTimeStep.hpp"
#include "SideForce.hpp"
#include <cmath>
#include <limits>
#include <random>

namespace membrane {
namespace {

/// y += dt² K x + 4 dt C x for one side.
struct TautSide {
    int a, b;
    Eigen::Vector3d direction;
    double axial, lateral, damping;
};

struct StiffCrease {
    int node[4];
    Eigen::Vector3d gradient[4]; ///< of theta
    double stiffness;
};

/// Spring between an apex of a crease and its foot on AB, the same in all directions.
struct FootSpring {
    int node[3];      ///< A, B, apex
    double weight[3]; ///< of their displacements in the spring's stretch
    double stiffness;
};

std::vector<TautSide> tautSides(const TimeStepInput& in) {
    std::vector<TautSide> sides;
    sides.reserve(in.rest.sides.size());
    for (std::size_t i = 0; i < in.rest.sides.size(); ++i) {
        const Side& s = in.rest.sides[i];
        const Eigen::Vector3d span = in.positions[s.b] - in.positions[s.a];
        const double length = span.norm();
        const double axial = std::max(0., s.stiffness), damping = in.damping.empty() ? 0. : in.damping[i];
        if (length > 0.) {
            const double tension = sideTension(length, s.stiffness, s.restLength, s.critical);
            sides.push_back({s.a, s.b, span / length, axial, std::max(0., tension / length), damping});
        } else { // its direction is anybody's guess
            sides.push_back({s.a, s.b, Eigen::Vector3d::UnitX(), axial, axial, damping});
        }
    }
    return sides;
}

/// A crease's moment K dtheta, and the turning of its forces with the triangles, which weighs where |force| / height is
/// not small. Turning couples an apex, its foot and the other triangle; the factor bounds them together.
void addCreases(const TimeStepInput& in, std::vector<StiffCrease>& creases, std::vector<FootSpring>& feet) {
    constexpr double turning = 3.;
    if (!(in.crease.bending > 0.)) return;
    for (const Crease& c : in.rest.creases) {
        const CreaseState s =
            creaseState(c.rest, in.positions[c.a], in.positions[c.b], in.positions[c.c], in.positions[c.d]);
        const CreaseForces f = creaseForces(c.rest, in.crease, s);
        const double heightC = std::max(s.heightC, leverFloor * c.rest.heightC);
        const double heightD = std::max(s.heightD, leverFloor * c.rest.heightD);
        const Eigen::Vector3d gradC = s.openC / heightC, gradD = s.openD / heightD;
        // (7) is no gradient where the heights differ: the larger of its two moments bounds both.
        const double paper =
            in.crease.bending * c.rest.length *
            std::max(heightC / (c.rest.heightC * c.rest.heightC), heightD / (c.rest.heightD * c.rest.heightD));
        creases.push_back(
            {{c.a, c.b, c.c, c.d},
             {-(1. - s.footC) * gradC - (1. - s.footD) * gradD, -s.footC * gradC - s.footD * gradD, gradC, gradD},
             (in.crease.conservative ? creaseStiffness(c.rest, in.crease) : paper) * std::max(1., in.crease.penalty)});
        feet.push_back({{c.a, c.b, c.c}, {-(1. - s.footC), -s.footC, 1.}, turning * f.c.norm() / heightC});
        feet.push_back({{c.a, c.b, c.d}, {-(1. - s.footD), -s.footD, 1.}, turning * f.d.norm() / heightD});
    }
}

} // namespace

double criticalTimeStep(const TimeStepInput& in) {
    const std::size_t n = in.positions.size();
    const std::vector<TautSide> sides = tautSides(in);
    std::vector<StiffCrease> creases;
    std::vector<FootSpring> feet;
    addCreases(in, creases, feet);
    std::vector<double> scale(n); // 1/sqrt(m), which makes the problem symmetric; 0 holds a node
    for (std::size_t i = 0; i < n; ++i) scale[i] = in.masses[i] > 0. ? 1. / std::sqrt(in.masses[i]) : 0.;

    std::mt19937 generator(1); // fixed: the estimate must repeat
    std::uniform_real_distribution<double> uniform(-1., 1.);
    Points x(n), kx(n), cx(n);
    for (auto& xi : x)
        for (int d = 0; d < 3; ++d) xi[d] = uniform(generator);

    double step = std::numeric_limits<double>::infinity();
    constexpr int iterations = 400;
    for (int iteration = 0; iteration < iterations; ++iteration) {
        double norm = 0.;
        for (std::size_t i = 0; i < n; ++i)
            if (scale[i] == 0.)
                x[i].setZero();
            else
                norm += x[i].squaredNorm();
        norm = std::sqrt(norm);
        if (!(norm > 0.)) return std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < n; ++i) {
            x[i] *= scale[i] / norm;
            kx[i].setZero();
            cx[i].setZero();
        }
        double stiff = 0., damped = 0.; // Rayleigh quotients of K and C
        for (const TautSide& s : sides) {
            const Eigen::Vector3d u = x[s.b] - x[s.a];
            const double along = s.direction.dot(u);
            const Eigen::Vector3d force = (s.axial - s.lateral) * along * s.direction + s.lateral * u;
            kx[s.a] -= force;
            kx[s.b] += force;
            const Eigen::Vector3d drag = s.damping * along * s.direction;
            cx[s.a] -= drag;
            cx[s.b] += drag;
            stiff += force.dot(u);
            damped += drag.dot(u);
        }
        for (const StiffCrease& c : creases) {
            double angle = 0.;
            for (int k = 0; k < 4; ++k) angle += c.gradient[k].dot(x[c.node[k]]);
            for (int k = 0; k < 4; ++k) kx[c.node[k]] += c.stiffness * angle * c.gradient[k];
            stiff += c.stiffness * angle * angle;
        }
        for (const FootSpring& f : feet) {
            Eigen::Vector3d stretch = Eigen::Vector3d::Zero();
            for (int k = 0; k < 3; ++k) stretch += f.weight[k] * x[f.node[k]];
            for (int k = 0; k < 3; ++k) kx[f.node[k]] += f.stiffness * f.weight[k] * stretch;
            stiff += f.stiffness * stretch.squaredNorm();
        }
        for (std::size_t i = 0; i < in.drag.size(); ++i) {
            cx[i] += in.drag[i] * x[i];
            damped += in.drag[i] * x[i].squaredNorm();
        }
        if (!(stiff > 0. || damped > 0.)) return std::numeric_limits<double>::infinity();
        // dt² stiff + 4 dt damped = 4
        step = 2. / (std::sqrt(damped * damped + stiff) + damped);
        for (std::size_t i = 0; i < n; ++i) x[i] = scale[i] * (step * kx[i] + 4. * cx[i]);
    }
    return 0.99 * step;
}

} // namespace membrane

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace membrane {

/// Area of a triangle with corners a, b, c [m²].
inline double triangleArea(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    return 0.5 * (b - a).cross(c - a).norm();
}

/// Spring stiffnesses [N/m] of a triangle's three sides, paper equation (5).
///
/// The three springs hold the strain energy of the plane-stress membrane in uniaxial stress along each side in turn.
/// \param lengths  side lengths L_i [m], > 0
/// \param area     area S [m²], > 0
/// \param young, poisson, thickness  E [Pa] > 0, nu [-] in (-1, 1/2], h [m] > 0
/// \return k_i in the order of `lengths`; negative for the base of a flat triangle; not finite if (5) is singular.
inline Eigen::Vector3d triangleStiffness(const Eigen::Vector3d& lengths, double area, double young, double poisson,
                                         double thickness) {
    // With k_i L_i² as unknowns the matrix of (5) is 1 - g off its diagonal and 1 on it, g = 1 - p² belonging to the
    // third side: solved in closed form it keeps its digits for slivers, where elimination would lose them.
    const Eigen::Vector3d squared = lengths.cwiseAbs2();
    Eigen::Vector3d g;
    for (int i = 0; i < 3; ++i) {
        const double q = 4. * (1. + poisson) * (area / squared[(i + 1) % 3]) * (area / squared[(i + 2) % 3]);
        g[i] = q * (2. - q); // p = 1 - q
    }
    const double sum = g.sum(), determinant = sum * sum - 2. * g.squaredNorm() - 2. * g.prod();
    Eigen::Vector3d k;
    for (int i = 0; i < 3; ++i) k[i] = young * thickness * (area / squared[i]) * g[i] * (sum - 2. * g[i]) / determinant;
    return k;
}

/// Mass [kg] of each corner of a triangle, paper equation (4).
inline double cornerMass(double area, double density, double thickness) {
    return density * thickness * area / 3.;
}

} // namespace membrane

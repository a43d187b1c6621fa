// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/LU>
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
    const Eigen::Vector3d squared = lengths.cwiseAbs2();
    // Divided by S, B depends on the shape alone, so that the solve is as good at 1e-8 m as at 1e8 m.
    Eigen::Matrix3d shape;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const double p = i == j ? 1. : 1. - 4. * (1. + poisson) * area * area / (squared[i] * squared[j]);
            shape(i, j) = p * p * squared[j] / area;
        }
    }
    return young * thickness * shape.fullPivLu().solve(Eigen::Vector3d::Ones());
}

/// Mass [kg] of each corner of a triangle, paper equation (4).
inline double cornerMass(double area, double density, double thickness) {
    return density * thickness * area / 3.;
}

} // namespace membrane

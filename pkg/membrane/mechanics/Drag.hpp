// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace membrane {

/// What one triangle adds to the drag weight of a corner [m³/s]: |a·V|, a = 2S times the unit normal, V the corner's
/// velocity. \param doubleArea a [m²];  \param velocity V [m/s]
inline double dragWeight(const Eigen::Vector3d& doubleArea, const Eigen::Vector3d& velocity) {
    return std::abs(doubleArea.dot(velocity));
}

/// By which a node's drag weight is multiplied [kg/m³]: rho/12, \param airDensity rho [kg/m³] >= 0.
inline double dragFactor(double airDensity) {
    return airDensity / 12.;
}

/// Air drag [N] on a node, paper equation (10) summed over its triangles: rho S_n V²/6 each, against the velocity V,
/// S_n the area of the triangle projected along V: S_n V² = |a·V| |V| / 2.
/// \param factor dragFactor();  \param weight sum of dragWeight() [m³/s]
inline Eigen::Vector3d nodeDrag(double factor, double weight, const Eigen::Vector3d& velocity) {
    return -factor * weight * velocity;
}

/// Air drag [N] on one corner of one triangle.
inline Eigen::Vector3d cornerDrag(double airDensity, const Eigen::Vector3d& doubleArea,
                                  const Eigen::Vector3d& velocity) {
    return nodeDrag(dragFactor(airDensity), dragWeight(doubleArea, velocity), velocity);
}

/// Bound [N s/m] of the slope of cornerDrag() by the velocity, in any direction.
inline double cornerDragSlope(double airDensity, const Eigen::Vector3d& doubleArea, const Eigen::Vector3d& velocity) {
    return dragFactor(airDensity) * (std::abs(doubleArea.dot(velocity)) + doubleArea.norm() * velocity.norm());
}

} // namespace membrane

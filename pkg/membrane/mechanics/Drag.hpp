// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace membrane {

/// Air drag [N] on one corner of a triangle, paper equation (10): rho S_n V²/6 against the corner's velocity V,
/// S_n the area of the triangle projected along V. With a = 2S times the unit normal, S_n V² = |a·V| |V| / 2.
/// \param airDensity rho [kg/m³] >= 0;  \param doubleArea a [m²];  \param velocity V [m/s]
inline Eigen::Vector3d cornerDrag(double airDensity, const Eigen::Vector3d& doubleArea,
                                  const Eigen::Vector3d& velocity) {
    return -(airDensity / 12.) * std::abs(doubleArea.dot(velocity)) * velocity;
}

/// Bound [N s/m] of the slope of cornerDrag() by the velocity, in any direction.
inline double cornerDragSlope(double airDensity, const Eigen::Vector3d& doubleArea, const Eigen::Vector3d& velocity) {
    return (airDensity / 12.) * (std::abs(doubleArea.dot(velocity)) + doubleArea.norm() * velocity.norm());
}

} // namespace membrane

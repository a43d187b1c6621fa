// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace membrane {

/// Twice the area of a triangle times its normal [m²], from its corners [m].
inline Eigen::Vector3d doubleArea(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    return (b - a).cross(c - a);
}

} // namespace membrane

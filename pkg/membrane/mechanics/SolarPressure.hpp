// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <Eigen/Core>
#include <cmath>

namespace membrane {

/// How light pushes a film, both sides alike. What is reflected neither as by a mirror nor diffusely is absorbed.
struct Sunlight {
    Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ(); ///< along which it travels, of length 1
    double pressure = 0.;                                  ///< on a black plate across it [Pa]
    double specular = 0.;                                  ///< share reflected as by a mirror [-]
    double diffuse = 0.;                                   ///< share reflected evenly bright to all sides (Lambert) [-]
};

/// Force [N] of sunlight on a flat triangle: with its area S, the normal n turned away from the sun and the cosine
/// c = n·s, p S c [(1 - specular) s + (2 c specular + 2/3 diffuse) n] (McInnes, Solar Sailing, 1999, 2.6). Work from
/// outside; it has no energy. Tends to 0 with the area and with c. \param doubleArea 2 S n [m²], n of either sign
inline Eigen::Vector3d solarForce(const Sunlight& light, const Eigen::Vector3d& doubleArea) {
    const double size = doubleArea.norm(), across = doubleArea.dot(light.direction);
    const double inverse = size > 0. ? 1. / size : 0.;
    const double shadow = 0.5 * std::abs(across), cosine = across * inverse; // c, with the sign of n
    const double along = (2. * std::abs(cosine) * light.specular + 2. / 3. * light.diffuse) * inverse;
    return light.pressure * shadow *
           ((1. - light.specular) * light.direction + std::copysign(along, across) * doubleArea);
}

/// Bound [Pa] of the slope of solarForce() by the doubled area, whatever its direction.
inline double solarSlope(const Sunlight& light) {
    return 0.5 * light.pressure * (1. - light.specular + 6. * light.specular + 4. / 3. * light.diffuse);
}

} // namespace membrane

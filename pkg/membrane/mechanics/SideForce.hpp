// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <algorithm>
#include <cmath>

namespace membrane {

/// Length [m] below which a side is buckled, paper equation (6): l_cr = L0 - alpha pi² h² / (12 L0), not below 0.
/// \param restLength L0 [m] > 0;  \param alpha >= 0 [-], 0 = bears no compression;  \param thickness h [m]
inline double criticalLength(double restLength, double alpha, double thickness) {
    constexpr double pi = 3.14159265358979323846;
    return std::max(0., restLength - alpha * pi * pi * thickness * thickness / (12. * restLength));
}

/// The same where the film buckles at one strain on any mesh: l_cr = L0 (1 - e), e = sigma_b / E, not below 0.
/// \param strain e [-] >= 0
inline double criticalLengthAt(double restLength, double strain) {
    return std::max(0., restLength * (1. - strain));
}

/// Tension [N] of a side of the given length, paper equations (3) and (6); negative in compression.
/// Linear above the critical length, constant below it (Figure 3).
inline double sideTension(double length, double stiffness, double restLength, double critical) {
    return stiffness * (std::max(length, critical) - restLength);
}

/// Strain energy [J] whose derivative by the length is sideTension().
inline double sideEnergy(double length, double stiffness, double restLength, double critical) {
    const double stretch = std::max(length, critical) - restLength;
    return stiffness * stretch * (0.5 * stretch + std::min(0., length - critical));
}

/// What the energy [J] of a side grows by beyond the mean of its tensions at the ends of a step times its change of
/// length. 0 unless the side buckles or becomes taut in between: elsewhere the tension is a straight line. With the
/// lengths u above the critical one and w below it at the two ends, k u w / 2, gained by buckling.
/// \param before, after length at the ends of the step [m]
inline double kinkEnergy(double before, double after, double stiffness, double critical) {
    const double above = std::max(std::max(before, after) - critical, 0.);
    const double below = std::max(critical - std::min(before, after), 0.);
    return (before > after ? 0.5 : -0.5) * stiffness * above * below;
}

} // namespace membrane

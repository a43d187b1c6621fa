// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace membrane {

/// Damping coefficient c [N s/m] of a side, paper equation (9): c = 2 zeta sqrt(k m).
/// \param ratio zeta >= 0 [-];  \param stiffness k [N/m]; a negative one (flat triangles) is not damped
/// \param meanMass m [kg], mean of the two nodes' masses
inline double dampingCoefficient(double ratio, double stiffness, double meanMass) {
    return 2. * ratio * std::sqrt(std::max(0., stiffness) * meanMass);
}

/// Damping tension [N] of a side of the film.
/// \param coefficient c [N s/m];  \param span from one node to the other [m];  \param inverse 1/its length [1/m]
/// \param relative velocity of the other node against the one [m/s]
inline double sideDamping(double coefficient, const Eigen::Vector3d& span, const Eigen::Vector3d& relative,
                          double inverse) {
    return coefficient * span.dot(relative) * inverse;
}

/// Damping tension [N] of a taut cable: together with its elastic tension never below 0, for a cable cannot push.
/// \param coefficient c [N s/m];  \param rate of its length [m/s];  \param tension elastic [N] >= 0
inline double cableDamping(double coefficient, double rate, double tension) {
    return std::max(coefficient * rate, -tension);
}

} // namespace membrane

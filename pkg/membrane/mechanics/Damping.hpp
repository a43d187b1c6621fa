// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <algorithm>
#include <cmath>

namespace membrane {

/// Damping coefficient c [N s/m] of a side, paper equation (9): c = 2 zeta sqrt(k m).
/// \param ratio zeta >= 0 [-];  \param stiffness k [N/m]; a negative one (flat triangles) is not damped
/// \param meanMass m [kg], mean of the two nodes' masses
inline double dampingCoefficient(double ratio, double stiffness, double meanMass) {
    return 2. * ratio * std::sqrt(std::max(0., stiffness) * meanMass);
}

} // namespace membrane

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "RestState.hpp"
#include <vector>

namespace membrane {

/// What bounds the time step besides the sides.
struct TimeStepInput {
    const RestState& rest;
    const std::vector<double>& masses;  ///< actual masses [kg]; a node that cannot move has 0
    const Points& positions;            ///< current positions [m]
    const std::vector<double>& damping; ///< c of each side [N s/m], or empty
    const std::vector<double>& drag;    ///< of each node, the same in all directions [N s/m], or empty
    CreaseLaw crease;                   ///< bending = 0: no creases
};

/// Critical time step [s] of the leapfrog in the given state.
///
/// Velocities at the time of the positions are extrapolated, v(n) = (3 v(n-1/2) - v(n-3/2))/2. Then
/// x(n+1) - 2x(n) + x(n-1) + dt² K x(n)/M + dt² C v(n)/M = 0 is stable while the largest eigenvalue of
/// (dt² K + 4 dt C)/M is below 4. K counts every side as if taut (a buckled one may become so in the next
/// step), with the stiffness of its direction under its present tension, and every crease with its penalty and the
/// turning of its forces; negative stiffness is left out. The largest eigenvalue is found by power iteration and the
/// step taken 1 % shorter than it says.
///
/// \return infinity if nothing can move
double criticalTimeStep(const TimeStepInput& input);

} // namespace membrane

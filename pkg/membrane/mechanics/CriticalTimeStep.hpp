// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "LinearForces.hpp"

namespace membrane {

/// Critical time step [s] of the leapfrog under the given forces.
///
/// Velocities at the time of the positions are extrapolated, v(n) = (3 v(n-1/2) - v(n-3/2))/2. Then
/// x(n+1) - 2x(n) + x(n-1) + dt² K x(n)/M + dt² C v(n)/M = 0 is stable while the largest eigenvalue of
/// (dt² K + 4 dt C)/M is below 4, K and C as in LinearForces. The eigenvalue is found by Lanczos' method and the step
/// taken 1 % shorter than it says. The same input gives the same number to the last bit.
///
/// \return infinity if nothing can move
double criticalTimeStep(const LinearForces& forces);

/// dt <= criticalTimeStep(forces), for far less work if dt is not close to it.
bool withinCriticalTimeStep(const LinearForces& forces, double dt);

} // namespace membrane

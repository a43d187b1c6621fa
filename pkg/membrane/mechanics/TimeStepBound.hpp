// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "LinearForces.hpp"

namespace membrane {

/// A step that the exact critical one is never below, and how the forces grow with the step there.
struct TimeStepBound {
    double step;     ///< [s]; infinite if nothing that moves is pulled
    double exponent; ///< of the step in dt² K + 4 dt C: 1 if damping decides, 2 if stiffness does
};

/// By Gershgorin's circles, with a block of K and C for each pair of nodes: the largest eigenvalue is at most the
/// largest sum of norms in a row, for any scales of the nodes' displacements. It costs a few products with K.
TimeStepBound timeStepBound(const LinearForces& forces);

} // namespace membrane

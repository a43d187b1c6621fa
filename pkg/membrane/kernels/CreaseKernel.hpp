// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "../mechanics/RestState.hpp"
#include "Arrangement.hpp"
#include "Coordinates.hpp"

namespace membrane {

/// The creases in their arrangement.
struct CreaseTable {
    Arrangement<4> order;
    Array length, heightC, heightD, sign; ///< as in CreaseRest
    Array steepestLever, slopeC, slopeD;  ///< its functions
};

CreaseTable creaseTable(const RestState& rest, const Partition& partition);

/// Adds the forces (7), (8) of a group's creases [N], at positions `x` [m].
void addCreases(const CreaseTable& table, const CreaseLaw& law, int group, const Components& x, const Window& to);

} // namespace membrane

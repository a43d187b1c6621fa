// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "../mechanics/RestState.hpp"
#include "Arrangement.hpp"
#include "Coordinates.hpp"
#include "Prefetch.hpp"
#include "Sums.hpp"

namespace membrane {

/// The sides of the film in their arrangement, and the cables, which are few, one by one.
struct SideTable {
    Arrangement<2> order;
    Array stiffness, restLength, critical, damping; ///< as in Side; c [N s/m]; 0 for padding
    /// Where in those four each block's constants begin. Blocks of sides that are all alike share theirs: large meshes
    /// are bound by memory.
    std::vector<int> constants;
    Array length;                    ///< of the last step [m]; empty: not kept
    std::vector<int> cables;         ///< sides that are cables, group by group
    std::vector<int> cableGroups;    ///< first cable of each group, then their number
    std::vector<double> cableLength; ///< of the last step [m], parallel to cables
};

/// What the sides of one group are computed from and where their forces go.
struct SideJob {
    Components x;           ///< positions [m]
    Components u;           ///< velocities [m/s] at the time of the positions; not needed without damping
    Window elastic;         ///< forces (3), (6) [N]; nowhere: not wanted
    Window damping;         ///< forces (9) [N]; nowhere: no damping; may be the same arrays as `elastic`
    Sums sums = Sums::none; ///< other than none: keep the lengths
    Prefetch* prefetch = nullptr;
};

struct SideEnergy {
    double elastic = 0.; ///< of the sides [J]; only with Sums::energies
    double kink = 0.;    ///< kinkEnergy() of the step [J]; only with sums
};

/// \param damping c of each side of `rest` [N s/m], or empty
SideTable sideTable(const RestState& rest, const std::vector<double>& damping, const Partition& partition);

/// Adds the forces of a group's sides; returns the energies that the job wants.
SideEnergy addSides(SideTable& table, const RestState& rest, const std::vector<double>& damping, int group,
                    const SideJob& job);

} // namespace membrane

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Arrangement.hpp"
#include "Coordinates.hpp"
#include <Eigen/Core>

namespace membrane {

/// The triangles in their arrangement; their corners in ascending order, for drag does not ask which way round they
/// run.
struct DragTable {
    Arrangement<3> order;
};

DragTable dragTable(const std::vector<Eigen::Vector3i>& triangles, const Partition& partition);

/// Where drag weights are added: on the node `first` and those that follow, or nowhere.
struct WeightWindow {
    double* values = nullptr;
    long first = 0;
};

/// Adds the drag weights of a group's triangles [m³/s] to their nodes, at positions `x` [m] and velocities `u` [m/s].
void addDragWeights(const DragTable& table, int group, const Components& x, const Components& u,
                    const WeightWindow& to);

} // namespace membrane

// SPDX-License-Identifier: GPL-2.0-or-later
#include "MathFlags.hpp" // like a CREATE_CPP_LOCAL_LOGGER it keeps this out of unity builds

#include "../mechanics/Drag.hpp"
#include "BlockTransfer.hpp"
#include "DragKernel.hpp"

namespace membrane {
namespace {

inline void compute(int padded, const Components (&x)[3], const Components (&u)[3], double (&weight)[3][blockSize]) {
    const Components a = x[0], b = x[1], c = x[2], ua = u[0], ub = u[1], uc = u[2];
#pragma GCC ivdep
    for (int e = 0; e < padded; ++e) {
        const Eigen::Vector3d corner = a.at(e);
        const Eigen::Vector3d area = (b.at(e) - corner).cross(c.at(e) - corner);
        weight[0][e] = dragWeight(area, ua.at(e));
        weight[1][e] = dragWeight(area, ub.at(e));
        weight[2][e] = dragWeight(area, uc.at(e));
    }
}

} // namespace

DragTable dragTable(const std::vector<Eigen::Vector3i>& triangles, const Partition& partition) {
    std::vector<std::array<int, 3>> corners;
    corners.reserve(triangles.size());
    for (const Eigen::Vector3i& t : triangles) {
        corners.push_back({t[0], t[1], t[2]});
        std::sort(corners.back().begin(), corners.back().end());
    }
    return {arrange<3>(corners, partition)};
}

MEMBRANE_VECTORISED void addDragWeights(const DragTable& table, int group, const Components& x, const Components& u,
                                        const WeightWindow& to) {
    BlockVectors roomX[3], roomU[3];
    double added[3][blockSize];
    for (int i = table.order.groups[group]; i < table.order.groups[group + 1]; ++i) {
        const Block block = table.order.blocks[i];
        const int* node[3];
        for (int k = 0; k < 3; ++k) node[k] = table.order.node[k].data() + block.begin;
        const Components at[] = {cornerOf(block, node[0], x, roomX[0]), cornerOf(block, node[1], x, roomX[1]),
                                 cornerOf(block, node[2], x, roomX[2])};
        const Components moving[] = {cornerOf(block, node[0], u, roomU[0]), cornerOf(block, node[1], u, roomU[1]),
                                     cornerOf(block, node[2], u, roomU[2])};
        compute(block.paddedCount(), at, moving, added);
        for (int k = 0; k < 3; ++k) {
            clearPadding(block, added[k]);
            if (block.run) {
                double* const target = to.values + (node[k][0] - to.first);
                const int padded = block.paddedCount();
#pragma GCC ivdep
                for (int e = 0; e < padded; ++e) target[e] += added[k][e];
            } else {
                for (int e = 0; e < block.count(); ++e) to.values[node[k][e] - to.first] += added[k][e];
            }
        }
    }
}

} // namespace membrane

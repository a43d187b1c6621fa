// SPDX-License-Identifier: GPL-2.0-or-later
#include "MathFlags.hpp" // like a CREATE_CPP_LOCAL_LOGGER it keeps this out of unity builds

#include "../mechanics/Drag.hpp"
#include "DragKernel.hpp"

namespace membrane {
namespace {

inline void compute(int padded, const OfCorners x, const OfCorners u, double (&weight)[3][blockSize]) {
#pragma GCC ivdep
    for (int e = 0; e < padded; ++e) {
        const Eigen::Vector3d area = doubleArea(x.a.at(e), x.b.at(e), x.c.at(e));
        weight[0][e] = dragWeight(area, u.a.at(e));
        weight[1][e] = dragWeight(area, u.b.at(e));
        weight[2][e] = dragWeight(area, u.c.at(e));
    }
}

/// Adds the weights of one corner of a block's triangles to its nodes.
inline void addWeights(const Block& block, const double* weight, const int* node, const WeightWindow& to) {
    if (block.run) {
        double* const target = to.values + (node[0] - to.first);
        const int padded = block.paddedCount();
#pragma GCC ivdep
        for (int e = 0; e < padded; ++e) target[e] += weight[e];
    } else {
        for (int e = 0; e < block.count(); ++e) to.values[node[e] - to.first] += weight[e];
    }
}

MEMBRANE_VECTORISED void addDragWeights(const Arrangement<3>& order, int group, const GroupJob& job) {
    BlockVectors roomX[3], roomU[3];
    double added[3][blockSize];
    for (int i = order.groups[group]; i < order.groups[group + 1]; ++i) {
        const Block block = order.blocks[i];
        compute(block.paddedCount(), ofCorners(order, block, job.x, roomX), ofCorners(order, block, job.u, roomU),
                added);
        for (int k = 0; k < 3; ++k) {
            clearPadding(block, added[k]);
            addWeights(block, added[k], order.node[k].data() + block.begin, job.viscous);
        }
    }
}

} // namespace

GroupEnergy DragForce::add(int group, const GroupJob& job) {
    addDragWeights(order_, group, job);
    return {};
}

double DragForce::viscosity() const {
    return dragFactor(airDensity_);
}

void DragForce::addTo(LinearForces& to, const Points& x, const Points& v) const {
    forTriangles(x, [&](const Eigen::Vector3i& triangle, const Eigen::Vector3d& area) {
        for (const int node : {triangle[0], triangle[1], triangle[2]})
            to.addDrag(node, cornerDragSlope(airDensity_, area, v[node]));
    });
}

Culprit DragForce::culprit(const Moment& moment, bool) const {
    std::vector<double> weights(moment.x.size(), 0.);
    forTriangles(moment.x, [&](const Eigen::Vector3i& triangle, const Eigen::Vector3d& area) {
        for (const int node : {triangle[0], triangle[1], triangle[2]})
            weights[node] += dragWeight(area, moment.v[node]);
    });
    Culprit most;
    for (std::size_t i = 0; i < weights.size(); ++i)
        most.consider(-nodeDrag(viscosity(), weights[i], moment.v[i]).dot(moment.v[i]), "node", {static_cast<int>(i)});
    return most;
}

} // namespace membrane

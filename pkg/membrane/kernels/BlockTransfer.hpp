// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Arrangement.hpp"
#include "Coordinates.hpp"

namespace membrane {

/// A vector for each element of a block.
struct BlockVectors {
    double component[3][blockSize];

    Components components() {
        Components c;
        c.x = component[0];
        c.y = component[1];
        c.z = component[2];
        return c;
    }
};

/// The values at one corner of each element: where they are if the block is a run, else gathered into `room`.
/// \param node of that corner for each element of the block
inline Components cornerOf(const Block& block, const int* node, const Components& from, BlockVectors& room) {
    if (block.run) return from + node[0];
    for (int e = 0; e < block.paddedCount(); ++e) {
        room.component[0][e] = from.x[node[e]];
        room.component[1][e] = from.y[node[e]];
        room.component[2][e] = from.z[node[e]];
    }
    return room.components();
}

/// Sets what a kernel found for padding to 0: adding a block's values runs on to whole lanes.
inline void clearPadding(const Block& block, double* value) {
    for (int e = block.count(); e < block.paddedCount(); ++e) value[e] = 0.;
}
inline void clearPadding(const Block& block, BlockVectors& value) {
    for (auto& component : value.component) clearPadding(block, component);
}

/// to += sign * value on one corner of each element; the padding's value must be 0.
template <int sign>
inline void addToCorner(const Block& block, const BlockVectors& value, const int* node, const Window& to) {
    const double *const x = value.component[0], *const y = value.component[1], *const z = value.component[2];
    if (block.run) {
        const int padded = block.paddedCount();
        const Components target = to.from(node[0]);
#pragma GCC ivdep
        for (int e = 0; e < padded; ++e) {
            // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): kernels set all paddedCount()
            target.x[e] += sign * x[e];
            target.y[e] += sign * y[e];
            target.z[e] += sign * z[e];
        }
    } else {
        const Components target = to.values;
        const long first = to.first;
        for (int e = 0; e < block.count(); ++e) {
            // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): of which count() is less
            target.x[node[e] - first] += sign * x[e];
            target.y[node[e] - first] += sign * y[e];
            target.z[node[e] - first] += sign * z[e];
        }
    }
}
inline void addCorner(const Block& block, const BlockVectors& value, const int* node, const Window& to) {
    addToCorner<1>(block, value, node, to);
}
inline void subtractCorner(const Block& block, const BlockVectors& value, const int* node, const Window& to) {
    addToCorner<-1>(block, value, node, to);
}

} // namespace membrane

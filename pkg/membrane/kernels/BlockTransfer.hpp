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
    for (int e = 0; e < wholeLanes(block.end - block.begin); ++e) {
        room.component[0][e] = from.x[node[e]];
        room.component[1][e] = from.y[node[e]];
        room.component[2][e] = from.z[node[e]];
    }
    return room.components();
}

/// to += value on one corner of each element.
inline void addCorner(const Block& block, const BlockVectors& value, const int* node, const Components& to) {
    const int count = block.end - block.begin;
    if (block.run) {
        double* const target[] = {to.x + node[0], to.y + node[0], to.z + node[0]};
        for (int k = 0; k < 3; ++k)
#pragma GCC ivdep
            for (int e = 0; e < count; ++e) target[k][e] += value.component[k][e];
    } else {
        for (int e = 0; e < count; ++e) {
            to.x[node[e]] += value.component[0][e];
            to.y[node[e]] += value.component[1][e];
            to.z[node[e]] += value.component[2][e];
        }
    }
}

/// to -= value on one corner of each element.
inline void subtractCorner(const Block& block, const BlockVectors& value, const int* node, const Components& to) {
    const int count = block.end - block.begin;
    if (block.run) {
        double* const target[] = {to.x + node[0], to.y + node[0], to.z + node[0]};
        for (int k = 0; k < 3; ++k)
#pragma GCC ivdep
            for (int e = 0; e < count; ++e) target[k][e] -= value.component[k][e];
    } else {
        for (int e = 0; e < count; ++e) {
            to.x[node[e]] -= value.component[0][e];
            to.y[node[e]] -= value.component[1][e];
            to.z[node[e]] -= value.component[2][e];
        }
    }
}

} // namespace membrane

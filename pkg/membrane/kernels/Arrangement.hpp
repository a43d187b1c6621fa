// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Vectorised.hpp"
#include <array>
#include <vector>

namespace membrane {

/// Which nodes are worked on together. Each part (thread) owns nodes that follow one another, in chunks that fit into
/// the second-level cache.
struct Partition {
    std::vector<int> chunks; ///< first node of each chunk, then the number of nodes
    std::vector<int> parts;  ///< first chunk of each part, then the number of chunks

    int partCount() const { return static_cast<int>(parts.size()) - 1; }
    int chunkCount() const { return static_cast<int>(chunks.size()) - 1; }
    int firstNode(int part) const { return chunks[parts[part]]; }
    int endNode(int part) const { return chunks[parts[part + 1]]; }
};

/// Splits `nodes` into `parts` of equal size and chunks of at most `chunkSize`.
Partition partition(int nodes, int parts, int chunkSize);

/// Elements in a row of the arrangement, at most blockSize. After its end there are elements -1 up to whole lanes.
struct Block {
    int begin, end;
    bool run;             ///< each corner's nodes follow one another: read and written without indices
    bool uniform = false; ///< its elements, padding too, share their constants

    int count() const { return end - begin; }
    int paddedCount() const { return wholeLanes(end - begin); }
    int paddedEnd() const { return begin + paddedCount(); }
};

/// An order of elements of K corners in which as many as possible lie in runs, where corner k of the next element is
/// the node after corner k of this one. Nodes of a mesh numbered row by row give runs as long as a row, or longer.
///
/// Groups: first those of each part whose nodes do not all lie in it, then those of each chunk, by their lowest node.
template <std::size_t K> struct Arrangement {
    std::array<std::vector<int>, K> node;
    std::vector<int> element; ///< index in the input; -1: padding. Within a block it joins two runs and must do nothing
    std::vector<Block> blocks;
    std::vector<int> groups; ///< first block of each group, then the number of blocks

    std::size_t size() const { return element.size(); }
};

/// \param elements nodes of each element; the order of its corners is kept
/// \param padding widest gap between two runs that is filled with elements -1; 0: none
template <std::size_t K>
Arrangement<K> arrange(const std::vector<std::array<int, K>>& elements, const Partition& partition, int padding = 0);

extern template Arrangement<2> arrange(const std::vector<std::array<int, 2>>&, const Partition&, int);
extern template Arrangement<3> arrange(const std::vector<std::array<int, 3>>&, const Partition&, int);
extern template Arrangement<4> arrange(const std::vector<std::array<int, 4>>&, const Partition&, int);

} // namespace membrane

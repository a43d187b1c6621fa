// SPDX-License-Identifier: GPL-2.0-or-later
#include "Arrangement.hpp"
#include <algorithm>
#include <cstdint>
#include <numeric>

namespace membrane {
namespace {

/// Shorter runs are not worth a block of their own.
constexpr int shortestRun = 6;

/// A run as long as this is not padded.
constexpr std::size_t longRun = 64;

template <std::size_t K> bool follows(const std::array<int, K>& next, const std::array<int, K>& one, int distance) {
    for (std::size_t k = 0; k < K; ++k)
        if (next[k] - one[k] != distance) return false;
    return true;
}

/// Part of a node: partitions are few and sorted.
int partOf(const Partition& p, int node) {
    int part = 0;
    while (node >= p.endNode(part)) ++part;
    return part;
}

template <std::size_t K>
std::vector<int> groupsOf(const std::vector<std::array<int, K>>& elements, const Partition& p) {
    std::vector<int> group(elements.size());
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const auto [low, high] = std::minmax_element(elements[e].begin(), elements[e].end());
        const int part = partOf(p, *low);
        const auto chunk = std::upper_bound(p.chunks.begin(), p.chunks.end() - 1, *low) - p.chunks.begin() - 1;
        group[e] = *high < p.endNode(part) ? p.partCount() + static_cast<int>(chunk) : part;
    }
    return group;
}

} // namespace

Partition partition(int nodes, int parts, int chunkSize) {
    Partition p;
    for (int part = 0; part < parts; ++part) {
        const int begin = static_cast<int>(static_cast<std::int64_t>(nodes) * part / parts);
        const int end = static_cast<int>(static_cast<std::int64_t>(nodes) * (part + 1) / parts);
        p.parts.push_back(static_cast<int>(p.chunks.size()));
        for (int node = begin; node < end; node += chunkSize) p.chunks.push_back(node);
    }
    p.parts.push_back(static_cast<int>(p.chunks.size()));
    p.chunks.push_back(nodes);
    return p;
}

template <std::size_t K>
Arrangement<K> arrange(const std::vector<std::array<int, K>>& elements, const Partition& partition, int widest) {
    const std::vector<int> group = groupsOf<K>(elements, partition);
    std::vector<int> order(elements.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int i, int j) {
        if (group[i] != group[j]) return group[i] < group[j];
        for (std::size_t k = 1; k < K; ++k) {
            const int a = elements[i][k] - elements[i][0], b = elements[j][k] - elements[j][0];
            if (a != b) return a < b;
        }
        return elements[i][0] != elements[j][0] ? elements[i][0] < elements[j][0] : i < j;
    });

    Arrangement<K> out;
    const auto append = [&](int element, const std::array<int, K>& nodes) {
        out.element.push_back(element);
        for (std::size_t k = 0; k < K; ++k) out.node[k].push_back(nodes[k]);
    };
    int begin = 0; // of the block that is being filled
    int limit = 0; // nodes from here on may not be read in this group
    const auto close = [&](bool run) {
        const int end = static_cast<int>(out.size());
        if (end == begin) return;
        const int padding = wholeLanes(end - begin) - (end - begin);
        for (const auto& nodes : out.node) run = run && nodes[end - 1] + padding < limit;
        out.blocks.push_back({begin, end, run});
        for (int spare = 1; static_cast<int>(out.size()) < end + padding; ++spare) {
            std::array<int, K> nodes;
            for (std::size_t k = 0; k < K; ++k) nodes[k] = out.node[k][end - 1] + (run ? spare : 0);
            append(-1, nodes);
        }
        begin = static_cast<int>(out.size());
    };
    const auto put = [&](int element, const std::array<int, K>& nodes, bool run) {
        append(element, nodes);
        if (static_cast<int>(out.size()) - begin == blockSize) close(run);
    };
    const int groups = partition.partCount() + partition.chunkCount();
    std::size_t at = 0;
    for (int g = 0; g < groups; ++g) {
        out.groups.push_back(static_cast<int>(out.blocks.size()));
        limit = partition.chunks.back();
        if (g >= partition.partCount())
            limit = partition.endNode(partOf(partition, partition.chunks[g - partition.partCount()]));
        std::vector<int> single;
        while (at < order.size() && group[order[at]] == g) {
            std::size_t end = at + 1;
            // Padding pays between short runs; in long ones it would only break the likeness of a block's elements.
            const auto gap = [&](std::size_t i) { return elements[order[i]][0] - elements[order[i - 1]][0]; };
            for (std::size_t unbroken = at; end < order.size() && group[order[end]] == g; ++end) {
                const int step = gap(end);
                if (!(step >= 1 && follows<K>(elements[order[end]], elements[order[end - 1]], step))) break;
                if (step == 1) continue;
                if (step > widest + 1 || end - unbroken > longRun) break;
                unbroken = end;
            }
            if (end - at < shortestRun) {
                single.insert(single.end(), order.data() + at, order.data() + end);
            } else {
                for (std::size_t i = at; i < end; ++i) {
                    std::array<int, K> nodes = elements[order[i]];
                    if (i > at)
                        for (int missing = gap(i) - 1; missing > 0; --missing) {
                            std::array<int, K> between = nodes;
                            for (int& node : between) node -= missing;
                            put(-1, between, true);
                        }
                    put(order[i], nodes, true);
                }
                close(true);
            }
            at = end;
        }
        std::sort(single.begin(), single.end(),
                  [&](int i, int j) { return elements[i] != elements[j] ? elements[i] < elements[j] : i < j; });
        for (int e : single) put(e, elements[e], false);
        close(false);
    }
    out.groups.push_back(static_cast<int>(out.blocks.size()));
    return out;
}

template Arrangement<2> arrange(const std::vector<std::array<int, 2>>&, const Partition&, int);
template Arrangement<3> arrange(const std::vector<std::array<int, 3>>&, const Partition&, int);
template Arrangement<4> arrange(const std::vector<std::array<int, 4>>&, const Partition&, int);

} // namespace membrane

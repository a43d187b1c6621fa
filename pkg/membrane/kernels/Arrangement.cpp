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

/// Elements group by group, and in each by their shape, so that those of a run stand side by side.
template <std::size_t K>
std::vector<int> sorted(const std::vector<std::array<int, K>>& elements, const std::vector<int>& group) {
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
    return order;
}

/// Fills an arrangement, block by block.
template <std::size_t K> class Filling {
public:
    explicit Filling(Arrangement<K>& out) : out_(out) {}

    /// Begins a group in which no node from `limit` on may be read.
    void beginGroup(int limit) {
        out_.groups.push_back(static_cast<int>(out_.blocks.size()));
        limit_ = limit;
    }

    void put(int element, const std::array<int, K>& nodes, bool run) {
        append(element, nodes);
        if (static_cast<int>(out_.size()) - begin_ == blockSize) close(run);
    }

    /// Ends a block, if one is being filled, with padding up to whole lanes.
    void close(bool run) {
        const int end = static_cast<int>(out_.size());
        if (end == begin_) return;
        const int padding = wholeLanes(end - begin_) - (end - begin_);
        for (const auto& nodes : out_.node) run = run && nodes[end - 1] + padding < limit_;
        out_.blocks.push_back({begin_, end, run});
        for (int spare = 1; static_cast<int>(out_.size()) < end + padding; ++spare) {
            std::array<int, K> nodes;
            for (std::size_t k = 0; k < K; ++k) nodes[k] = out_.node[k][end - 1] + (run ? spare : 0);
            append(-1, nodes);
        }
        begin_ = static_cast<int>(out_.size());
    }

private:
    Arrangement<K>& out_;
    int begin_ = 0; ///< of the block that is being filled
    int limit_ = 0;

    void append(int element, const std::array<int, K>& nodes) {
        out_.element.push_back(element);
        for (std::size_t k = 0; k < K; ++k) out_.node[k].push_back(nodes[k]);
    }
};

/// The elements in their order, of which runs are found.
template <std::size_t K> struct Row {
    const std::vector<std::array<int, K>>& elements;
    const std::vector<int>&order, &group;
    int widest;

    int gap(std::size_t i) const { return elements[order[i]][0] - elements[order[i - 1]][0]; }

    /// Where a run ends that begins at `at`. Padding pays between short runs; in long ones it would only break the
    /// likeness of a block's elements.
    std::size_t endOfRun(std::size_t at) const {
        std::size_t end = at + 1;
        const int g = group[order[at]];
        for (std::size_t unbroken = at; end < order.size() && group[order[end]] == g; ++end) {
            const int step = gap(end);
            if (!(step >= 1 && follows<K>(elements[order[end]], elements[order[end - 1]], step))) break;
            if (step == 1) continue;
            if (step > widest + 1 || end - unbroken > longRun) break;
            unbroken = end;
        }
        return end;
    }

    /// Puts a run in blocks of its own, its gaps filled with elements -1.
    void putRun(Filling<K>& filling, std::size_t at, std::size_t end) const {
        for (std::size_t i = at; i < end; ++i) {
            const std::array<int, K>& nodes = elements[order[i]];
            for (int missing = i > at ? gap(i) - 1 : 0; missing > 0; --missing) {
                std::array<int, K> between = nodes;
                for (int& node : between) node -= missing;
                filling.put(-1, between, true);
            }
            filling.put(order[i], nodes, true);
        }
        filling.close(true);
    }
};

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
    const std::vector<int> group = groupsOf<K>(elements, partition), order = sorted<K>(elements, group);
    const Row<K> row{elements, order, group, widest};
    Arrangement<K> out;
    Filling<K> filling(out);
    std::size_t at = 0;
    for (int g = 0; g < partition.partCount() + partition.chunkCount(); ++g) {
        const int chunk = g - partition.partCount();
        const bool inPart = chunk >= 0;
        filling.beginGroup(inPart ? partition.endNode(partOf(partition, partition.chunks[chunk]))
                                  : partition.chunks.back());
        std::vector<int> single;
        while (at < order.size() && group[order[at]] == g) {
            const std::size_t end = row.endOfRun(at);
            if (end - at < shortestRun)
                single.insert(single.end(), order.data() + at, order.data() + end);
            else
                row.putRun(filling, at, end);
            at = end;
        }
        std::sort(single.begin(), single.end(),
                  [&](int i, int j) { return elements[i] != elements[j] ? elements[i] < elements[j] : i < j; });
        for (const int e : single) filling.put(e, elements[e], false);
        filling.close(false);
    }
    out.groups.push_back(static_cast<int>(out.blocks.size()));
    return out;
}

template Arrangement<2> arrange(const std::vector<std::array<int, 2>>&, const Partition&, int);
template Arrangement<3> arrange(const std::vector<std::array<int, 3>>&, const Partition&, int);
template Arrangement<4> arrange(const std::vector<std::array<int, 4>>&, const Partition&, int);

} // namespace membrane

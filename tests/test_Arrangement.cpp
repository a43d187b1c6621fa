// SPDX-License-Identifier: GPL-2.0-or-later
// The order in which the kernels go through sides, triangles and creases: every one once, in runs where there are any.
#include "pkg/membrane/kernels/Arrangement.hpp"
#include "pkg/membrane/mechanics/RestState.hpp"
#include "shapes.hpp"
#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>

using namespace membrane;

namespace {

template <std::size_t K> using Elements = std::vector<std::array<int, K>>;

std::vector<int> shuffled(int count, unsigned seed) {
    std::vector<int> order(count);
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(seed));
    return order;
}

/// The elements with other numbers for their nodes.
template <std::size_t K> Elements<K> renumbered(Elements<K> elements, const std::vector<int>& number) {
    for (auto& nodes : elements)
        for (int& node : nodes) node = number[node];
    return elements;
}

RestState restOf(int nx, int ny) {
    return restState(shapes::sheet(nx, ny, 0.01, 3, true));
}

Elements<2> sidesOf(const RestState& rest) {
    Elements<2> sides;
    for (const Side& s : rest.sides) sides.push_back({s.a, s.b});
    return sides;
}

Elements<4> creasesOf(const RestState& rest) {
    Elements<4> creases;
    for (const Crease& c : rest.creases) creases.push_back({c.a, c.b, c.c, c.d});
    return creases;
}

Elements<3> trianglesOf(int nx, int ny) {
    Elements<3> triangles;
    for (const Eigen::Vector3i& t : shapes::sheet(nx, ny, 0., 3, false).triangles)
        triangles.push_back({t[0], t[1], t[2]});
    return triangles;
}

/// Part of a node by counting through the partition.
int partOfNode(const Partition& p, int node) {
    for (int part = 0; part < p.partCount(); ++part)
        if (node >= p.firstNode(part) && node < p.endNode(part)) return part;
    return -1;
}

int chunkOfNode(const Partition& p, int node) {
    for (int chunk = 0; chunk < p.chunkCount(); ++chunk)
        if (node >= p.chunks[chunk] && node < p.chunks[chunk + 1]) return chunk;
    return -1;
}

/// Group in which an element belongs, by its description.
template <std::size_t K> int expectedGroup(const std::array<int, K>& nodes, const Partition& p) {
    const int low = *std::min_element(nodes.begin(), nodes.end());
    const int part = partOfNode(p, low);
    for (int node : nodes)
        if (partOfNode(p, node) != part) return part;
    return p.partCount() + chunkOfNode(p, low);
}

/// Holds an arrangement against everything that its description says; returns how many of the elements lie in runs.
template <std::size_t K> int check(const Elements<K>& elements, const Partition& p, int padding) {
    const Arrangement<K> order = arrange<K>(elements, p, padding);
    EXPECT_EQ(order.groups.size(), static_cast<std::size_t>(p.partCount() + p.chunkCount() + 1));
    EXPECT_EQ(order.groups.front(), 0);
    EXPECT_EQ(order.groups.back(), static_cast<int>(order.blocks.size()));
    EXPECT_TRUE(std::is_sorted(order.groups.begin(), order.groups.end()));
    for (const auto& corner : order.node) EXPECT_EQ(corner.size(), order.size());

    std::vector<int> met(elements.size(), 0);
    int at = 0, inRuns = 0;
    for (int g = 0; g + 1 < static_cast<int>(order.groups.size()); ++g) {
        for (int b = order.groups[g]; b < order.groups[g + 1]; ++b) {
            const Block& block = order.blocks[b];
            EXPECT_EQ(block.begin, at) << "blocks must follow one another";
            EXPECT_GT(block.end, block.begin);
            EXPECT_LE(block.end - block.begin, blockSize);
            at = block.begin + wholeLanes(block.end - block.begin);
            int limit = p.chunks.back(); // beyond, nodes of other parts are moved meanwhile
            if (g >= p.partCount()) limit = p.endNode(partOfNode(p, p.chunks[g - p.partCount()]));
            for (int e = block.end; e < at; ++e) {
                EXPECT_EQ(order.element[e], -1);
                for (std::size_t k = 0; k < K; ++k) {
                    EXPECT_EQ(order.node[k][e], order.node[k][e - 1] + block.run);
                    EXPECT_LT(order.node[k][e], limit);
                }
            }
            for (int e = block.begin; e < block.end; ++e) {
                const int element = order.element[e];
                for (std::size_t k = 0; k < K; ++k) {
                    if (block.run && e > block.begin) {
                        EXPECT_EQ(order.node[k][e], order.node[k][e - 1] + 1);
                    }
                }
                if (element < 0) {
                    for (std::size_t k = 0; k < K; ++k) {
                        EXPECT_GE(order.node[k][e], 0);
                        EXPECT_LT(order.node[k][e], p.chunks.back());
                    }
                    continue;
                }
                ++met[element];
                inRuns += block.run;
                for (std::size_t k = 0; k < K; ++k) EXPECT_EQ(order.node[k][e], elements[element][k]);
                EXPECT_EQ(expectedGroup<K>(elements[element], p), g) << "element " << element;
            }
        }
        // A gap lies between two elements of one run, even where a block ends in it.
        std::vector<int> row;
        for (int b = order.groups[g]; b < order.groups[g + 1]; ++b)
            for (int e = order.blocks[b].begin; e < order.blocks[b].end; ++e) row.push_back(e);
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (order.element[row[i]] >= 0) continue;
            std::size_t last = i;
            while (last < row.size() && order.element[row[last]] < 0) ++last;
            const int width = static_cast<int>(last - i);
            EXPECT_LE(width, padding);
            if (i == 0 || last == row.size()) {
                ADD_FAILURE() << "a gap before or after all elements";
                break;
            }
            for (std::size_t k = 0; k < K; ++k)
                EXPECT_EQ(order.node[k][row[last]] - order.node[k][row[i - 1]], width + 1);
            i = last;
        }
    }
    EXPECT_EQ(at, static_cast<int>(order.size()));
    for (std::size_t e = 0; e < elements.size(); ++e) EXPECT_EQ(met[e], 1) << "element " << e;
    return inRuns;
}

/// The same for several partitions and gaps.
template <std::size_t K> void checkAll(const Elements<K>& elements, int nodes) {
    for (int parts : {1, 2, 3, 5})
        for (int chunkSize : {1, 7, 64, 512})
            for (int padding : {0, 1, 2, 5}) {
                SCOPED_TRACE(testing::Message()
                             << parts << " parts, chunks of " << chunkSize << ", padding " << padding);
                check<K>(elements, partition(nodes, parts, chunkSize), padding);
            }
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(Partition, CoversEveryNodeOnceInPartsOfEqualSize) {
    for (int nodes : {0, 1, 2, 5, 100, 1337})
        for (int parts : {1, 2, 3, 8})
            for (int chunkSize : {1, 7, 512}) {
                const Partition p = partition(nodes, parts, chunkSize);
                ASSERT_EQ(p.partCount(), parts);
                EXPECT_EQ(p.firstNode(0), 0);
                EXPECT_EQ(p.endNode(parts - 1), nodes);
                for (int part = 0; part < parts; ++part) {
                    const int size = p.endNode(part) - p.firstNode(part);
                    EXPECT_LE(std::abs(size * parts - nodes), parts) << "part " << part << " of " << nodes;
                    EXPECT_EQ(p.firstNode(part), part > 0 ? p.endNode(part - 1) : 0);
                }
                EXPECT_EQ(p.chunks.back(), nodes);
                for (int chunk = 0; chunk < p.chunkCount(); ++chunk) {
                    EXPECT_GT(p.chunks[chunk + 1], p.chunks[chunk]);
                    EXPECT_LE(p.chunks[chunk + 1] - p.chunks[chunk], chunkSize);
                }
            }
}

TEST(Arrangement, SheetsInAnyNumbering) {
    const int nx = 23, ny = 17, nodes = (nx + 1) * (ny + 1);
    const RestState rest = restOf(nx, ny);
    for (unsigned seed : {0u, 1u}) {
        std::vector<int> number(nodes);
        std::iota(number.begin(), number.end(), 0);
        if (seed) number = shuffled(nodes, seed);
        checkAll<2>(renumbered<2>(sidesOf(rest), number), nodes);
        checkAll<3>(renumbered<3>(trianglesOf(nx, ny), number), nodes);
        checkAll<4>(renumbered<4>(creasesOf(rest), number), nodes);
    }
}

TEST(Arrangement, RandomElementsEvenTheSameOneTwice) {
    shapes::Random random(4);
    const int nodes = 40;
    Elements<2> pairs;
    Elements<4> fours;
    for (int i = 0; i < 300; ++i) {
        const auto any = [&] { return std::min(nodes - 1, static_cast<int>(random.between(0, nodes))); };
        pairs.push_back({any(), any()});
        fours.push_back({any(), any(), any(), any()});
    }
    pairs.insert(pairs.end(), pairs.begin(), pairs.begin() + 20);
    checkAll<2>(pairs, nodes);
    checkAll<4>(fours, nodes);
}

TEST(Arrangement, NoneAndOneElement) {
    for (int nodes : {0, 5}) checkAll<2>({}, nodes);
    checkAll<2>({{3, 1}}, 4);
    checkAll<3>({{0, 1, 2}}, 3);
    checkAll<4>({{7, 0, 3, 4}}, 8);
}

TEST(Arrangement, RowsOfASheetAreRuns) {
    // Nodes numbered row by row: but for the shortest, all sides of a row have the nodes of the next one in a row.
    const int nx = 40, ny = 30;
    const Elements<2> sides = sidesOf(restOf(nx, ny));
    const int nodes = (nx + 1) * (ny + 1);
    // The last blocks may read no further than the last node.
    const auto nearlyAll = [](const auto& elements) { return static_cast<int>(elements.size()) - 4 * blockSize; };
    EXPECT_GT(check<2>(sides, partition(nodes, 1, 100000), 2), nearlyAll(sides));
    EXPECT_GT(check<2>(sides, partition(nodes, 1, 100000), 0), nearlyAll(sides));
    const Elements<3> triangles = trianglesOf(nx, ny);
    EXPECT_GT(check<3>(triangles, partition(nodes, 1, 100000), 0), nearlyAll(triangles));
    EXPECT_LT(check<2>(renumbered<2>(sides, shuffled(nodes, 2)), partition(nodes, 1, 100000), 0), 300);
}

TEST(Arrangement, PaddingJoinsRunsAcrossGapsNoWiderThanAsked) {
    Elements<2> elements; // 10 pairs of neighbours, a gap of one, of two, of three; 10 pairs between them
    int node = 0;
    for (int gap : {1, 2, 3, 0}) {
        for (int i = 0; i < 10; ++i, ++node) elements.push_back({node, node + 1});
        node += gap;
    }
    const Partition p = partition(node + 2, 1, 1000);
    const int runs[] = {4, 3, 2, 1}, inBlocks[] = {40, 41, 43, 46};
    for (int padding = 0; padding <= 3; ++padding) {
        const Arrangement<2> order = arrange<2>(elements, p, padding);
        EXPECT_EQ(static_cast<int>(order.blocks.size()), runs[padding]) << padding;
        int count = 0;
        for (const Block& block : order.blocks) count += block.end - block.begin;
        EXPECT_EQ(count, inBlocks[padding]) << padding;
        check<2>(elements, p, padding);
    }
}

TEST(Arrangement, RunsEndWhereOneCornerDoesNotFollow) {
    Elements<2> pairs;
    Elements<4> fours;
    for (int i = 0; i < 20; ++i) {
        pairs.push_back({i, i + (i < 10 ? 1 : 3)});
        fours.push_back({i, i + 1, i + 2, i + (i < 10 ? 3 : 5)});
    }
    check<2>(pairs, partition(30, 1, 1000), 2);
    check<4>(fours, partition(30, 1, 1000), 2);
    EXPECT_EQ(arrange<2>(pairs, partition(30, 1, 1000), 2).blocks.size(), 2u);
    EXPECT_EQ(arrange<4>(fours, partition(30, 1, 1000), 2).blocks.size(), 2u);
}

TEST(Arrangement, PaddingStaysInsideItsGroup) {
    // A gap across the end of a chunk or a part is none: what lies behind it is done later, or by another thread.
    Elements<2> elements;
    for (int node = 0; node < 60; ++node)
        if (node % 10 != 9) elements.push_back({node, node + 1});
    for (int chunkSize : {9, 10, 11, 20})
        for (int parts : {1, 2, 4}) {
            const Partition p = partition(62, parts, chunkSize);
            check<2>(elements, p, 2);
            const Arrangement<2> order = arrange<2>(elements, p, 2);
            for (int g = 0; g + 1 < static_cast<int>(order.groups.size()); ++g)
                for (int b = order.groups[g]; b < order.groups[g + 1]; ++b)
                    for (int e = order.blocks[b].begin; e < order.blocks[b].end; ++e)
                        EXPECT_EQ((expectedGroup<2>({order.node[0][e], order.node[1][e]}, p)), g);
        }
}

} // namespace

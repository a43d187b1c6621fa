// SPDX-License-Identifier: GPL-2.0-or-later
#include "MathFlags.hpp" // like a CREATE_CPP_LOCAL_LOGGER it keeps this out of unity builds

#include "BlockTransfer.hpp"
#include "CreaseKernel.hpp"

namespace membrane {
namespace {

struct CreaseColumns {
    const double *length, *heightC, *heightD, *sign, *steepestLever, *slopeC, *slopeD;
};

/// CreaseRest with its functions computed beforehand.
struct Rest {
    double length, heightC, heightD, sign, lever, ofC, ofD;
    double steepestLever() const { return lever; }
    double slopeC() const { return ofC; }
    double slopeD() const { return ofD; }
};

template <bool conservative>
inline void compute(int padded, const Components (&x)[4], const CreaseColumns& c, const CreaseLaw& parameters,
                    BlockVectors (&force)[4]) {
    CreaseLaw law = parameters;
    law.conservative = conservative; // known to the compiler
    const Components a = x[0], b = x[1], apexC = x[2], apexD = x[3];
#pragma GCC ivdep
    for (int e = 0; e < padded; ++e) {
        const Rest rest{c.length[e],        c.heightC[e], c.heightD[e], c.sign[e],
                        c.steepestLever[e], c.slopeC[e],  c.slopeD[e]};
        const CreaseForces f = creaseForces(rest, law, creaseState(rest, a.at(e), b.at(e), apexC.at(e), apexD.at(e)));
        for (int k = 0; k < 3; ++k) {
            force[0].component[k][e] = f.a[k];
            force[1].component[k][e] = f.b[k];
            force[2].component[k][e] = f.c[k];
            force[3].component[k][e] = f.d[k];
        }
    }
}

template <bool conservative>
inline void addBlocks(const CreaseTable& table, const CreaseLaw& law, int group, const Components& x,
                      const Window& to) {
    BlockVectors room[4], force[4];
    for (int i = table.order.groups[group]; i < table.order.groups[group + 1]; ++i) {
        const Block block = table.order.blocks[i];
        const int* node[4];
        for (int k = 0; k < 4; ++k) node[k] = table.order.node[k].data() + block.begin;
        const Components corners[] = {cornerOf(block, node[0], x, room[0]), cornerOf(block, node[1], x, room[1]),
                                      cornerOf(block, node[2], x, room[2]), cornerOf(block, node[3], x, room[3])};
        compute<conservative>(block.paddedCount(), corners,
                              {table.length.data() + block.begin, table.heightC.data() + block.begin,
                               table.heightD.data() + block.begin, table.sign.data() + block.begin,
                               table.steepestLever.data() + block.begin, table.slopeC.data() + block.begin,
                               table.slopeD.data() + block.begin},
                              law, force);
        for (int k = 0; k < 4; ++k) addCorner(block, force[k], node[k], to);
    }
}

MEMBRANE_VECTORISED void paperCreases(const CreaseTable& table, const CreaseLaw& law, int group, const Components& x,
                                      const Window& to) {
    addBlocks<false>(table, law, group, x, to);
}
MEMBRANE_VECTORISED void conservativeCreases(const CreaseTable& table, const CreaseLaw& law, int group,
                                             const Components& x, const Window& to) {
    addBlocks<true>(table, law, group, x, to);
}

} // namespace

CreaseTable creaseTable(const RestState& rest, const Partition& partition) {
    std::vector<std::array<int, 4>> corners;
    for (const Crease& c : rest.creases) corners.push_back({c.a, c.b, c.c, c.d});
    CreaseTable table;
    table.order = arrange<4>(corners, partition);
    for (const int e : table.order.element) {
        const CreaseRest r = e >= 0 ? rest.creases[e].rest : CreaseRest{0., 1., 1., 1.}; // padding without forces
        table.length.push_back(r.length);
        table.heightC.push_back(r.heightC);
        table.heightD.push_back(r.heightD);
        table.sign.push_back(r.sign);
        table.steepestLever.push_back(e >= 0 ? r.steepestLever() : 1.);
        table.slopeC.push_back(r.slopeC());
        table.slopeD.push_back(r.slopeD());
    }
    return table;
}

void addCreases(const CreaseTable& table, const CreaseLaw& law, int group, const Components& x, const Window& to) {
    (law.conservative ? conservativeCreases : paperCreases)(table, law, group, x, to);
}

} // namespace membrane

// SPDX-License-Identifier: GPL-2.0-or-later
#include "MathFlags.hpp" // like a CREATE_CPP_LOCAL_LOGGER it keeps this out of unity builds

#include "BlockTransfer.hpp"
#include "CreaseKernel.hpp"

namespace membrane {
namespace {

struct CreaseColumns {
    const double *length, *heightC, *heightD, *sign, *steepestLever, *slopeC, *slopeD;

    CreaseColumns operator+(int first) const {
        return {length + first,        heightC + first, heightD + first, sign + first,
                steepestLever + first, slopeC + first,  slopeD + first};
    }
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

/// The creases, to the functions below.
struct CreaseTable {
    const Arrangement<4>& order;
    CreaseColumns columns;
    const CreaseLaw& law;
};

template <bool conservative>
inline void addBlocks(const CreaseTable& table, int group, const Components& x, const Window& to) {
    BlockVectors room[4], force[4];
    for (int i = table.order.groups[group]; i < table.order.groups[group + 1]; ++i) {
        const Block block = table.order.blocks[i];
        const int* node[4];
        for (int k = 0; k < 4; ++k) node[k] = table.order.node[k].data() + block.begin;
        const Components corners[] = {cornerOf(block, node[0], x, room[0]), cornerOf(block, node[1], x, room[1]),
                                      cornerOf(block, node[2], x, room[2]), cornerOf(block, node[3], x, room[3])};
        compute<conservative>(block.paddedCount(), corners, table.columns + block.begin, table.law, force);
        for (int k = 0; k < 4; ++k) addCorner(block, force[k], node[k], to);
    }
}

MEMBRANE_VECTORISED void paperCreases(const CreaseTable& table, int group, const Components& x, const Window& to) {
    addBlocks<false>(table, group, x, to);
}
MEMBRANE_VECTORISED void conservativeCreases(const CreaseTable& table, int group, const Components& x,
                                             const Window& to) {
    addBlocks<true>(table, group, x, to);
}

} // namespace

void CreaseForce::arrange(const Partition& partition) {
    std::vector<std::array<int, 4>> corners;
    for (const Crease& c : rest_->creases) corners.push_back({c.a, c.b, c.c, c.d});
    order_ = membrane::arrange<4>(corners, partition);
    for (Array* column : {&length_, &heightC_, &heightD_, &sign_, &steepestLever_, &slopeC_, &slopeD_}) column->clear();
    for (const int e : order_.element) {
        const CreaseRest r = e >= 0 ? rest_->creases[e].rest : CreaseRest{0., 1., 1., 1.}; // padding without forces
        length_.push_back(r.length);
        heightC_.push_back(r.heightC);
        heightD_.push_back(r.heightD);
        sign_.push_back(r.sign);
        steepestLever_.push_back(e >= 0 ? r.steepestLever() : 1.);
        slopeC_.push_back(r.slopeC());
        slopeD_.push_back(r.slopeD());
    }
}

GroupEnergy CreaseForce::add(int group, const GroupJob& job) {
    const CreaseTable table{order_,
                            {length_.data(), heightC_.data(), heightD_.data(), sign_.data(), steepestLever_.data(),
                             slopeC_.data(), slopeD_.data()},
                            law_};
    (law_.conservative ? conservativeCreases : paperCreases)(table, group, job.x, job.own);
    return {};
}

double CreaseForce::energyOf(const Crease& crease, const Points& x) const {
    return creaseEnergy(crease.rest, law_, creaseState(crease, x).theta);
}

double CreaseForce::energy(const Points& x) const {
    double sum = 0.;
    for (const Crease& c : rest_->creases) sum += energyOf(c, x);
    return sum;
}

void CreaseForce::addTo(LinearForces& to, const Points& x, const Points&) const {
    to.creases.reserve(rest_->creases.size());
    for (const Crease& c : rest_->creases) to.creases.push_back(stiffCrease(c, law_, x));
}

Culprit CreaseForce::culprit(const Moment& moment, bool) const {
    Culprit most;
    for (const Crease& c : rest_->creases) most.consider(energyOf(c, moment.x), "crease", {c.a, c.b});
    return most;
}

} // namespace membrane

// SPDX-License-Identifier: GPL-2.0-or-later
#include "MathFlags.hpp" // like a CREATE_CPP_LOCAL_LOGGER it keeps this out of unity builds

#include "../mechanics/Damping.hpp"
#include "../mechanics/SideForce.hpp"
#include "BlockTransfer.hpp"
#include "SideKernel.hpp"
#include <cmath>

namespace membrane {
namespace {

struct SideColumns {
    const double *stiffness, *restLength, *critical, *damping;
    double* length;
};

/// Forces and energies of a block's sides.
struct Results {
    BlockVectors pull, brake;
    double energy[blockSize], kink[blockSize];
};

/// Which forces of the sides are wanted: springs, brakes, both added together or both kept apart.
enum class Wanted { springs, brakes, together, apart };

template <Wanted wanted, Sums sums>
inline void compute(int padded, const Components& xa, const Components& xb, const Components& ua, const Components& ub,
                    const SideColumns& c, Results& out) {
    constexpr bool springs = wanted != Wanted::brakes, brakes = wanted != Wanted::springs;
#pragma GCC ivdep
    for (int e = 0; e < padded; ++e) {
        const Eigen::Vector3d span = xb.at(e) - xa.at(e);
        const double length = span.norm();
        const double inverse = length > 0. ? 1. / length : 0.;
        double pull = springs ? sideTension(length, c.stiffness[e], c.restLength[e], c.critical[e]) : 0.;
        double brake = brakes ? sideDamping(c.damping[e], span, ub.at(e) - ua.at(e), inverse) : 0.;
        if (wanted == Wanted::together) pull += brake;
        pull *= inverse;
        brake *= inverse;
        for (int k = 0; k < 3; ++k) {
            if (springs) out.pull.component[k][e] = pull * span[k];
            if (wanted == Wanted::brakes || wanted == Wanted::apart) out.brake.component[k][e] = brake * span[k];
        }
        if (sums == Sums::energies) out.energy[e] = sideEnergy(length, c.stiffness[e], c.restLength[e], c.critical[e]);
        if (sums != Sums::none) {
            out.kink[e] = kinkEnergy(c.length[e], length, c.stiffness[e], c.critical[e]);
            c.length[e] = length;
        }
    }
}

/// The sides of the film, to the functions below.
struct SideTable {
    const Arrangement<2>& order;
    const std::vector<int>& firsts; ///< see SideForces::constants_
    SideColumns columns;
};

/// Adds a block's values, lane by lane, to a sum; those of padding must be 0.
inline void addUp(const Block& block, const double* value, double (&sum)[lanes]) {
    for (int e = 0; e < block.paddedCount(); e += lanes)
        // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): compute() has set all paddedCount() of them
        for (int lane = 0; lane < lanes; ++lane) sum[lane] += value[e + lane];
}
inline double total(const double (&sum)[lanes]) {
    double all = 0.;
    for (const double part : sum) all += part;
    return all;
}

template <Wanted wanted, Sums sums>
inline GroupEnergy addBlocks(const SideTable& table, int group, const GroupJob& job) {
    constexpr bool springs = wanted != Wanted::brakes, brakes = wanted != Wanted::springs;
    constexpr bool brakesApart = wanted == Wanted::brakes || wanted == Wanted::apart;
    double stored[lanes] = {}, missed[lanes] = {};
    Results results;
    BlockVectors gathered[4];
    for (int i = table.order.groups[group]; i < table.order.groups[group + 1]; ++i) {
        const Block block = table.order.blocks[i];
        const int first = table.firsts[i];
        const SideColumns constants{table.columns.stiffness + first, table.columns.restLength + first,
                                    table.columns.critical + first, table.columns.damping + first,
                                    sums != Sums::none ? table.columns.length + block.begin : nullptr};
        const int* const a = table.order.node[0].data() + block.begin;
        const int* const b = table.order.node[1].data() + block.begin;
        compute<wanted, sums>(block.paddedCount(), cornerOf(block, a, job.x, gathered[0]),
                              cornerOf(block, b, job.x, gathered[1]),
                              brakes ? cornerOf(block, a, job.u, gathered[2]) : Components(),
                              brakes ? cornerOf(block, b, job.u, gathered[3]) : Components(), constants, results);
        if (block.uniform && block.count() < block.paddedCount()) { // its constants are not 0 for padding
            clearPadding(block, results.pull);
            clearPadding(block, results.brake);
            clearPadding(block, results.energy);
            clearPadding(block, results.kink);
        }
        if (springs) {
            addCorner(block, results.pull, a, job.elastic);
            subtractCorner(block, results.pull, b, job.elastic);
        }
        if (brakesApart) {
            addCorner(block, results.brake, a, job.own);
            subtractCorner(block, results.brake, b, job.own);
        }
        if (job.prefetch) job.prefetch->next();
        if (sums == Sums::energies) addUp(block, results.energy, stored);
        if (sums != Sums::none) addUp(block, results.kink, missed);
    }
    return {total(stored), total(missed)};
}

/// Stiffness, rest length, critical length, damping of a side.
using SideConstants = std::array<double, 4>;

/// Sides whose constants differ by less than this are alike: coordinates of a regular mesh are rounded, and so are
/// they.
constexpr double alike = 1e-12;

bool areAlike(const SideConstants& a, const SideConstants& b) {
    for (std::size_t k = 0; k < a.size(); ++k)
        if (!(std::abs(a[k] - b[k]) <= alike * std::abs(a[k]))) return false;
    return true;
}

// One function for each use: the compiler makes vectorised versions of functions, not of templates.
#define MEMBRANE_SIDES(name, ...)                                                                                      \
    MEMBRANE_VECTORISED GroupEnergy name(const SideTable& table, int group, const GroupJob& job) {                     \
        return addBlocks<__VA_ARGS__>(table, group, job);                                                              \
    }
MEMBRANE_SIDES(springs, Wanted::springs, Sums::none)
MEMBRANE_SIDES(springsWithWorks, Wanted::springs, Sums::works)
MEMBRANE_SIDES(springsWithEnergies, Wanted::springs, Sums::energies)
MEMBRANE_SIDES(brakes, Wanted::brakes, Sums::none)
MEMBRANE_SIDES(together, Wanted::together, Sums::none)
MEMBRANE_SIDES(apart, Wanted::apart, Sums::none)
MEMBRANE_SIDES(apartWithWorks, Wanted::apart, Sums::works)
MEMBRANE_SIDES(apartWithEnergies, Wanted::apart, Sums::energies)
#undef MEMBRANE_SIDES

} // namespace

void SideForces::arrange(const Partition& partition) {
    std::vector<std::array<int, 2>> film, cables;
    std::vector<int> sideOf, cableOf;
    for (std::size_t i = 0; i < rest_->sides.size(); ++i) {
        const Side& s = rest_->sides[i];
        if (!rest_->isSpring(s)) continue;
        const bool cable = s.kind == SideKind::cable;
        (cable ? cables : film).push_back({s.a, s.b});
        (cable ? cableOf : sideOf).push_back(static_cast<int>(i));
    }
    order_ = membrane::arrange<2>(film, partition, 2);
    for (int& e : order_.element)
        if (e >= 0) e = sideOf[e];
    for (Array* column : {&stiffness_, &restLength_, &critical_, &coefficient_, &length_}) column->clear();
    constants_.clear();
    cableLength_.clear();
    arrangeConstants();
    arrangeCables(membrane::arrange<2>(cables, partition), cableOf);
}

void SideForces::arrangeConstants() {
    const auto constantsOf = [&](int e) -> SideConstants {
        if (e < 0) return {0., 1., 0., 0.};
        const Side& s = rest_->sides[e];
        return {s.stiffness, s.restLength, s.critical, damping_.empty() ? 0. : damping_[e]};
    };
    const auto append = [this](const SideConstants& c) {
        stiffness_.push_back(c[0]);
        restLength_.push_back(c[1]);
        critical_.push_back(c[2]);
        coefficient_.push_back(c[3]);
    };
    std::vector<std::pair<SideConstants, int>> shared; // few; the last are the likeliest
    for (Block& block : order_.blocks) {
        const SideConstants first = constantsOf(order_.element[block.begin]);
        bool uniform = block.count() > blockSize / 2 && shared.size() < 64;
        for (int e = block.begin; uniform && e < block.end; ++e)
            uniform = areAlike(first, constantsOf(order_.element[e]));
        if (uniform) {
            const auto found =
                std::find_if(shared.rbegin(), shared.rend(), [&](const auto& s) { return areAlike(first, s.first); });
            block.uniform = true;
            if (found != shared.rend()) {
                constants_.push_back(found->second);
                continue;
            }
            shared.emplace_back(first, static_cast<int>(stiffness_.size()));
        }
        constants_.push_back(static_cast<int>(stiffness_.size()));
        if (uniform)
            for (int e = 0; e < blockSize; ++e) append(first);
        else
            for (int e = block.begin; e < block.paddedEnd(); ++e) append(constantsOf(order_.element[e]));
    }
}

void SideForces::arrangeCables(const Arrangement<2>& order, const std::vector<int>& cableOf) {
    cables_.clear();
    cableGroups_.clear();
    for (std::size_t g = 0; g + 1 < order.groups.size(); ++g) {
        cableGroups_.push_back(static_cast<int>(cables_.size()));
        for (int b = order.groups[g]; b < order.groups[g + 1]; ++b)
            for (int e = order.blocks[b].begin; e < order.blocks[b].end; ++e)
                cables_.push_back(cableOf[order.element[e]]);
    }
    cableGroups_.push_back(static_cast<int>(cables_.size()));
}

void SideForces::widen(int group, int& first, int& last) const {
    ArrangedForce<2>::widen(group, first, last);
    for (int i = cableGroups_[group]; i < cableGroups_[group + 1]; ++i) {
        const Side& s = rest_->sides[cables_[i]];
        first = std::min(first, s.a);
        last = std::max(last, s.b + 1);
    }
}

GroupEnergy SideForces::add(int group, const GroupJob& job) {
    if (!job.elastic.isThere() && damping_.empty()) return {};
    GroupEnergy sum = addFilm(group, job);
    for (int i = cableGroups_[group]; i < cableGroups_[group + 1]; ++i) addCable(i, job, sum);
    return sum;
}

GroupEnergy SideForces::addFilm(int group, const GroupJob& job) {
    const SideTable table{
        order_,
        constants_,
        {stiffness_.data(), restLength_.data(), critical_.data(), coefficient_.data(), length_.data()}};
    if (!job.elastic.isThere()) return brakes(table, group, job);
    const auto fitting = [&](auto none, auto works, auto energies) {
        return job.sums == Sums::none ? none : job.sums == Sums::works ? works : energies;
    };
    if (damping_.empty()) return fitting(springs, springsWithWorks, springsWithEnergies)(table, group, job);
    if (job.sums == Sums::none && job.elastic.values.x == job.own.values.x) return together(table, group, job);
    return fitting(apart, apartWithWorks, apartWithEnergies)(table, group, job);
}

void SideForces::addCable(int i, const GroupJob& job, GroupEnergy& sum) {
    const Side& s = rest_->sides[cables_[i]];
    const Eigen::Vector3d span = job.x.at(s.b) - job.x.at(s.a);
    const double length = span.norm();
    if (job.sums != Sums::none) {
        sum.elastic += sideEnergy(length, s.stiffness, s.restLength, s.critical);
        sum.kink += kinkEnergy(cableLength_[i], length, s.stiffness, s.critical);
        cableLength_[i] = length;
    }
    if (!(length > s.restLength)) return; // slack: neither pulls nor is damped
    const double tension = sideTension(length, s.stiffness, s.restLength, s.critical);
    if (job.elastic.isThere()) {
        const Eigen::Vector3d force = tension / length * span;
        job.elastic.add(s.a, force);
        job.elastic.add(s.b, -force);
    }
    if (damping_.empty()) return;
    const double rate = span.dot(job.u.at(s.b) - job.u.at(s.a)) / length;
    const Eigen::Vector3d force = cableDamping(damping_[cables_[i]], rate, tension) / length * span;
    job.own.add(s.a, force);
    job.own.add(s.b, -force);
}

void SideForces::addTo(LinearForces& to, const Points& x, const Points&) const {
    to.sides.reserve(rest_->sides.size());
    for (std::size_t i = 0; i < rest_->sides.size(); ++i)
        if (rest_->isSpring(rest_->sides[i]))
            to.addSide(tautSide(rest_->sides[i], damping_.empty() ? 0. : damping_[i], x));
}

Culprit SideForces::culprit(const Moment& moment, bool elastic) const {
    Culprit most;
    for (const Side& s : rest_->sides) {
        if (!rest_->isSpring(s)) continue;
        const double now = (moment.x[s.b] - moment.x[s.a]).norm();
        const double then = (moment.before[s.b] - moment.before[s.a]).norm(), change = now - then;
        const double mean = 0.5 * (sideTension(now, s.stiffness, s.restLength, s.critical) +
                                   sideTension(then, s.stiffness, s.restLength, s.critical));
        most.consider(elastic ? std::abs(mean * change) : s.stiffness * change * change, "side", {s.a, s.b});
    }
    return most;
}

void SideForces::appendMemory(std::vector<double>& lengths) const {
    const std::size_t first = lengths.size();
    lengths.resize(first + rest_->sides.size());
    for (std::size_t e = 0; e < order_.size(); ++e)
        if (order_.element[e] >= 0) lengths[first + order_.element[e]] = length_[e];
    for (std::size_t i = 0; i < cables_.size(); ++i) lengths[first + cables_[i]] = cableLength_[i];
}

void SideForces::setMemory(const double* lengths) {
    length_.resize(order_.size(), 1.);
    for (std::size_t e = 0; e < order_.size(); ++e)
        if (order_.element[e] >= 0) length_[e] = lengths[order_.element[e]];
    cableLength_.resize(cables_.size());
    for (std::size_t i = 0; i < cables_.size(); ++i) cableLength_[i] = lengths[cables_[i]];
}

void SideForces::setMemoryFrom(const Points& x) {
    std::vector<double> lengths;
    lengths.reserve(rest_->sides.size());
    for (const Side& s : rest_->sides) lengths.push_back((x[s.b] - x[s.a]).norm());
    setMemory(lengths.data());
}

} // namespace membrane

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
        double brake = brakes ? c.damping[e] * span.dot(ub.at(e) - ua.at(e)) * inverse : 0.;
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

/// Adds a block's values, lane by lane, to a sum; those of padding must be 0.
inline void addUp(const Block& block, const double* value, double (&sum)[lanes]) {
    for (int e = 0; e < block.paddedCount(); e += lanes)
        for (int lane = 0; lane < lanes; ++lane) sum[lane] += value[e + lane];
}
inline double total(const double (&sum)[lanes]) {
    double all = 0.;
    for (const double part : sum) all += part;
    return all;
}

template <Wanted wanted, Sums sums> inline SideEnergy addBlocks(SideTable& table, int group, const SideJob& job) {
    constexpr bool springs = wanted != Wanted::brakes, brakes = wanted != Wanted::springs;
    constexpr bool brakesApart = wanted == Wanted::brakes || wanted == Wanted::apart;
    double stored[lanes] = {}, missed[lanes] = {};
    Results results;
    BlockVectors gathered[4];
    for (int i = table.order.groups[group]; i < table.order.groups[group + 1]; ++i) {
        const Block block = table.order.blocks[i];
        const int first = table.constants[i];
        const SideColumns constants{table.stiffness.data() + first, table.restLength.data() + first,
                                    table.critical.data() + first, table.damping.data() + first,
                                    sums != Sums::none ? table.length.data() + block.begin : nullptr};
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
            addCorner(block, results.brake, a, job.damping);
            subtractCorner(block, results.brake, b, job.damping);
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
    MEMBRANE_VECTORISED SideEnergy name(SideTable& table, int group, const SideJob& job) {                             \
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

SideEnergy addFilm(SideTable& table, int group, const SideJob& job) {
    const bool elastic = job.elastic.isThere(), damped = job.damping.isThere();
    if (!elastic) return brakes(table, group, job);
    const auto fitting = [&](auto none, auto works, auto energies) {
        return job.sums == Sums::none ? none : job.sums == Sums::works ? works : energies;
    };
    if (!damped) return fitting(springs, springsWithWorks, springsWithEnergies)(table, group, job);
    if (job.sums == Sums::none && job.elastic.values.x == job.damping.values.x) return together(table, group, job);
    return fitting(apart, apartWithWorks, apartWithEnergies)(table, group, job);
}

} // namespace

SideTable sideTable(const RestState& rest, const std::vector<double>& damping, const Partition& partition) {
    SideTable table;
    std::vector<std::array<int, 2>> film;
    std::vector<int> sideOf;
    std::vector<std::array<int, 2>> cables;
    std::vector<int> cableOf;
    for (std::size_t i = 0; i < rest.sides.size(); ++i) {
        const Side& s = rest.sides[i];
        const bool cable = s.kind == SideKind::cable;
        (cable ? cables : film).push_back({s.a, s.b});
        (cable ? cableOf : sideOf).push_back(static_cast<int>(i));
    }
    table.order = arrange<2>(film, partition, 2);
    for (int& e : table.order.element)
        if (e >= 0) e = sideOf[e];
    const auto constantsOf = [&](int e) -> SideConstants {
        if (e < 0) return {0., 1., 0., 0.};
        const Side& s = rest.sides[e];
        return {s.stiffness, s.restLength, s.critical, damping.empty() ? 0. : damping[e]};
    };
    const auto append = [&table](const SideConstants& c) {
        table.stiffness.push_back(c[0]);
        table.restLength.push_back(c[1]);
        table.critical.push_back(c[2]);
        table.damping.push_back(c[3]);
    };
    std::vector<std::pair<SideConstants, int>> shared; // few; the last are the likeliest
    for (Block& block : table.order.blocks) {
        const SideConstants first = constantsOf(table.order.element[block.begin]);
        bool uniform = block.count() > blockSize / 2 && shared.size() < 64;
        for (int e = block.begin; uniform && e < block.end; ++e)
            uniform = areAlike(first, constantsOf(table.order.element[e]));
        if (uniform) {
            const auto found =
                std::find_if(shared.rbegin(), shared.rend(), [&](const auto& s) { return areAlike(first, s.first); });
            block.uniform = true;
            if (found != shared.rend()) {
                table.constants.push_back(found->second);
                continue;
            }
            shared.emplace_back(first, static_cast<int>(table.stiffness.size()));
        }
        table.constants.push_back(static_cast<int>(table.stiffness.size()));
        if (uniform)
            for (int e = 0; e < blockSize; ++e) append(first);
        else
            for (int e = block.begin; e < block.paddedEnd(); ++e) append(constantsOf(table.order.element[e]));
    }
    const Arrangement<2> order = arrange<2>(cables, partition);
    for (std::size_t g = 0; g + 1 < order.groups.size(); ++g) {
        table.cableGroups.push_back(static_cast<int>(table.cables.size()));
        for (int b = order.groups[g]; b < order.groups[g + 1]; ++b)
            for (int e = order.blocks[b].begin; e < order.blocks[b].end; ++e)
                table.cables.push_back(cableOf[order.element[e]]);
    }
    table.cableGroups.push_back(static_cast<int>(table.cables.size()));
    return table;
}

SideEnergy addSides(SideTable& table, const RestState& rest, const std::vector<double>& damping, int group,
                    const SideJob& job) {
    const bool elastic = job.elastic.isThere(), damped = job.damping.isThere();
    if (!elastic && !damped) return {};
    SideEnergy sum = addFilm(table, group, job);
    for (int i = table.cableGroups[group]; i < table.cableGroups[group + 1]; ++i) {
        const Side& s = rest.sides[table.cables[i]];
        const Eigen::Vector3d span = job.x.at(s.b) - job.x.at(s.a);
        const double length = span.norm();
        if (job.sums != Sums::none) {
            sum.elastic += sideEnergy(length, s.stiffness, s.restLength, s.critical);
            sum.kink += kinkEnergy(table.cableLength[i], length, s.stiffness, s.critical);
            table.cableLength[i] = length;
        }
        if (!(length > s.restLength)) continue; // slack: neither pulls nor is damped
        const double tension = sideTension(length, s.stiffness, s.restLength, s.critical);
        if (elastic) {
            const Eigen::Vector3d force = tension / length * span;
            job.elastic.add(s.a, force);
            job.elastic.add(s.b, -force);
        }
        if (damped) {
            const double rate = span.dot(job.u.at(s.b) - job.u.at(s.a)) / length;
            const Eigen::Vector3d force = cableDamping(damping[table.cables[i]], rate, tension) / length * span;
            job.damping.add(s.a, force);
            job.damping.add(s.b, -force);
        }
    }
    return sum;
}

} // namespace membrane

// SPDX-License-Identifier: GPL-2.0-or-later
#include "SideKernel.hpp"
#include "../mechanics/Damping.hpp"
#include "../mechanics/SideForce.hpp"
#include "BlockTransfer.hpp"
#include <cmath>

namespace membrane {
namespace {

struct Constants {
    const double *stiffness, *restLength, *critical, *damping;
    double* length;
};

/// Forces and energies of a block's sides.
struct Results {
    BlockVectors pull, brake;
    double energy[blockSize], kink[blockSize];
};

template <bool elastic, bool damped, bool energy>
inline void compute(int count, const Components& xa, const Components& xb, const Components& ua, const Components& ub,
                    const Constants& c, Results& out) {
    const int padded = wholeLanes(count);
#pragma GCC ivdep
    for (int e = 0; e < padded; ++e) {
        const Eigen::Vector3d span = xb.at(e) - xa.at(e);
        const double length = span.norm();
        const double inverse = length > 0. ? 1. / length : 0.;
        if (elastic) {
            const double pull = sideTension(length, c.stiffness[e], c.restLength[e], c.critical[e]) * inverse;
            for (int k = 0; k < 3; ++k) out.pull.component[k][e] = pull * span[k];
        }
        if (damped) {
            const double rate = span.dot(ub.at(e) - ua.at(e)) * inverse;
            const double brake = c.damping[e] * rate * inverse;
            for (int k = 0; k < 3; ++k) out.brake.component[k][e] = brake * span[k];
        }
        if (energy) {
            out.energy[e] = sideEnergy(length, c.stiffness[e], c.restLength[e], c.critical[e]);
            out.kink[e] = kinkEnergy(c.length[e], length, c.stiffness[e], c.critical[e]);
            c.length[e] = length;
        }
    }
}

template <bool elastic, bool damped, bool energy>
inline SideEnergy addBlocks(SideTable& table, int group, const SideJob& job) {
    SideEnergy sum;
    Results results;
    BlockVectors gathered[4];
    for (int i = table.order.groups[group]; i < table.order.groups[group + 1]; ++i) {
        const Block block = table.order.blocks[i];
        const int count = block.end - block.begin;
        const int first = table.constants[i];
        const Constants constants{table.stiffness.data() + first, table.restLength.data() + first,
                                  table.critical.data() + first, table.damping.data() + first,
                                  energy ? table.length.data() + block.begin : nullptr};
        const int* const a = table.order.node[0].data() + block.begin;
        const int* const b = table.order.node[1].data() + block.begin;
        compute<elastic, damped, energy>(
            count, cornerOf(block, a, job.x, gathered[0]), cornerOf(block, b, job.x, gathered[1]),
            damped ? cornerOf(block, a, job.u, gathered[2]) : Components(),
            damped ? cornerOf(block, b, job.u, gathered[3]) : Components(), constants, results);
        if (elastic && damped && job.elastic.x == job.damping.x)
            for (int k = 0; k < 3; ++k) {
                const int padded = wholeLanes(count);
#pragma GCC ivdep
                for (int e = 0; e < padded; ++e) results.pull.component[k][e] += results.brake.component[k][e];
            }
        if (elastic) {
            addCorner(block, results.pull, a, job.elastic);
            subtractCorner(block, results.pull, b, job.elastic);
        }
        if (damped && !(elastic && job.elastic.x == job.damping.x)) {
            addCorner(block, results.brake, a, job.damping);
            subtractCorner(block, results.brake, b, job.damping);
        }
        if (job.prefetch) job.prefetch->next();
        if (energy) {
            double stored = 0., missed = 0.;
#pragma omp simd reduction(+ : stored, missed)
            for (int e = 0; e < count; ++e) {
                stored += results.energy[e];
                missed += results.kink[e];
            }
            sum.elastic += stored;
            sum.kink += missed;
        }
    }
    return sum;
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
MEMBRANE_SIDES(elasticSides, true, false, false)
MEMBRANE_SIDES(dampedSides, true, true, false)
MEMBRANE_SIDES(brakes, false, true, false)
MEMBRANE_SIDES(elasticSidesWithEnergy, true, false, true)
MEMBRANE_SIDES(dampedSidesWithEnergy, true, true, true)
#undef MEMBRANE_SIDES

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
    for (const Block& block : table.order.blocks) {
        const SideConstants first = constantsOf(table.order.element[block.begin]);
        bool uniform = block.end - block.begin > blockSize / 2 && shared.size() < 64;
        for (int e = block.begin; uniform && e < block.end; ++e)
            uniform = areAlike(first, constantsOf(table.order.element[e]));
        if (uniform) {
            const auto found =
                std::find_if(shared.rbegin(), shared.rend(), [&](const auto& s) { return areAlike(first, s.first); });
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
            for (int e = block.begin; e < block.begin + wholeLanes(block.end - block.begin); ++e)
                append(constantsOf(table.order.element[e]));
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
    const bool elastic = job.elastic.x, damped = job.damping.x;
    SideEnergy sum;
    if (!elastic && !damped) return sum;
    if (!elastic)
        sum = brakes(table, group, job);
    else if (job.energy)
        sum = damped ? dampedSidesWithEnergy(table, group, job) : elasticSidesWithEnergy(table, group, job);
    else
        sum = damped ? dampedSides(table, group, job) : elasticSides(table, group, job);

    for (int i = table.cableGroups[group]; i < table.cableGroups[group + 1]; ++i) {
        const Side& s = rest.sides[table.cables[i]];
        const Eigen::Vector3d span = job.x.at(s.b) - job.x.at(s.a);
        const double length = span.norm();
        if (job.energy) {
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

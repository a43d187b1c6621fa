// SPDX-License-Identifier: GPL-2.0-or-later
#include "MathFlags.hpp" // like a CREATE_CPP_LOCAL_LOGGER it keeps this out of unity builds

#include "FilmKernel.hpp"

namespace membrane {
namespace {

struct FilmColumns {
    const double *square[3], *trace[3], *normal[3], *shear[3], *area;
    double* grown[3];

    FilmRest at(int e) const {
        FilmRest rest;
        for (int i = 0; i < 3; ++i) {
            rest.square[i] = square[i][e];
            rest.trace[i] = trace[i][e];
            rest.normal[i] = normal[i][e];
            rest.shear[i] = shear[i][e];
        }
        rest.area = area[e];
        return rest;
    }
};

/// Which forces of the film are wanted: elastic, damping, both added together or both kept apart.
enum class FilmParts { elastic, damping, together, apart };

/// Forces on the corners of a block's triangles, and their energies.
struct FilmResults {
    BlockVectors elastic[3], damping[3];
    double energy[blockSize], kink[blockSize];
};

inline void setForces(BlockVectors (&to)[3], int e, const Eigen::Vector3d (&force)[3]) {
    for (int corner = 0; corner < 3; ++corner)
        for (int k = 0; k < 3; ++k) to[corner].component[k][e] = force[corner][k];
}

template <FilmParts wanted, Sums sums>
inline void compute(int padded, int first, const OfCorners& x, const OfCorners& u, const FilmColumns& columns,
                    const FilmLaw& law, FilmResults& out) {
#pragma GCC ivdep
    for (int e = 0; e < padded; ++e) {
        const FilmRest rest = columns.at(first + e);
        const FilmSides sides(x.a.at(e), x.b.at(e), x.c.at(e));
        const Eigen::Vector3d grown = sides.grown(rest);
        Eigen::Vector3d ahead = grown;
        if (wanted != FilmParts::elastic) ahead += law.time * sides.growing(u.a.at(e), u.b.at(e), u.c.at(e));
        Eigen::Vector3d force[3];
        if (wanted == FilmParts::together) {
            sides.forces(filmGradient(law, rest, ahead), force);
            setForces(out.elastic, e, force);
            continue;
        }
        const Eigen::Vector3d g = filmGradient(law, rest, grown);
        if (wanted != FilmParts::damping) {
            sides.forces(g, force);
            setForces(out.elastic, e, force);
        }
        if (wanted != FilmParts::elastic) {
            sides.forces(filmGradient(law, rest, ahead) - g, force);
            setForces(out.damping, e, force);
        }
        if (sums == Sums::none) continue;
        const Eigen::Vector3d before(columns.grown[0][first + e], columns.grown[1][first + e],
                                     columns.grown[2][first + e]);
        const double energy = law.thickness * rest.area * filmEnergyDensity(law, filmStrain(rest, grown));
        const double was = law.thickness * rest.area * filmEnergyDensity(law, filmStrain(rest, before));
        out.energy[e] = energy;
        out.kink[e] = energy - was - 0.5 * (g + filmGradient(law, rest, before)).dot(grown - before);
        for (int i = 0; i < 3; ++i) columns.grown[i][first + e] = grown[i];
    }
}

struct FilmTable {
    const Arrangement<3>& order;
    FilmColumns columns;
    const FilmLaw& law;
};

template <FilmParts wanted, Sums sums>
inline GroupEnergy addFilmBlocks(const FilmTable& table, int group, const GroupJob& job) {
    BlockVectors roomX[3], roomU[3];
    FilmResults results;
    GroupEnergy sum;
    for (int i = table.order.groups[group]; i < table.order.groups[group + 1]; ++i) {
        const Block block = table.order.blocks[i];
        const OfCorners x = ofCorners(table.order, block, job.x, roomX);
        const OfCorners u = wanted == FilmParts::elastic ? x : ofCorners(table.order, block, job.u, roomU);
        compute<wanted, sums>(block.paddedCount(), block.begin, x, u, table.columns, table.law, results);
        for (int k = 0; k < 3; ++k) {
            const int* const node = table.order.node[k].data() + block.begin;
            if (wanted != FilmParts::damping) {
                clearPadding(block, results.elastic[k]);
                addCorner(block, results.elastic[k], node, job.elastic);
            }
            if (wanted == FilmParts::damping || wanted == FilmParts::apart) {
                clearPadding(block, results.damping[k]);
                addCorner(block, results.damping[k], node, job.own);
            }
        }
        if (sums == Sums::none) continue;
        for (int e = 0; e < block.count(); ++e) {
            // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): compute() has set all of them
            sum.elastic += results.energy[e];
            sum.kink += results.kink[e];
        }
    }
    return sum;
}

// One function for each use: the compiler makes vectorised versions of functions, not of templates.
#define MEMBRANE_FILM(name, ...)                                                                                       \
    MEMBRANE_VECTORISED GroupEnergy name(const FilmTable& table, int group, const GroupJob& job) {                     \
        return addFilmBlocks<__VA_ARGS__>(table, group, job);                                                          \
    }
MEMBRANE_FILM(elasticFilm, FilmParts::elastic, Sums::none)
MEMBRANE_FILM(elasticFilmWithSums, FilmParts::elastic, Sums::energies)
MEMBRANE_FILM(filmDamping, FilmParts::damping, Sums::none)
MEMBRANE_FILM(dampedFilm, FilmParts::together, Sums::none)
MEMBRANE_FILM(filmApart, FilmParts::apart, Sums::none)
MEMBRANE_FILM(filmApartWithSums, FilmParts::apart, Sums::energies)
#undef MEMBRANE_FILM

} // namespace

Eigen::Vector3i FilmForce::sorted(Eigen::Vector3i triangle) {
    std::sort(triangle.data(), triangle.data() + 3);
    return triangle;
}

FilmRest FilmForce::restOf(const Eigen::Vector3i& t) const {
    return {(*nodes_)[t[0]], (*nodes_)[t[1]], (*nodes_)[t[2]]};
}

void FilmForce::arrange(const Partition& partition) {
    TriangleForce::arrange(partition);
    for (auto* three : {&square_, &trace_, &normal_, &shear_, &grown_})
        for (Array& column : *three) column.clear();
    area_.clear();
    for (const int e : order_.element) {
        const FilmRest rest = e >= 0 ? restOf(sorted((*triangles_)[e])) : FilmRest();
        for (int i = 0; i < 3; ++i) {
            square_[i].push_back(rest.square[i]);
            trace_[i].push_back(rest.trace[i]);
            normal_[i].push_back(rest.normal[i]);
            shear_[i].push_back(rest.shear[i]);
        }
        area_.push_back(rest.area);
    }
}

GroupEnergy FilmForce::add(int group, const GroupJob& job) {
    FilmColumns columns{};
    for (int i = 0; i < 3; ++i) {
        columns.square[i] = square_[i].data();
        columns.trace[i] = trace_[i].data();
        columns.normal[i] = normal_[i].data();
        columns.shear[i] = shear_[i].data();
        columns.grown[i] = grown_[i].data();
    }
    columns.area = area_.data();
    const FilmTable table{order_, columns, law_};
    const bool counted = job.sums != Sums::none, damped = law_.time > 0.;
    if (!job.elastic.isThere()) return damped ? filmDamping(table, group, job) : GroupEnergy();
    if (!damped) return (counted ? elasticFilmWithSums : elasticFilm)(table, group, job);
    if (!counted && job.elastic.values.x == job.own.values.x) return dampedFilm(table, group, job);
    return (counted ? filmApartWithSums : filmApart)(table, group, job);
}

void FilmForce::addTo(LinearForces& to, const Points& x, const Points&) const {
    to.triangles.reserve(to.triangles.size() + triangles_->size());
    for (const Eigen::Vector3i& t : *triangles_) to.addTriangle(stiffTriangle(t, restOf(t), law_, x));
}

Culprit FilmForce::culprit(const Moment& moment, bool elastic) const {
    Culprit most;
    for (const Eigen::Vector3i& t : *triangles_) {
        const FilmRest rest = restOf(t);
        const auto grownAt = [&](const Points& x) { return FilmSides(x[t[0]], x[t[1]], x[t[2]]).grown(rest); };
        const Eigen::Vector3d now = grownAt(moment.x), change = now - grownAt(moment.before);
        const double given = elastic ? std::abs(filmGradient(law_, rest, now).dot(change))
                                     : filmGradient(law_, rest, change).dot(change);
        most.consider(given, "triangle", {t[0], t[1], t[2]});
    }
    return most;
}

void FilmForce::appendMemory(std::vector<double>& grown) const {
    const std::size_t first = grown.size();
    grown.resize(first + memorySize());
    for (std::size_t e = 0; e < order_.size(); ++e) {
        if (order_.element[e] < 0) continue;
        double* const to = &grown[first + 3 * static_cast<std::size_t>(order_.element[e])];
        for (int i = 0; i < 3; ++i) to[i] = grown_[i][e];
    }
}

void FilmForce::setMemory(const double* grown) {
    for (int i = 0; i < 3; ++i) {
        grown_[i].resize(order_.size(), 0.);
        for (std::size_t e = 0; e < order_.size(); ++e)
            if (order_.element[e] >= 0) grown_[i][e] = grown[3 * static_cast<std::size_t>(order_.element[e]) + i];
    }
}

void FilmForce::setMemoryFrom(const Points& x) {
    std::vector<double> all;
    all.reserve(memorySize());
    for (const Eigen::Vector3i& triangle : *triangles_) {
        const Eigen::Vector3i t = sorted(triangle);
        const Eigen::Vector3d grown = FilmSides(x[t[0]], x[t[1]], x[t[2]]).grown(restOf(t));
        all.insert(all.end(), grown.data(), grown.data() + 3);
    }
    setMemory(all.data());
}

} // namespace membrane

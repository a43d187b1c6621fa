// SPDX-License-Identifier: GPL-2.0-or-later
#include "Sweep.hpp"
#include "../mechanics/Drag.hpp"
#ifdef _OPENMP // a YADE tree may be built without
#include <omp.h>
#endif

namespace membrane {
namespace {

void setZero(Coordinates& c) {
    for (auto* component : {&c.x, &c.y, &c.z}) std::fill(component->begin(), component->end(), 0.);
}

/// Adds a window of forces, whose first node is `first`, to the nodes begin..end-1.
void addWindow(const Coordinates& window, int first, int begin, int end, Coordinates& to) {
    for (int i = begin; i < end; ++i) {
        to.x[i] += window.x[i - first];
        to.y[i] += window.y[i - first];
        to.z[i] += window.z[i - first];
    }
}

/// Widens first..last-1 to all nodes that a group writes to, those of padding included.
template <std::size_t K> void widen(const Arrangement<K>& order, int group, int& first, int& last) {
    for (int b = order.groups[group]; b < order.groups[group + 1]; ++b)
        for (const auto& nodes : order.node)
            for (int e = order.blocks[b].begin; e < order.blocks[b].paddedEnd(); ++e) {
                first = std::min(first, nodes[e]);
                last = std::max(last, nodes[e] + 1);
            }
}

void add(MotionSums& to, const MotionSums& more) {
    for (int k = 0; k < 3; ++k) {
        to.power[k] += more.power[k];
        to.arriving[k] += more.arriving[k];
    }
    to.torque += more.torque;
    to.kinetic += more.kinetic;
    to.potential += more.potential;
    to.angularMomentum += more.angularMomentum;
}

} // namespace

void Sweep::prepare(const RestState& rest, const std::vector<Eigen::Vector3i>& triangles, const Laws& laws,
                    const std::vector<double>& masses, const std::vector<char>& owned, int parts, int chunkSize) {
    rest_ = &rest;
    sideCount_ = rest.sides.size();
    laws_ = laws;
    mass_.assign(masses.begin(), masses.end());
    const int nodes = static_cast<int>(masses.size());
    partition_ = partition(nodes, parts, chunkSize);
    sides_ = sideTable(rest, laws.damping, partition_);
    creases_ = laws.crease.bending > 0. ? creaseTable(rest, partition_) : creaseTable(RestState(), partition_);
    drag_ = dragTable(laws.airDensity > 0. ? triangles : std::vector<Eigen::Vector3i>(), partition_);
    foreign_.clear();
    for (int i = 0; i < nodes; ++i)
        if (!owned[i]) foreign_.push_back(i);
    for (Coordinates* c : {&x, &v, &u})
        if (c->size() != masses.size()) c->assign(masses.size());
    elastic_.assign(masses.size());
    damping_ = crease_ = Coordinates();
    dragWeight_.assign(laws.airDensity > 0. ? masses.size() : 0, 0.);
    hasLengths_ = false;
    partSums_.assign(parts, {});
    makeBorders();
    makeReach();
}

void Sweep::makeBorders() {
    borders_.assign(partition_.partCount(), {});
    for (int part = 0; part + 1 < partition_.partCount(); ++part) {
        Border& border = borders_[part];
        border.first = partition_.endNode(part);
        border.last = border.first;
        widen(sides_.order, part, border.first, border.last);
        widen(creases_.order, part, border.first, border.last);
        widen(drag_.order, part, border.first, border.last);
        for (int i = sides_.cableGroups[part]; i < sides_.cableGroups[part + 1]; ++i) {
            const Side& s = rest_->sides[sides_.cables[i]];
            border.first = std::min(border.first, s.a);
            border.last = std::max(border.last, s.b + 1);
        }
        border.elastic.assign(border.last - border.first);
        border.dragWeight.assign(dragWeight_.empty() ? 0 : border.last - border.first, 0.);
    }
}

/// Room for the forces of damping and creases by themselves; made before threads begin, which must not throw.
void Sweep::keepApart() {
    if (damping_.size()) return;
    damping_.assign(x.size());
    crease_.assign(x.size());
    for (Border& border : borders_) {
        border.damping.assign(border.last - border.first);
        border.crease.assign(border.last - border.first);
    }
}

void Sweep::makeReach() {
    constexpr int cached = 8192; // so many nodes with all their arrays stay in the second-level cache
    reach_.clear();
    if (partition_.chunks.back() <= cached) return;
    int first = 0, last = 0;
    for (int chunk = 0; chunk < partition_.chunkCount(); ++chunk) {
        widen(sides_.order, partition_.partCount() + chunk, first, last);
        reach_.push_back(last);
    }
}

/// Lets the work on a chunk fetch what the next one needs.
void Sweep::prefetchAfter(int chunk, int part, Prefetch& prefetch) {
    if (reach_.empty()) return;
    const int group = partition_.partCount() + chunk;
    prefetch.start(sides_.order.groups[group + 1] - sides_.order.groups[group]);
    if (chunk + 1 >= partition_.parts[part + 1]) return;
    prefetch.add(Components(x), reach_[chunk], reach_[chunk + 1]);
    prefetch.add(Components(u), reach_[chunk], reach_[chunk + 1]);
    prefetch.add(Components(elastic_), reach_[chunk], reach_[chunk + 1]);
    prefetch.add(Components(v), partition_.chunks[chunk + 1], partition_.chunks[chunk + 2]);
    prefetch.add(mass_.data(), partition_.chunks[chunk + 1], partition_.chunks[chunk + 2]);
}

SideEnergy Sweep::addGroup(int group, const Targets& to, const SweepStep& now, Prefetch* prefetch) {
    SideJob job;
    job.x = Components(x);
    job.u = Components(u);
    if (now.elastic) job.elastic = to.elastic;
    if (!laws_.damping.empty()) job.damping = to.damping;
    job.sums = now.sums;
    job.prefetch = prefetch;
    const SideEnergy energy = addSides(sides_, *rest_, laws_.damping, group, job);
    if (creases_.order.size()) addCreases(creases_, laws_.crease, group, job.x, to.crease);
    if (drag_.order.size()) addDragWeights(drag_, group, job.x, job.u, to.dragWeight);
    return energy;
}

void Sweep::computeBorder(int part, const SweepStep& now) {
    Border& border = borders_[part];
    partSums_[part] = {};
    if (border.first == border.last) return;
    Targets to;
    setZero(border.elastic);
    to.elastic = to.damping = to.crease = Window(border.elastic, border.first);
    if (now.apart) {
        setZero(border.damping);
        setZero(border.crease);
        to.damping = Window(border.damping, border.first);
        to.crease = Window(border.crease, border.first);
    }
    std::fill(border.dragWeight.begin(), border.dragWeight.end(), 0.);
    if (!border.dragWeight.empty()) to.dragWeight = {border.dragWeight.data(), border.first};
    partSums_[part].energy = addGroup(part, to, now, nullptr);
}

void Sweep::addBorders(int part, bool apart) {
    for (const Border& border : borders_) {
        const int begin = std::max(border.first, partition_.firstNode(part));
        const int end = std::min(border.last, partition_.endNode(part));
        addWindow(border.elastic, border.first, begin, end, elastic_);
        if (apart) {
            addWindow(border.damping, border.first, begin, end, damping_);
            addWindow(border.crease, border.first, begin, end, crease_);
        }
        if (!dragWeight_.empty())
            for (int i = begin; i < end; ++i) dragWeight_[i] += border.dragWeight[i - border.first];
    }
}

void Sweep::sweepPart(int part, const SweepStep& now) {
    PartSums& sums = partSums_[part];
    Targets to;
    to.elastic = to.damping = to.crease = Window(elastic_);
    if (now.apart) {
        to.damping = Window(damping_);
        to.crease = Window(crease_);
    }
    if (!dragWeight_.empty()) to.dragWeight = {dragWeight_.data(), 0};

    Motion motion;
    motion.x = Components(x);
    motion.v = Components(v);
    motion.u = Components(u);
    motion.elastic = to.elastic.values;
    motion.damping = to.damping.values;
    motion.crease = to.crease.values;
    motion.dragWeight = to.dragWeight.values;
    motion.mass = mass_.data();
    motion.dt = now.dt;
    motion.airDensity = laws_.airDensity;
    motion.localDamping = now.localDamping;
    motion.gravity = now.gravity;
    motion.centrifugal = now.centrifugal;

    Prefetch prefetch;
    if (partition_.partCount() > 1) addBorders(part, now.apart);
    for (int chunk = partition_.parts[part]; chunk < partition_.parts[part + 1]; ++chunk) {
        prefetchAfter(chunk, part, prefetch);
        const SideEnergy energy =
            addGroup(partition_.partCount() + chunk, to, now, reach_.empty() ? nullptr : &prefetch);
        sums.energy.elastic += energy.elastic;
        sums.energy.kink += energy.kink;
        if (!now.move) continue;
        int begin = partition_.chunks[chunk];
        const int end = partition_.chunks[chunk + 1];
        for (auto stop = std::lower_bound(foreign_.begin(), foreign_.end(), begin); begin < end; ++stop) {
            const int last = stop == foreign_.end() ? end : std::min(end, *stop);
            if (begin < last) sums.lost += moveNodes(begin, last, motion, now.sums, sums.motion);
            begin = last + 1;
            if (stop == foreign_.end()) break;
        }
    }
}

bool Sweep::step(const SweepStep& now) {
    if (now.apart) keepApart();
    // A step that moves leaves no force on the nodes that it owns.
    if (moved_)
        for (const int node : foreign_) clearForces(node);
    else
        clearForces();
    for (const auto& [node, f] : outside) elastic_.add(node, f);
    moved_ = now.move;
    if (now.sums != Sums::none && !hasLengths_) {
        std::vector<double> before(rest_->sides.size()); // from where the nodes were a step ago
        for (std::size_t i = 0; i < before.size(); ++i) {
            const Side& s = rest_->sides[i];
            before[i] = ((x.at(s.b) - now.dt * v.at(s.b)) - (x.at(s.a) - now.dt * v.at(s.a))).norm();
        }
        setLengths(before);
    }
    if (now.sums == Sums::none) hasLengths_ = false;

    const int parts = partition_.partCount();
    if (parts == 1) {
        partSums_[0] = {};
        sweepPart(0, now);
    } else {
#ifdef _OPENMP
#pragma omp parallel num_threads(std::min(parts, omp_get_num_procs()))
        {
            for (int p = omp_get_thread_num(); p < parts; p += omp_get_num_threads()) computeBorder(p, now);
#pragma omp barrier
            for (int p = omp_get_thread_num(); p < parts; p += omp_get_num_threads()) sweepPart(p, now);
        }
#else
        for (int p = 0; p < parts; ++p) computeBorder(p, now);
        for (int p = 0; p < parts; ++p) sweepPart(p, now);
#endif
    }
    motion_ = {};
    energy_ = {};
    double lost = 0.;
    for (const PartSums& sums : partSums_) {
        add(motion_, sums.motion);
        energy_.elastic += sums.energy.elastic;
        energy_.kink += sums.energy.kink;
        lost += sums.lost;
    }
    return lost == 0.;
}

Eigen::Vector3d Sweep::dragForce(int node) const {
    if (dragWeight_.empty()) return Eigen::Vector3d::Zero();
    return nodeDrag(laws_.airDensity, dragWeight_[node], u.at(node));
}

Eigen::Vector3d Sweep::force(int node) const {
    return elastic_.at(node) + dampingForce(node) + creaseForce(node) + dragForce(node);
}

void Sweep::clearForces(int node) {
    elastic_.set(node, Eigen::Vector3d::Zero());
    if (damping_.size()) damping_.set(node, Eigen::Vector3d::Zero());
    if (crease_.size()) crease_.set(node, Eigen::Vector3d::Zero());
    if (!dragWeight_.empty()) dragWeight_[node] = 0.;
}

void Sweep::clearForces() {
    for (Coordinates* c : {&elastic_, &damping_, &crease_}) setZero(*c);
    std::fill(dragWeight_.begin(), dragWeight_.end(), 0.);
}

std::vector<double> Sweep::lengths() const {
    if (!hasLengths_) return {};
    std::vector<double> all(sideCount_);
    for (std::size_t e = 0; e < sides_.order.size(); ++e)
        if (sides_.order.element[e] >= 0) all[sides_.order.element[e]] = sides_.length[e];
    for (std::size_t i = 0; i < sides_.cables.size(); ++i) all[sides_.cables[i]] = sides_.cableLength[i];
    return all;
}

void Sweep::setLengths(const std::vector<double>& lengths) {
    sides_.length.resize(sides_.order.size(), 1.);
    for (std::size_t e = 0; e < sides_.order.size(); ++e)
        if (sides_.order.element[e] >= 0) sides_.length[e] = lengths[sides_.order.element[e]];
    sides_.cableLength.resize(sides_.cables.size());
    for (std::size_t i = 0; i < sides_.cables.size(); ++i) sides_.cableLength[i] = lengths[sides_.cables[i]];
    hasLengths_ = true;
}

} // namespace membrane

// SPDX-License-Identifier: GPL-2.0-or-later
#include "Sweep.hpp"
#include "../mechanics/Drag.hpp"
#ifdef _OPENMP // a YADE tree may be built without
#include <omp.h>
#endif
#include <stdexcept>

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

} // namespace

void Sweep::prepare(const ElementForces& forces, const std::vector<double>& masses, const std::vector<char>& owned,
                    int parts, int chunkSize) {
    forces_ = forces;
    nameChannels();
    mass_.assign(masses.begin(), masses.end());
    const int nodes = static_cast<int>(masses.size());
    partition_ = partition(nodes, parts, chunkSize);
    for (const auto& force : forces_) force->arrange(partition_);
    foreign_.clear();
    for (int i = 0; i < nodes; ++i)
        if (!owned[i]) foreign_.push_back(i);
    for (Coordinates* c : {&x, &v, &u})
        if (c->size() != masses.size()) c->assign(masses.size());
    elastic_.assign(masses.size());
    own_.assign(channels_.size(), Coordinates());
    dragWeight_.assign(dragFactor_ > 0. ? masses.size() : 0, 0.);
    remembers_ = false;
    partSums_.assign(parts, {});
    makeBorders();
    makeReach();
}

void Sweep::nameChannels() {
    channels_ = {"crease", "damping", "drag"};
    exchange_ = {Exchange::stores, Exchange::loses, Exchange::loses};
    channelOf_.clear();
    dragFactor_ = 0.;
    for (const auto& force : forces_) {
        const std::string name = force->channel();
        const auto place = std::find(channels_.begin(), channels_.end(), name);
        channelOf_.push_back(static_cast<int>(place - channels_.begin()));
        if (place == channels_.end()) {
            channels_.push_back(name);
            exchange_.push_back(force->exchange());
        }
        if (channels_.size() > maxChannels)
            throw std::invalid_argument("Membrane: more than " + std::to_string(maxChannels) + " kinds of forces");
        if (!(force->viscosity() > 0.)) continue;
        if (dragFactor_ > 0.) throw std::invalid_argument("Membrane: two kinds of drag");
        dragFactor_ = force->viscosity();
    }
}

void Sweep::makeBorders() {
    borders_.assign(partition_.partCount(), {});
    for (int part = 0; part + 1 < partition_.partCount(); ++part) {
        Border& border = borders_[part];
        border.first = partition_.endNode(part);
        border.last = border.first;
        for (const auto& force : forces_) force->widen(part, border.first, border.last);
        border.elastic.assign(border.last - border.first);
        border.own.assign(channels_.size(), Coordinates());
        border.dragWeight.assign(dragWeight_.empty() ? 0 : border.last - border.first, 0.);
    }
}

/// Room for the forces of each channel by themselves; made before threads begin, which must not throw.
void Sweep::keepApart() {
    if (own_[dampingChannel].size()) return;
    for (std::size_t k = 0; k < channels_.size(); ++k) {
        if (k == dragChannel) continue;
        own_[k].assign(x.size());
        for (Border& border : borders_)
            if (!border.own.empty()) border.own[k].assign(border.last - border.first);
    }
}

void Sweep::makeReach() {
    constexpr int cached = 8192; // so many nodes with all their arrays stay in the second-level cache
    reach_.clear();
    if (partition_.chunks.back() <= cached) return;
    int first = 0, last = 0;
    for (int chunk = 0; chunk < partition_.chunkCount(); ++chunk) {
        forces_.front()->widen(partition_.partCount() + chunk, first, last);
        reach_.push_back(last);
    }
}

/// Lets the work on a chunk fetch what the next one needs.
void Sweep::prefetchAfter(int chunk, int part, Prefetch& prefetch) {
    if (reach_.empty()) return;
    const int group = partition_.partCount() + chunk;
    prefetch.start(forces_.front()->blocks(group));
    if (chunk + 1 >= partition_.parts[part + 1]) return;
    prefetch.add(Components(x), reach_[chunk], reach_[chunk + 1]);
    prefetch.add(Components(u), reach_[chunk], reach_[chunk + 1]);
    prefetch.add(Components(elastic_), reach_[chunk], reach_[chunk + 1]);
    prefetch.add(Components(v), partition_.chunks[chunk + 1], partition_.chunks[chunk + 2]);
    prefetch.add(mass_.data(), partition_.chunks[chunk + 1], partition_.chunks[chunk + 2]);
}

GroupEnergy Sweep::addGroup(int group, const Targets& to, const SweepStep& now, Prefetch* prefetch) {
    GroupJob job;
    job.x = Components(x);
    job.u = Components(u);
    if (now.elastic) job.elastic = to.elastic;
    job.viscous = to.dragWeight;
    job.sums = now.sums;
    job.prefetch = prefetch;
    GroupEnergy sum;
    for (std::size_t f = 0; f < forces_.size(); ++f) {
        job.own = to.own[channelOf_[f]];
        sum.add(forces_[f]->add(group, job));
        job.prefetch = nullptr;
    }
    return sum;
}

/// Where the forces go: to those of the strain energy, or each channel to its own.
void Sweep::Targets::choose(Coordinates& all, std::vector<Coordinates>& each, bool apart, int first) {
    elastic = Window(all, first);
    for (std::size_t k = 0; k < each.size(); ++k)
        if (k != dragChannel) own[k] = apart ? Window(each[k], first) : elastic;
}

void Sweep::computeBorder(int part, const SweepStep& now) {
    Border& border = borders_[part];
    partSums_[part] = {};
    if (border.first == border.last) return;
    Targets to;
    to.choose(border.elastic, border.own, now.apart, border.first);
    setZero(border.elastic);
    if (now.apart)
        for (Coordinates& own : border.own) setZero(own);
    std::fill(border.dragWeight.begin(), border.dragWeight.end(), 0.);
    if (!border.dragWeight.empty()) to.dragWeight = {border.dragWeight.data(), border.first};
    partSums_[part].energy = addGroup(part, to, now, nullptr);
}

void Sweep::addBorders(int part, bool apart) {
    for (const Border& border : borders_) {
        const int begin = std::max(border.first, partition_.firstNode(part));
        const int end = std::min(border.last, partition_.endNode(part));
        addWindow(border.elastic, border.first, begin, end, elastic_);
        for (std::size_t k = 0; apart && k < border.own.size(); ++k)
            if (k != dragChannel) addWindow(border.own[k], border.first, begin, end, own_[k]);
        if (!dragWeight_.empty())
            for (int i = begin; i < end; ++i) dragWeight_[i] += border.dragWeight[i - border.first];
    }
}

void Sweep::sweepPart(int part, const SweepStep& now) {
    PartSums& sums = partSums_[part];
    Targets to;
    to.choose(elastic_, own_, now.apart, 0);
    if (!dragWeight_.empty()) to.dragWeight = {dragWeight_.data(), 0};

    Motion motion;
    motion.x = Components(x);
    motion.v = Components(v);
    motion.u = Components(u);
    motion.elastic = to.elastic.values;
    motion.channels = static_cast<int>(channels_.size());
    for (int k = 0; k < motion.channels; ++k) motion.own[k] = to.own[k].values;
    motion.dragWeight = to.dragWeight.values;
    motion.mass = mass_.data();
    motion.dt = now.dt;
    motion.dragFactor = dragFactor_;
    motion.localDamping = now.localDamping;
    motion.gravity = now.gravity;
    motion.centrifugal = now.centrifugal;

    Prefetch prefetch;
    if (partition_.partCount() > 1) addBorders(part, now.apart);
    for (int chunk = partition_.parts[part]; chunk < partition_.parts[part + 1]; ++chunk) {
        prefetchAfter(chunk, part, prefetch);
        sums.energy.add(addGroup(partition_.partCount() + chunk, to, now, reach_.empty() ? nullptr : &prefetch));
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
    if (now.sums != Sums::none && !remembers_) recall(now.dt);
    if (now.sums == Sums::none) remembers_ = false;

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
        motion_.add(sums.motion);
        energy_.add(sums.energy);
        lost += sums.lost;
    }
    return lost == 0.;
}

/// Takes what the kinks are counted from, from where the nodes were a step ago.
void Sweep::recall(double dt) {
    Points before(x.size());
    for (std::size_t i = 0; i < before.size(); ++i) before[i] = x.at(i) - dt * v.at(i);
    for (const auto& force : forces_) force->setMemoryFrom(before);
    remembers_ = true;
}

Eigen::Vector3d Sweep::channelForce(int channel, int node) const {
    if (channel != dragChannel)
        return own_[channel].size() ? own_[channel].at(node) : Eigen::Vector3d(Eigen::Vector3d::Zero());
    return dragWeight_.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                               : nodeDrag(dragFactor_, dragWeight_[node], u.at(node));
}

Eigen::Vector3d Sweep::force(int node) const {
    Eigen::Vector3d sum = elastic_.at(node);
    for (const int channel : {dampingChannel, creaseChannel, dragChannel}) sum += channelForce(channel, node);
    for (int channel = otherChannels; channel < static_cast<int>(channels_.size()); ++channel)
        sum += channelForce(channel, node);
    return sum;
}

const ElementForce* Sweep::forceOf(int channel) const {
    const auto place = std::find(channelOf_.begin(), channelOf_.end(), channel);
    return place == channelOf_.end() || forces_.empty() ? nullptr : forces_[place - channelOf_.begin()].get();
}

void Sweep::clearForces(int node) {
    elastic_.set(node, Eigen::Vector3d::Zero());
    for (Coordinates& own : own_)
        if (own.size()) own.set(node, Eigen::Vector3d::Zero());
    if (!dragWeight_.empty()) dragWeight_[node] = 0.;
}

void Sweep::clearForces() {
    setZero(elastic_);
    for (Coordinates& own : own_) setZero(own);
    std::fill(dragWeight_.begin(), dragWeight_.end(), 0.);
}

std::vector<double> Sweep::memory() const {
    std::vector<double> all;
    if (remembers_)
        for (const auto& force : forces_) force->appendMemory(all);
    return all;
}

std::size_t Sweep::memorySize() const {
    std::size_t size = 0;
    for (const auto& force : forces_) size += force->memorySize();
    return size;
}

void Sweep::setMemory(const std::vector<double>& memory) {
    const double* from = memory.data();
    for (const auto& force : forces_) {
        force->setMemory(from);
        from += force->memorySize();
    }
    remembers_ = true;
}

} // namespace membrane

// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneLedger.hpp"
#include "ContactBook.hpp"
#include "FreeHub.hpp"
#include "RunEnd.hpp"
#include <algorithm>
#include <cmath>
#include <core/Scene.hpp>
#include <numeric>

namespace yade {

YADE_PLUGIN((MembraneLedger));

namespace {

/// Works of creases, damping, drag and contacts in a single step, over the energies of the membrane, that make all
/// energies wanted in the next one: a run that goes wrong may do so within a few steps.
constexpr Real restlessShare = 1e-3;

/// Of doneWorks: first the usual channels, as the sweep numbers them; last those of further forces.
enum WorkEntry : std::size_t {
    creaseEntry = ::membrane::creaseChannel,
    dampingEntry = ::membrane::dampingChannel,
    dragEntry = ::membrane::dragChannel,
    drivenEntry,
    otherEntry,
    impulseEntry,
    furtherEntries
};

/// A vector turned about -z by `angle` [rad]: the chord of a driven node's step before, from that of this step.
Vector3r turnedBack(const Vector3r& v, Real angle) {
    const Real c = std::cos(angle), s = std::sin(angle);
    return {c * v[0] + s * v[1], c * v[1] - s * v[0], v[2]};
}

/// 1 in the directions in which a body may move freely, 0 in those that are blocked.
Vector3r freeDirections(const State& state) {
    const auto open = [&state](unsigned direction) { return state.blockedDOFs & direction ? 0. : 1.; };
    return {open(State::DOF_X), open(State::DOF_Y), open(State::DOF_Z)};
}

} // namespace

/// What a step has and does.
struct MembraneLedger::Tally {
    vector<Real> arriving, mean; ///< powers by WorkEntry [W], at the velocities before this step and at their mean
    Real kinetic = 0., potential = 0., momentum = 0.;
    bool all = false; ///< energies and arriving powers are known

    Tally(const ::membrane::MotionSums& moved, std::size_t entries, bool wanted)
        : arriving(entries, 0.), mean(entries, 0.), kinetic(moved.kinetic), potential(moved.potential),
          momentum(moved.angularMomentum), all(wanted) {
        mean[impulseEntry] = moved.torque;
    }
};

void MembraneLedger::action() {
    StepGuard::refuseCall(*this);
    const FreeHub* const hub = hubOfThisStep();
    const ::membrane::Sweep& sweep = forces->sweep();
    if (started && !lastLengths.empty() && lastLengths.size() != sweep.memorySize())
        throw std::runtime_error("MembraneLedger: forces has another membrane now");
    std::size_t entry[::membrane::maxChannels];
    for (std::size_t channel = 0; channel < sweep.channels().size(); ++channel)
        entry[channel] = entryOf(sweep, static_cast<int>(channel));
    Tally tally(sweep.motionSums(), furtherEntries + furtherNames.size(),
                forces->madeSums() == ::membrane::Sums::energies);
    countNodes(tally, hub, entry);
    if (hub) countHub(tally, *hub);
    tally.arriving[impulseEntry] = tally.mean[impulseEntry]; // this step's torque all along
    bookContacts();
    bookWorks(tally);
    if (tally.all) bringUpToDate(tally);
}

/// The free hub, if any; the engines that this one looks at must have run.
const FreeHub* MembraneLedger::hubOfThisStep() const {
    if (!forces || !forces->membrane) throw std::runtime_error("MembraneLedger: forces is not set, or has no membrane");
    if (!forces->hasRun(*scene) || forces->madeSums() == ::membrane::Sums::none)
        throw std::runtime_error("MembraneLedger: its MembraneForceEngine must run in the same step, before it");
    const FreeHub* const hub = forces->hub(*scene);
    if (hub && !hub->hasRun(*scene))
        throw std::runtime_error("MembraneLedger: FreeHub must run in the same step, before it");
    return hub;
}

/// Adds what the sweep has summed, and the nodes that it has left out.
void MembraneLedger::countNodes(Tally& tally, const FreeHub* hub, const std::size_t* entry) const {
    const ::membrane::Sweep& sweep = forces->sweep();
    const ::membrane::MotionSums& moved = sweep.motionSums();
    const int channels = static_cast<int>(sweep.channels().size());
    for (int channel = 0; channel < channels; ++channel) {
        tally.arriving[entry[channel]] = moved.arriving[channel];
        tally.mean[entry[channel]] = moved.power[channel];
    }
    const auto [arrivingOutside, leavingOutside] = forces->powerFromOutside();
    tally.arriving[otherEntry] = arrivingOutside;
    tally.mean[otherEntry] = 0.5 * (arrivingOutside + leavingOutside);
    const auto& states = forces->states();
    for (const int i : forces->nodesLeft()) {
        const State& state = *states[i];
        const Vector3r x = forces->positionSeen(i);
        const bool onHub = hub && hub->turns(i); // what such a node gives or takes stays in the system
        const Vector3r free = freeDirections(state);
        const Vector3r held = onHub ? Vector3r(Vector3r::Zero()) : Vector3r(Vector3r::Ones() - free);
        const Vector3r total = forces->totalForce(i);
        Vector3r internal = sweep.elasticForce(i), ofChannel[::membrane::maxChannels];
        for (int channel = 0; channel < channels; ++channel)
            internal += ofChannel[channel] = sweep.channelForce(channel, i);
        const Vector3r other = total - internal;
        const Vector3r after = state.vel;
        const Vector3r before =
            free.isZero() && !onHub ? turnedBack(after, state.angVel[2] * scene->dt) : forces->velocitySeen(i);
        const auto addPowers = [&](vector<Real>& powers, const Vector3r& v) {
            for (int channel = 0; channel < channels; ++channel) powers[entry[channel]] += ofChannel[channel].dot(v);
            powers[drivenEntry] -= internal.cwiseProduct(held).dot(v); // what holds a node bears the forces on it
            powers[otherEntry] += other.cwiseProduct(Vector3r::Ones() - held).dot(v);
        };
        const Vector3r between = 0.5 * (before + after);
        addPowers(tally.mean, between);
        if (tally.all) addPowers(tally.arriving, before);
        tally.kinetic += 0.5 * state.mass * before.cwiseProduct(free).dot(after);
        tally.potential -= state.mass * gravity.cwiseProduct(free).dot(x);
        const Vector3r momentum = state.mass * between.cwiseProduct(free);
        tally.momentum += x[0] * momentum[1] - x[1] * momentum[0];
        // The integrator keeps gravity out of the scene's forces.
        const Vector3r pull = (total + state.mass * gravity).cwiseProduct(free);
        tally.mean[impulseEntry] += x[0] * pull[1] - x[1] * pull[0];
    }
}

void MembraneLedger::countHub(Tally& tally, const FreeHub& hub) {
    tally.kinetic += hub.kinetic();
    tally.momentum += hub.angularMomentum();
    tally.mean[impulseEntry] += hub.torque;
    tally.mean[otherEntry] += hub.contactTorque * 0.5 * (hub.spinBefore + hub.spin);
    tally.arriving[otherEntry] += hub.contactTorque * hub.spinBefore;
}

/// Work from the step before to this one is the mean of both forces times the velocity between them: half a step with
/// this step's forces before it, and half a step after it.
void MembraneLedger::bookWorks(const Tally& tally) {
    const vector<Real>&arriving = tally.arriving, &mean = tally.mean;
    doneWorks.resize(mean.size());
    if (started) {
        doneKinks += forces->sweep().elementEnergies().kink;
        if (tally.all) {
            vector<Real*> entries{&creaseWork, &dampingWork, &dragWork, &drivenWork, &contactWork, &angularImpulse};
            furtherWorks.resize(furtherNames.size());
            for (Real& work : furtherWorks) entries.push_back(&work);
            for (std::size_t i = 0; i < arriving.size(); ++i)
                *entries[i] = doneWorks[i] + 0.5 * countedStep * arriving[i];
        }
        // Both halves at once, in which arriving power need not be known, unless the step has changed.
        for (std::size_t i = 0; i < mean.size(); ++i)
            doneWorks[i] += countedStep == scene->dt
                                ? scene->dt * mean[i]
                                : 0.5 * countedStep * arriving[i] + 0.5 * scene->dt * (2. * mean[i] - arriving[i]);
    } else {
        for (std::size_t i = 0; i < mean.size(); ++i) doneWorks[i] = 0.5 * scene->dt * (2. * mean[i] - arriving[i]);
    }
    countedStep = scene->dt;
    Real moving = 0.;
    for (const std::size_t k : {creaseEntry, dampingEntry, dragEntry, otherEntry}) moving += std::abs(mean[k]);
    restless = !(scene->dt * moving <= restlessShare * (std::abs(kinetic) + elastic));
}

void MembraneLedger::bringUpToDate(const Tally& tally) {
    upToDate_ = scene->iter;
    time = scene->time;
    elastic = forces->sweep().elementEnergies().elastic;
    kinkError = doneKinks;
    kinetic = tally.kinetic;
    potential = tally.potential;
    angularMomentum = tally.momentum;
    if (started) return;
    initial = total();
    initialCrease = crease();
    initialAngularMomentum = angularMomentum;
    started = true;
}

void MembraneLedger::postLoad(MembraneLedger&) {
    const StepGuard::Look look;
    if (period <= 0) throw std::invalid_argument("MembraneLedger: period = " + std::to_string(period) + " must be > 0");
    const std::size_t entries = furtherEntries + furtherNames.size();
    if (started && doneWorks.size() != entries)
        throw std::invalid_argument("MembraneLedger: doneWorks has " + std::to_string(doneWorks.size()) +
                                    " entries; a ledger that was started has " + std::to_string(entries));
    if (furtherWorks.size() > furtherNames.size())
        throw std::invalid_argument("MembraneLedger: furtherWorks has more entries than furtherNames");
    if (contactWorks.size() != contactPairs.size() || contactMost.size() != contactPairs.size())
        throw std::invalid_argument(
            "MembraneLedger: contactPairs, contactWorks and contactMost must have the same length");
}

void MembraneLedger::bookContacts() {
    const auto& contacts = forces->contacts();
    if (contacts.empty() && contactPairs.empty()) return;
    ContactBook book{contactPairs, contactWorks, contactMost, contactEnded, contactGain, contactTaken};
    book.turnPage(*forces, *scene, gravity, !started);
}

bool MembraneLedger::wantsEnergies(const Scene& now) const {
    return !started || now.iter % period == 0 || now.dt != countedStep || restless || endsRun(now);
}

bool MembraneLedger::isUpToDate(const Scene& now) const {
    return upToDate_ == now.iter;
}

Real MembraneLedger::crease() const {
    if (!forces || !forces->membrane || !forces->law().isThere()) return 0.;
    const vector<Vector3r> x = forces->lastPositions();
    return x.empty() ? savedCrease : forces->creaseEnergy(x);
}

void MembraneLedger::preSave(MembraneLedger&) {
    const StepGuard::Look look;
    StepGuard::holdForSave();
    fetch();
}

void MembraneLedger::fetch() {
    savedCrease = crease();
    if (started && forces && forces->madeSums() != ::membrane::Sums::none) lastLengths = forces->sweep().memory();
}

/// Where a channel's work is booked.
std::size_t MembraneLedger::entryOf(const ::membrane::Sweep& sweep, int channel) {
    if (channel < ::membrane::otherChannels) return channel;
    const string& name = sweep.channels()[channel];
    const auto place = std::find(furtherNames.begin(), furtherNames.end(), name);
    const std::size_t entry = furtherEntries + (place - furtherNames.begin());
    if (place == furtherNames.end()) furtherNames.push_back(name);
    return entry;
}

Real MembraneLedger::workOf(const string& channel) const {
    const std::pair<const char*, Real> first[] = {{"crease", creaseWork}, {"damping", dampingWork}, {"drag", dragWork}};
    for (const auto& [name, work] : first)
        if (channel == name) return work;
    const std::size_t place = std::find(furtherNames.begin(), furtherNames.end(), channel) - furtherNames.begin();
    return place < furtherWorks.size() ? furtherWorks[place] : 0.;
}

Real MembraneLedger::balance() const {
    return total() - initial - creaseWork - dampingWork - dragWork - drivenWork - contactWork -
           std::accumulate(furtherWorks.begin(), furtherWorks.end(), 0.);
}

} // namespace yade

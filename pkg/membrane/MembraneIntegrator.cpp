// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneIntegrator.hpp"
#include "CentrifugalField.hpp"
#include "Exactly.hpp"
#include "MembraneLedger.hpp"
#include "MembraneNode.hpp"
#include "RunEnd.hpp"
#include "mechanics/LocalDamping.hpp"
#include <algorithm>
#include <core/BodyContainer.hpp>
#include <core/Omega.hpp>
#include <core/Scene.hpp>
#ifdef _OPENMP // a YADE tree may be built without
#include <omp.h>
#endif

namespace yade {

YADE_PLUGIN((MembraneIntegrator));

namespace {

/// A thread with fewer nodes than this costs more time than it saves.
constexpr int nodesOfThread = 4096;

/// How many threads YADE was started with.
int mostThreads() {
#ifdef _OPENMP
    return omp_get_max_threads();
#else
    return 1;
#endif
}

constexpr int maskByDefault = 1;

} // namespace

void MembraneIntegrator::postLoad(MembraneIntegrator&) {
    if (exchangePeriod <= 0)
        throw std::invalid_argument("MembraneIntegrator: exchangePeriod = " + std::to_string(exchangePeriod) +
                                    " must be > 0");
    if (!centredVelocities.empty() && centredVelocities.size() != seenPositions.size())
        throw std::invalid_argument(
            "MembraneIntegrator: centredVelocities and seenPositions must have the same length");
    if (!allFinite(centredVelocities))
        throw std::invalid_argument("MembraneIntegrator: centredVelocities must be finite");
}

void MembraneIntegrator::fetch() {
    if (!held_.is(Omega::instance().getScene().get())) return;
    writeBack();
    centredVelocities.resize(states_.size());
    for (const int i : allNodes_) centredVelocities[i] = sweep_.u.at(i);
    seenPositions = sweep_.x.points(); // of the nodes moved here by which changes by hand are seen
    seenVelocities = sweep_.v.points();
    for (std::size_t k = 0; k < shared_.size(); ++k) {
        seenPositions[shared_[k]] = sharedSeenPositions_[k];
        seenVelocities[shared_[k]] = sharedSeenVelocities_[k];
    }
    if (allFinite(seenPositions) && allFinite(seenVelocities) && allFinite(centredVelocities)) return;
    centredVelocities.clear(); // of a run that diverged nothing is to go on
    forgetSeen();
}

/// Whether a node may be moved here: it can touch nothing and is free.
bool MembraneIntegrator::belongsHere(int node) const {
    return !bodies_[node]->isBounded() && !(states_[node]->blockedDOFs & State::DOF_XYZ);
}

void MembraneIntegrator::prepare(Scene& now) {
    const bool known = holds(now);
    if (known) writeBack();
    MembraneForceEngine::prepare(now);
    if (known) return;

    held_.set(now);
    heldMembrane_ = membrane;
    bodiesCurrent_ = true;
    const std::size_t count = states_.size();
    const bool saved =
        centredVelocities.size() == count && seenPositions.size() == count && seenVelocities.size() == count;
    for (const int i : allNodes_) {
        const bool asSaved = saved && states_[i]->pos == seenPositions[i] && states_[i]->vel == seenVelocities[i];
        sweep_.x.set(i, states_[i]->pos);
        sweep_.v.set(i, states_[i]->vel);
        sweep_.u.set(i, asSaved ? centredVelocities[i] : states_[i]->vel);
    }
    for (std::size_t k = 0; saved && k < shared_.size(); ++k) {
        sharedSeenPositions_[k] = seenPositions[shared_[k]];
        sharedSeenVelocities_[k] = seenVelocities[shared_[k]];
    }
    for (auto* vectors : {&centredVelocities, &seenPositions, &seenVelocities}) vector<Vector3r>().swap(*vectors);
    syncs_ = 0;
}

void MembraneIntegrator::forget() {
    writeBack();
    owned_.clear();
    shared_.clear();
    outsideShared_.clear();
    held_.clear();
    heldMembrane_.reset();
    MembraneForceEngine::forget();
}

void MembraneIntegrator::arrange() {
    vector<char> mine(states_.size());
    vector<Vector3r> seenX, seenV;
    vector<int> shared;
    const bool continued = holds(*scene);
    owned_.clear();
    for (const int i : allNodes_) {
        mine[i] = belongsHere(i) ? 1 : 0;
        const auto place = std::lower_bound(shared_.begin(), shared_.end(), i);
        const bool wasShared = place != shared_.end() && *place == i;
        const std::size_t k = place - shared_.begin();
        if (mine[i]) {
            owned_.push_back(i);
            bodies_[i]->groupMask = nodeMask;
            if (!continued || !wasShared) continue;
            const State& state = *states_[i];
            sweep_.u.set(i, centredVelocity(state, sharedSeenPositions_[k], sharedSeenVelocities_[k], scene->dt));
            sweep_.x.set(i, state.pos);
            sweep_.v.set(i, state.vel);
            continue;
        }
        if (bodies_[i]->groupMask == nodeMask) bodies_[i]->groupMask = maskByDefault;
        // One that was never seen counts as seen here: then its velocity is taken as it is.
        seenX.push_back(wasShared ? sharedSeenPositions_[k] : continued ? positionSeen(i) : states_[i]->pos);
        seenV.push_back(wasShared ? sharedSeenVelocities_[k] : continued ? velocitySeen(i) : states_[i]->vel);
        shared.push_back(i);
    }
    shared_.swap(shared);
    sharedSeenPositions_.swap(seenX);
    sharedSeenVelocities_.swap(seenV);
    prepareSweep(mine, wantedParts());
}

int MembraneIntegrator::wantedParts() const {
    constexpr int most = 1024; // each has tables of its own
    if (ompThreads > most)
        throw std::runtime_error("MembraneIntegrator: ompThreads = " + std::to_string(ompThreads) +
                                 " must be <= " + std::to_string(most));
    if (ompThreads > 0) return std::min(ompThreads, static_cast<int>(states_.size()));
    return std::min(mostThreads(), std::max(1, static_cast<int>(states_.size()) / nodesOfThread));
}

/// The integrator and the field that count in this step.
void MembraneIntegrator::chooseEngines() {
    newton_ = surroundings_.newton(*scene);
    sharedMoveHere_ = !newton_ || newton_->dead;
    const CentrifugalField* const field = takesField(*scene) ? surroundings_.field(*membrane, *scene) : nullptr;
    centrifugal_ = field ? field->omega * field->omega : 0.;
    if (movesShared()) return;
    if (newton_->mask <= 0 || (newton_->mask & nodeMask))
        throw std::runtime_error(
            "MembraneIntegrator: NewtonIntegrator would move its nodes a second time; give it mask=" +
            std::to_string(nodeMask - 1));
}

/// A NewtonIntegrator that is dead, for only nodes moved, must live when a body comes that is free to move.
void MembraneIntegrator::checkOthers() {
    const std::size_t count = scene->bodies->size();
    if (count == othersAmong_ || !moveNodes || !newton_ || !newton_->dead) return;
    for (const auto& body : *scene->bodies)
        if (body && body->state && movesFreely(*body) && !exactly<MembraneNode>(body->shape))
            throw std::runtime_error("MembraneIntegrator: body #" + std::to_string(body->id) +
                                     " is free to move, but NewtonIntegrator is dead; set its `dead` to False");
    othersAmong_ = count;
}

void MembraneIntegrator::gather() {
    chooseEngines();
    const bool otherStep = movedStep > 0. && scene->dt != movedStep;
    if (bodiesCurrent_) readBodies();
    readShared();
    if (forget_ || otherStep)
        for (const int i : owned_) sweep_.u.set(i, sweep_.v.at(i));
    forget_ = false;
    takeForces();
}

/// Takes over what was changed by hand since the bodies were last brought up to date.
void MembraneIntegrator::readBodies() {
    checkClumps();
    checkOthers();
    bool same = sweep_.parts() == wantedParts();
    for (const int i : owned_) {
        checkNode(i);
        same = same && belongsHere(i);
    }
    for (const int i : shared_) same = same && !belongsHere(i);
    if (!same) {
        arrange();
        checkSurroundings();
    }
    Real probe = 0.;
    for (const int i : owned_) {
        const State& state = *states_[i];
        if (state.pos == sweep_.x.at(i) && state.vel == sweep_.v.at(i)) continue;
        sweep_.x.set(i, state.pos);
        sweep_.v.set(i, state.vel);
        sweep_.u.set(i, state.vel);
        probe += 0. * (state.pos.sum() + state.vel.sum());
    }
    if (!(probe == 0.)) stopDiverged();
}

void MembraneIntegrator::readShared() {
    Real probe = 0.;
    for (std::size_t k = 0; k < shared_.size(); ++k) {
        const int i = shared_[k];
        checkNode(i);
        const State& state = *states_[i];
        sweep_.x.set(i, state.pos);
        sweep_.v.set(i, state.vel);
        sweep_.u.set(i, forget_ ? state.vel
                                : centredVelocity(state, sharedSeenPositions_[k], sharedSeenVelocities_[k], scene->dt));
        sharedSeenPositions_[k] = state.pos;
        sharedSeenVelocities_[k] = state.vel;
        probe += 0. * (state.pos.sum() + state.vel.sum());
    }
    if (!(probe == 0.)) stopDiverged();
}

/// Forces that other engines put on the nodes in this step.
void MembraneIntegrator::takeForces() {
    sweep_.outside.clear();
    outsideShared_.assign(movesShared() ? shared_.size() : 0, Vector3r::Zero());
    ForceContainer& forces = scene->forces;
    if (forces.synced && forces.syncCount == syncs_) return; // nobody has added any since the last step
    forces.sync();
    for (const int i : owned_) {
        const Vector3r& f = forces.getForce(membrane->bodyIds[i]);
        if (!f.isZero(0.)) sweep_.outside.emplace_back(i, f);
    }
    bool any = !sweep_.outside.empty();
    for (std::size_t k = 0; k < outsideShared_.size(); ++k) {
        outsideShared_[k] = forces.getForce(membrane->bodyIds[shared_[k]]);
        any = any || !outsideShared_[k].isZero(0.);
    }
    if (any && forces.lastReset < scene->iter) // else they would be those of an earlier step, too
        throw std::runtime_error(
            "MembraneIntegrator: forces were added to O.forces, which were not reset in this step: "
            "put a ForceResetter at the beginning of O.engines, and let it not be dead");
}

void MembraneIntegrator::computeForces() {
    const MembraneLedger* const counting = ledger(*scene);
    ::membrane::Sums sums = ::membrane::Sums::none;
    if (counting) sums = counting->wantsEnergies(*scene) ? ::membrane::Sums::energies : ::membrane::Sums::works;
    continueLedger(counting, sums);
    ::membrane::SweepStep step;
    step.dt = scene->dt;
    if (newton_) {
        step.gravity = newton_->gravity;
        step.localDamping = newton_->damping;
    }
    step.centrifugal = centrifugal_;
    step.move = moveNodes;
    step.sums = sums;
    step.apart = counting || !moveNodes;
    moved_ = moveNodes;
    if (!sweep_.step(step)) stopDiverged();
    if (!movesShared())
        for (const int i : shared_) scene->forces.addForce(membrane->bodyIds[i], sweep_.force(i) + fieldForce(i));
    syncs_ = scene->forces.syncCount + (scene->forces.synced ? 0 : 1); // NewtonIntegrator will sum them
    if (!moveNodes) return;
    if (movesShared()) moveShared();
    movedStep = scene->dt;
    bodiesCurrent_ = false;
    if (++sinceExchange_ >= exchangePeriod || endsRun(*scene)) writeBack();
}

Vector3r MembraneIntegrator::totalForce(int node) const {
    if (outsideShared_.size() != shared_.size()) return MembraneForceEngine::totalForce(node);
    const auto place = std::lower_bound(shared_.begin(), shared_.end(), node) - shared_.begin();
    return sweep_.force(node) + outsideShared_[place] + fieldForce(node);
}

/// Whether the arrays hold the nodes of this membrane in a scene.
bool MembraneIntegrator::holds(const Scene& in) const {
    return held_.is(&in) && heldMembrane_ == membrane && sweep_.x.size() == states_.size();
}

bool MembraneIntegrator::takesField(const Scene& in) const {
    return !ledger(in); // which counts work from outside, and the field's is such
}

Vector3r MembraneIntegrator::fieldForce(int node) const {
    const Vector3r x = sweep_.x.at(node);
    return states_[node]->mass * centrifugal_ * Vector3r(x[0], x[1], 0.);
}

/// NewtonIntegrator's step for the shared nodes, rotations apart.
void MembraneIntegrator::moveShared() {
    const Real dt = scene->dt, local = newton_ ? newton_->damping : 0.;
    const Vector3r gravity = newton_ ? newton_->gravity : Vector3r::Zero();
    for (const int i : shared_) {
        State& state = *states_[i];
        const Vector3r acceleration = totalForce(i) / state.mass + gravity;
        for (int axis = 0; axis < 3; ++axis)
            if (!(state.blockedDOFs & State::axisDOF(axis)))
                state.vel[axis] += dt * ::membrane::locallyDamped(acceleration[axis], state.vel[axis], dt, local);
        state.pos += dt * state.vel;
    }
    if (newton_) tellCollider();
}

/// Whether a node has left the bounds for which the collider has looked, where it looks for that.
void MembraneIntegrator::tellCollider() const {
    newton_->maxVelocitySq = 0.5; // not 0, which means that nobody has checked
    for (const int i : shared_) {
        if (!bodies_[i]->bound) continue;
        const Bound& bound = *bodies_[i]->bound;
        const Real moved = (states_[i]->pos - bound.refPos).cwiseAbs().maxCoeff();
        if (!(moved == 0. || moved < bound.sweepLength)) newton_->maxVelocitySq = 2.;
    }
}

void MembraneIntegrator::writeBack() {
    if (bodiesCurrent_) return;
    for (const int i : owned_) {
        states_[i]->pos = sweep_.x.at(i);
        states_[i]->vel = sweep_.v.at(i);
    }
    bodiesCurrent_ = true;
    sinceExchange_ = 0;
}

::membrane::Points MembraneIntegrator::presentPositions(const Scene& now) const {
    ::membrane::Points x = MembraneForceEngine::presentPositions(now);
    if (holds(now) && !bodiesCurrent_)
        for (const int i : owned_) x[i] = sweep_.x.at(i);
    return x;
}

Vector3r MembraneIntegrator::positionSeen(int node) const {
    // Where it was before it moved here; shared nodes are still there in the arrays.
    const bool moved = moved_ && !std::binary_search(shared_.begin(), shared_.end(), node);
    return moved ? Vector3r(sweep_.x.at(node) - movedStep * sweep_.v.at(node)) : Vector3r(sweep_.x.at(node));
}

Vector3r MembraneIntegrator::velocitySeen(int node) const {
    const bool moved = moved_ && !std::binary_search(shared_.begin(), shared_.end(), node);
    return moved ? Vector3r(3. * sweep_.v.at(node) - 2. * sweep_.u.at(node)) : Vector3r(sweep_.v.at(node));
}

std::pair<Real, Real> MembraneIntegrator::powerFromOutside() const {
    std::pair<Real, Real> power{0., 0.};
    for (const auto& [node, f] : sweep_.outside) {
        power.first += f.dot(velocitySeen(node));
        power.second += f.dot(sweep_.v.at(node));
    }
    return power;
}

vector<Vector3r> MembraneIntegrator::nodeForces() {
    const shared_ptr<Scene> current = sceneAtRest();
    vector<Vector3r> forces(states_.size());
    for (const int i : owned_) forces[i] = sweep_.force(i) + fieldForce(i); // with those from outside
    if (!movesShared()) current->forces.sync();
    for (const int i : shared_) forces[i] = totalForce(i);
    return forces;
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneLedger.hpp"
#include "FreeHub.hpp"
#include <cmath>
#include <core/Scene.hpp>

namespace yade {

YADE_PLUGIN((MembraneLedger));

namespace {

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

void MembraneLedger::action() {
    if (!forces || !forces->membrane) throw std::runtime_error("MembraneLedger: forces is not set, or has no membrane");
    const Membrane& membrane = *forces->membrane;
    if (forces->lastStep() != scene->iter || !forces->madeSums())
        throw std::runtime_error("MembraneLedger: its MembraneForceEngine must run in the same step, before it");
    const FreeHub* const hub = FreeHub::of(*scene, *forces);
    if (hub && hub->lastStep() != scene->iter)
        throw std::runtime_error("MembraneLedger: FreeHub must run in the same step, before it");
    const ::membrane::Sweep& sweep = forces->sweep();
    if (started && !lastLengths.empty() && lastLengths.size() != membrane.rest().sides.size())
        throw std::runtime_error("MembraneLedger: forces has another membrane now");
    elastic = sweep.sideEnergies().elastic;
    if (started) kinkError += sweep.sideEnergies().kink;

    // Work from the step before to this one: mean of both forces times the velocity between them.
    const ::membrane::MotionSums& moved = sweep.motionSums();
    const auto [arrivingOutside, leavingOutside] = forces->powerFromOutside();
    kinetic = moved.kinetic;
    potential = moved.potential;
    angularMomentum = moved.angularMomentum;
    Real torque = moved.torque;
    vector<Real> arriving{moved.arriving[0], moved.arriving[1], moved.arriving[2], 0., arrivingOutside};
    vector<Real> leaving{moved.leaving[0], moved.leaving[1], moved.leaving[2], 0., leavingOutside};
    const auto& states = forces->states();
    for (const int i : forces->nodesLeft()) {
        const State& state = *states[i];
        const Vector3r x = forces->positionSeen(i);
        const bool onHub = hub && hub->turns(i); // what such a node gives or takes stays in the system
        const Vector3r free = freeDirections(state);
        const Vector3r held = onHub ? Vector3r(Vector3r::Zero()) : Vector3r(Vector3r::Ones() - free);
        const Vector3r total = forces->totalForce(i);
        const Vector3r fCrease = sweep.creaseForce(i), fDamping = sweep.dampingForce(i), fDrag = sweep.dragForce(i);
        const Vector3r internal = sweep.elasticForce(i) + fCrease + fDamping + fDrag, other = total - internal;
        const Vector3r after = state.vel;
        const Vector3r before =
            free.isZero() && !onHub ? turnedBack(after, state.angVel[2] * scene->dt) : forces->velocitySeen(i);
        const auto addPowers = [&](vector<Real>& powers, const Vector3r& v) {
            powers[0] += fCrease.dot(v);
            powers[1] += fDamping.dot(v);
            powers[2] += fDrag.dot(v);
            powers[3] -= internal.cwiseProduct(held).dot(v); // what holds a node bears the membrane's forces on it
            powers[4] += other.cwiseProduct(Vector3r::Ones() - held).dot(v);
        };
        addPowers(arriving, before);
        addPowers(leaving, after);
        kinetic += 0.5 * state.mass * before.cwiseProduct(free).dot(after);
        potential -= state.mass * gravity.cwiseProduct(free).dot(x);
        const Vector3r momentum = state.mass * 0.5 * (before + after).cwiseProduct(free);
        angularMomentum += x[0] * momentum[1] - x[1] * momentum[0];
        // The integrator keeps gravity out of the scene's forces.
        const Vector3r pull = (total + state.mass * gravity).cwiseProduct(free);
        torque += x[0] * pull[1] - x[1] * pull[0];
    }
    if (hub) {
        kinetic += hub->kinetic();
        angularMomentum += hub->angularMomentum();
        torque += hub->torque;
        arriving[4] += hub->contactTorque * hub->spinBefore;
        leaving[4] += hub->contactTorque * hub->spin;
    }
    time = scene->time;

    if (!started) {
        initial = total();
        initialCrease = crease();
        initialAngularMomentum = angularMomentum;
        started = true;
    } else {
        Real* const works[] = {&creaseWork, &dampingWork, &dragWork, &drivenWork, &contactWork};
        for (std::size_t i = 0; i < arriving.size(); ++i) *works[i] += 0.5 * scene->dt * (lastPowers[i] + arriving[i]);
        angularImpulse += 0.5 * scene->dt * (lastTorque + torque);
    }
    lastPowers = leaving;
    lastTorque = torque;
}

Real MembraneLedger::crease() const {
    return forces && forces->beta > 0. && forces->lastStep() >= 0 ? forces->creaseEnergy(forces->lastPositions()) : 0.;
}

void MembraneLedger::preSave(MembraneLedger&) {
    if (started && forces && forces->madeSums()) lastLengths = forces->sweep().lengths();
}

Real MembraneLedger::balance() const {
    return total() - initial - creaseWork - dampingWork - dragWork - drivenWork - contactWork;
}

} // namespace yade

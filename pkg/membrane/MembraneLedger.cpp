// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneLedger.hpp"
#include "mechanics/SideForce.hpp"
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
    const ::membrane::Points& x = forces->positions();
    if (x.empty() || forces->lastStep() != scene->iter)
        throw std::runtime_error("MembraneLedger: its MembraneForceEngine must run in the same step, before it");

    // Elastic forces once more, so that what other engines put on the nodes is known by difference.
    const auto& sides = membrane.rest().sides;
    ::membrane::Points elasticForces(x.size(), Vector3r::Zero());
    elastic = 0.;
    if (!started) lastLengths.assign(sides.size(), 0.);
    if (lastLengths.size() != sides.size()) throw std::runtime_error("MembraneLedger: forces has another membrane now");
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const ::membrane::Side& s = sides[i];
        const Vector3r span = x[s.b] - x[s.a];
        const Real length = span.norm();
        if (started) kinkError += ::membrane::kinkEnergy(lastLengths[i], length, s.stiffness, s.restLength, s.critical);
        lastLengths[i] = length;
        elastic += ::membrane::sideEnergy(length, s.stiffness, s.restLength, s.critical);
        if (!(length > 0.)) continue;
        const Vector3r force = ::membrane::sideTension(length, s.stiffness, s.restLength, s.critical) / length * span;
        elasticForces[s.a] += force;
        elasticForces[s.b] -= force;
    }

    // Work from the step before to this one: mean of both forces times the velocity between them.
    kinetic = potential = angularMomentum = 0.;
    vector<Real> arriving(5, 0.), leaving(5, 0.);
    Real torque = 0.;
    const auto& states = forces->states();
    for (std::size_t i = 0; i < x.size(); ++i) {
        const State& state = *states[i];
        const Vector3r free = freeDirections(state), held = Vector3r::Ones() - free;
        const Vector3r total = scene->forces.getForce(membrane.bodyIds[i]);
        const Vector3r &fCrease = forces->creaseForces()[i], &fDamping = forces->dampingForces()[i],
                       &fDrag = forces->dragForces()[i];
        const Vector3r internal = elasticForces[i] + fCrease + fDamping + fDrag, other = total - internal;
        const Vector3r after = state.vel;
        const Vector3r before =
            free.isZero() ? turnedBack(after, state.angVel[2] * scene->dt) : forces->velocities()[i];
        const auto addPowers = [&](vector<Real>& powers, const Vector3r& v) {
            powers[0] += fCrease.dot(v);
            powers[1] += fDamping.dot(v);
            powers[2] += fDrag.dot(v);
            powers[3] -= internal.cwiseProduct(held).dot(v); // what holds a node bears the membrane's forces on it
            powers[4] += other.cwiseProduct(free).dot(v);
        };
        addPowers(arriving, before);
        addPowers(leaving, after);
        kinetic += 0.5 * state.mass * before.cwiseProduct(free).dot(after);
        potential -= state.mass * gravity.cwiseProduct(free).dot(x[i]);
        const Vector3r momentum = state.mass * 0.5 * (before + after).cwiseProduct(free);
        angularMomentum += x[i][0] * momentum[1] - x[i][1] * momentum[0];
        // The integrator keeps gravity out of the scene's forces.
        const Vector3r pull = (total + state.mass * gravity).cwiseProduct(free);
        torque += x[i][0] * pull[1] - x[i][1] * pull[0];
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
    return forces && forces->beta > 0. && !forces->positions().empty() ? forces->creaseEnergy(forces->positions()) : 0.;
}

Real MembraneLedger::balance() const {
    return total() - initial - creaseWork - dampingWork - dragWork - drivenWork - contactWork;
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#include "ContactBook.hpp"
#include "BodyAt.hpp"
#include "MembraneForceEngine.hpp"
#include <algorithm>

namespace yade {

namespace {

/// Velocities [m/s] half a step before and after a step's forces.
struct Velocities {
    Vector3r before, after;
};

Velocities ofNode(const MembraneForceEngine& forces, int node) {
    return {forces.velocitySeen(node), forces.states()[node]->vel};
}

/// Of a body at a place. Before: what NewtonIntegrator has added is taken off again.
Velocities ofBody(const MembraneForceEngine& forces, Scene& scene, const Body& body, const Vector3r& at,
                  const Vector3r& gravity) {
    const State& state = *body.state;
    const Vector3r arm = at - state.pos;
    Vector3r vel = state.vel, angVel = state.angVel;
    const Vector3r after = vel + angVel.cross(arm);
    if (!movesFreely(body) || !forces.isMoved(body)) return {after, after};
    const Vector3r force = scene.forces.getForce(body.id), torque = scene.forces.getTorque(body.id);
    for (int axis = 0; axis < 3; ++axis) {
        if (!(state.blockedDOFs & State::axisDOF(axis)))
            vel[axis] -= scene.dt * (force[axis] / state.mass + gravity[axis]);
        if (!(state.blockedDOFs & State::axisDOF(axis, true)) && state.inertia[axis] > 0.)
            angVel[axis] -= scene.dt * torque[axis] / state.inertia[axis];
    }
    return {vel + angVel.cross(arm), after};
}

} // namespace

void ContactBook::turnPage(const MembraneForceEngine& forces, Scene& scene, const Vector3r& gravity, bool loaded) {
    vector<Vector2i> pairsNow;
    vector<Real> worksNow, mostNow;
    std::size_t old = 0; // of those of the last step
    gain = 0.;
    const auto isBefore = [](const Vector2i& a, const Vector2i& b) { return a[0] != b[0] ? a[0] < b[0] : a[1] < b[1]; };
    const auto end = [&](std::size_t upTo) {
        for (; old < upTo; ++old) ended += works[old];
    };
    for (const NodeContact& contact : forces.contacts()) {
        const shared_ptr<Body> other = bodyAt(scene, contact.other);
        if (!other || !other->state) continue;
        const Vector2i pair(contact.node, contact.other);
        end(std::lower_bound(pairs.data() + old, pairs.data() + pairs.size(), pair, isBefore) - pairs.data());
        const bool goesOn = old < pairs.size() && pairs[old] == pair;
        const Real work = goesOn ? works[old] : loaded ? -contact.stored : 0.;
        Real deepest = goesOn ? most[old] : 0.;
        if (goesOn) ++old;

        const Velocities node = ofNode(forces, contact.node);
        const Velocities body = ofBody(forces, scene, *other, contact.point, gravity);
        const Real arriving = contact.force.dot(node.before - body.before);
        const Real leaving = contact.force.dot(node.after - body.after);
        const Real now = work + 0.5 * scene.dt * arriving, given = std::max(0., -now);
        gain += now + (contact.linear ? std::min(contact.stored, given) : given);
        if (given > deepest) {
            taken += given - deepest;
            deepest = given;
        }
        pairsNow.push_back(pair);
        worksNow.push_back(work + 0.5 * scene.dt * (arriving + leaving));
        mostNow.push_back(deepest);
    }
    end(pairs.size());
    gain += ended;
    pairs.swap(pairsNow);
    works.swap(worksNow);
    most.swap(mostNow);
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#include "FreeHub.hpp"
#include "BodyAt.hpp"
#include <cmath>
#include <core/Omega.hpp>

namespace yade {

YADE_PLUGIN((FreeHub));

namespace {

/// A place turned about +z by `angle` [rad].
Vector3r turned(const Vector3r& x, Real angle) {
    const Real c = std::cos(angle), s = std::sin(angle);
    return {c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]};
}

/// Velocity [m/s] that takes a node of the hub along its chord in a step in which the hub turns by `turn` [rad].
Vector3r chordVelocity(const Vector3r& place, Real angle, Real turn, Real dt) {
    const Vector3r middle = turned(place, angle + 0.5 * turn);
    const Real rate = 2. * std::sin(0.5 * turn) / dt;
    return {-rate * middle[1], rate * middle[0], 0.};
}

[[noreturn]] void refuseNode(int node, int count) {
    throw std::runtime_error("FreeHub: nodes: " + std::to_string(node) + " must be in 0 ... " +
                             std::to_string(count - 1));
}

Real aboutZ(const Vector3r& x, const Vector3r& f) {
    return x[0] * f[1] - x[1] * f[0];
}

} // namespace

void FreeHub::postLoad(FreeHub&) {
    if (!(inertia >= 0.) || !std::isfinite(inertia))
        throw std::invalid_argument("FreeHub: inertia = " + std::to_string(inertia) + " kg m2 must be finite and >= 0");
}

void FreeHub::action() {
    StepGuard::refuseCall(*this);
    if (!forces || !forces->membrane) throw std::runtime_error("FreeHub: forces is not set, or has no membrane");
    if (!forces->hasRun(*scene))
        throw std::runtime_error("FreeHub: its MembraneForceEngine must run in the same step, before it");
    checkNodes();
    if (!hasPlaces()) begin();
    scene->forces.sync();
    torque = contactTorque = contacts();
    for (const int node : nodes) torque += aboutZ(forces->positionSeen(node), forces->totalForce(node));

    spinBefore = spin;
    spin += scene->dt * torque / totalInertia();
    const Real turn = scene->dt * spin;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        State& state = *forces->states()[nodes[k]];
        state.vel = chordVelocity(places[k], angle, turn, scene->dt);
        state.pos = turned(places[k], angle + turn);
    }
    angle += turn;
    if (spool) {
        spool->angle = angle;
        spool->angularVelocity = spin;
    }
    lastStep_ = scene->iter;
    lastScene_.set(*scene);
}

void FreeHub::checkNodes() const {
    const int count = forces->nodeCount();
    for (const int node : nodes) {
        if (node < 0 || node >= count) refuseNode(node, count);
        if (!isHeld(*forces->states()[node]))
            throw std::runtime_error("FreeHub: node " + std::to_string(node) +
                                     " must be held: set blockedDOFs='xyzXYZ' of its body");
    }
}

/// Takes the nodes as they are.
void FreeHub::begin() {
    vector<int> sorted = nodes;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end())
        throw std::runtime_error("FreeHub: nodes: " + std::to_string(*twice) + " is listed twice");
    if (!(totalInertia() > 0.))
        throw std::runtime_error("FreeHub: inertia and nodes: the hub has no moment of inertia at all");
    places.clear();
    for (const int node : nodes) places.push_back(turned(forces->positionSeen(node), -angle));
    placed = nodes;
}

/// Torque [N m] of contacts with the facets, whose forces are those on point masses: what turns a touching sphere in
/// YADE, friction times its radius, turns the hub.
Real FreeHub::contacts() const {
    if (!spool || spool->dead || scene->forces.lastReset < scene->iter) return 0.;
    Real sum = 0.;
    for (const int id : spool->ids)
        if (const shared_ptr<Body> facet = bodyAt(*scene, id))
            sum += aboutZ(facet->state->pos, scene->forces.getForce(id)) + scene->forces.getTorque(id)[2];
    for (const int id : spool->touching) sum += scene->forces.getTorque(id)[2];
    return sum;
}

Real FreeHub::totalInertia() const {
    Real sum = inertia;
    const bool begun = hasPlaces();
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        const State& state = stateOf(nodes[k]);
        // Of the first places, so that the inertia is the same in all steps.
        const Vector3r& x = begun ? places[k] : state.pos;
        sum += state.mass * x.head<2>().squaredNorm();
    }
    return sum;
}

const State& FreeHub::stateOf(int node) const {
    if (!forces || !forces->membrane) throw std::runtime_error("FreeHub: forces is not set, or has no membrane");
    const Membrane& membrane = *forces->membrane;
    const int count = static_cast<int>(membrane.bodyIds.size());
    if (node < 0 || node >= count) refuseNode(node, count);
    const shared_ptr<Body> body = bodyAt(*Omega::instance().getScene(), membrane.bodyIds[node]);
    if (!body || !membrane.isNode(*body, node))
        throw std::runtime_error("FreeHub: node " + std::to_string(node) + " has no body in the scene");
    return *body->state;
}

/// As many masses, each on its own, as together are as easy to move as the hub: they vibrate at least as fast.
void FreeHub::addTo(vector<Real>& masses) const {
    const Real share = totalInertia() / static_cast<Real>(nodes.size());
    for (const int node : nodes) {
        const Real r2 = stateOf(node).pos.head<2>().squaredNorm();
        if (r2 > 0.) masses.at(node) = share / r2;
    }
}

} // namespace yade

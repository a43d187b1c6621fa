// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneWatch.hpp"
#include "BodyAt.hpp"
#include "FreeHub.hpp"
#include "mechanics/Drag.hpp"
#include "mechanics/SideForce.hpp"
#include <algorithm>
#include <cmath>
#include <core/Omega.hpp>
#include <limits>
#include <sstream>

namespace yade {

YADE_PLUGIN((MembraneWatch));

namespace {

enum Part { sidesPart, creasesPart, dampingPart, dragPart, contactsPart, parts };
const char* const partNames[] = {"the sides", "the creases", "damping", "air drag", "contacts"};

/// Strain [-] of all sides whose energy counts as none: rounding must not stop a membrane at rest.
constexpr Real noStrain = 1e-9;

/// Of a body whose state is kept: id, pos, vel, angVel, ori.
constexpr std::size_t numbersOfBody = 1 + 3 + 3 + 3 + 4;

std::string pairText(const Membrane& membrane, int a, int b) {
    return std::to_string(a) + "-" + std::to_string(b) + " (bodies #" + std::to_string(membrane.bodyIds[a]) + " and #" +
           std::to_string(membrane.bodyIds[b]) + ")";
}

} // namespace

void MembraneWatch::postLoad(MembraneWatch&) {
    const StepGuard::Look look;
    if (!(tolerance > 0.))
        throw std::invalid_argument("MembraneWatch: tolerance = " + std::to_string(tolerance) + " must be > 0");
    if (period <= 0) throw std::invalid_argument("MembraneWatch: period = " + std::to_string(period) + " must be > 0");
    const auto checkLength = [](const char* name, std::size_t length, std::size_t unit, std::size_t most) {
        if (length % unit != 0 || length / unit > most)
            throw std::invalid_argument(string("MembraneWatch: ") + name + " has " + std::to_string(length) +
                                        " entries, which no watch has kept");
    };
    constexpr std::size_t any = std::numeric_limits<std::size_t>::max();
    checkLength("lowest", lowest.size(), parts, 1);
    checkLength("newerBodies", newerBodies.size(), numbersOfBody, any);
    checkLength("olderBodies", olderBodies.size(), numbersOfBody, any);
    checkLength("newerHub", newerHub.size(), 2, 1);
    checkLength("olderHub", olderHub.size(), 2, 1);
    floor_ = 0.;
}

void MembraneWatch::action() {
    StepGuard::refuseCall(*this);
    if (!ledger || !ledger->forces) throw std::runtime_error("MembraneWatch: ledger is not set, or has no forces");
    if (ledger->dead || !ledger->isUpToDate(*scene)) return;
    if (floor_ == 0.)
        for (const ::membrane::Side& s : ledger->forces->membrane->rest().sides)
            floor_ += 0.5 * std::abs(s.stiffness) * std::pow(noStrain * s.restLength, 2);

    const bool look = looked < 0 || scene->iter - looked >= period;
    const Real gave[parts] = {ledger->balance(), look ? ledger->creaseDefect() : 0., ledger->dampingWork,
                              ledger->dragWork, ledger->contactGain};
    if (lowest.empty()) lowest.assign(gave, gave + parts);
    peak = std::max(peak, ledger->kinetic + ledger->elastic + (look ? ledger->crease() : 0.));
    Real worstShare = 0.; // of what it may give
    for (int part = 0; part < parts; ++part) {
        if (part == creasesPart && !look) continue;
        lowest[part] = std::min(lowest[part], gave[part]);
        const Real risen = gave[part] - lowest[part];
        const Real all = allEnergy() + (part == contactsPart ? ledger->contactTaken : 0.);
        const Real share = risen / (tolerance * (all + floor_));
        if (!(share <= 1.)) stop(part, risen, all);
        worstShare = std::max(worstShare, share);
    }
    if (!look) return;
    looked = scene->iter;
    if (worstShare <= 0.5) keep();
}

Real MembraneWatch::allEnergy() const {
    return peak + std::abs(ledger->dampingWork) + std::abs(ledger->dragWork);
}

void MembraneWatch::keep() {
    olderBodies.swap(newerBodies);
    olderHub = newerHub;
    olderLedger = newerLedger;
    olderTime = newerTime;
    newerBodies.clear();
    ledger->forces->writeBack();
    ledger->fetch();
    for (const auto& body : *scene->bodies) {
        if (!body || !body->state) continue;
        const State& state = *body->state;
        newerBodies.push_back(body->id);
        for (const Vector3r& v : {Vector3r(state.pos), Vector3r(state.vel), Vector3r(state.angVel)})
            newerBodies.insert(newerBodies.end(), v.data(), v.data() + 3);
        const Quaternionr turned = state.ori;
        newerBodies.insert(newerBodies.end(), turned.coeffs().data(), turned.coeffs().data() + 4);
    }
    if (const FreeHub* hub = ledger->forces->hub(*scene)) newerHub = {hub->angle, hub->spin};
    newerLedger = shared_ptr<MembraneLedger>(new MembraneLedger(*ledger));
    newerLedger->forces.reset();         // else a save would fetch the present lengths into it
    newerTime = scene->time + scene->dt; // the integrator has moved the bodies already
}

Real MembraneWatch::restore() {
    if (!newerLedger) throw std::runtime_error("MembraneWatch: no state was kept yet");
    if (!ledger || !ledger->forces) throw std::runtime_error("MembraneWatch: ledger is not set, or has no forces");
    const shared_ptr<Scene> current = Omega::instance().getScene(); // that of the engine may be gone
    ledger->forces->given().bodies(*current);                       // refuses another one
    const vector<Real>& bodies = olderLedger ? olderBodies : newerBodies;
    const MembraneLedger& book = olderLedger ? *olderLedger : *newerLedger;
    const Real time = olderLedger ? olderTime : newerTime;
    const shared_ptr<MembraneForceEngine> forces = ledger->forces;
    forces->writeBack();
    for (std::size_t at = 0; at + numbersOfBody <= bodies.size(); at += numbersOfBody) {
        const Real* const was = &bodies[at];
        // A number that is no id, as of a damaged file, has no body.
        const bool isId = was[0] >= 0. && was[0] < static_cast<Real>(current->bodies->size());
        const shared_ptr<Body> body = isId ? bodyAt(*current, static_cast<Body::id_t>(was[0])) : shared_ptr<Body>();
        if (!body || !body->state) continue;
        State& state = *body->state;
        state.pos = Vector3r(was + 1);
        state.vel = Vector3r(was + 4);
        state.angVel = Vector3r(was + 7);
        state.ori = Quaternionr(was + 10);
    }
    const vector<Real>& hubWas = olderLedger ? olderHub : newerHub;
    if (FreeHub* hub = forces->hub(*current); hub && hubWas.size() == 2) {
        hub->angle = hubWas[0];
        hub->spin = hubWas[1];
    }
    *ledger = book;
    ledger->forces = forces;
    forces->forgetLengths();
    current->time = time;
    current->subStep = -1; // the state lies between two steps, and not within the one that was stopped
    current->speed = 0.;   // of the computer; two saves of one state are to be the same
    current->forces.reset(current->iter);
    lowest.clear();
    looked = -1;
    return time;
}

void MembraneWatch::stop(int part, Real gain, Real all) const {
    MembraneForceEngine& forces = *ledger->forces;
    const Membrane& membrane = *forces.membrane;
    const ::membrane::Points x = forces.lastPositions();
    ::membrane::Points v;
    for (int i = 0; i < forces.nodeCount(); ++i) v.push_back(forces.velocitySeen(i));
    const auto before = [&](int node) -> Vector3r { return x[node] - scene->dt * v[node]; };

    // Where most energy moved in the last step; of the creases, where most is stored.
    std::string where;
    Real most = -1.;
    if (part == creasesPart) {
        const ::membrane::CreaseLaw law = forces.law();
        for (const ::membrane::Crease& c : membrane.rest().creases) {
            const Real energy = ::membrane::creaseEnergy(
                c.rest, law, ::membrane::creaseState(c.rest, x[c.a], x[c.b], x[c.c], x[c.d]).theta);
            if (!(energy <= most)) most = energy, where = "crease " + pairText(membrane, c.a, c.b);
        }
    } else if (part == contactsPart) {
        for (const NodeContact& contact : forces.contacts()) {
            const Real strength = contact.force.norm();
            if (!(strength <= most))
                most = strength, where = "the contact of bodies #" + std::to_string(membrane.bodyIds[contact.node]) +
                                         " and #" + std::to_string(contact.other);
        }
        if (where.empty()) where = "contacts that are over";
    } else if (part == dragPart) {
        vector<Real> weights(x.size(), 0.);
        for (const Vector3i& t : membrane.triangles) {
            const Vector3r area = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
            for (int k = 0; k < 3; ++k) weights[t[k]] += ::membrane::dragWeight(area, v[t[k]]);
        }
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Real power = -::membrane::nodeDrag(forces.airDensity, weights[i], v[i]).dot(v[i]);
            if (!(power <= most)) most = power, where = "node " + std::to_string(i);
        }
    } else {
        for (const ::membrane::Side& s : membrane.rest().sides) {
            const Vector3r now = x[s.b] - x[s.a], then = before(s.b) - before(s.a);
            const Real change = now.norm() - then.norm();
            const Real mean = 0.5 * (::membrane::sideTension(now.norm(), s.stiffness, s.restLength, s.critical) +
                                     ::membrane::sideTension(then.norm(), s.stiffness, s.restLength, s.critical));
            const Real weight = part == dampingPart ? s.stiffness * change * change : std::abs(mean * change);
            if (!(weight <= most)) most = weight, where = "side " + pairText(membrane, s.a, s.b);
        }
    }
    std::size_t fastest = 0;
    for (std::size_t i = 0; i < v.size(); ++i)
        if (!(v[i].squaredNorm() <= v[fastest].squaredNorm())) fastest = i;

    std::ostringstream message;
    message << "Membrane: the run went wrong at t = " << scene->time << " s, step " << scene->iter << ": "
            << partNames[part] << " gave " << gain << " J from nowhere, more than " << tolerance << " of all energy, "
            << all << " J; most of it at " << where << "; node " << fastest << " is the fastest, " << v[fastest].norm()
            << " m/s. O.dt = " << scene->dt << " s, the critical time step is " << forces.criticalTimeStep()
            << " s: try a shorter one";
    throw std::runtime_error(message.str());
}

} // namespace yade

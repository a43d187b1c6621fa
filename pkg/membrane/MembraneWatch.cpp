// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneWatch.hpp"
#include "BodyAt.hpp"
#include "FreeHub.hpp"
#include <algorithm>
#include <cmath>
#include <core/Omega.hpp>
#include <sstream>

namespace yade {

YADE_PLUGIN((MembraneWatch));

namespace {

/// Parts that every watch has: sides, creases, damping, drag, contacts.
constexpr std::size_t usualParts = 5;

/// Strain [-] of all sides whose energy counts as none: rounding must not stop a membrane at rest.
constexpr Real noStrain = 1e-9;

/// Of a body whose state is kept: id, pos, vel, angVel, ori.
constexpr std::size_t numbersOfBody = 1 + 3 + 3 + 3 + 4;

string bodyText(const Membrane& membrane, int node) {
    return "#" + std::to_string(membrane.bodyIds[node]);
}

/// An element by its nodes and their bodies.
string elementText(const ::membrane::Culprit& culprit, const Membrane& membrane) {
    string text = culprit.element;
    if (culprit.nodes.size() < 2) {
        for (const int node : culprit.nodes) text += " " + std::to_string(node);
        return text;
    }
    for (std::size_t k = 0; k < culprit.nodes.size(); ++k)
        text += (k == 0 ? " " : "-") + std::to_string(culprit.nodes[k]);
    text += " (bodies ";
    for (std::size_t k = 0; k < culprit.nodes.size(); ++k)
        text += (k == 0 ? "" : k + 1 < culprit.nodes.size() ? ", " : " and ") + bodyText(membrane, culprit.nodes[k]);
    return text + ")";
}

} // namespace

/// What may give energy from nowhere.
struct MembraneWatch::Part {
    const char* title;
    Real gave;                             ///< [J]
    const ::membrane::ElementForce* force; ///< whose elements to blame; null: contacts
    bool elastic = false;                  ///< its strain energy, and not what its channel gave
    bool known = true;                     ///< whether it was looked at in this step
};

void MembraneWatch::postLoad(MembraneWatch&) {
    const StepGuard::Look look;
    if (!(tolerance > 0.))
        throw std::invalid_argument("MembraneWatch: tolerance = " + std::to_string(tolerance) + " must be > 0");
    if (period <= 0) throw std::invalid_argument("MembraneWatch: period = " + std::to_string(period) + " must be > 0");
    const auto refuseUnless = [](bool kept, const char* name, const vector<Real>& list) {
        if (!kept && !list.empty())
            throw std::invalid_argument(string("MembraneWatch: ") + name + " has " + std::to_string(list.size()) +
                                        " entries, which no watch has kept");
    };
    constexpr std::size_t mostParts = usualParts + ::membrane::maxChannels - ::membrane::otherChannels;
    refuseUnless(lowest.size() >= usualParts && lowest.size() <= mostParts, "lowest", lowest);
    refuseUnless(newerBodies.size() % numbersOfBody == 0, "newerBodies", newerBodies);
    refuseUnless(olderBodies.size() % numbersOfBody == 0, "olderBodies", olderBodies);
    refuseUnless(newerHub.size() == 2, "newerHub", newerHub);
    refuseUnless(olderHub.size() == 2, "olderHub", olderHub);
    floor_ = 0.;
}

void MembraneWatch::action() {
    StepGuard::refuseCall(*this);
    if (!ledger || !ledger->forces) throw std::runtime_error("MembraneWatch: ledger is not set, or has no forces");
    if (ledger->dead || !ledger->isUpToDate(*scene) || !ledger->forces->hasRun(*scene)) return;
    if (floor_ == 0.)
        for (const ::membrane::Side& s : ledger->forces->membrane->rest().sides)
            floor_ += 0.5 * std::abs(s.stiffness) * std::pow(noStrain * s.restLength, 2);

    const bool look = looked < 0 || scene->iter - looked >= period;
    const vector<Part> all = parts(look);
    for (std::size_t k = lowest.size(); k < all.size(); ++k) lowest.push_back(all[k].gave);
    peak = std::max(peak, ledger->kinetic + ledger->elastic + (look ? ledger->crease() : 0.));
    Real worstShare = 0.; // of what it may give
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Part& part = all[k];
        if (!part.known) continue;
        lowest[k] = std::min(lowest[k], part.gave);
        const Real risen = part.gave - lowest[k];
        const Real energy = allEnergy() + (part.force ? 0. : ledger->contactTaken);
        const Real share = risen / (tolerance * (energy + floor_));
        if (!(share <= 1.)) stop(part, risen, energy);
        worstShare = std::max(worstShare, share);
    }
    if (!look) return;
    looked = scene->iter;
    if (worstShare <= 0.5) keep();
}

/// The sides, whose energy from nowhere is the ledger's balance; all kinds of forces that must not give any; contacts.
vector<MembraneWatch::Part> MembraneWatch::parts(bool look) const {
    const ::membrane::Sweep& sweep = ledger->forces->sweep();
    const ::membrane::ElementForce* const sides = sweep.forces().front().get();
    const auto of = [&](int channel) {
        const ::membrane::ElementForce* const force = sweep.forceOf(channel);
        return force ? force : sides; // without one there is nothing to blame
    };
    vector<Part> all{{ledger->forces->membrane->rest().planeStress ? "the film and its cables" : "the sides",
                      ledger->balance(), sides, true},
                     {"the creases", look ? ledger->creaseDefect() : 0., of(::membrane::creaseChannel), false, look},
                     {"damping", ledger->dampingWork, of(::membrane::dampingChannel)},
                     {"air drag", ledger->dragWork, of(::membrane::dragChannel)},
                     {"contacts", ledger->contactGain, nullptr}};
    for (int channel = ::membrane::otherChannels; channel < static_cast<int>(sweep.channels().size()); ++channel)
        if (sweep.exchange(channel) == ::membrane::Exchange::loses)
            all.push_back({of(channel)->title(), ledger->workOf(sweep.channels()[channel]), of(channel)});
    return all;
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
    forces->forgetMemory();
    current->time = time;
    current->subStep = -1; // the state lies between two steps, and not within the one that was stopped
    current->speed = 0.;   // of the computer; two saves of one state are to be the same
    current->forces.reset(current->iter);
    lowest.clear();
    looked = -1;
    return time;
}

/// Where most energy moved in the last step; of the creases, where most is stored.
string MembraneWatch::worstPlace(const Part& part) const {
    MembraneForceEngine& forces = *ledger->forces;
    const Membrane& membrane = *forces.membrane;
    if (part.force) {
        const ::membrane::Points x = forces.lastPositions(), v = forces.lastVelocities();
        ::membrane::Points before;
        for (std::size_t i = 0; i < x.size(); ++i) before.push_back(x[i] - scene->dt * v[i]);
        ::membrane::Culprit most;
        for (const auto& force : forces.sweep().forces()) { // film and cables share a channel
            if (string(force->channel()) != part.force->channel()) continue;
            const ::membrane::Culprit its = force->culprit({x, v, before}, part.elastic);
            if (!(its.weight <= most.weight)) most = its;
        }
        return elementText(most, membrane);
    }
    const NodeContact* strongest = nullptr;
    for (const NodeContact& contact : forces.contacts())
        if (!strongest || !(contact.force.norm() <= strongest->force.norm())) strongest = &contact;
    return strongest ? "the contact of bodies " + bodyText(membrane, strongest->node) + " and #" +
                           std::to_string(strongest->other)
                     : "contacts that are over";
}

void MembraneWatch::stop(const Part& part, Real gain, Real all) const {
    const ::membrane::Points v = ledger->forces->lastVelocities();
    std::size_t fastest = 0;
    for (std::size_t i = 0; i < v.size(); ++i)
        if (!(v[i].squaredNorm() <= v[fastest].squaredNorm())) fastest = i;

    std::ostringstream message;
    message << "Membrane: the run went wrong at t = " << scene->time << " s, step " << scene->iter << ": " << part.title
            << " gave " << gain << " J from nowhere, more than " << tolerance << " of all energy, " << all
            << " J; most of it at " << worstPlace(part) << "; node " << fastest << " is the fastest, "
            << v[fastest].norm() << " m/s. O.dt = " << scene->dt << " s, the critical time step is "
            << ledger->forces->criticalTimeStep() << " s: try a shorter one";
    throw std::runtime_error(message.str());
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneLedger.hpp"
#include "mechanics/SideForce.hpp"
#include <core/Scene.hpp>

namespace yade {

YADE_PLUGIN((MembraneLedger));

void MembraneLedger::action() {
    if (!forces || !forces->membrane) throw std::runtime_error("MembraneLedger: forces is not set, or has no membrane");
    const Membrane& membrane = *forces->membrane;
    const ::membrane::Points &x = forces->positions(), &before = forces->velocities();
    if (x.empty()) throw std::runtime_error("MembraneLedger: its MembraneForceEngine must run in the same step");

    // Elastic forces once more, so that what other engines put on the nodes is known by difference.
    ::membrane::Points elasticForces(x.size(), Vector3r::Zero());
    elastic = 0.;
    for (const ::membrane::Side& s : membrane.rest().sides) {
        const Vector3r span = x[s.b] - x[s.a];
        const Real length = span.norm();
        elastic += ::membrane::sideEnergy(length, s.stiffness, s.restLength, s.critical);
        if (!(length > 0.)) continue;
        const Vector3r force = ::membrane::sideTension(length, s.stiffness, s.restLength, s.critical) / length * span;
        elasticForces[s.a] += force;
        elasticForces[s.b] -= force;
    }

    kinetic = potential = angularMomentum = 0.;
    vector<Real> rates(6, 0.);
    const auto& states = forces->states();
    for (std::size_t i = 0; i < x.size(); ++i) {
        const State& state = *states[i];
        const Vector3r total = scene->forces.getForce(membrane.bodyIds[i]);
        const bool driven = (state.blockedDOFs & State::DOF_XYZ) == State::DOF_XYZ;
        const Vector3r v = driven ? Vector3r(state.angVel.cross(x[i])) : Vector3r(0.5 * (before[i] + state.vel));
        const Vector3r &fCrease = forces->creaseForces()[i], &fDamping = forces->dampingForces()[i],
                       &fDrag = forces->dragForces()[i];
        rates[0] += fCrease.dot(v);
        rates[1] += fDamping.dot(v);
        rates[2] += fDrag.dot(v);
        if (driven) {
            rates[3] -= total.dot(v); // the support's force is minus the sum of all others
            continue;
        }
        rates[4] += (total - elasticForces[i] - fCrease - fDamping - fDrag).dot(v);
        rates[5] += x[i][0] * total[1] - x[i][1] * total[0];
        kinetic += 0.5 * state.mass * v.squaredNorm();
        potential -= state.mass * gravity.dot(x[i]);
        angularMomentum += state.mass * (x[i][0] * v[1] - x[i][1] * v[0]);
    }
    time = scene->time;

    if (!started) {
        initial = total();
        initialAngularMomentum = angularMomentum;
        started = true;
    } else {
        Real* const integrals[] = {&creaseWork, &dampingWork, &dragWork, &drivenWork, &contactWork, &angularImpulse};
        for (std::size_t i = 0; i < rates.size(); ++i) *integrals[i] += 0.5 * scene->dt * (lastRates[i] + rates[i]);
    }
    lastRates = rates;
}

Real MembraneLedger::crease() const {
    return forces && forces->beta > 0. && !forces->positions().empty() ? forces->creaseEnergy(forces->positions()) : 0.;
}

Real MembraneLedger::balance() const {
    return total() - initial - creaseWork - dampingWork - dragWork - drivenWork - contactWork;
}

} // namespace yade

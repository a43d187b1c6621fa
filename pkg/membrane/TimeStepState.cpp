// SPDX-License-Identifier: GPL-2.0-or-later
#include "TimeStepState.hpp"
#include "MembraneForceEngine.hpp"
#include "mechanics/Damping.hpp"
#include "mechanics/Drag.hpp"

namespace yade {

TimeStepState::TimeStepState(const Membrane& membrane, const vector<shared_ptr<Body>>& bodies, Real zeta,
                             Real airDensity)
    : damping(dampingCoefficients(membrane, bodies, zeta)) {
    positions.reserve(bodies.size());
    masses.reserve(bodies.size());
    for (const auto& body : bodies) {
        positions.push_back(body->state->pos);
        // A node held in some directions only counts as free: that bounds the step from below.
        masses.push_back(isHeld(*body->state) ? 0. : body->state->mass);
    }
    if (!(airDensity > 0.)) return;
    drag.assign(bodies.size(), 0.);
    for (const Vector3i& t : membrane.triangles) {
        const Vector3r& corner = positions[t[0]];
        const Vector3r area = (positions[t[1]] - corner).cross(positions[t[2]] - corner);
        for (int k = 0; k < 3; ++k)
            drag[t[k]] += ::membrane::cornerDragSlope(airDensity, area, bodies[t[k]]->state->vel);
    }
}

::membrane::TimeStepInput TimeStepState::input(const Membrane& membrane, const ::membrane::CreaseLaw& law) const {
    return {membrane.rest(), masses, positions, damping, drag, law, &contacts.ground, contacts.fastest};
}

vector<Real> dampingCoefficients(const Membrane& membrane, const vector<shared_ptr<Body>>& bodies, Real zeta) {
    vector<Real> c;
    if (!(zeta > 0.)) return c;
    c.reserve(membrane.rest().sides.size());
    for (const ::membrane::Side& s : membrane.rest().sides)
        c.push_back(::membrane::dampingCoefficient(zeta, s.stiffness,
                                                   0.5 * (bodies[s.a]->state->mass + bodies[s.b]->state->mass)));
    return c;
}

} // namespace yade

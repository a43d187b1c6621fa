// SPDX-License-Identifier: GPL-2.0-or-later
#include "SpoolRotation.hpp"
#include "BodyAt.hpp"
#include "RunEnd.hpp"
#include "StepGuard.hpp"
#include <cmath>

namespace yade {

YADE_PLUGIN((SpoolRotation));

void SpoolRotation::postLoad(SpoolRotation&) {
    if (!(sweep > 0.)) throw std::invalid_argument("SpoolRotation: sweep = " + std::to_string(sweep) + " must be > 0");
    if (restPeriod <= 0)
        throw std::invalid_argument("SpoolRotation: restPeriod = " + std::to_string(restPeriod) + " must be > 0");
}

void SpoolRotation::action() {
    StepGuard::refuseCall(*this);
    const Real next = angle + angularVelocity * scene->dt;
    if (mayTouch())
        turnFacets(angle);
    else if (scene->iter % restPeriod == 0 || endsRun(*scene))
        turnFacets(next);
    angle = next;
}

bool SpoolRotation::mayTouch() const {
    for (const int id : touching) {
        const shared_ptr<Body> body = bodyAt(*scene, id);
        // Not "< reach": a position that is not a number may touch.
        if (body && body->state && !(body->state->pos.head<2>().squaredNorm() >= reach * reach)) return true;
    }
    return false;
}

/// Brings the facets to an angle, with velocities that take them to the next step's.
void SpoolRotation::turnFacets(Real to) {
    const Vector3r axis = Vector3r::UnitZ();
    const Quaternionr turn(AngleAxisr(to - facetAngle, axis));
    const Quaternionr next(AngleAxisr(angularVelocity * scene->dt, axis));
    Real radius = 0.;
    for (const int id : ids) {
        const shared_ptr<Body> body = bodyAt(*scene, id);
        if (!body || !body->state) continue;
        State& state = *body->state;
        state.pos = turn * state.pos;
        state.ori = (turn * state.ori).normalized();
        state.vel = (next * state.pos - state.pos) / scene->dt;
        state.angVel = angularVelocity * axis;
        radius = std::max(radius, state.pos.head<2>().norm());
    }
    facetAngle = to;
    if (!(std::abs(facetAngle - sortedAngle) * radius < sweep)) {
        scene->doSort = true;
        sortedAngle = facetAngle;
    }
}

} // namespace yade

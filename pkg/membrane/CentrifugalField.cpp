// SPDX-License-Identifier: GPL-2.0-or-later
#include "CentrifugalField.hpp"
#include "MembraneForceEngine.hpp"
#include <core/Omega.hpp>
#include <core/Scene.hpp>

namespace yade {

YADE_PLUGIN((CentrifugalField));

void CentrifugalField::action() {
    StepGuard::refuseCall(*this);
    if (!membrane) throw std::runtime_error("CentrifugalField: membrane is not set");
    if (MembraneForceEngine* const forces = MembraneForceEngine::of(membrane.get(), *scene)) {
        if (forces->takesField(*scene)) return;
        forces->writeBack(); // the nodes may be ahead of their bodies
    }
    const auto states = membrane->states(*scene);
    for (std::size_t i = 0; i < states.size(); ++i) {
        const Vector3r& x = states[i]->pos;
        scene->forces.addForce(membrane->bodyIds[i], states[i]->mass * omega * omega * Vector3r(x[0], x[1], 0.));
    }
}

Real CentrifugalField::energy() const {
    if (!membrane) throw std::runtime_error("CentrifugalField: membrane is not set");
    Real sum = 0.;
    for (const auto& state : membrane->states(*Omega::instance().getScene()))
        sum += state->mass * state->pos.head<2>().squaredNorm();
    return -0.5 * omega * omega * sum;
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneForce.hpp"
#include "MembraneForceEngine.hpp"
#include <core/Scene.hpp>

namespace yade {

YADE_PLUGIN((MembraneForce));

/// Nothing: the engine of the membrane's forces has it among its own.
void MembraneForce::action() {
    StepGuard::refuseCall(*this);
    if (!membrane) throw std::runtime_error(getClassName() + ": membrane is not set");
    if (!MembraneForceEngine::of(membrane.get(), *scene))
        throw std::runtime_error(getClassName() +
                                 ": no MembraneForceEngine of its membrane is in O.engines, or it is dead");
}

std::shared_ptr<::membrane::ElementForce> MembraneForce::make() const {
    throw std::runtime_error(getClassName() + " is not a force itself: use a class derived from it");
}

} // namespace yade

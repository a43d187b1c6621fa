// SPDX-License-Identifier: GPL-2.0-or-later
#include "Law2_MembraneGeom_MembranePhys_Buckling.hpp"
#include "BodyAt.hpp"
#include "Exactly.hpp"
#include "MembraneFault.hpp"
#include "MembraneForceEngine.hpp"
#include "mechanics/SideForce.hpp"
#include <algorithm>
#include <cmath>
#include <core/EnergyTracker.hpp>
#include <core/Interaction.hpp>
#include <core/InteractionContainer.hpp>
#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include <mutex>
#include <pkg/dem/NewtonIntegrator.hpp>

namespace yade {

YADE_PLUGIN((Law2_MembraneGeom_MembranePhys_Buckling));

namespace {

/// Finds the place of an energy that is reset in every step. YADE's own search makes two from two threads at once.
void findEnergy(EnergyTracker& energies, const string& name, int& index) {
    static std::mutex counting;
    if (__atomic_load_n(&index, __ATOMIC_ACQUIRE) >= 0) return;
    const std::lock_guard<std::mutex> lock(counting);
    int found = index;
    if (found < 0) energies.add(0., name, found, /*reset in every step*/ true); // findId itself is not in every YADE
    __atomic_store_n(&index, found, __ATOMIC_RELEASE);
}

/// Whether the membrane of a side has no engine that looks at what its nodes do.
bool isUnwatched(const Interaction& link, const Scene& scene) {
    const shared_ptr<Body> body = bodyAt(scene, link.getId1());
    const MembraneNode* const node = body ? exactly<MembraneNode>(body->shape) : nullptr;
    return !(node && MembraneForceEngine::of(node->membrane.get(), scene));
}

} // namespace

bool Law2_MembraneGeom_MembranePhys_Buckling::go(shared_ptr<IGeom>& geomBase, shared_ptr<IPhys>& physBase,
                                                 Interaction* link) {
    const auto fault = [&](const std::string& what) {
        MembraneFault::note(*scene, "Membrane: bodies #" + std::to_string(link->getId1()) + " and #" +
                                        std::to_string(link->getId2()) + " " + what);
        return true;
    };
    MembraneGeom* const geom = exactly<MembraneGeom>(geomBase);
    MembranePhys* const phys = exactly<MembranePhys>(physBase);
    if (!geom || !phys)
        return fault("interact by a " + (geomBase ? geomBase->getClassName() : "missing geom") + " and a " +
                     (physBase ? physBase->getClassName() : "missing phys") +
                     ", not by a MembraneGeom and a MembranePhys");
    if (!(phys->restLength > 0.)) return fault("interact but are no side of the membrane");
    if (!std::isfinite(geom->length)) return fault("are " + std::to_string(geom->length) + " m apart");
    if (phys->computed >= 0 && phys->computed == scene->iter - 1 && phys->checked != phys->computed && bodiesMove() &&
        isUnwatched(*link, *scene))
        return fault("are a side that moves without a MembraneForceEngine of its membrane: put one into O.engines, "
                     "after InteractionLoop, and let it not be dead");

    const Real tension = ::membrane::sideTension(geom->length, phys->kn, phys->restLength, phys->criticalLength);
    phys->normalForce = -tension * geom->normal;
    phys->computed = scene->iter;
    addForce(link->getId1(), -phys->normalForce, scene);
    addForce(link->getId2(), phys->normalForce, scene);

    if (scene->trackEnergy) {
        const string name = "membraneElastic";
        findEnergy(*scene->energy, name, energyIndex);
        scene->energy->add(::membrane::sideEnergy(geom->length, phys->kn, phys->restLength, phys->criticalLength), name,
                           energyIndex, /*reset in every step*/ true);
    }
    return true;
}

/// Whether a NewtonIntegrator lives in this step: looked up once, not for each side.
bool Law2_MembraneGeom_MembranePhys_Buckling::bodiesMove() {
    const long step = scene->iter;
    const long known = __atomic_load_n(&lookedUp_, __ATOMIC_RELAXED);
    if (known / 2 == step + 1) return known % 2 != 0;
    const bool found = std::any_of(scene->engines.begin(), scene->engines.end(), [](const shared_ptr<Engine>& engine) {
        return !engine->dead && dynamic_cast<const NewtonIntegrator*>(engine.get());
    });
    __atomic_store_n(&lookedUp_, 2 * (step + 1) + (found ? 1 : 0), __ATOMIC_RELAXED);
    return found;
}

Real Law2_MembraneGeom_MembranePhys_Buckling::elasticEnergy() const {
    Real energy = 0.;
    for (const auto& link : *Omega::instance().getScene()->interactions) {
        if (!link->isReal()) continue;
        const auto* geom = exactly<MembraneGeom>(link->geom);
        const auto* phys = exactly<MembranePhys>(link->phys);
        if (geom && phys)
            energy += ::membrane::sideEnergy(geom->length, phys->kn, phys->restLength, phys->criticalLength);
    }
    return energy;
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#include "Law2_MembraneGeom_MembranePhys_Buckling.hpp"
#include "Faults.hpp"
#include "mechanics/SideForce.hpp"
#include <cmath>
#include <core/EnergyTracker.hpp>
#include <core/Interaction.hpp>
#include <core/InteractionContainer.hpp>
#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include <mutex>

namespace yade {

YADE_PLUGIN((Law2_MembraneGeom_MembranePhys_Buckling));

namespace {

/// Finds the place of an energy that is reset in every step. YADE's own search makes two from two threads at once.
void findEnergy(EnergyTracker& energies, const string& name, int& index) {
    static std::mutex guard;
    if (__atomic_load_n(&index, __ATOMIC_ACQUIRE) >= 0) return;
    const std::lock_guard<std::mutex> lock(guard);
    int found = index;
    if (found < 0) energies.findId(name, found, /*reset in every step*/ true);
    __atomic_store_n(&index, found, __ATOMIC_RELEASE);
}

} // namespace

bool Law2_MembraneGeom_MembranePhys_Buckling::go(shared_ptr<IGeom>& geomBase, shared_ptr<IPhys>& physBase,
                                                 Interaction* link) {
    const auto& geom = *static_cast<MembraneGeom*>(geomBase.get());
    auto& phys = *static_cast<MembranePhys*>(physBase.get());

    const auto fault = [&](const std::string& what) {
        faults::record(scene, "Membrane: bodies #" + std::to_string(link->getId1()) + " and #" +
                                  std::to_string(link->getId2()) + " " + what);
        return true;
    };
    if (!(phys.restLength > 0.)) return fault("interact but are no side of the membrane");
    if (!std::isfinite(geom.length)) return fault("are " + std::to_string(geom.length) + " m apart");

    const Real tension = ::membrane::sideTension(geom.length, phys.kn, phys.restLength, phys.criticalLength);
    phys.normalForce = -tension * geom.normal;
    addForce(link->getId1(), -phys.normalForce, scene);
    addForce(link->getId2(), phys.normalForce, scene);

    if (scene->trackEnergy) {
        const string name = "membraneElastic";
        findEnergy(*scene->energy, name, energyIndex);
        scene->energy->add(::membrane::sideEnergy(geom.length, phys.kn, phys.restLength, phys.criticalLength), name,
                           energyIndex, /*reset in every step*/ true);
    }
    return true;
}

Real Law2_MembraneGeom_MembranePhys_Buckling::elasticEnergy() const {
    Real energy = 0.;
    for (const auto& link : *Omega::instance().getScene()->interactions) {
        if (!link->isReal()) continue;
        const auto* geom = dynamic_cast<MembraneGeom*>(link->geom.get());
        const auto* phys = dynamic_cast<MembranePhys*>(link->phys.get());
        if (geom && phys)
            energy += ::membrane::sideEnergy(geom->length, phys->kn, phys->restLength, phys->criticalLength);
    }
    return energy;
}

} // namespace yade

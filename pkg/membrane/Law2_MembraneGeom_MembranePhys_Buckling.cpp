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

namespace yade {

YADE_PLUGIN((Law2_MembraneGeom_MembranePhys_Buckling));

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

    if (scene->trackEnergy)
        scene->energy->add(::membrane::sideEnergy(geom.length, phys.kn, phys.restLength, phys.criticalLength),
                           "membraneElastic", energyIndex, /*reset in every step*/ true);
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

// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembranePhys.hpp"
#include "MembraneGeom.hpp"
#include <core/Interaction.hpp>

namespace yade {

YADE_PLUGIN((MembranePhys)(Ip2_MembraneMat_MembraneMat_MembranePhys));

void Ip2_MembraneMat_MembraneMat_MembranePhys::go(const shared_ptr<Material>&, const shared_ptr<Material>&,
                                                  const shared_ptr<Interaction>& link) {
    if (link->phys) return;
    const shared_ptr<MembranePhys> phys(new MembranePhys);
    link->phys = phys;
    const int side = membrane ? membrane->sideBetween(link->getId1(), link->getId2()) : -1;
    if (side < 0) return; // without a rest length, which the law records as a fault in every step
    phys->set(membrane->rest().sides[side]);
    if (auto* geom = dynamic_cast<MembraneGeom*>(link->geom.get())) {
        geom->refR1 = geom->refR2 = 0.5 * phys->restLength;
        geom->penetrationDepth = phys->restLength - geom->length;
    }
}

} // namespace yade

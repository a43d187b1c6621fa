// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembranePhys.hpp"
#include "BodyAt.hpp"
#include "Exactly.hpp"
#include "MembraneGeom.hpp"
#include "MembraneNode.hpp"
#include <core/Interaction.hpp>

namespace yade {

YADE_PLUGIN((MembranePhys)(Ip2_MembraneMat_MembraneMat_MembranePhys));

namespace {

/// The membrane's side between two bodies, or none.
const ::membrane::Side* sideBetween(const Interaction& link, const Scene& scene) {
    const shared_ptr<Body> first = bodyAt(scene, link.getId1());
    const MembraneNode* const node = first ? exactly<MembraneNode>(first->shape) : nullptr;
    if (!node || !node->membrane) return nullptr;
    const int side = node->membrane->sideBetween(link.getId1(), link.getId2());
    const ::membrane::RestState& rest = node->membrane->rest();
    return side < 0 || !rest.isSpring(rest.sides[side]) ? nullptr : &rest.sides[side];
}

} // namespace

void Ip2_MembraneMat_MembraneMat_MembranePhys::go(const shared_ptr<Material>& one, const shared_ptr<Material>& other,
                                                  const shared_ptr<Interaction>& link) {
    if (link->phys) return;
    MembraneGeom* const geom = exactly<MembraneGeom>(link->geom);
    if (!geom) {
        const shared_ptr<IPhysFunctor> given = contact ? contact : ordinaryContact_;
        given->scene = scene;
        given->go(one, other, link);
        return;
    }
    const shared_ptr<MembranePhys> phys(new MembranePhys);
    link->phys = phys;
    const ::membrane::Side* const side = sideBetween(*link, *scene);
    if (!side) return; // without a rest length, which the law notes as a fault in every step
    phys->set(*side);
    geom->refR1 = geom->refR2 = 0.5 * phys->restLength;
    geom->penetrationDepth = phys->restLength - geom->length;
}

} // namespace yade

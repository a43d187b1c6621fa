// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneGeom.hpp"
#include "Exactly.hpp"
#include <core/Interaction.hpp>
#include <core/State.hpp>

namespace yade {

YADE_PLUGIN((MembraneGeom)(Ig2_MembraneNode_MembraneNode_MembraneGeom));

bool Ig2_MembraneNode_MembraneNode_MembraneGeom::go(const shared_ptr<Shape>&, const shared_ptr<Shape>&,
                                                    const State& state1, const State& state2, const Vector3r& shift2,
                                                    const bool& force, const shared_ptr<Interaction>& link) {
    if (!link->geom) {
        if (!force) return false; // two nodes that touch are no side
        const shared_ptr<MembraneGeom> fresh(new MembraneGeom);
        fresh->refR1 = fresh->refR2 = 0.5 * (state2.pos + shift2 - state1.pos).norm();
        link->geom = fresh;
    }
    MembraneGeom* const geom = exactly<MembraneGeom>(link->geom);
    if (!geom) return false; // a contact that another functor has made
    geom->update(state1.pos, state2.pos + shift2);
    return true;
}

} // namespace yade

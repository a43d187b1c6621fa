// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "MembraneNode.hpp"
#include <core/Dispatching.hpp>
#include <pkg/dem/ScGeom.hpp>

namespace yade {

/// Length and direction of a side. An ScGeom, since YADE's own analyses take every interaction for one.
class MembraneGeom : public ScGeom {
public:
    /// From the positions of the two nodes [m]. Where they coincide the old direction stays.
    void update(const Vector3r& a, const Vector3r& b) {
        const Vector3r span = b - a;
        length = span.norm();
        if (length > 0.) normal = span / length;
        contactPoint = 0.5 * (a + b);
        penetrationDepth = refR1 + refR2 - length;
    }
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(MembraneGeom, ScGeom,
        "Geometry of one side of a :yref:`Membrane`: present length and direction (:yref:`normal<GenericSpheresContact.normal>`, from the "
        "first body to the second). Its :yref:`penetrationDepth<ScGeom.penetrationDepth>` [m] is rest length minus length; rotation and shear are not used.",
        ((Real, length, 0., , "Present length of the side [m]."))
        ,
        // YADE leaves these as it finds the memory; saved files should not hold what happens to lie there.
        normal = Vector3r::UnitX();
        contactPoint = shearInc = Vector3r::Zero();
        createIndex();
    );
    // clang-format on
    REGISTER_CLASS_INDEX(MembraneGeom, ScGeom);
};
REGISTER_SERIALIZABLE(MembraneGeom);

class Ig2_MembraneNode_MembraneNode_MembraneGeom : public IGeomFunctor {
public:
    bool go(const shared_ptr<Shape>&, const shared_ptr<Shape>&, const State& state1, const State& state2,
            const Vector3r& shift2, const bool& force, const shared_ptr<Interaction>& link) override;
    FUNCTOR2D(MembraneNode, MembraneNode);
    DEFINE_FUNCTOR_ORDER_2D(MembraneNode, MembraneNode);
    // clang-format off
    YADE_CLASS_BASE_DOC(Ig2_MembraneNode_MembraneNode_MembraneGeom, IGeomFunctor,
        "Updates the :yref:`MembraneGeom` of existing sides. Nodes that merely touch one another do not interact (paper, 2.1 and 3.3); what a node "
        "and another body do is left to YADE's functors for spheres, which may stand beside this one in either order.");
    // clang-format on
};
REGISTER_SERIALIZABLE(Ig2_MembraneNode_MembraneNode_MembraneGeom);

} // namespace yade

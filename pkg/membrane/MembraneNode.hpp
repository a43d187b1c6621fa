// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Membrane.hpp"
#include <pkg/common/Sphere.hpp>

namespace yade {

class MembraneNode : public Sphere {
public:
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(MembraneNode, Sphere,
        "Node of a :yref:`Membrane`. A shape of its own, so that sides and ordinary contacts have functors of their own in one loop: two nodes are taken by "
        ":yref:`Ig2_MembraneNode_MembraneNode_MembraneGeom`, a node and any other shape by the functor that YADE has for a sphere. "
        "Its radius [m] counts for contacts of bounded bodies and for drawing.",
        ((shared_ptr<Membrane>, membrane, , Attr::readonly, "The membrane that it is a node of."))
        ((int, node, -1, Attr::readonly, "Its id in the mesh of that membrane."))
        ,
        createIndex();
    );
    // clang-format on
    REGISTER_CLASS_INDEX(MembraneNode, Sphere);
};
REGISTER_SERIALIZABLE(MembraneNode);

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class BoundFunctor;
class InternalForceFunctor;

class Shape : public Serializable, public Indexable {
public:
    virtual ~Shape();
    // caches of YADE's
    shared_ptr<BoundFunctor> boundFunctor;
    shared_ptr<InternalForceFunctor> internalforcefunctor;

    Vector3r color;
    bool wire;
    bool highlight;

    Shape() : color(1, 1, 1), wire(false), highlight(false) {}
    YADE_ABI_SERIALIZABLE
#if YADE_ABI_RELEASE >= 202601
    virtual Real getVolume();
#endif
    YADE_ABI_TOP_INDEXABLE
};

YADE_ABI_LAYOUT(Shape, 96, ((boundFunctor, 32))((internalforcefunctor, 48))((color, 64))((wire, 88))((highlight, 89)));
YADE_ABI_TAIL(Shape, 90);
YADE_ABI_SAVED(Shape)

} // namespace yade

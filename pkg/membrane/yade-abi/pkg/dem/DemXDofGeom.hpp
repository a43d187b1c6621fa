// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/IGeom.hpp>

namespace yade {

class GenericSpheresContact : public IGeom {
public:
    // unit vector from body 1 to body 2
    Vector3r normal;
    Vector3r contactPoint;
    Real refR1;
    Real refR2;

    GenericSpheresContact() : normal(), contactPoint(), refR1(), refR2() { createIndex(); }
    virtual ~GenericSpheresContact();
    YADE_ABI_SERIALIZABLE
    YADE_ABI_INDEXABLE
};

YADE_ABI_LAYOUT(GenericSpheresContact, 96, ((normal, 32))((contactPoint, 56))((refR1, 80))((refR2, 88)));
YADE_ABI_SAVED(GenericSpheresContact)

} // namespace yade

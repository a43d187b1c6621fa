// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Shape.hpp>

namespace yade {

class Sphere : public Shape {
public:
    Real radius;

    Sphere();
    Sphere(Real radius_) : Sphere() { radius = radius_; }
    virtual ~Sphere();
    YADE_ABI_SERIALIZABLE
#if YADE_ABI_RELEASE >= 202601
    Real getVolume() override;
#endif
    YADE_ABI_INDEXABLE
};

YADE_ABI_LAYOUT(Sphere, 104, ((radius, 96)));
YADE_ABI_SAVED(Sphere)

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Bound.hpp>

namespace yade {

class Aabb : public Bound {
public:
    Aabb();
    virtual ~Aabb();
    YADE_ABI_SERIALIZABLE
    YADE_ABI_INDEXABLE
};

YADE_ABI_LAYOUT(Aabb, 144, );
YADE_ABI_SAVED(Aabb)

} // namespace yade

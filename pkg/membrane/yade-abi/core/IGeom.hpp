// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class IGeom : public Serializable, public Indexable {
public:
    IGeom() {}
    virtual ~IGeom();
    YADE_ABI_SERIALIZABLE
    YADE_ABI_TOP_INDEXABLE
};

YADE_ABI_LAYOUT(IGeom, 32, );
YADE_ABI_SAVED(IGeom)

} // namespace yade

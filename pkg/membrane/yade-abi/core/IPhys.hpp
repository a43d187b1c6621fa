// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class IPhys : public Serializable, public Indexable {
public:
    IPhys() {}
    virtual ~IPhys();
    YADE_ABI_SERIALIZABLE
    YADE_ABI_TOP_INDEXABLE
};

YADE_ABI_LAYOUT(IPhys, 32, );
YADE_ABI_SAVED(IPhys)

} // namespace yade

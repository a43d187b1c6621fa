// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/GlobalEngine.hpp>

namespace yade {

// Base of engines that act on bodies by a field of force.
class FieldApplier : public GlobalEngine {
    void action() override;

public:
    // of the work done by the field, in Scene::energy
    int fieldWorkIx;

    FieldApplier() : fieldWorkIx(-1) {}
    virtual ~FieldApplier();
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(FieldApplier, 112, ((fieldWorkIx, 104)));
YADE_ABI_TAIL(FieldApplier, 108);
YADE_ABI_SAVED(FieldApplier)

} // namespace yade

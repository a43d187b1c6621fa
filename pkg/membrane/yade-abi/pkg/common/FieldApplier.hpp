// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/GlobalEngine.hpp>

namespace yade {

// Puts the forces of a field, such as gravity, on bodies.
class FieldApplier : public GlobalEngine {
public:
    int fieldWorkIx;

    FieldApplier() : fieldWorkIx(-1) {}
    virtual ~FieldApplier();
    void action() override;
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(FieldApplier, 112, ((fieldWorkIx, 104)));
YADE_ABI_SAVED(FieldApplier)

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <core/Engine.hpp>

namespace yade {

// Acts on the bodies listed in ids.
class PartialEngine : public Engine {
public:
    vector<int> ids;

    PartialEngine() {}
    virtual ~PartialEngine();
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(PartialEngine, 128, ((ids, 104)));
YADE_ABI_SAVED(PartialEngine)

} // namespace yade

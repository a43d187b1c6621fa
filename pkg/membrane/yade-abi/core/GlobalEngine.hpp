// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Engine.hpp>

namespace yade {

class GlobalEngine : public Engine {
public:
    GlobalEngine() {}
    virtual ~GlobalEngine();
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(GlobalEngine, 104, );
YADE_ABI_SAVED(GlobalEngine)

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Omega.hpp>
#include <core/Timing.hpp>
#include <lib/base/Logging.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class Body;
class Scene;

class Engine : public Serializable {
public:
    // set before every step
    Scene* scene;
    TimingInfo timingInfo;
    shared_ptr<TimingDeltas> timingDeltas;

    virtual ~Engine();
    virtual bool isActivated();
    virtual void action();

    bool dead;
    int ompThreads;
    string label;

    Engine();
    DECLARE_LOGGER;
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(Engine, 104,
                ((scene, 24))((timingInfo, 32))((timingDeltas, 48))((dead, 64))((ompThreads, 68))((label, 72)));
YADE_ABI_SAVED(Engine)

} // namespace yade

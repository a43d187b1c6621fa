// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/GlobalEngine.hpp>
#include <core/Interaction.hpp>
#include <core/Scene.hpp>

namespace yade {

class TimeStepper : public GlobalEngine {
public:
    bool active;
    unsigned int timeStepUpdateInterval;

    TimeStepper() : active(true), timeStepUpdateInterval(1) {}
    virtual ~TimeStepper();
    virtual void computeTimeStep(Scene*);
    bool isActivated() override;
    void action() override;
    void setActive(bool on, int interval = -1) {
        active = on;
        if (interval > 0) timeStepUpdateInterval = static_cast<unsigned int>(interval);
    }
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(TimeStepper, 112, ((active, 104))((timeStepUpdateInterval, 108)));
YADE_ABI_SAVED(TimeStepper)

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "MembraneForceEngine.hpp"
#include <core/TimeStepper.hpp>

namespace yade {

class MembraneTimeStepper : public TimeStepper {
public:
    bool isActivated() override;
    void computeTimeStep(Scene* now) override;
    void postLoad(MembraneTimeStepper&);

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(MembraneTimeStepper, TimeStepper,
        "Keeps O.dt at a fraction of :yref:`MembraneForceEngine.criticalTimeStep` as the state changes. Every change of the step disturbs "
        "the leapfrog's energy a little: leave :yref:`timeStepUpdateInterval<TimeStepper.timeStepUpdateInterval>` large.",
        ((shared_ptr<MembraneForceEngine>, forces, , , "The engine that knows the critical time step."))
        ((Real, fraction, 0.5, Attr::triggerPostLoad, "O.dt over the critical time step [-], in (0, 1]."))
        ,
        timeStepUpdateInterval = 5000;
    );
    // clang-format on
};
REGISTER_SERIALIZABLE(MembraneTimeStepper);

} // namespace yade

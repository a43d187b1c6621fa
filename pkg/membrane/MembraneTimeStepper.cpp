// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneTimeStepper.hpp"
#include <cmath>
#include <core/Scene.hpp>

namespace yade {

YADE_PLUGIN((MembraneTimeStepper));

void MembraneTimeStepper::postLoad(MembraneTimeStepper&) {
    if (!(fraction > 0. && fraction <= 1.))
        throw std::invalid_argument("MembraneTimeStepper: fraction = " + std::to_string(fraction) +
                                    " must be in (0, 1]");
}

bool MembraneTimeStepper::isActivated() {
    if (timeStepUpdateInterval == 0) // by which YADE divides
        throw std::runtime_error("MembraneTimeStepper: timeStepUpdateInterval = 0 must be > 0");
    return TimeStepper::isActivated();
}

void MembraneTimeStepper::computeTimeStep(Scene* now) {
    StepGuard::refuseCall(*this);
    if (!forces) throw std::runtime_error("MembraneTimeStepper: forces is not set");
    const Real limit = forces->criticalTimeStep();
    if (std::isfinite(limit)) now->dt = fraction * limit;
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace membrane {

/// Local damping of one component of an acceleration [m/s²], as YADE's NewtonIntegrator does it: less where it drives
/// the motion, more where it brakes. Physical damping it is not; it serves to find an equilibrium. \param velocity
/// [m/s];  \param dt [s];  \param damping [-], in [0, 1)
inline double locallyDamped(double acceleration, double velocity, double dt, double damping) {
    const double power = acceleration * (velocity + 0.5 * dt * acceleration);
    const double sign = (power > 0. ? 1. : 0.) - (power < 0. ? 1. : 0.);
    return acceleration * (1. - damping * sign);
}

} // namespace membrane

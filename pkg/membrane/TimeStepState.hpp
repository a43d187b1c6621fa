// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Membrane.hpp"
#include "mechanics/LinearForces.hpp"

namespace yade {

/// What the critical time step depends on, taken from the bodies as they are.
struct TimeStepState {
    ::membrane::Points positions; ///< [m]
    vector<Real> masses;          ///< [kg]; 0: held
    vector<Real> drag;            ///< slopes [N s/m]; empty without air

    TimeStepState(const Membrane& membrane, const vector<shared_ptr<State>>& states, Real airDensity);
};

} // namespace yade

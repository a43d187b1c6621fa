// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "NodeContacts.hpp"
#include "mechanics/LinearForces.hpp"

namespace yade {

/// What the critical time step depends on, taken from the bodies as they are.
struct TimeStepState {
    ::membrane::Points positions; ///< [m]
    vector<Real> masses;          ///< [kg]; 0: held
    vector<Real> damping;         ///< of the sides [N s/m]; empty: none
    vector<Real> drag;            ///< slopes [N s/m]; empty without air
    ContactStiffness contacts;

    TimeStepState(const Membrane& membrane, const vector<shared_ptr<Body>>& bodies, Real zeta, Real airDensity);
    ::membrane::TimeStepInput input(const Membrane& membrane, const ::membrane::CreaseLaw& law) const;
};

/// Coefficients (9) of the sides [N s/m], from the masses of the nodes' bodies; empty without damping.
vector<Real> dampingCoefficients(const Membrane& membrane, const vector<shared_ptr<Body>>& bodies, Real zeta);

} // namespace yade

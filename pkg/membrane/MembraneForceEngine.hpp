// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Membrane.hpp"
#include "mechanics/Crease.hpp"
#include <core/GlobalEngine.hpp>

namespace yade {

class MembraneForceEngine : public GlobalEngine {
public:
    void action() override;
    void postLoad(MembraneForceEngine&);

    /// Positions [m] and velocities [m/s] of the nodes, as this step's forces saw them.
    const ::membrane::Points& positions() const { return x_; }
    vector<Vector3r> lastPositions() const { return x_; }
    const ::membrane::Points& velocities() const { return v_; }
    /// Step in which the forces were last computed; -1: none yet.
    long lastStep() const { return lastStep_; }
    const vector<shared_ptr<State>>& states() const { return states_; }
    /// Forces of this step on each node [N].
    const ::membrane::Points& creaseForces() const { return creaseForces_; }
    const ::membrane::Points& dampingForces() const { return dampingForces_; }
    const ::membrane::Points& dragForces() const { return dragForces_; }

    Real criticalTimeStep();
    Real creaseEnergy(const ::membrane::Points& x) const;
    Real creaseEnergyNow() const;
    vector<Real> creaseAngles(const vector<Vector3r>& at) const;
    ::membrane::CreaseLaw law() const;

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneForceEngine, GlobalEngine,
        "Creases (7), (8), damping (9) and air drag (10) of a :yref:`Membrane`; a part whose parameter is 0 is not computed. It also "
        "raises the faults that the functors met, refuses a time step above the critical one, and stops at the first number that is "
        "not finite. The leapfrog's velocities lie half a step before the positions; damping and drag take those at the time of the "
        "positions, extrapolated from the last two. Put it after InteractionLoop and before NewtonIntegrator.",
        ((shared_ptr<Membrane>, membrane, , Attr::triggerPostLoad, "The membrane on which the forces act."))
        ((Real, beta, 0., Attr::triggerPostLoad, "Crease stiffness parameter beta [-], >= 0; 0: no creases."))
        ((Real, gamma, 100., Attr::triggerPostLoad, "Penalty factor gamma [-], >= 0, on creases whose faces passed through each other."))
        ((Real, theta0, 0., Attr::triggerPostLoad, "Natural angle theta0 of the creases [rad], in [0, pi]; 0: closed."))
        ((string, creaseLaw, "paper", Attr::triggerPostLoad, "'paper': equation (7) as printed; 'conservative': the gradient of an energy."))
        ((Real, zeta, 0., Attr::triggerPostLoad, "Damping ratio zeta [-], >= 0; 0: none."))
        ((Real, airDensity, 0., Attr::triggerPostLoad, "Density of the air [kg/m³], >= 0; 0: none."))
        ((bool, forceTimeStep, false, , "Run even if O.dt is above criticalTimeStep()."))
        ((int, timeStepCheckPeriod, 5000, Attr::triggerPostLoad, "Steps between two checks of O.dt against criticalTimeStep(), which changes with the state; also checked when O.dt changes. > 0."))
        ((vector<Vector3r>, seenPositions, , , "Positions [m] of the nodes in the last step; empty it after giving nodes other velocities, which then count as they are."))
        ((vector<Vector3r>, seenVelocities, , Attr::readonly, "Velocities [m/s] of the nodes in the last step."))
        ((Real, creasePower, 0., Attr::readonly, "Power of the crease forces in the last step [W], at the velocities half a step before."))
        ((Real, dampingPower, 0., Attr::readonly, "Power of the damping forces in the last step [W], <= 0."))
        ((Real, dragPower, 0., Attr::readonly, "Power of the air drag in the last step [W], <= 0."))
        ,
        ,
        .def("criticalTimeStep", &MembraneForceEngine::criticalTimeStep, "Estimate of the critical time step [s] in the present state, from the actual "
            "stiffnesses, damping, drag, creases and masses; contacts of other functors are not counted.")
        .def("creaseEnergy", &MembraneForceEngine::creaseEnergyNow, "Energy [J] stored in the creases in the present state.")
        .def("creaseAngles", &MembraneForceEngine::creaseAngles, (boost::python::arg("positions") = vector<Vector3r>()), "Angle [rad] of each crease: 0 "
            "closed, pi flat, below 0 passed through itself; at given positions of the N nodes [m], default: the present ones.")
        .def("lastPositions", &MembraneForceEngine::lastPositions, "Positions [m] of the nodes as the last step's forces saw them, before the "
            "integrator moved them; empty before the first step.")
    );
    // clang-format on

private:
    vector<shared_ptr<State>> states_;
    vector<Real> damping_; ///< c of each side [N s/m]
    ::membrane::Points x_, v_;
    ::membrane::Points u_; ///< velocities [m/s] at the time of x_, of which damping and drag are functions
    ::membrane::Points creaseForces_, dampingForces_, dragForces_;
    const Scene* preparedFor_ = nullptr;
    Real checkedStep_ = -1.;
    long lastStep_ = -1;

    void prepare(Scene& now);
    void gather();
    void centreVelocities();
    void checkTimeStep();
    void addCreases();
    void addDamping();
    void addDrag();
    void scatter() const;
};
REGISTER_SERIALIZABLE(MembraneForceEngine);

} // namespace yade

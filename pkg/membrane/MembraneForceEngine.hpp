// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Membrane.hpp"
#include "StepGuard.hpp"
#include "kernels/Sweep.hpp"
#include <core/GlobalEngine.hpp>

namespace yade {

class FreeHub;
class MembraneLedger;
struct TimeStepState;

class MembraneForceEngine : public GlobalEngine {
public:
    void action() override;
    void postLoad(MembraneForceEngine&);
    virtual void preSave(MembraneForceEngine&) {}

    /// Step in which the forces were last computed; -1: none yet.
    long lastStep() const { return lastStep_; }
    int nodeCount() const { return static_cast<int>(states_.size()); }
    const vector<shared_ptr<State>>& states() const { return states_; }
    /// Position [m] and velocity [m/s] of a node, as the last step's forces saw them.
    virtual Vector3r positionSeen(int node) const { return sweep_.x.at(node); }
    virtual Vector3r velocitySeen(int node) const { return sweep_.v.at(node); }
    vector<Vector3r> lastPositions() const;
    /// Present positions [m] of the nodes, for a thread other than the one that runs the scene: waits for a step's end.
    ::membrane::Points positionsNow(Scene& now) const;
    vector<Vector3r> creaseForces() const { return ofNodes(&::membrane::Sweep::creaseForce); }
    vector<Vector3r> dampingForces() const { return ofNodes(&::membrane::Sweep::dampingForce); }
    vector<Vector3r> dragForces() const { return ofNodes(&::membrane::Sweep::dragForce); }
    boost::python::object lastPositionsBytes() const;

    /// The free hub that this engine's forces turn, or none.
    FreeHub* hub(const Scene& in) const;

    /// For the ledger: the nodes that the sweep does not move, and everything summed over the others.
    virtual const vector<int>& nodesLeft() const { return allNodes_; }
    const ::membrane::Sweep& sweep() const { return sweep_; }
    /// All forces [N] on one of the nodes that the sweep does not move, gravity apart.
    virtual Vector3r totalForce(int node) const;
    /// Power [W] of the forces from outside on those others, at the velocities before and after the last step.
    virtual std::pair<Real, Real> powerFromOutside() const { return {0., 0.}; }
    /// The sums that the last step made for the ledger.
    ::membrane::Sums madeSums() const { return madeSums_; }
    void forgetLengths() { keepLengths_ = false; }

    /// Brings the bodies up to date, if this engine moves them itself.
    virtual void writeBack() {}
    /// The nodes' present velocities were given by hand: until the next step they count as they are.
    virtual void forgetVelocities() { seenPositions.clear(); }
    virtual vector<Vector3r> nodeForces();
    /// Whether a CentrifugalField need not put its forces on the nodes: this engine counts them in.
    virtual bool takesField(const Scene&) const { return false; }

    static void advance(long steps);
    Real criticalTimeStep();
    Real creaseEnergy(const ::membrane::Points& x) const;
    Real creaseEnergyNow();
    vector<Real> creaseAngles(const boost::python::object& at);
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
        ((vector<Vector3r>, seenPositions, , Attr::readonly, "Positions [m] of the nodes in the last step."))
        ((vector<Vector3r>, seenVelocities, , Attr::readonly, "Velocities [m/s] of the nodes in the last step."))
        ,
        ,
        .def("advance", &MembraneForceEngine::advance, "Run so many steps of the scene: O.step() without the way through Python in between.")
        .staticmethod("advance")
        .def("criticalTimeStep", &MembraneForceEngine::criticalTimeStep, "Estimate of the critical time step [s] in the present state, from the actual "
            "stiffnesses, damping, drag, creases and masses; contacts of other functors are not counted.")
        .def("creaseEnergy", &MembraneForceEngine::creaseEnergyNow, "Energy [J] stored in the creases in the present state.")
        .def("creaseAngles", &MembraneForceEngine::creaseAngles, (boost::python::arg("positions") = boost::python::list()), "Angle [rad] of each crease: 0 "
            "closed, pi flat, below 0 passed through itself; at given positions of the N nodes [m], default: the present ones.")
        .def("lastPositions", &MembraneForceEngine::lastPositions, "Positions [m] of the nodes as the last step's forces saw them, before the "
            "integrator moved them; empty before the first step.")
        .def("lastPositionsBytes", &MembraneForceEngine::lastPositionsBytes, "The same as bytes, 3 N doubles, for numpy.frombuffer.")
        .def("creaseForces", &MembraneForceEngine::creaseForces, "Forces of the creases on the nodes in the last step [N]; 0 where a MembraneIntegrator has moved them.")
        .def("dampingForces", &MembraneForceEngine::dampingForces, "Forces of damping on the nodes in the last step [N]; 0 where a MembraneIntegrator has moved them.")
        .def("dragForces", &MembraneForceEngine::dragForces, "Forces of air drag on the nodes in the last step [N]; 0 where a MembraneIntegrator has moved them.")
        .def("nodeForces", &MembraneForceEngine::nodeForces, "All forces on the nodes [N] in a step in which nothing was moved, gravity apart.")
        .def("forgetVelocities", &MembraneForceEngine::forgetVelocities, "Call it after giving nodes other velocities: until the next step they count as they are.")
        .def("writeBack", &MembraneForceEngine::writeBack, "Bring the bodies up to date, in the middle of a run with an exchangePeriod above 1.")
    );
    // clang-format on

protected:
    vector<shared_ptr<State>> states_;
    vector<int> allNodes_;
    ::membrane::Sweep sweep_;
    long lastStep_ = -1;
    ::membrane::Sums madeSums_ = ::membrane::Sums::none;

    /// Looks up the bodies and computes what stays the same while it runs.
    virtual void prepare(Scene& now);
    /// Decides which nodes the sweep moves, and calls prepareSweep().
    virtual void arrange() { prepareSweep(vector<char>(states_.size(), false), 1); }
    virtual void gather();
    virtual ::membrane::Points presentPositions(Scene& now) const { return membrane->positions(now); }
    virtual void computeForces();
    /// Builds the tables of the forces for nodes of which `owned` are moved by the sweep.
    void prepareSweep(const vector<char>& owned, int parts);
    /// The ledger that counts this engine's energies in this step, or none.
    MembraneLedger* ledger(const Scene& in) const;
    /// Called when O.engines are others than before: looking through them in every step takes longer than many a force.
    virtual void findEngines(const Scene& in) const;
    void findEnginesIfOthers(const Scene& in) const;
    /// What the sweep needs to begin or continue a ledger's sums.
    void continueLedger(const MembraneLedger* ledger, ::membrane::Sums wanted);
    [[noreturn]] void stopDiverged() const;

private:
    mutable StepGuard guard_;
    const Scene* preparedFor_ = nullptr;
    mutable vector<std::pair<const Engine*, const std::type_info*>> knownEngines_;
    mutable vector<MembraneLedger*> ledgers_; ///< in the order of O.engines
    mutable vector<FreeHub*> hubs_;
    Real checkedStep_ = -1.;
    bool keepLengths_ = false; ///< the sweep's lengths are those of the ledger's last step

    TimeStepState timeStepState(const Scene& in) const;
    void checkTimeStep();
    vector<Real> dampingCoefficients() const;
    vector<Vector3r> ofNodes(Vector3r (::membrane::Sweep::*force)(int) const) const;
};
REGISTER_SERIALIZABLE(MembraneForceEngine);

/// Whether a node cannot move but as it is driven.
bool isHeld(const State& state);

/// Velocity [m/s] at the time of the position, of a node seen elsewhere in the step before. With one half a step old,
/// damping and drag would be of first order in the step, and a spinning membrane under a false tension.
Vector3r centredVelocity(const State& state, const Vector3r& seenPosition, const Vector3r& seenVelocity, Real dt);

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Membrane.hpp"
#include "MembranePhys.hpp"
#include "NodeContacts.hpp"
#include "SceneMark.hpp"
#include "StepGuard.hpp"
#include "Surroundings.hpp"
#include "kernels/Sweep.hpp"
#include <core/GlobalEngine.hpp>

namespace yade {

class FreeHub;
class MembraneForce;
class MembraneLedger;

class MembraneForceEngine : public GlobalEngine {
public:
    void action() final;
    void postLoad(MembraneForceEngine&);
    void preSave(MembraneForceEngine&);

    /// The engine in O.engines that lives and computes the forces on a membrane; null: none.
    static MembraneForceEngine* of(const Membrane* membrane, const Scene& in);
    /// Whether it has computed the forces in the present step of a scene.
    bool hasRun(const Scene& in) const { return lastStep_ == in.iter && preparedFor_.is(&in); }
    int nodeCount() const { return static_cast<int>(states_.size()); }
    const vector<shared_ptr<State>>& states() const { return states_; }
    /// Position [m] and velocity [m/s] of a node, as the last step's forces saw them.
    virtual Vector3r positionSeen(int node) const { return sweep_.x.at(node); }
    virtual Vector3r velocitySeen(int node) const { return sweep_.v.at(node); }
    vector<Vector3r> lastPositions() const;
    vector<Vector3r> lastVelocities() const;
    /// Present positions [m] of the nodes, for the thread that draws them.
    ::membrane::Points positionsNow(const Scene& now) const;
    vector<Vector3r> creaseForces() const { return channelForces(::membrane::creaseChannel); }
    vector<Vector3r> dampingForces() const { return channelForces(::membrane::dampingChannel); }
    vector<Vector3r> dragForces() const { return channelForces(::membrane::dragChannel); }
    vector<Vector3r> forcesOf(const string& channel) const;
    boost::python::object lastPositionsBytes() const;

    /// The free hub that this engine's forces turn, or none.
    FreeHub* hub(const Scene& in) const { return surroundings_.hub(*this, in); }
    /// The membrane; refuses that there is none.
    const Membrane& given() const;
    /// Whether a NewtonIntegrator of the present step moves a body.
    bool isMoved(const Body& body) const { return surroundings_.moves(*scene, {&body}); }
    /// The contacts of its nodes in the last step.
    const vector<NodeContact>& contacts() const { return contacts_; }

    /// For the ledger: the nodes that the sweep does not move, and everything summed over the others.
    virtual const vector<int>& nodesLeft() const { return allNodes_; }
    const ::membrane::Sweep& sweep() const { return sweep_; }
    /// All forces [N] on one of the nodes that the sweep does not move, gravity apart.
    virtual Vector3r totalForce(int node) const;
    /// Power [W] of the forces from outside on those others, at the velocities before and after the last step.
    virtual std::pair<Real, Real> powerFromOutside() const { return {0., 0.}; }
    /// The sums that the last step made for the ledger.
    ::membrane::Sums madeSums() const { return madeSums_; }
    void forgetMemory() { keepMemory_ = false; }

    /// Brings the bodies up to date, if this engine moves them itself.
    virtual void writeBack() {}
    /// The nodes' present velocities were given by hand: until the next step they count as they are.
    virtual void forgetVelocities() { forgetSeen(); }
    virtual vector<Vector3r> nodeForces();
    /// Whether a CentrifugalField need not put its forces on the nodes: this engine counts them in.
    virtual bool takesField(const Scene&) const { return false; }

    static void advance(long steps);
    Real criticalTimeStep();
    /// Energy [J] of the creases at given positions of the nodes; 0 without a membrane.
    Real creaseEnergy(const ::membrane::Points& x) const;
    Real creaseEnergyNow();
    vector<Real> creaseAngles(const boost::python::object& at);
    ::membrane::CreaseLaw law() const;

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneForceEngine, GlobalEngine,
        "Creases (7), (8), damping (9) and air drag (10) of a :yref:`Membrane`; a part whose parameter is 0 is not computed. It also "
        "raises the faults that the functors met, refuses a time step above the critical one, contacts included, and stops at the first number that is "
        "not finite. It also stops where a side was not computed, where nodes were erased, clumped or given another mass since it began, and where two engines do one work. The leapfrog's velocities lie half a step before the positions; damping and drag take those at the time of the "
        "positions, extrapolated from the last two. Put it after InteractionLoop and before NewtonIntegrator.",
        ((shared_ptr<Membrane>, membrane, , Attr::triggerPostLoad, "The membrane on which the forces act."))
        ((Real, beta, 0., Attr::triggerPostLoad, "Crease stiffness parameter beta [-], >= 0; 0: no creases."))
        ((Real, gamma, 100., Attr::triggerPostLoad, "Penalty factor gamma [-], >= 0, on creases whose faces passed through each other."))
        ((Real, theta0, 0., Attr::triggerPostLoad, "Natural angle theta0 of the creases [rad], in [0, pi]; 0: closed."))
        ((Real, creaseLength, 0., Attr::triggerPostLoad, "The creases' own length L* [m], >= 0, in place of beta: stiffness D / L* a length on any mesh, D = E h³ / (12 (1 - nu²)), always the gradient of an energy; 0: by beta."))
        ((string, creaseLaw, "paper", Attr::triggerPostLoad, "'paper': equation (7) as printed; 'conservative': the gradient of an energy."))
        ((Real, zeta, 0., Attr::triggerPostLoad, "Damping ratio zeta [-], >= 0; 0: none."))
        ((Real, dampingTime, 0., Attr::triggerPostLoad, "Damping time tau [s], >= 0, in place of zeta: film and cables are those of Kelvin and Voigt with this one time, on any mesh; 0: by zeta."))
        ((Real, airDensity, 0., Attr::triggerPostLoad, "Density of the air [kg/m³], >= 0; 0: none."))
        ((bool, forceTimeStep, false, , "Run even if O.dt is above criticalTimeStep()."))
        ((int, timeStepCheckPeriod, 5000, Attr::triggerPostLoad, "Steps between two checks of O.dt against criticalTimeStep(), which changes with the state; also checked when O.dt changes. > 0."))
        ((vector<Vector3r>, seenPositions, , Attr::readonly, "Positions [m] of the nodes in the last step."))
        ((vector<Vector3r>, seenVelocities, , Attr::readonly, "Velocities [m/s] of the nodes in the last step."))
        ,
        ,
        .def("advance", &MembraneForceEngine::advance, "Run so many steps of the scene: O.step() without the way through Python in between.")
        .staticmethod("advance")
        .def("criticalTimeStep", &Guarded<&MembraneForceEngine::criticalTimeStep>::call, "Estimate of the critical time step [s] in the present state, from the actual "
            "stiffnesses, damping, drag, creases and masses, and from the contacts that nodes have now, where their stiffness is that of a NormShearPhys.")
        .def("creaseEnergy", &Guarded<&MembraneForceEngine::creaseEnergyNow>::call, "Energy [J] stored in the creases in the present state.")
        .def("creaseAngles", &Guarded<&MembraneForceEngine::creaseAngles>::call, (boost::python::arg("positions") = boost::python::list()), "Angle [rad] of each crease: 0 "
            "closed, pi flat, below 0 passed through itself; at given positions of the N nodes [m], default: the present ones.")
        .def("lastPositions", &Guarded<&MembraneForceEngine::lastPositions>::call, "Positions [m] of the nodes as the last step's forces saw them, before the "
            "integrator moved them; empty before the first step.")
        .def("lastPositionsBytes", &Guarded<&MembraneForceEngine::lastPositionsBytes>::call, "The same as bytes, 3 N doubles, for numpy.frombuffer.")
        .def("creaseForces", &Guarded<&MembraneForceEngine::creaseForces>::call, "Forces of the creases on the nodes in the last step [N]; 0 where a MembraneIntegrator has moved them.")
        .def("dampingForces", &Guarded<&MembraneForceEngine::dampingForces>::call, "Forces of damping on the nodes in the last step [N]; 0 where a MembraneIntegrator has moved them.")
        .def("dragForces", &Guarded<&MembraneForceEngine::dragForces>::call, "Forces of air drag on the nodes in the last step [N]; 0 where a MembraneIntegrator has moved them.")
        .def("forcesOf", &Guarded<&MembraneForceEngine::forcesOf>::call, (boost::python::arg("channel")), "Forces of one kind on the nodes in the last step [N], by the name under which their "
            "work is booked: 'crease', 'damping', 'drag', or that of a :yref:`MembraneForce`; 0 where a MembraneIntegrator has moved them.\n\n:raises ValueError: if there is no such kind")
        .def("nodeForces", &Guarded<&MembraneForceEngine::nodeForces>::call, "All forces on the nodes [N] in a step in which nothing was moved, gravity apart.")
        .def("forgetVelocities", &Guarded<&MembraneForceEngine::forgetVelocities>::call, "Call it after giving nodes other velocities: until the next step they count as they are.")
        .def("writeBack", &Guarded<&MembraneForceEngine::writeBack>::call, "Bring the bodies up to date, in the middle of a run with an exchangePeriod above 1.")
    );
    // clang-format on

protected:
    vector<shared_ptr<Body>> bodies_;
    vector<shared_ptr<State>> states_;
    vector<int> allNodes_;
    ::membrane::Sweep sweep_;
    ::membrane::Sums madeSums_ = ::membrane::Sums::none;
    mutable Surroundings surroundings_;

    /// Looks up the bodies and computes what stays the same while it runs.
    virtual void prepare(Scene& now);
    /// Decides which nodes the sweep moves, and calls prepareSweep().
    virtual void arrange();
    virtual void gather();
    virtual ::membrane::Points presentPositions(const Scene& now) const { return membrane->positions(now); }
    virtual void computeForces();
    /// Fetches into the attributes what a saved engine needs to go on.
    virtual void fetch() {}
    /// Whether sides are interactions.
    virtual bool takesInteractions() const { return true; }
    /// Refuses other engines that cannot stand beside this one.
    void checkSurroundings();
    shared_ptr<Scene> sceneAtRest() const;
    virtual void forget();
    /// Builds the tables of the forces for nodes of which `owned` are moved by the sweep.
    void prepareSweep(const vector<char>& owned, int parts);
    /// Refuses a node whose body was erased, replaced, clumped or given another mass since prepare(), which would go on
    /// as it was.
    void checkNode(int node) const;
    /// The same of all nodes if bodies have come or gone.
    void checkClumps();
    /// The ledger that counts this engine's energies in this step, or none.
    MembraneLedger* ledger(const Scene& in) const { return surroundings_.ledger(*this, in); }
    /// What the sweep needs to begin or continue a ledger's sums.
    void continueLedger(const MembraneLedger* ledger, ::membrane::Sums wanted);
    bool isPreparedFor(const Scene& in) const { return preparedFor_.is(&in); }
    [[noreturn]] void stopDiverged() const;
    void forgetSeen() {
        seenPositions.clear();
        seenVelocities.clear();
    }

private:
    SceneMark preparedFor_; ///< with the present parameters
    SceneMark begunIn_;     ///< with others, it may be
    shared_ptr<Membrane> preparedMembrane_;
    long preparedVersion_ = -1; ///< of that membrane
    vector<Real> masses_;       ///< of the nodes [kg], for which it is prepared
    std::size_t bodyCount_ = 0; ///< of the scene, when clumps were last looked for
    long lastStep_ = -1;        ///< in which the forces were computed; -1: none yet
    Real checkedStep_ = -1.;
    Real checkedContacts_ = 0.;                 ///< ContactStiffness::fastest with which O.dt was checked
    bool keepMemory_ = false;                   ///< the sweep's memory is that of the ledger's last step
    vector<shared_ptr<MembraneForce>> further_; ///< for which it is prepared
    vector<NodeContact> contacts_;
    vector<const Body*> left_;                     ///< bodies of the nodes that NewtonIntegrator may move
    vector<shared_ptr<MembranePhys>> interacting_; ///< what computes the springs among the sides

    void step();
    void checkLaws() const;
    void addFilmForces() const;
    void checkKnown() const;
    ::membrane::ElementForces makeForces(const vector<shared_ptr<Body>>& bodies, const Scene& in) const;
    ::membrane::LinearForces linearForces(const Scene& in, const vector<shared_ptr<Body>>& bodies,
                                          const ContactStiffness& contacts) const;
    void checkTimeStep();
    void checkSides();
    void findSides();
    [[noreturn]] void refuseSpring(std::size_t number) const;
    void findContacts();
    vector<Vector3r> channelForces(int channel) const;
};
REGISTER_SERIALIZABLE(MembraneForceEngine);

bool allFinite(const vector<Vector3r>& all);

/// Whether a node cannot move but as it is driven.
bool isHeld(const State& state);

/// Velocity [m/s] at the time of the position, of a node seen elsewhere in the step before. With one half a step old,
/// damping and drag would be of first order in the step, and a spinning membrane under a false tension.
Vector3r centredVelocity(const State& state, const Vector3r& seenPosition, const Vector3r& seenVelocity, Real dt);

} // namespace yade

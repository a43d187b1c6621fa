// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "MembraneForceEngine.hpp"
#include <core/GlobalEngine.hpp>

namespace yade {

class FreeHub;

class MembraneLedger : public GlobalEngine {
public:
    void action() override;
    void postLoad(MembraneLedger&);
    /// Whether this step's energies are wanted, not only its works.
    bool wantsEnergies(const Scene& now) const;
    /// Whether the values are those of the step `now`.
    bool isUpToDate(const Scene& now) const;
    void preSave(MembraneLedger&);
    /// Fetches into the attributes what a saved ledger needs to go on.
    void fetch();
    Real balance() const;
    Real unexplained() const { return balance() - kinkError; }
    Real crease() const;
    Real creaseDefect() const { return crease() - initialCrease + creaseWork; }
    Real total() const { return kinetic + elastic + potential; }
    Real workOf(const string& channel) const;

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneLedger, GlobalEngine,
        "Energies of a :yref:`Membrane` and the work done on it, at the time of this step's forces. The leapfrog's velocities v-, v+ lie half a "
        "step before and after; with m v- v+ / 2 for kinetic energy, and the mean of two steps' forces times the velocity between them for work, "
        "energy is conserved to the last digit in a linear system at any time step. Put it right after NewtonIntegrator, and set its damping to 0. "
        "Blocked directions of a node count as driven; a node with all translations blocked turns about the z axis with its angVel. A :yref:`FreeHub` belongs to the "
        "system with its nodes: its energy and angular momentum are counted, and no work of driving. Where a "
        "side buckles or becomes taut within a step, the mean force misses a part of its energy: kinkError, nearly all of the balance.",
        ((shared_ptr<MembraneForceEngine>, forces, , , "The engine of the crease, damping and drag forces."))
        ((Vector3r, gravity, Vector3r::Zero(), , "NewtonIntegrator's gravity [m/s²]."))
        ((bool, started, false, Attr::readonly, "Whether the first step was seen."))
        ((Real, time, 0., Attr::readonly, "Time to which all values belong [s]."))
        ((Real, kinetic, 0., Attr::readonly, "Kinetic energy of the free nodes [J], m v- v+ / 2, and of a free hub."))
        ((Real, elastic, 0., Attr::readonly, "Strain energy of all sides [J]."))
        ((Real, potential, 0., Attr::readonly, "Potential energy of gravity of the free nodes [J], 0 at the origin."))
        ((Real, initial, 0., Attr::readonly, "kinetic + elastic + potential at the first step [J]."))
        ((Real, initialCrease, 0., Attr::readonly, "crease at the first step [J]."))
        ((Real, creaseWork, 0., Attr::readonly, "Work of the crease forces [J]."))
        ((Real, dampingWork, 0., Attr::readonly, "Work of the damping forces [J], <= 0."))
        ((Real, dragWork, 0., Attr::readonly, "Work of the air drag [J], <= 0."))
        ((Real, drivenWork, 0., Attr::readonly, "Work that driven nodes do on the membrane [J]: the spool through the tethers' ends."))
        ((Real, contactWork, 0., Attr::readonly, "Work of all other forces on free nodes [J]: contact of the tethers with the spool."))
        ((Real, contactGain, 0., Attr::readonly, "Energy [J] that the nodes' contacts gave to both bodies beyond what they had taken from them and may still have stored: "
            "falls with friction, and rises only where contacts are too stiff for the time step, or were made overlapping."))
        ((Real, contactTaken, 0., Attr::readonly, "Energy [J] that contacts had taken at most, each by itself."))
        ((Real, kinkError, 0., Attr::readonly, "Energy [J] that sides gained beyond the work of their mean forces, where they buckled or became taut within a step: the integrator's error."))
        ((Real, angularMomentum, 0., Attr::readonly, "Angular momentum of the free nodes and of a free hub about z [N m s]."))
        ((Real, angularImpulse, 0., Attr::readonly, "Integral of the torque about z of all forces on the free nodes and on a free hub [N m s]."))
        ((Real, initialAngularMomentum, 0., Attr::readonly, "Angular momentum about z at the first step [N m s]."))
        ((int, period, 1, Attr::triggerPostLoad, "Steps between two times at which all values are brought up to date, > 0; also done in the first step, when O.dt changes, while the works of a "
            "single step are more than a thousandth of the energies, and at the end of a run. "
            "What a MembraneIntegrator has to add up, is added up in every step. With interactions every step is brought up to date."))
        ((vector<string>, furtherNames, , (Attr::readonly | Attr::hidden), "The kinds of further forces, see :yref:`MembraneForce`, that have done work."))
        ((vector<Real>, furtherWorks, , (Attr::readonly | Attr::hidden), "The work of each [J]."))
        ((vector<Real>, doneWorks, , (Attr::readonly | Attr::hidden), "Works [J] of crease, damping, drag, driven nodes, others, angular impulse [N m s], and works of further forces, up to half a step after the last one."))
        ((Real, doneKinks, 0., (Attr::readonly | Attr::hidden), "kinkError up to the last step [J]."))
        ((bool, restless, false, (Attr::readonly | Attr::hidden), "The last step's works were large: a watch must not miss what comes."))
        ((Real, countedStep, 0., (Attr::readonly | Attr::hidden), "O.dt of the last step [s]."))
        ((Real, savedCrease, 0., (Attr::readonly | Attr::hidden), "crease as of the last save [J]."))
        ((vector<Vector2i>, contactPairs, , (Attr::readonly | Attr::hidden), "Node and other body of the contacts of the last step, in order."))
        ((vector<Real>, contactWorks, , (Attr::readonly | Attr::hidden), "Work of each on both bodies since it began [J], up to half a step after the last one."))
        ((Real, contactEnded, 0., (Attr::readonly | Attr::hidden), "Sum of the works of contacts that are over [J]."))
        ((vector<Real>, contactMost, , (Attr::readonly | Attr::hidden), "What each has taken at most [J]."))
        ((vector<Real>, lastLengths, , (Attr::readonly | Attr::hidden), "Lengths of the sides [m] in the last step, as of the last save."))
        ,
        ,
        .add_property("crease", &Guarded<&MembraneLedger::crease>::call, "Energy stored in the creases [J]; with the law 'paper' and unequal heights only nearly minus creaseWork.")
        .add_property("creaseDefect", &Guarded<&MembraneLedger::creaseDefect>::call, "crease - initialCrease + creaseWork [J]: what creases gave beyond their energy. "
            "The law 'paper' gives and takes where heights are unequal; an angle that jumps through its branch cut does too.")
        .def("workOf", &Guarded<&MembraneLedger::workOf>::call, (boost::python::arg("channel")), "Work [J] of the forces of one kind: 'crease', 'damping', 'drag', or that of a :yref:`MembraneForce`; 0 if there were none.")
        .add_property("total", &MembraneLedger::total, "kinetic + elastic + potential [J].")
        .add_property("balance", &Guarded<&MembraneLedger::balance>::call, "total - initial - all works [J]: 0 but for the error of the time step.")
        .add_property("unexplained", &Guarded<&MembraneLedger::unexplained>::call, "balance - kinkError [J]: the rest of the time step's error, and of the book-keeping.")
    );
    // clang-format on

private:
    long upToDate_ = -1; ///< step to which all values belong

    struct Tally;
    const FreeHub* hubOfThisStep() const;
    std::size_t entryOf(const ::membrane::Sweep& sweep, int channel);
    void countNodes(Tally& tally, const FreeHub* hub, const std::size_t* entry) const;
    static void countHub(Tally& tally, const FreeHub& hub);
    void bookContacts();
    void bookWorks(const Tally& tally);
    void bringUpToDate(const Tally& tally);
};
REGISTER_SERIALIZABLE(MembraneLedger);

} // namespace yade

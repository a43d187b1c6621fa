// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "MembraneLedger.hpp"
#include <core/GlobalEngine.hpp>

namespace yade {

class MembraneWatch : public GlobalEngine {
public:
    void action() override;
    void postLoad(MembraneWatch&);
    Real restore();

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneWatch, GlobalEngine,
        "Stops a run that goes wrong. A time step too long, for the mesh or for sides that snap between taut and buckled, shows as energy "
        "from nowhere long before numbers overflow, and may never overflow at all. Whenever the ledger is up to date the watch looks at what sides, damping, drag and contacts have "
        "given since their lowest, and in every `period` steps also at the creases; where that is more than `tolerance` of all energy it raises "
        "RuntimeError, with the part, the side or crease and the node to blame. :yref:`restore` then brings back the last good state. "
        "A saved watch goes on as if it had never stopped. Put it after :yref:`MembraneLedger`; it rests while that is dead. Nodes that are given other velocities by hand are energy from nowhere, too: "
        "then start a new ledger and watch.",
        ((shared_ptr<MembraneLedger>, ledger, , Attr::triggerPostLoad, "The ledger that is watched."))
        ((Real, tolerance, 0.1, Attr::triggerPostLoad, "Energy from nowhere that stops the run, over all energy: the largest of kinetic, strain and crease energy so far, and what was lost by damping and drag [-], > 0."))
        ((int, period, 100, Attr::triggerPostLoad, "Steps between two states that are kept to be restored, and between two looks at the creases, > 0."))
        ((vector<Real>, lowest, , (Attr::readonly | Attr::hidden), "Lowest yet of what sides, creases, damping, drag, contacts and further forces gave [J]."))
        ((Real, peak, 0., (Attr::readonly | Attr::hidden), "Largest kinetic, strain and crease energy yet [J]."))
        ((long, looked, -1, (Attr::readonly | Attr::hidden), "Step of the last look at the creases; -1: none yet."))
        ((vector<Real>, newerBodies, , (Attr::readonly | Attr::hidden), "The state kept last: id, pos, vel, angVel and ori of every body in turn."))
        ((vector<Real>, olderBodies, , (Attr::readonly | Attr::hidden), "The state kept before that."))
        ((vector<Real>, newerHub, , (Attr::readonly | Attr::hidden), "Angle [rad] and spin [rad/s] of its FreeHub, if any."))
        ((vector<Real>, olderHub, , (Attr::readonly | Attr::hidden), "The same of the state kept before."))
        ((shared_ptr<MembraneLedger>, newerLedger, , (Attr::readonly | Attr::hidden), "Its ledger, without forces."))
        ((shared_ptr<MembraneLedger>, olderLedger, , (Attr::readonly | Attr::hidden), "Its ledger, without forces."))
        ((Real, newerTime, 0., (Attr::readonly | Attr::hidden), "Its time [s]."))
        ((Real, olderTime, 0., (Attr::readonly | Attr::hidden), "Its time [s]."))
        ,
        ,
        .def("restore", &Guarded<&MembraneWatch::restore>::call, "Put all bodies and the ledger back to the last good state, at most 2 `period` steps before the last step "
            "unless energy had been growing for longer; returns its time [s]. Interactions other than the membrane's are not put back.\n\n"
            ":raises RuntimeError: if no state was kept yet")
    );
    // clang-format on

private:
    Real floor_ = 0.; ///< energy [J] that counts as none

    struct Part;
    vector<Part> parts(bool look) const;
    void keep();
    Real allEnergy() const;
    std::string worstPlace(const Part& part) const;
    [[noreturn]] void stop(const Part& part, Real gain, Real all) const;
};
REGISTER_SERIALIZABLE(MembraneWatch);

} // namespace yade

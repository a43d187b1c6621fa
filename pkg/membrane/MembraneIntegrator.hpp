// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "MembraneForceEngine.hpp"

namespace yade {

class MembraneIntegrator : public MembraneForceEngine {
public:
    ~MembraneIntegrator() override {}
    void postLoad(MembraneIntegrator&);
    void preSave(MembraneForceEngine&) override;
    void action() override;

    Vector3r positionSeen(int node) const override;
    Vector3r velocitySeen(int node) const override;
    const vector<int>& nodesOfYade() const override { return shared_; }
    std::pair<Real, Real> powerFromOutside() const override;
    void writeBack() override;
    void forgetVelocities() override { forget_ = true; }
    vector<Vector3r> nodeForces() override;

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneIntegrator, MembraneForceEngine,
        "All forces of a :yref:`Membrane` and the leapfrog of its nodes in one pass over arrays of its own: the same physics as interactions, "
        ":yref:`MembraneForceEngine` and :yref:`NewtonIntegrator` together, several times faster. The membrane needs no interactions.\n\n"
        "Nodes that can touch something or are driven (bounded bodies, and those with a blocked translation) stay with NewtonIntegrator: in every step "
        "their places are read and their forces handed over. All others are moved here; their bodies get the mask `nodeMask`, which NewtonIntegrator's "
        "mask must not contain. Forces that other engines put on them are taken from O.forces in every step. Their bodies are brought up to date "
        "every `exchangePeriod` steps, at the end of a run (O.run with a number of steps or O.stopAtTime, O.step) and before a save; where they were changed by hand since, "
        "the change is taken over at the beginning of the next run. Put it after InteractionLoop and before NewtonIntegrator.",
        ((Vector3r, gravity, Vector3r::Zero(), , "Gravity [m/s²]; the same as NewtonIntegrator's."))
        ((Real, damping, 0., Attr::triggerPostLoad, "Local damping as NewtonIntegrator's [-], in [0, 1); only to find an equilibrium."))
        ((int, exchangePeriod, 1, Attr::triggerPostLoad, "Steps between two updates of the bodies of nodes that touch nothing, > 0. Engines and scripts that look at those "
            "bodies in the middle of a run see them up to so many steps old (:yref:`writeBack<MembraneForceEngine.writeBack>` brings them up to date)."))
        ((int, nodeMask, (1 << 29), Attr::readonly, "Mask of the bodies that this engine moves: a bit that no other body has."))
        ((bool, moveNodes, true, , "False: only compute the forces."))
        ((vector<Vector3r>, centredVelocities, , (Attr::readonly | Attr::hidden), "Velocities [m/s] at the time of the positions, as of the last save."))
        ((Real, movedStep, 0., (Attr::readonly | Attr::hidden), "O.dt of the last step [s]."))
        ,
        ,
    );
    // clang-format on

protected:
    void prepare(Scene& now) override;
    void arrange() override;
    void gather() override;
    void computeForces() override;

private:
    vector<shared_ptr<Body>> bodies_;
    vector<int> owned_, shared_;  ///< nodes moved here and by NewtonIntegrator
    vector<Vector3r> sharedSeenPositions_, sharedSeenVelocities_; ///< of the shared nodes, in the step before
    const Scene* scene_ = nullptr; ///< whose nodes the arrays hold
    bool bodiesCurrent_ = true;    ///< the bodies hold what the arrays hold, but for changes by hand
    bool forget_ = false;
    bool integratorChecked_ = false;
    int sinceExchange_ = 0;
    unsigned long syncs_ = 0; ///< how often the scene's forces had been summed, or will have been, since the last step

    bool belongsHere(int node) const;
    void checkIntegrator() const;
    void readBodies();
    void readShared();
    void takeForces();
    bool exchangeIsDue();
};
REGISTER_SERIALIZABLE(MembraneIntegrator);

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "MembraneForceEngine.hpp"
#include <atomic>
#include <pkg/dem/NewtonIntegrator.hpp>

namespace yade {

class CentrifugalField;

class MembraneIntegrator : public MembraneForceEngine {
public:
    ~MembraneIntegrator() override {}
    void postLoad(MembraneIntegrator&);

    Vector3r positionSeen(int node) const override;
    Vector3r velocitySeen(int node) const override;
    const vector<int>& nodesLeft() const override { return shared_; }
    Vector3r totalForce(int node) const override;
    std::pair<Real, Real> powerFromOutside() const override;
    void writeBack() override;
    void forgetVelocities() override { forget_ = true; }
    vector<Vector3r> nodeForces() override;
    bool takesField(const Scene& in) const override;

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneIntegrator, MembraneForceEngine,
        "All forces of a :yref:`Membrane` and the leapfrog of its nodes in one pass over arrays of its own: the same physics as interactions, "
        ":yref:`MembraneForceEngine` and :yref:`NewtonIntegrator` together, several times faster. The membrane needs no interactions.\n\n"
        "Gravity and local damping are those of the scene's NewtonIntegrator, which may be dead; its mask must not contain `nodeMask`, the mask that bodies of "
        "nodes get here. Nodes that can touch something or are driven (bounded bodies, and those with a blocked translation) are exchanged in every step: "
        "NewtonIntegrator moves them, unless it is dead; then they move here too. Forces that other engines put on nodes are taken from O.forces; a "
        ":yref:`CentrifugalField` is added here. "
        "The other nodes' bodies are brought up to date "
        "every `exchangePeriod` steps, at the end of a run (O.run with a number of steps or O.stopAtTime, O.step) and before a save; where they were changed by hand since, "
        "the change is taken over at the beginning of the next run. After O.pause with an exchangePeriod above 1, call writeBack before looking or changing. "
        "Put it after InteractionLoop and all engines that add forces, and before NewtonIntegrator.",
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
    void forget() override;
    void gather() override;
    void computeForces() override;
    void fetch() override;
    bool takesInteractions() const override { return false; }
    ::membrane::Points presentPositions(const Scene& now) const override;

private:
    vector<int> owned_, shared_; ///< nodes in the sweep, and those exchanged in every step
    vector<Vector3r> sharedSeenPositions_, sharedSeenVelocities_; ///< of the shared nodes, in the step before
    SceneMark held_;                                              ///< whose nodes the arrays hold
    shared_ptr<Membrane> heldMembrane_;
    /// The bodies hold what the arrays hold, but for changes by hand; a thread that draws asks, too.
    std::atomic<bool> bodiesCurrent_{true};
    bool forget_ = false;
    bool moved_ = false;                 ///< whether the last step did
    NewtonIntegrator* newton_ = nullptr; ///< of the scene, only to be used within a step
    bool sharedMoveHere_ = true;         ///< whether the shared nodes move here, too
    Real centrifugal_ = 0.;              ///< omega² [1/s²] of the scene's CentrifugalField, in this step
    vector<Vector3r> outsideShared_;     ///< forces [N] from outside on the shared nodes, if they move here
    int sinceExchange_ = 0;
    std::size_t othersAmong_ = 0; ///< so many bodies, when those that a dead NewtonIntegrator leaves were looked for
    unsigned long syncs_ = 0; ///< how often the scene's forces had been summed, or will have been, since the last step

    bool belongsHere(int node) const;
    bool holds(const Scene& in) const;
    int wantedParts() const;
    void chooseEngines();
    void checkOthers();
    bool movesShared() const { return sharedMoveHere_; }
    void moveShared();
    Vector3r fieldForce(int node) const;
    void tellCollider() const;
    void readBodies();
    void readShared();
    void takeForces();
};
REGISTER_SERIALIZABLE(MembraneIntegrator);

} // namespace yade

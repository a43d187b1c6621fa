// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <core/Scene.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>
#include <typeinfo>

namespace yade {

class CentrifugalField;
class FreeHub;
class Membrane;
class MembraneForce;
class MembraneForceEngine;
class MembraneLedger;

/// The engines beside one of a membrane's forces: which belong to it, and whether they can stand together. Looks
/// through O.engines only when they are others than before, since that takes longer than many a force.
class Surroundings {
public:
    /// Those that live and belong to an engine of forces; none: null.
    MembraneLedger* ledger(const MembraneForceEngine& forces, const Scene& scene);
    FreeHub* hub(const MembraneForceEngine& forces, const Scene& scene);
    /// Further forces on a membrane, in their order.
    vector<shared_ptr<MembraneForce>> furtherForces(const Membrane& membrane, const Scene& scene);
    CentrifugalField* field(const Membrane& membrane, const Scene& scene);
    /// The first that lives, else the last one: its gravity and damping count all the same.
    NewtonIntegrator* newton(const Scene& scene);

    /// Whether an engine lives that computes interactions.
    bool computesInteractions(const Scene& scene);
    /// Whether a living NewtonIntegrator moves one of these bodies.
    bool moves(const Scene& scene, const vector<const Body*>& bodies);
    /// \param sides whether the membrane's sides are interactions;  \param left nodes that a NewtonIntegrator may move
    /// \throws std::runtime_error naming what would be computed twice, or too late
    void check(const MembraneForceEngine& forces, const Scene& scene, bool sides, const vector<const Body*>& left);

private:
    template <class Kind> struct Placed {
        Kind* engine;
        std::size_t place; ///< in O.engines
    };
    template <class Kind> using List = vector<Placed<Kind>>;
    struct Known {
        const Engine* engine;
        const std::type_info* type;
    };

    vector<Known> known_;
    List<MembraneForceEngine> forces_;
    List<MembraneLedger> ledgers_;
    List<FreeHub> hubs_;
    List<CentrifugalField> fields_;
    List<MembraneForce> further_;
    List<NewtonIntegrator> newtons_;
    List<Engine> loops_;    ///< InteractionLoops and LawDispatchers
    List<Engine> repeated_; ///< of those above, and of others that must not act twice, what stands there once more

    void look(const Scene& scene);
    void sort(Engine& engine, std::size_t place);
};

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#include "Surroundings.hpp"
#include "CentrifugalField.hpp"
#include "FreeHub.hpp"
#include "MembraneForce.hpp"
#include "MembraneLedger.hpp"
#include "MembraneWatch.hpp"
#include "SpoolRotation.hpp"
#include <algorithm>

namespace yade {

namespace {

[[noreturn]] void refuse(const MembraneForceEngine& forces, const string& what) {
    throw std::runtime_error(forces.getClassName() + ": " + what);
}

/// The only one of a list that lives and fits, or none; refuses two, which would both do what `does` says.
template <class List, class Fits>
auto onlyOne(const List& list, const MembraneForceEngine& forces, const char* does, Fits fits) {
    decltype(list.front().engine) found = nullptr;
    for (const auto& one : list) {
        if (one.engine->dead || !fits(*one.engine) || found == one.engine) continue;
        if (found)
            refuse(forces, "two engines in O.engines, a " + found->getClassName() + " and a " +
                               one.engine->getClassName() + ", " + does + "; one must go or be dead");
        found = one.engine;
    }
    return found;
}

bool movesIt(const NewtonIntegrator& newton, const Body& body) {
    return !newton.dead && (newton.mask <= 0 || (newton.mask & body.groupMask));
}

bool movesAny(const NewtonIntegrator& newton, const vector<const Body*>& bodies) {
    return std::any_of(bodies.begin(), bodies.end(), [&](const Body* body) { return movesIt(newton, *body); });
}

bool mustNotRepeat(const Engine& engine) {
    return dynamic_cast<const MembraneWatch*>(&engine) || dynamic_cast<const SpoolRotation*>(&engine);
}

} // namespace

void Surroundings::look(const Scene& scene) {
    // By type, too: another engine may lie where one lay before.
    const auto isSame = [](const Known& one, const shared_ptr<Engine>& engine) {
        return one.engine == engine.get() && *one.type == typeid(*engine.get());
    };
    if (std::equal(known_.begin(), known_.end(), scene.engines.begin(), scene.engines.end(), isSame)) return;
    *this = Surroundings();
    for (std::size_t place = 0; place < scene.engines.size(); ++place) {
        Engine& engine = *scene.engines[place];
        sort(engine, place);
        known_.push_back({&engine, &typeid(engine)});
    }
}

void Surroundings::sort(Engine& engine, std::size_t place) {
    const auto take = [&](auto& list, auto* as) {
        if (as) list.push_back({as, place});
        return as != nullptr;
    };
    const string name = engine.getClassName();
    const bool counts =
        take(forces_, dynamic_cast<MembraneForceEngine*>(&engine)) ||
        take(ledgers_, dynamic_cast<MembraneLedger*>(&engine)) || take(hubs_, dynamic_cast<FreeHub*>(&engine)) ||
        take(fields_, dynamic_cast<CentrifugalField*>(&engine)) ||
        take(further_, dynamic_cast<MembraneForce*>(&engine)) ||
        take(newtons_, dynamic_cast<NewtonIntegrator*>(&engine)) ||
        take(loops_, name == "InteractionLoop" || name == "LawDispatcher" ? &engine : nullptr) || mustNotRepeat(engine);
    const auto isIt = [&engine](const Known& one) { return one.engine == &engine; };
    if (counts && std::any_of(known_.begin(), known_.end(), isIt)) repeated_.push_back({&engine, place});
}

MembraneLedger* Surroundings::ledger(const MembraneForceEngine& forces, const Scene& scene) {
    look(scene);
    return onlyOne(ledgers_, forces, "count its energies",
                   [&](const MembraneLedger& one) { return one.forces.get() == &forces; });
}

FreeHub* Surroundings::hub(const MembraneForceEngine& forces, const Scene& scene) {
    look(scene);
    return onlyOne(hubs_, forces, "turn with its torque",
                   [&](const FreeHub& one) { return one.forces.get() == &forces; });
}

CentrifugalField* Surroundings::field(const Membrane& membrane, const Scene& scene) {
    look(scene);
    for (const auto& one : fields_)
        if (!one.engine->dead && one.engine->membrane.get() == &membrane) return one.engine;
    return nullptr;
}

vector<shared_ptr<MembraneForce>> Surroundings::furtherForces(const Membrane& membrane, const Scene& scene) {
    look(scene);
    vector<shared_ptr<MembraneForce>> all;
    for (const auto& one : further_)
        if (!one.engine->dead && one.engine->membrane.get() == &membrane)
            all.push_back(boost::static_pointer_cast<MembraneForce>(scene.engines[one.place]));
    return all;
}

NewtonIntegrator* Surroundings::newton(const Scene& scene) {
    look(scene);
    if (newtons_.empty()) return nullptr;
    const auto lives = [](const auto& one) { return !one.engine->dead; };
    const auto first = std::find_if(newtons_.begin(), newtons_.end(), lives);
    return first == newtons_.end() ? newtons_.back().engine : first->engine;
}

bool Surroundings::computesInteractions(const Scene& scene) {
    look(scene);
    return std::any_of(loops_.begin(), loops_.end(), [](const auto& loop) { return !loop.engine->dead; });
}

bool Surroundings::moves(const Scene& scene, const vector<const Body*>& bodies) {
    look(scene);
    return std::any_of(newtons_.begin(), newtons_.end(),
                       [&](const auto& one) { return movesAny(*one.engine, bodies); });
}

void Surroundings::check(const MembraneForceEngine& forces, const Scene& scene, bool sides,
                         const vector<const Body*>& left) {
    ledger(forces, scene);
    hub(forces, scene);
    for (const auto& one : repeated_)
        if (!one.engine->dead) refuse(forces, "a " + one.engine->getClassName() + " is in O.engines twice");
    const auto ofMembrane = [&](const auto& one) { return one.membrane == forces.membrane; };
    onlyOne(forces_, forces, "compute the forces of one membrane", ofMembrane);
    onlyOne(fields_, forces, "are the field of one membrane", ofMembrane);

    const auto mine =
        std::find_if(forces_.begin(), forces_.end(), [&](const auto& one) { return one.engine == &forces; });
    if (mine == forces_.end()) return; // called from outside of O.engines
    const auto lives = [](const auto& one) { return !one.engine->dead; };
    if (sides) {
        if (std::count_if(loops_.begin(), loops_.end(), lives) > 1)
            refuse(forces,
                   "two engines in O.engines compute interactions, so that all forces would be doubled; one must go");
        for (const auto& loop : loops_)
            if (lives(loop) && loop.place > mine->place)
                refuse(forces, "InteractionLoop must come before it in O.engines");
    }
    List<NewtonIntegrator> moving;
    for (const auto& one : newtons_)
        if (movesAny(*one.engine, left)) moving.push_back(one);
    for (const auto& one : moving)
        if (one.place < mine->place) refuse(forces, "NewtonIntegrator must come after it in O.engines");
    if (moving.size() < 2) return;
    for (const Body* body : left)
        if (std::count_if(moving.begin(), moving.end(), [&](const auto& one) { return movesIt(*one.engine, *body); }) >
            1)
            refuse(forces,
                   "two NewtonIntegrators in O.engines would move its nodes twice; one must go, or have another mask");
}

} // namespace yade

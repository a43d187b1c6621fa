// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneForceEngine.hpp"
#include "Buffers.hpp"
#include "Faults.hpp"
#include "FreeHub.hpp"
#include "MembraneLedger.hpp"
#include "TimeStepState.hpp"
#include "mechanics/CriticalTimeStep.hpp"
#include "mechanics/Damping.hpp"
#include <cmath>
#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include <lib/high-precision/Constants.hpp>
#include <numeric>
#include <sstream>
#include <typeinfo>

namespace yade {

YADE_PLUGIN((MembraneForceEngine));

namespace {

template <class Value> [[noreturn]] void refuse(const char* field, const Value& value, const char* range) {
    std::ostringstream message;
    message << "MembraneForceEngine: " << field << " = " << value << " must be " << range;
    throw std::invalid_argument(message.str());
}

void requireNotNegative(const char* field, Real value) {
    if (!(value >= 0.) || !std::isfinite(value)) refuse(field, value, "finite and >= 0");
}

} // namespace

bool isHeld(const State& state) {
    return (state.blockedDOFs & State::DOF_XYZ) == State::DOF_XYZ;
}

Vector3r centredVelocity(const State& state, const Vector3r& seenPosition, const Vector3r& seenVelocity, Real dt) {
    const auto cameAt = [&](const Vector3r& velocity) {
        const Real rounding = 1e-15 * state.pos.norm(), moved = dt * velocity.norm();
        return (state.pos - seenPosition - dt * velocity).norm() <= 1e-9 * moved + rounding;
    };
    // A node has come here at its present velocity, unless it is driven and has got its next already.
    if (cameAt(state.vel)) return 1.5 * state.vel - 0.5 * seenVelocity;
    if (isHeld(state) && cameAt(seenVelocity)) return 0.5 * state.vel + 0.5 * seenVelocity;
    // Someone has put it elsewhere, given it another velocity or changed the step.
    return state.vel;
}

void MembraneForceEngine::postLoad(MembraneForceEngine&) {
    requireNotNegative("beta", beta);
    requireNotNegative("gamma", gamma);
    requireNotNegative("zeta", zeta);
    requireNotNegative("airDensity", airDensity);
    if (!(theta0 >= 0. && theta0 <= Mathr::PI)) refuse("theta0", theta0, "in [0, pi]");
    if (creaseLaw != "paper" && creaseLaw != "conservative")
        refuse("creaseLaw", creaseLaw, "'paper' or 'conservative'");
    if (timeStepCheckPeriod <= 0) refuse("timeStepCheckPeriod", timeStepCheckPeriod, "> 0");
    preparedFor_ = nullptr;
}

::membrane::CreaseLaw MembraneForceEngine::law() const {
    const Real h = membrane->material ? membrane->material->thickness : 0.;
    ::membrane::CreaseLaw law;
    law.bending = membrane->material ? beta * membrane->material->young * h * h * h / 12. : 0.;
    law.penalty = gamma;
    law.naturalAngle = theta0;
    law.conservative = creaseLaw == "conservative";
    return law;
}

void MembraneForceEngine::action() {
    const auto guarded = guard_.step();
    faults::raise(scene);
    if (preparedFor_ != scene) {
        prepare(*scene);
        checkedStep_ = -1.;
        preparedFor_ = scene;
    }
    gather();
    if (scene->dt != checkedStep_ || scene->iter % timeStepCheckPeriod == 0) checkTimeStep();
    computeForces();
    lastStep_ = scene->iter;
}

void MembraneForceEngine::prepare(Scene& now) {
    if (!membrane) throw std::runtime_error("MembraneForceEngine: membrane is not set");
    states_ = membrane->states(now);
    membrane->checkUnchanged();
    allNodes_.resize(states_.size());
    std::iota(allNodes_.begin(), allNodes_.end(), 0);
    for (const int i : allNodes_)
        if (!(states_[i]->mass > 0.) || !std::isfinite(states_[i]->mass))
            throw std::runtime_error("Membrane: the mass " + std::to_string(states_[i]->mass) + " kg of body #" +
                                     std::to_string(membrane->bodyIds[i]) + " must be finite and > 0");
    arrange();
}

void MembraneForceEngine::prepareSweep(const vector<char>& owned, int parts) {
    vector<Real> masses;
    masses.reserve(states_.size());
    for (const auto& state : states_) masses.push_back(state->mass);
    ::membrane::Laws laws;
    laws.crease = law();
    laws.airDensity = airDensity;
    laws.damping = dampingCoefficients();
    const vector<Real> lengths = sweep_.lengths();
    sweep_.prepare(membrane->rest(), membrane->triangles, laws, masses, owned, parts);
    if (lengths.size() == membrane->rest().sides.size()) sweep_.setLengths(lengths);
}

vector<Real> MembraneForceEngine::dampingCoefficients() const {
    vector<Real> c;
    if (!(zeta > 0.)) return c;
    c.reserve(membrane->rest().sides.size());
    for (const ::membrane::Side& s : membrane->rest().sides)
        c.push_back(::membrane::dampingCoefficient(zeta, s.stiffness, 0.5 * (states_[s.a]->mass + states_[s.b]->mass)));
    return c;
}

void MembraneForceEngine::gather() {
    const bool seen = seenPositions.size() == states_.size() && seenVelocities.size() == states_.size();
    seenPositions.resize(states_.size());
    seenVelocities.resize(states_.size());
    Real probe = 0.; // 0 times anything finite; NaN otherwise
    for (const int i : allNodes_) {
        const State& state = *states_[i];
        sweep_.x.set(i, state.pos);
        sweep_.v.set(i, state.vel);
        sweep_.u.set(i, seen ? centredVelocity(state, seenPositions[i], seenVelocities[i], scene->dt) : state.vel);
        seenPositions[i] = state.pos;
        seenVelocities[i] = state.vel;
        probe += 0. * (state.pos.sum() + state.vel.sum());
    }
    if (!(probe == 0.)) stopDiverged();
}

void MembraneForceEngine::stopDiverged() const {
    std::size_t lost = 0;
    while (lost + 1 < states_.size() && sweep_.x.at(lost).allFinite() && sweep_.v.at(lost).allFinite()) ++lost;
    throw std::runtime_error("Membrane: the run diverged at t = " + std::to_string(scene->time) + " s: node " +
                             std::to_string(lost) + " (body #" + std::to_string(membrane->bodyIds[lost]) +
                             ") has a position or velocity that is not finite");
}

void MembraneForceEngine::findEngines(const Scene& in) const {
    ledgers_.clear();
    hubs_.clear();
    for (const auto& engine : in.engines)
        if (auto* const ledger = dynamic_cast<MembraneLedger*>(engine.get()))
            ledgers_.push_back(ledger);
        else if (auto* const hub = dynamic_cast<FreeHub*>(engine.get()))
            hubs_.push_back(hub);
}

void MembraneForceEngine::findEnginesIfOthers(const Scene& in) const {
    // By type, too: another engine may lie where one lay before.
    const auto known = [](const auto& one, const shared_ptr<Engine>& engine) {
        return one.first == engine.get() && one.second == &typeid(*engine);
    };
    if (std::equal(knownEngines_.begin(), knownEngines_.end(), in.engines.begin(), in.engines.end(), known)) return;
    findEngines(in);
    knownEngines_.clear();
    for (const auto& engine : in.engines) knownEngines_.emplace_back(engine.get(), &typeid(*engine));
}

MembraneLedger* MembraneForceEngine::ledger(const Scene& in) const {
    findEnginesIfOthers(in);
    for (MembraneLedger* const found : ledgers_)
        if (!found->dead && found->forces.get() == this) return found;
    return nullptr;
}

FreeHub* MembraneForceEngine::hub(const Scene& in) const {
    findEnginesIfOthers(in);
    for (FreeHub* const found : hubs_)
        if (!found->dead && found->forces.get() == this) return found;
    return nullptr;
}

void MembraneForceEngine::continueLedger(const MembraneLedger* of, ::membrane::Sums wanted) {
    if (of && of->started && !keepLengths_ && of->lastLengths.size() == membrane->rest().sides.size())
        sweep_.setLengths(of->lastLengths);
    keepLengths_ = of != nullptr;
    madeSums_ = wanted;
}

void MembraneForceEngine::computeForces() {
    const MembraneLedger* const counting = ledger(*scene);
    const ::membrane::Sums sums = counting ? ::membrane::Sums::energies : ::membrane::Sums::none;
    continueLedger(counting, sums);
    if (!counting && !(beta > 0. || zeta > 0. || airDensity > 0.)) return; // all forces were 0 from the start
    ::membrane::SweepStep step;
    step.dt = scene->dt;
    step.move = false;
    step.apart = true;
    step.elastic = counting;
    step.sums = sums;
    sweep_.step(step);
    for (const int i : allNodes_)
        scene->forces.addForce(membrane->bodyIds[i],
                               sweep_.creaseForce(i) + sweep_.dampingForce(i) + sweep_.dragForce(i));
}

TimeStepState MembraneForceEngine::timeStepState(const Scene& in) const {
    TimeStepState now(*membrane, states_, airDensity);
    if (const FreeHub* hub = this->hub(in)) hub->addTo(now.masses);
    return now;
}

void MembraneForceEngine::checkTimeStep() {
    if (!forceTimeStep) {
        writeBack();
        const TimeStepState now = timeStepState(*scene);
        const vector<Real> damping = dampingCoefficients();
        if (!::membrane::withinCriticalTimeStep({membrane->rest(), now.masses, now.positions, damping, now.drag, law()},
                                                scene->dt)) {
            std::ostringstream message;
            message << "MembraneForceEngine: O.dt = " << scene->dt << " s must be <= " << criticalTimeStep()
                    << " s, the critical time step; lower it, or set forceTimeStep=True";
            throw std::runtime_error(message.str());
        }
    }
    checkedStep_ = scene->dt;
}

void MembraneForceEngine::advance(long steps) {
    constexpr long between = 64; // looks for Ctrl-C
    if (Omega::instance().isRunning()) throw std::runtime_error("advance: the scene is running already");
    const shared_ptr<Scene> current = Omega::instance().getScene();
    for (long step = 0; step < steps; ++step) {
        current->moveToNextTimeStep();
        if (step % between == 0 && PyErr_CheckSignals() != 0) boost::python::throw_error_already_set();
    }
}

Vector3r MembraneForceEngine::totalForce(int node) const {
    return scene->forces.getForce(membrane->bodyIds[node]);
}

::membrane::Points MembraneForceEngine::positionsNow(Scene& now) const {
    const auto guarded = guard_.look();
    return presentPositions(now);
}

vector<Vector3r> MembraneForceEngine::lastPositions() const {
    vector<Vector3r> x;
    if (lastStep_ < 0) return x;
    x.reserve(states_.size());
    for (const int i : allNodes_) x.push_back(positionSeen(i));
    return x;
}

boost::python::object MembraneForceEngine::lastPositionsBytes() const {
    const vector<Vector3r> x = lastPositions();
    static_assert(sizeof(Vector3r) == 3 * sizeof(Real));
    return boost::python::object(boost::python::handle<>(
        PyBytes_FromStringAndSize(reinterpret_cast<const char*>(x.data()), x.size() * sizeof(Vector3r))));
}

vector<Vector3r> MembraneForceEngine::ofNodes(Vector3r (::membrane::Sweep::*force)(int) const) const {
    vector<Vector3r> forces;
    for (const int i : allNodes_) forces.push_back((sweep_.*force)(i));
    return forces;
}

vector<Vector3r> MembraneForceEngine::nodeForces() {
    const shared_ptr<Scene> current = Omega::instance().getScene();
    current->forces.sync();
    vector<Vector3r> forces;
    for (const int i : allNodes_) forces.push_back(current->forces.getForce(membrane->bodyIds[i]));
    return forces;
}

Real MembraneForceEngine::criticalTimeStep() {
    const shared_ptr<Scene> current = Omega::instance().getScene();
    writeBack();
    if (preparedFor_ != current.get()) {
        if (!membrane) throw std::runtime_error("MembraneForceEngine: membrane is not set");
        states_ = membrane->states(*current);
        membrane->checkUnchanged();
    }
    const TimeStepState now = timeStepState(*current);
    const vector<Real> damping = dampingCoefficients();
    return ::membrane::criticalTimeStep({membrane->rest(), now.masses, now.positions, damping, now.drag, law()});
}

Real MembraneForceEngine::creaseEnergy(const ::membrane::Points& x) const {
    const ::membrane::CreaseLaw lawNow = law();
    Real energy = 0.;
    for (const ::membrane::Crease& c : membrane->rest().creases)
        energy += ::membrane::creaseEnergy(c.rest, lawNow,
                                           ::membrane::creaseState(c.rest, x[c.a], x[c.b], x[c.c], x[c.d]).theta);
    return energy;
}

Real MembraneForceEngine::creaseEnergyNow() {
    writeBack();
    if (!membrane) throw std::runtime_error("MembraneForceEngine: membrane is not set");
    return creaseEnergy(membrane->positions(*Omega::instance().getScene()));
}

vector<Real> MembraneForceEngine::creaseAngles(const boost::python::object& at) {
    writeBack();
    if (!membrane) throw std::runtime_error("MembraneForceEngine: membrane is not set");
    const ::membrane::Points x = membrane->positions(*Omega::instance().getScene(),
                                                     pointsFrom(at, "MembraneForceEngine.creaseAngles: positions"));
    vector<Real> angles;
    for (const ::membrane::Crease& c : membrane->rest().creases)
        angles.push_back(::membrane::creaseState(c.rest, x[c.a], x[c.b], x[c.c], x[c.d]).theta);
    return angles;
}

} // namespace yade

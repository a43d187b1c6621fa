// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneForceEngine.hpp"
#include "BodyAt.hpp"
#include "Buffers.hpp"
#include "Exactly.hpp"
#include "FreeHub.hpp"
#include "MembraneFault.hpp"
#include "MembraneForce.hpp"
#include "MembraneLedger.hpp"
#include "kernels/CreaseKernel.hpp"
#include "kernels/DragKernel.hpp"
#include "kernels/FilmKernel.hpp"
#include "kernels/SideKernel.hpp"
#include "mechanics/CriticalTimeStep.hpp"
#include "mechanics/Damping.hpp"
#include "mechanics/SideForce.hpp"
#include <cmath>
#include <core/InteractionContainer.hpp>
#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include <lib/high-precision/Constants.hpp>
#include <numeric>
#include <sstream>

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

/// Coefficients of the sides [N s/m], (9) with the masses of the nodes' bodies, or by a damping time [s]; empty
/// without.
vector<Real> dampingCoefficients(const Membrane& membrane, const vector<shared_ptr<Body>>& bodies, Real zeta,
                                 Real time) {
    vector<Real> c;
    if (!(zeta > 0. || time > 0.)) return c;
    c.reserve(membrane.rest().sides.size());
    for (const ::membrane::Side& s : membrane.rest().sides) {
        const Real mass = 0.5 * (bodies[s.a]->state->mass + bodies[s.b]->state->mass);
        c.push_back(time > 0. ? time * std::max(0., s.stiffness)
                              : ::membrane::dampingCoefficient(zeta, s.stiffness, mass));
    }
    return c;
}

} // namespace

bool allFinite(const vector<Vector3r>& all) {
    return std::all_of(all.begin(), all.end(), [](const Vector3r& one) { return one.allFinite(); });
}

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

MembraneForceEngine* MembraneForceEngine::of(const Membrane* membrane, const Scene& in) {
    for (const auto& engine : in.engines) {
        auto* const forces = dynamic_cast<MembraneForceEngine*>(engine.get());
        if (forces && !forces->dead && forces->membrane.get() == membrane) return forces;
    }
    return nullptr;
}

void MembraneForceEngine::postLoad(MembraneForceEngine&) {
    const StepGuard::Look look;
    requireNotNegative("beta", beta);
    requireNotNegative("gamma", gamma);
    requireNotNegative("creaseLength", creaseLength);
    requireNotNegative("zeta", zeta);
    requireNotNegative("dampingTime", dampingTime);
    requireNotNegative("airDensity", airDensity);
    if (!(theta0 >= 0. && theta0 <= Mathr::PI)) refuse("theta0", theta0, "in [0, pi]");
    if (creaseLaw != "paper" && creaseLaw != "conservative")
        refuse("creaseLaw", creaseLaw, "'paper' or 'conservative'");
    if (beta > 0. && creaseLength > 0.) refuse("beta", beta, "0 where creaseLength is given");
    if (zeta > 0. && dampingTime > 0.) refuse("zeta", zeta, "0 where dampingTime is given");
    if (timeStepCheckPeriod <= 0) refuse("timeStepCheckPeriod", timeStepCheckPeriod, "> 0");
    if (seenPositions.size() != seenVelocities.size())
        throw std::invalid_argument("MembraneForceEngine: seenPositions and seenVelocities must have the same length");
    if (!allFinite(seenPositions) || !allFinite(seenVelocities))
        throw std::invalid_argument("MembraneForceEngine: seenPositions and seenVelocities must be finite");
    preparedFor_.clear();
    if (membrane != preparedMembrane_) forget();
}

/// What was computed for another membrane.
void MembraneForceEngine::forget() {
    if (preparedMembrane_) forgetSeen(); // else they are those of a saved engine, which is to go on
    preparedMembrane_.reset();
    lastStep_ = -1;
    madeSums_ = ::membrane::Sums::none;
    bodies_.clear();
    states_.clear();
    allNodes_.clear();
    contacts_.clear();
    further_.clear();
    sweep_.dropForces();
    left_.clear();
    interacting_.clear();
}

void MembraneForceEngine::preSave(MembraneForceEngine&) {
    const StepGuard::Look look;
    StepGuard::holdForSave();
    fetch();
}

::membrane::CreaseLaw MembraneForceEngine::law() const {
    const Real h = membrane->material ? membrane->material->thickness : 0.;
    ::membrane::CreaseLaw law;
    law.bending = membrane->material ? beta * membrane->material->young * h * h * h / 12. : 0.;
    law.penalty = gamma;
    law.naturalAngle = theta0;
    law.conservative = creaseLaw == "conservative" || creaseLength > 0.;
    if (membrane->material && creaseLength > 0.)
        law.perLength = ::membrane::creaseStiffnessPerLength(membrane->material->young, membrane->material->poisson, h,
                                                             creaseLength);
    return law;
}

void MembraneForceEngine::action() {
    StepGuard::refuseCall(*this);
    const StepGuard::Step guarded;
    try {
        step();
    } catch (...) {
        writeBack();
        scene->forces.sync(); // else what was added so far would be added to the next step's, too
        throw;
    }
}

void MembraneForceEngine::step() {
    MembraneFault::raise(*scene);
    const bool known = isPreparedFor(*scene) && membrane && preparedVersion_ == membrane->version();
    if (!known || further_ != surroundings_.furtherForces(*membrane, *scene)) {
        checkKnown();
        try {
            prepare(*scene);
        } catch (...) {
            forget(); // half of it was done
            throw;
        }
        checkedStep_ = -1.;
        checkedContacts_ = 0.;
        preparedFor_.set(*scene);
        begunIn_.set(*scene);
        preparedMembrane_ = membrane;
        preparedVersion_ = membrane->version();
    }
    // A step that is refused must leave no trace: what is gathered counts as the step before.
    checkSurroundings();
    if (takesInteractions()) checkSides();
    findContacts();
    if (scene->dt != checkedStep_ || scene->iter % timeStepCheckPeriod == 0) checkTimeStep();
    gather();
    computeForces();
    lastStep_ = scene->iter;
}

/// What nodes must not become is refused also where other parameters let the engine begin anew.
void MembraneForceEngine::checkKnown() const {
    if (!membrane || preparedMembrane_ != membrane || preparedVersion_ != membrane->version() || !begunIn_.is(scene))
        return;
    for (const int i : allNodes_) checkNode(i);
}

void MembraneForceEngine::prepare(Scene& now) {
    given();
    if (now.isPeriodic) throw std::runtime_error("MembraneForceEngine: a membrane cannot be in a periodic scene");
    bodies_ = membrane->bodies(now);
    membrane->checkUnchanged();
    checkLaws();
    states_.clear();
    masses_.clear();
    for (const auto& body : bodies_) {
        states_.push_back(body->state);
        masses_.push_back(body->state->mass);
    }
    allNodes_.resize(states_.size());
    std::iota(allNodes_.begin(), allNodes_.end(), 0);
    for (const int i : allNodes_)
        if (!(masses_[i] > 0.) || !std::isfinite(masses_[i]))
            throw std::runtime_error("Membrane: the mass " + std::to_string(masses_[i]) + " kg of body #" +
                                     std::to_string(membrane->bodyIds[i]) + " must be finite and > 0");
    interacting_.clear();
    bodyCount_ = 0;
    arrange();
}

void MembraneForceEngine::checkLaws() const {
    if (membrane->rest().planeStress && zeta > 0.)
        refuse("zeta", zeta, "0 with a film of plane stress, which is damped by dampingTime");
}

void MembraneForceEngine::arrange() {
    prepareSweep(vector<char>(states_.size(), false), 1);
}

void MembraneForceEngine::checkNode(int node) const {
    const Body::id_t id = membrane->bodyIds[node];
    const auto& there = scene->bodies->body;
    const bool same = id >= 0 && static_cast<std::size_t>(id) < there.size() && there[id] == bodies_[node] &&
                      bodies_[node]->state == states_[node];
    if (same && states_[node]->mass == masses_[node]) return;
    const string which = "Membrane: body #" + std::to_string(id) + " of node " + std::to_string(node);
    if (!same) throw std::runtime_error(which + " was erased or replaced after its forces were first computed");
    std::ostringstream message;
    message << which << ": its mass was changed from " << masses_[node] << " to " << states_[node]->mass
            << " kg since its forces were first computed; give pointMasses to a new membrane, or set the engine's "
               "membrane to "
            << "None and back to go on with that mass";
    throw std::runtime_error(message.str());
}

void MembraneForceEngine::checkClumps() {
    const std::size_t count = scene->bodies->size();
    if (count == bodyCount_) return; // a clump comes with a body of its own
    for (const auto& body : bodies_)
        if (body->clumpId != Body::ID_NONE)
            throw std::runtime_error("Membrane: body #" + std::to_string(body->id) + " is a member of clump #" +
                                     std::to_string(body->clumpId) + ", which a node cannot be");
    bodyCount_ = count;
}

void MembraneForceEngine::prepareSweep(const vector<char>& owned, int parts) {
    left_.clear();
    for (const int i : allNodes_)
        if (!owned[i]) left_.push_back(bodies_[i].get());
    const vector<Real> memory = sweep_.memory();
    further_ = surroundings_.furtherForces(*membrane, *scene);
    sweep_.prepare(makeForces(bodies_, *scene), masses_, owned, parts);
    if (!memory.empty() && memory.size() == sweep_.memorySize()) sweep_.setMemory(memory);
}

/// All forces on the membrane: the one place that knows which there are.
::membrane::ElementForces MembraneForceEngine::makeForces(const vector<shared_ptr<Body>>& bodies,
                                                          const Scene& in) const {
    const ::membrane::RestState& rest = membrane->rest();
    const auto damping = dampingCoefficients(*membrane, bodies, zeta, dampingTime);
    ::membrane::ElementForces all{std::make_shared<::membrane::SideForces>(rest, damping)};
    if (rest.planeStress) // first, for there are most of them
        all.insert(all.begin(), std::make_shared<::membrane::FilmForce>(membrane->nodes, membrane->triangles,
                                                                        membrane->filmLaw(dampingTime)));
    if (law().isThere()) all.push_back(std::make_shared<::membrane::CreaseForce>(rest, law()));
    if (airDensity > 0.) all.push_back(std::make_shared<::membrane::DragForce>(membrane->triangles, airDensity));
    for (const auto& further : surroundings_.furtherForces(*membrane, in)) all.push_back(further->make());
    return all;
}

void MembraneForceEngine::gather() {
    const bool seen = seenPositions.size() == states_.size() && seenVelocities.size() == states_.size();
    seenPositions.resize(states_.size());
    seenVelocities.resize(states_.size());
    checkClumps();
    Real probe = 0.; // 0 times anything finite; NaN otherwise
    for (const int i : allNodes_) {
        checkNode(i);
        const State& state = *states_[i];
        sweep_.x.set(i, state.pos);
        sweep_.v.set(i, state.vel);
        sweep_.u.set(i, seen ? centredVelocity(state, seenPositions[i], seenVelocities[i], scene->dt) : state.vel);
        seenPositions[i] = state.pos;
        seenVelocities[i] = state.vel;
        probe += 0. * (state.pos.sum() + state.vel.sum());
    }
    if (!(probe == 0.)) {
        forgetSeen();
        stopDiverged();
    }
}

void MembraneForceEngine::stopDiverged() const {
    std::size_t lost = 0;
    while (lost + 1 < states_.size() && sweep_.x.at(lost).allFinite() && sweep_.v.at(lost).allFinite()) ++lost;
    throw std::runtime_error("Membrane: the run diverged at t = " + std::to_string(scene->time) + " s: node " +
                             std::to_string(lost) + " (body #" + std::to_string(membrane->bodyIds[lost]) +
                             ") has a position or velocity that is not finite");
}

void MembraneForceEngine::checkSurroundings() {
    surroundings_.check(*this, *scene, takesInteractions(), left_);
}

void MembraneForceEngine::checkSides() {
    const ::membrane::RestState& rest = membrane->rest();
    const auto computed = [&](const shared_ptr<MembranePhys>& phys) {
        if (!phys || phys->computed != scene->iter) return false;
        phys->checked = scene->iter;
        return true;
    };
    const auto all = [&] {
        return interacting_.size() == rest.sides.size() - rest.firstSpring() &&
               std::count_if(interacting_.begin(), interacting_.end(), computed) ==
                   static_cast<std::ptrdiff_t>(interacting_.size());
    };
    if (all()) return;
    findSides();
    if (all() || !surroundings_.moves(*scene, left_)) return;
    const auto lost = std::find_if_not(interacting_.begin(), interacting_.end(), computed);
    refuseSpring(lost - interacting_.begin());
}

/// Looks up what computes the sides: interactions may have been removed and added again.
void MembraneForceEngine::findSides() {
    interacting_.clear();
    const ::membrane::RestState& rest = membrane->rest();
    for (std::size_t i = rest.firstSpring(); i < rest.sides.size(); ++i) {
        const ::membrane::Side& side = rest.sides[i];
        const auto& link = scene->interactions->find(membrane->bodyIds[side.a], membrane->bodyIds[side.b]);
        MembranePhys* const phys = link ? exactly<MembranePhys>(link->phys) : nullptr;
        interacting_.push_back(phys ? boost::static_pointer_cast<MembranePhys>(link->phys)
                                    : shared_ptr<MembranePhys>());
    }
}

void MembraneForceEngine::refuseSpring(std::size_t number) const {
    const ::membrane::RestState& rest = membrane->rest();
    const ::membrane::Side& side = rest.sides[rest.firstSpring() + number];
    for (const int node : {side.a, side.b}) checkNode(node); // which may be why
    const string a = std::to_string(side.a), b = std::to_string(side.b);
    const string which = "Membrane: side " + a + "-" + b + " (bodies #" + std::to_string(membrane->bodyIds[side.a]) +
                         " and #" + std::to_string(membrane->bodyIds[side.b]) + ")";
    if (!interacting_[number])
        throw std::runtime_error(which + " has no interaction with a MembranePhys, so that nothing computes it; call "
                                         "addInteractions() of the membrane");
    throw std::runtime_error(which + " was not computed in this step: put an InteractionLoop with "
                                     "Ig2_MembraneNode_MembraneNode_MembraneGeom, "
                                     "Ip2_MembraneMat_MembraneMat_MembranePhys and "
                                     "Law2_MembraneGeom_MembranePhys_Buckling before the MembraneForceEngine");
}

/// The contacts of this step. Where they are stiffer than those with which O.dt was checked, it is checked again.
void MembraneForceEngine::findContacts() {
    contacts_.clear();
    if (scene->interactions->size() == interacting_.size()) return; // there are none but sides
    NodeInteractions found(*membrane, *scene);
    if (found.sides && !takesInteractions() && surroundings_.computesInteractions(*scene))
        throw std::runtime_error(getClassName() + ": the interactions of its membrane would pull a second time; call "
                                                  "removeInteractions() of the membrane");
    contacts_.swap(found.contacts);
    for (const NodeContact& contact : contacts_)
        if (membrane->nodeOf(contact.other) >= 0)
            throw std::runtime_error(getClassName() + ": bodies #" + std::to_string(membrane->bodyIds[contact.node]) +
                                     " and #" + std::to_string(contact.other) +
                                     ", nodes of one membrane, touch like grains; put "
                                     "Ig2_MembraneNode_MembraneNode_MembraneGeom() into InteractionLoop");
    if (contacts_.empty() || forceTimeStep) return;
    constexpr Real grown = 1.1;
    const Real fastest = ContactStiffness(contacts_, bodies_, *scene).fastest;
    if (fastest <= grown * checkedContacts_) return;
    checkTimeStep();
    checkedContacts_ = fastest;
}

void MembraneForceEngine::continueLedger(const MembraneLedger* of, ::membrane::Sums wanted) {
    if (of && of->started && !keepMemory_ && of->lastLengths.size() == sweep_.memorySize())
        sweep_.setMemory(of->lastLengths);
    keepMemory_ = of != nullptr;
    madeSums_ = wanted;
}

void MembraneForceEngine::computeForces() {
    const MembraneLedger* const counting = ledger(*scene);
    const ::membrane::Sums sums = counting ? ::membrane::Sums::energies : ::membrane::Sums::none;
    continueLedger(counting, sums);
    const bool onlySprings = sweep_.forces().size() == 1 && !(zeta > 0. || dampingTime > 0.);
    if (!counting && onlySprings) return; // which are interactions
    ::membrane::SweepStep step;
    step.dt = scene->dt;
    step.move = false;
    step.apart = true;
    const bool film = membrane->rest().planeStress; // is no interaction
    step.elastic = counting || film;
    step.sums = sums;
    sweep_.step(step);
    for (const int i : allNodes_) {
        Vector3r sum = sweep_.channelForce(0, i);
        for (std::size_t channel = 1; channel < sweep_.channels().size(); ++channel)
            sum += sweep_.channelForce(static_cast<int>(channel), i);
        scene->forces.addForce(membrane->bodyIds[i], sum);
    }
    if (film) addFilmForces();
}

/// Adds the elastic forces but those of the cables, which are interactions.
void MembraneForceEngine::addFilmForces() const {
    vector<Vector3r> elastic;
    for (const int i : allNodes_) elastic.push_back(sweep_.elasticForce(i));
    for (const ::membrane::Side& s : membrane->rest().sides) {
        if (!membrane->rest().isSpring(s)) continue;
        const Vector3r span = sweep_.x.at(s.b) - sweep_.x.at(s.a);
        const Real length = span.norm();
        if (!(length > s.restLength)) continue;
        const Vector3r pull = ::membrane::sideTension(length, s.stiffness, s.restLength, s.critical) / length * span;
        elastic[s.a] -= pull;
        elastic[s.b] += pull;
    }
    for (const int i : allNodes_) scene->forces.addForce(membrane->bodyIds[i], elastic[i]);
}

::membrane::LinearForces MembraneForceEngine::linearForces(const Scene& in, const vector<shared_ptr<Body>>& bodies,
                                                           const ContactStiffness& contacts) const {
    ::membrane::Points x, v;
    vector<Real> masses;
    for (const auto& body : bodies) {
        x.push_back(body->state->pos);
        v.push_back(body->state->vel);
        // A node held in some directions only counts as free: that bounds the step from below.
        masses.push_back(isHeld(*body->state) ? 0. : body->state->mass);
    }
    if (const FreeHub* hub = this->hub(in)) hub->addTo(masses);
    ::membrane::LinearForces all(masses);
    for (const auto& force : makeForces(bodies, in)) force->addTo(all, x, v);
    for (std::size_t i = 0; i < contacts.ground.size(); ++i) all.addGround(static_cast<int>(i), contacts.ground[i]);
    all.beside = contacts.fastest;
    return all;
}

void MembraneForceEngine::checkTimeStep() {
    checkedStep_ = scene->dt;
    if (forceTimeStep) return;
    writeBack();
    const auto isFinite = [](const shared_ptr<State>& state) { return state->pos.allFinite(); };
    if (!std::all_of(states_.begin(), states_.end(), isFinite)) return; // gather() tells
    const ContactStiffness contacts(contacts_, bodies_, *scene);
    const ::membrane::LinearForces all = linearForces(*scene, bodies_, contacts);
    if (::membrane::withinCriticalTimeStep(all, scene->dt)) return;
    checkedStep_ = -1.;
    std::ostringstream message;
    message << "MembraneForceEngine: O.dt = " << scene->dt << " s must be <= " << ::membrane::criticalTimeStep(all)
            << " s, the critical time step; lower it, or set forceTimeStep=True";
    if (contacts.node >= 0)
        message << " (" << ::membrane::criticalTimeStep(linearForces(*scene, bodies_, ContactStiffness()))
                << " s without contacts, of which that of bodies #" << membrane->bodyIds[contacts.node] << " and #"
                << contacts.other << " weighs most)";
    throw std::runtime_error(message.str());
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

::membrane::Points MembraneForceEngine::positionsNow(const Scene& now) const {
    const StepGuard::Look look(/*between*/ false);
    return presentPositions(now);
}

vector<Vector3r> MembraneForceEngine::lastPositions() const {
    vector<Vector3r> x;
    if (lastStep_ < 0) return x;
    x.reserve(states_.size());
    for (const int i : allNodes_) x.push_back(positionSeen(i));
    return x;
}

vector<Vector3r> MembraneForceEngine::lastVelocities() const {
    vector<Vector3r> v;
    for (const int i : allNodes_) v.push_back(velocitySeen(i));
    return v;
}

boost::python::object MembraneForceEngine::lastPositionsBytes() const {
    const vector<Vector3r> x = lastPositions();
    static_assert(sizeof(Vector3r) == 3 * sizeof(Real));
    return boost::python::object(boost::python::handle<>(PyBytes_FromStringAndSize(
        reinterpret_cast<const char*>(x.data()), static_cast<Py_ssize_t>(x.size() * sizeof(Vector3r)))));
}

vector<Vector3r> MembraneForceEngine::channelForces(int channel) const {
    vector<Vector3r> forces;
    for (const int i : allNodes_) forces.push_back(sweep_.channelForce(channel, i));
    return forces;
}

vector<Vector3r> MembraneForceEngine::forcesOf(const string& channel) const {
    const auto& names = sweep_.channels();
    const auto found = std::find(names.begin(), names.end(), channel);
    if (found == names.end())
        throw std::invalid_argument(getClassName() + ".forcesOf: channel = '" + channel +
                                    "' must be a kind of forces that was computed");
    return channelForces(static_cast<int>(found - names.begin()));
}

vector<Vector3r> MembraneForceEngine::nodeForces() {
    const shared_ptr<Scene> current = sceneAtRest();
    current->forces.sync();
    vector<Vector3r> forces;
    for (const int id : membrane->bodyIds) forces.push_back(current->forces.getForce(id));
    return forces;
}

Real MembraneForceEngine::criticalTimeStep() {
    const shared_ptr<Scene> current = Omega::instance().getScene();
    writeBack();
    given().checkUnchanged();
    const auto bodies = membrane->bodies(*current);
    const ContactStiffness contacts(NodeInteractions(*membrane, *current).contacts, bodies, *current);
    return ::membrane::criticalTimeStep(linearForces(*current, bodies, contacts));
}

Real MembraneForceEngine::creaseEnergy(const ::membrane::Points& x) const {
    if (!membrane || x.size() != membrane->nodes.size()) return 0.;
    return ::membrane::CreaseForce(membrane->rest(), law()).energy(x);
}

Real MembraneForceEngine::creaseEnergyNow() {
    writeBack();
    return creaseEnergy(given().positions(*Omega::instance().getScene()));
}

vector<Real> MembraneForceEngine::creaseAngles(const boost::python::object& at) {
    writeBack();
    const ::membrane::Points x =
        given().positions(*Omega::instance().getScene(), pointsFrom(at, "MembraneForceEngine.creaseAngles: positions"));
    vector<Real> angles;
    for (const ::membrane::Crease& c : membrane->rest().creases) angles.push_back(::membrane::creaseState(c, x).theta);
    return angles;
}

/// The scene, which must hold the nodes and not be running: forces that threads add to must not be summed.
shared_ptr<Scene> MembraneForceEngine::sceneAtRest() const {
    shared_ptr<Scene> current = Omega::instance().getScene();
    given().bodies(*current);
    if (StepGuard::othersRun())
        throw std::runtime_error(getClassName() + ": nodeForces: the scene is running; pause it");
    return current;
}

const Membrane& MembraneForceEngine::given() const {
    if (!membrane) throw std::runtime_error(getClassName() + ": membrane is not set");
    return *membrane;
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneForceEngine.hpp"
#include "Faults.hpp"
#include "mechanics/CriticalTimeStep.hpp"
#include "mechanics/Damping.hpp"
#include "mechanics/Drag.hpp"
#include "mechanics/SideForce.hpp"
#include <cmath>
#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include <lib/high-precision/Constants.hpp>
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

Real power(const ::membrane::Points& forces, const ::membrane::Points& velocities) {
    Real sum = 0.;
    for (std::size_t i = 0; i < forces.size(); ++i) sum += forces[i].dot(velocities[i]);
    return sum;
}

/// Whether a node cannot move but as it is driven.
bool held(const State& state) {
    return (state.blockedDOFs & State::DOF_XYZ) == State::DOF_XYZ;
}

/// Twice the area [m²] of a triangle times its unit normal.
Vector3r doubleArea(const ::membrane::Points& x, const Vector3i& t) {
    return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
}

} // namespace

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
    faults::raise(scene);
    if (preparedFor_ != scene) prepare(*scene);
    gather();
    centreVelocities();
    if (scene->dt != checkedStep_ || scene->iter % timeStepCheckPeriod == 0) checkTimeStep();
    lastStep_ = scene->iter;

    if (beta > 0.) addCreases();
    if (zeta > 0.) addDamping();
    if (airDensity > 0.) addDrag();
    if (beta > 0. || zeta > 0. || airDensity > 0.) scatter();
}

/// Looks up the bodies and computes what stays the same while it runs.
void MembraneForceEngine::prepare(Scene& now) {
    if (!membrane) throw std::runtime_error("MembraneForceEngine: membrane is not set");
    states_ = membrane->states(now);
    membrane->checkUnchanged();
    const std::size_t n = states_.size();
    for (std::size_t i = 0; i < n; ++i)
        if (!(states_[i]->mass > 0.) || !std::isfinite(states_[i]->mass))
            throw std::runtime_error("Membrane: the mass " + std::to_string(states_[i]->mass) + " kg of body #" +
                                     std::to_string(membrane->bodyIds[i]) + " must be finite and > 0");
    for (::membrane::Points* points : {&x_, &v_, &u_, &creaseForces_, &dampingForces_, &dragForces_})
        points->assign(n, Vector3r::Zero());
    creasePower = dampingPower = dragPower = 0.; // of parts no longer computed
    damping_.clear();
    for (const ::membrane::Side& s : membrane->rest().sides)
        damping_.push_back(
            ::membrane::dampingCoefficient(zeta, s.stiffness, 0.5 * (states_[s.a]->mass + states_[s.b]->mass)));
    checkedStep_ = -1.;
    preparedFor_ = &now;
}

void MembraneForceEngine::gather() {
    Real probe = 0.; // 0 times anything finite; NaN otherwise
    for (std::size_t i = 0; i < states_.size(); ++i) {
        x_[i] = states_[i]->pos;
        v_[i] = states_[i]->vel;
        probe += 0. * (x_[i].sum() + v_[i].sum());
    }
    if (probe == 0.) return;
    for (std::size_t i = 0; i < states_.size(); ++i)
        if (!x_[i].allFinite() || !v_[i].allFinite())
            throw std::runtime_error("Membrane: the run diverged at t = " + std::to_string(scene->time) + " s: node " +
                                     std::to_string(i) + " (body #" + std::to_string(membrane->bodyIds[i]) +
                                     ") has a position or velocity that is not finite");
}

/// Velocities at the time of the positions: with those half a step old, damping and drag would be of first order in
/// the step, and a spinning membrane would be under a false tension.
void MembraneForceEngine::centreVelocities() {
    const bool seen = seenPositions.size() == x_.size() && seenVelocities.size() == x_.size();
    u_ = v_;
    for (std::size_t i = 0; seen && i < x_.size(); ++i) {
        // The velocity that moved the node to where it is: a driven one has got its next already.
        const bool driven = held(*states_[i]);
        const Vector3r& arrived = driven ? seenVelocities[i] : v_[i];
        const Real rounding = 1e-15 * x_[i].norm(), moved = scene->dt * arrived.norm();
        // Not so if someone has put it elsewhere, given it another velocity or changed the step.
        if (!((x_[i] - seenPositions[i] - scene->dt * arrived).norm() <= 1e-9 * moved + rounding)) continue;
        const Real share = driven ? 0.5 : 1.5;
        u_[i] = share * v_[i] + (1. - share) * seenVelocities[i];
    }
    seenPositions = x_;
    seenVelocities = v_;
}

void MembraneForceEngine::checkTimeStep() {
    if (!forceTimeStep) {
        const Real limit = criticalTimeStep();
        if (!(scene->dt <= limit)) {
            std::ostringstream message;
            message << "MembraneForceEngine: O.dt = " << scene->dt << " s must be <= " << limit
                    << " s, the critical time step; lower it, or set forceTimeStep=True";
            throw std::runtime_error(message.str());
        }
    }
    checkedStep_ = scene->dt;
}

void MembraneForceEngine::addCreases() {
    const ::membrane::CreaseLaw lawNow = law();
    for (auto& f : creaseForces_) f.setZero();
    for (const ::membrane::Crease& c : membrane->rest().creases) {
        const ::membrane::CreaseState state = ::membrane::creaseState(c.rest, x_[c.a], x_[c.b], x_[c.c], x_[c.d]);
        const ::membrane::CreaseForces f = ::membrane::creaseForces(c.rest, lawNow, state);
        creaseForces_[c.a] += f.a;
        creaseForces_[c.b] += f.b;
        creaseForces_[c.c] += f.c;
        creaseForces_[c.d] += f.d;
    }
    creasePower = power(creaseForces_, u_);
}

void MembraneForceEngine::addDamping() {
    for (auto& f : dampingForces_) f.setZero();
    const auto& sides = membrane->rest().sides;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const ::membrane::Side& s = sides[i];
        const Vector3r span = x_[s.b] - x_[s.a];
        const Real length = span.norm();
        if (!(length > 0.)) continue;
        Real tension = damping_[i] * span.dot(u_[s.b] - u_[s.a]) / length;
        if (s.kind == ::membrane::SideKind::cable) { // a slack cable is not damped, and damping may not make one push
            if (length <= s.restLength) continue;
            tension = std::max(tension, -::membrane::sideTension(length, s.stiffness, s.restLength, s.critical));
        }
        const Vector3r force = (tension / length) * span;
        dampingForces_[s.a] += force;
        dampingForces_[s.b] -= force;
    }
    dampingPower = power(dampingForces_, u_);
}

void MembraneForceEngine::addDrag() {
    for (auto& f : dragForces_) f.setZero();
    for (const Vector3i& t : membrane->triangles) {
        const Vector3r area = doubleArea(x_, t);
        for (int k = 0; k < 3; ++k) dragForces_[t[k]] += ::membrane::cornerDrag(airDensity, area, u_[t[k]]);
    }
    dragPower = power(dragForces_, u_);
}

void MembraneForceEngine::scatter() const {
    for (std::size_t i = 0; i < states_.size(); ++i)
        scene->forces.addForce(membrane->bodyIds[i], creaseForces_[i] + dampingForces_[i] + dragForces_[i]);
}

Real MembraneForceEngine::criticalTimeStep() {
    const shared_ptr<Scene> current = Omega::instance().getScene();
    if (preparedFor_ != current.get()) prepare(*current);
    ::membrane::Points x;
    vector<Real> masses;
    for (const auto& state : states_) {
        x.push_back(state->pos);
        // A node held in some directions only counts as free: that bounds the step from below.
        masses.push_back(held(*state) ? 0. : state->mass);
    }
    vector<Real> drag;
    if (airDensity > 0.) {
        drag.assign(x.size(), 0.);
        for (const Vector3i& t : membrane->triangles) {
            const Vector3r area = doubleArea(x, t);
            for (int k = 0; k < 3; ++k) drag[t[k]] += ::membrane::cornerDragSlope(airDensity, area, states_[t[k]]->vel);
        }
    }
    return ::membrane::criticalTimeStep({membrane->rest(), masses, x, damping_, drag, law()});
}

Real MembraneForceEngine::creaseEnergy(const ::membrane::Points& x) const {
    const ::membrane::CreaseLaw lawNow = law();
    Real energy = 0.;
    for (const ::membrane::Crease& c : membrane->rest().creases)
        energy += ::membrane::creaseEnergy(c.rest, lawNow,
                                           ::membrane::creaseState(c.rest, x[c.a], x[c.b], x[c.c], x[c.d]).theta);
    return energy;
}

Real MembraneForceEngine::creaseEnergyNow() const {
    if (!membrane) throw std::runtime_error("MembraneForceEngine: membrane is not set");
    return creaseEnergy(membrane->positions(*Omega::instance().getScene()));
}

vector<Real> MembraneForceEngine::creaseAngles(const vector<Vector3r>& at) const {
    if (!membrane) throw std::runtime_error("MembraneForceEngine: membrane is not set");
    const ::membrane::Points x = membrane->positions(*Omega::instance().getScene(), at);
    vector<Real> angles;
    for (const ::membrane::Crease& c : membrane->rest().creases)
        angles.push_back(::membrane::creaseState(c.rest, x[c.a], x[c.b], x[c.c], x[c.d]).theta);
    return angles;
}

} // namespace yade

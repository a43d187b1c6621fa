// SPDX-License-Identifier: GPL-2.0-or-later
#include "LinearForces.hpp"
#include "SideForce.hpp"
#include <algorithm>
#include <cmath>

namespace membrane {

TautSide tautSide(const Side& s, double damping, const Points& x) {
    const Eigen::Vector3d span = x[s.b] - x[s.a];
    const double length = span.norm();
    const double axial = std::max(0., s.stiffness);
    // Without a length its direction is anybody's guess.
    if (!(length > 0.)) return {s.a, s.b, Eigen::Vector3d::UnitX(), axial, axial, damping};
    const double tension = sideTension(length, s.stiffness, s.restLength, s.critical);
    return {s.a, s.b, span / length, axial, std::max(0., tension / length), damping};
}

/// The forces' turning with the triangles weighs where |force| / height is not small. It couples an apex, its foot and
/// the other triangle; the factor bounds them together.
StiffCrease stiffCrease(const Crease& c, const CreaseLaw& law, const Points& x) {
    constexpr double turning = 3.;
    const CreaseState s = creaseState(c, x);
    const CreaseForces f = creaseForces(c.rest, law, s);
    const double heightC = std::max(s.heightC, leverFloor * c.rest.heightC);
    const double heightD = std::max(s.heightD, leverFloor * c.rest.heightD);
    // (7) is no gradient where the heights differ: the larger of its two moments bounds both.
    const double paper =
        law.bending * c.rest.length *
        std::max(heightC / (c.rest.heightC * c.rest.heightC), heightD / (c.rest.heightD * c.rest.heightD));
    const double moment = law.conservative ? creaseStiffness(c.rest, law) : paper;
    return {c.a,
            c.b,
            c.c,
            c.d,
            s.footC,
            s.footD,
            s.openC / heightC,
            s.openD / heightD,
            moment * std::max(1., law.penalty),
            turning * f.c.norm() / heightC,
            turning * f.d.norm() / heightD};
}

namespace {

Eigen::Vector4d padded(const Eigen::Vector3d& v) {
    return {v[0], v[1], v[2], 0.};
}

double dot(const Eigen::Vector4d& a, const Eigen::Vector4d& b) {
    const Eigen::Vector4d product = a.cwiseProduct(b);
    return product[0] + product[1] + product[2];
}

} // namespace

LinearForces::LinearForces(const std::vector<double>& masses) {
    inverseRoot.reserve(masses.size());
    for (const double mass : masses) inverseRoot.push_back(mass > 0. ? 1. / std::sqrt(mass) : 0.);
}

void LinearForces::addSide(const TautSide& side) {
    sides.push_back(side);
    damped = damped || side.damping > 0.;
}

void LinearForces::addDrag(int node, double slope) {
    drag.resize(inverseRoot.size());
    drag[node] += slope;
    damped = damped || slope > 0.;
}

void LinearForces::addGround(int node, double stiffness) {
    ground.resize(inverseRoot.size());
    ground[node] += stiffness;
}

void addProduct(const LinearForces& forces, double k, double c, const NodeVectors& x, NodeVectors& y) {
    const TautSide* side = forces.sides.data();
    const TautSide* const end = side + forces.sides.size();
    while (side != end) { // sides of the same first node, of which a film has a few in a row, write to it once
        const int a = side->a;
        // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): writing to y need not read it again
        const Eigen::Vector4d xa = x[a];
        Eigen::Vector4d sum = Eigen::Vector4d::Zero();
        do {
            const Eigen::Vector4d n = padded(side->direction), u = x[side->b] - xa;
            const double lateral = k * side->lateral;
            const double along = (k * side->axial + c * side->damping - lateral) * dot(n, u);
            const Eigen::Vector4d force = along * n + lateral * u;
            y[side->b] += force;
            sum += force;
            ++side;
        } while (side != end && side->a == a);
        y[a] -= sum;
    }
    for (const StiffCrease& e : forces.creases) {
        const Eigen::Vector4d gradC = padded(e.gradC), gradD = padded(e.gradD);
        const Eigen::Vector4d stretchC = x[e.c] - (1. - e.footC) * x[e.a] - e.footC * x[e.b];
        const Eigen::Vector4d stretchD = x[e.d] - (1. - e.footD) * x[e.a] - e.footD * x[e.b];
        const double moment = k * e.moment * (dot(gradC, stretchC) + dot(gradD, stretchD));
        const Eigen::Vector4d forceC = moment * gradC + (k * e.turningC) * stretchC;
        const Eigen::Vector4d forceD = moment * gradD + (k * e.turningD) * stretchD;
        y[e.c] += forceC;
        y[e.d] += forceD;
        y[e.a] -= (1. - e.footC) * forceC + (1. - e.footD) * forceD;
        y[e.b] -= e.footC * forceC + e.footD * forceD;
    }
    for (std::size_t i = 0; i < forces.drag.size(); ++i) y[i] += (c * forces.drag[i]) * x[i];
    for (std::size_t i = 0; i < forces.ground.size(); ++i) y[i] += (k * forces.ground[i]) * x[i];
}

} // namespace membrane

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

namespace {

/// A triangle as large as at rest, anywhere.
FilmSides sidesAtRest(const FilmRest& rest) {
    const double base = std::sqrt(rest.square[0]);
    const double along = 0.5 * (rest.square[2] - rest.square[1] - rest.square[0]) / base;
    const Eigen::Vector3d b = Eigen::Vector3d::Zero(), c(base, 0., 0.);
    return {c + Eigen::Vector3d(along, std::sqrt(std::max(0., rest.square[1] - along * along)), 0.), b, c};
}

/// The sides with which a triangle may be taut in the next step: none shorter than at rest. Where it has collapsed its
/// directions are anybody's guess.
FilmSides tautSides(const FilmRest& rest, FilmSides sides) {
    constexpr double collapsed = 0.05;
    double grown = 1.;
    for (int i = 0; i < 3; ++i) {
        const double share = std::sqrt(sides.side[i].squaredNorm() / rest.square[i]);
        if (!(share > collapsed)) return sidesAtRest(rest);
        grown = std::max(grown, 1. / share);
    }
    for (auto& side : sides.side) side *= grown;
    return sides;
}

} // namespace

StiffTriangle stiffTriangle(const Eigen::Vector3i& nodes, const FilmRest& rest, const FilmLaw& law, const Points& x) {
    const FilmSides present(x[nodes[0]], x[nodes[1]], x[nodes[2]]);
    const Eigen::Vector3d g = filmGradient(law, rest, present.grown(rest));
    const FilmSides sides = tautSides(rest, present);
    const double volume = law.thickness * rest.area;
    const double mean = std::sqrt(volume * law.meanModulus()), shear = std::sqrt(0.5 * volume * law.shearModulus());
    StiffTriangle t;
    t.time = law.time;
    for (int i = 0; i < 3; ++i) {
        t.node[i] = nodes[i];
        t.lateral[i] = std::max(0., 2. * g[i]);
    }
    for (int corner = 0; corner < 3; ++corner) {
        const int ends = (corner + 1) % 3, begins = (corner + 2) % 3; // sides that end and begin at this corner
        // Side i runs from corner i + 1 to i + 2: side i + 1 ends at corner i, side i + 2 begins there.
        const auto moved = [&](const double(&by)[3], double root) -> Eigen::Vector3d {
            return 2. * root * (by[ends] * sides.side[ends] - by[begins] * sides.side[begins]);
        };
        t.gradient[0][corner] = moved(rest.trace, mean);
        t.gradient[1][corner] = moved(rest.normal, shear);
        t.gradient[2][corner] = moved(rest.shear, shear);
    }
    return t;
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

void LinearForces::addTriangle(const StiffTriangle& triangle) {
    triangles.push_back(triangle);
    damped = damped || triangle.time > 0.;
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
    for (const StiffTriangle& t : forces.triangles) {
        const double square = k + c * t.time;
        Eigen::Vector4d force[3] = {Eigen::Vector4d::Zero(), Eigen::Vector4d::Zero(), Eigen::Vector4d::Zero()};
        for (const auto& gradient : t.gradient) {
            double change = 0.;
            for (int i = 0; i < 3; ++i) change += gradient[i].dot(x[t.node[i]].head<3>());
            for (int i = 0; i < 3; ++i) force[i] += (square * change) * padded(gradient[i]);
        }
        for (int i = 0; i < 3; ++i) {
            const int from = (i + 1) % 3, to = (i + 2) % 3;
            const Eigen::Vector4d lateral = (k * t.lateral[i]) * (x[t.node[to]] - x[t.node[from]]);
            force[to] += lateral;
            force[from] -= lateral;
        }
        for (int i = 0; i < 3; ++i) y[t.node[i]] += force[i];
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

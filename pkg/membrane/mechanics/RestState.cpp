// SPDX-License-Identifier: GPL-2.0-or-later
#include "RestState.hpp"
#include "FilmTriangle.hpp"
#include "SideForce.hpp"
#include "TriangleStiffness.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace membrane {
namespace {

using NodePair = std::pair<int, int>;

NodePair ordered(int a, int b) {
    return {std::min(a, b), std::max(a, b)};
}

NodePair ordered(const Eigen::Vector2i& nodes) {
    return ordered(nodes[0], nodes[1]);
}

template <class... Parts> [[noreturn]] void refuse(const Parts&... parts) {
    std::ostringstream message;
    message.precision(10);
    (message << ... << parts);
    throw std::invalid_argument(message.str());
}

void requirePositive(const char* field, double value) {
    if (!(value > 0.) || !std::isfinite(value)) refuse("Membrane: ", field, " = ", value, " must be finite and > 0");
}

void requireNotNegative(const char* field, double value) {
    if (!(value >= 0.) || !std::isfinite(value)) refuse("Membrane: ", field, " = ", value, " must be finite and >= 0");
}

void checkParameters(const MeshInput& in) {
    if (!in.triangles.empty()) {
        requirePositive("young", in.young);
        requirePositive("thickness", in.thickness);
        requirePositive("density", in.density);
        if (!(in.poisson > -1. && in.poisson <= 0.5))
            refuse("Membrane: poisson = ", in.poisson, " must be in (-1, 0.5]");
    }
    if (!in.cables.empty()) {
        requirePositive("cableStiffness", in.cableStiffness);
        requireNotNegative("cableDensity", in.cableDensity);
    }
    requireNotNegative("alpha", in.alpha);
    requireNotNegative("alphaCrease", in.alphaCrease);
    requireNotNegative("buckling", in.buckling);
    requireNotNegative("bucklingCrease", in.bucklingCrease);
    for (std::size_t i = 0; i < in.nodes.size(); ++i)
        if (!in.nodes[i].allFinite())
            refuse("Membrane: nodes[", i, "] = (", in.nodes[i].transpose(), ") must be finite");
    if (!in.pointMasses.empty() && in.pointMasses.size() != in.nodes.size())
        refuse("Membrane: pointMasses has ", in.pointMasses.size(),
               " entries; it must be empty or have one for each of the ", in.nodes.size(), " nodes");
    for (std::size_t i = 0; i < in.pointMasses.size(); ++i)
        if (!(in.pointMasses[i] >= 0.) || !std::isfinite(in.pointMasses[i]))
            refuse("Membrane: pointMasses[", i, "] = ", in.pointMasses[i], " must be finite and >= 0");
    if (in.creaseSigns.size() != in.creases.size())
        refuse("Membrane: creaseSigns has ", in.creaseSigns.size(), " entries; it must have one for each of the ",
               in.creases.size(), " creases");
}

/// Place of the first node that is out of range or repeats one before it; -1: none.
template <class Indices> int firstBadNode(const Indices& nodes, std::size_t count) {
    for (int i = 0; i < nodes.size(); ++i) {
        if (nodes[i] < 0 || nodes[i] >= static_cast<int>(count)) return i;
        for (int j = 0; j < i; ++j)
            if (nodes[i] == nodes[j]) return i;
    }
    return -1;
}

/// Node indices in range and all different.
template <class Indices> void checkIndices(const char* field, std::size_t at, const Indices& nodes, std::size_t count) {
    const int i = firstBadNode(nodes, count);
    if (i < 0) return;
    if (nodes[i] < 0 || nodes[i] >= static_cast<int>(count))
        refuse("Membrane: ", field, "[", at, "] = (", nodes.transpose(), ") names node ", nodes[i],
               "; it must be in 0..", static_cast<long>(count) - 1);
    refuse("Membrane: ", field, "[", at, "] = (", nodes.transpose(), ") repeats node ", nodes[i]);
}

/// Number of entries before the first with bad indices: only those can be sorted by their nodes.
template <class Entries> int countGood(const Entries& entries, std::size_t nodes) {
    const auto bad = [nodes](const auto& entry) { return firstBadNode(entry, nodes) >= 0; };
    return static_cast<int>(std::find_if(entries.begin(), entries.end(), bad) - entries.begin());
}

/// 0..count-1 sorted by the nodes of each, the lower one first; equal ones stay in order. Takes a time that grows with
/// count + nodes.
template <class NodesOf> std::vector<int> sortedByNodes(int count, std::size_t nodes, NodesOf nodesOf) {
    std::vector<int> order(count), sorted(count);
    std::iota(order.begin(), order.end(), 0);
    for (int NodePair::*node : {&NodePair::second, &NodePair::first}) {
        std::vector<int> place(nodes + 1, 0);
        for (int i : order) ++place[nodesOf(i).*node + 1];
        std::partial_sum(place.begin(), place.end(), place.begin());
        for (int i : order) sorted[place[nodesOf(i).*node]++] = i;
        order.swap(sorted);
    }
    return order;
}

/// Which of the pairs, given in the order of their nodes, repeat one before them?
std::vector<bool> findRepeated(const std::vector<Eigen::Vector2i>& pairs, const std::vector<int>& order) {
    std::vector<bool> repeated(pairs.size(), false);
    for (std::size_t k = 1; k < order.size(); ++k)
        repeated[order[k]] = ordered(pairs[order[k]]) == ordered(pairs[order[k - 1]]);
    return repeated;
}

/// How the film's triangles share their sides. Half-side 3 t + i of triangle t runs from its corner i + 1 to i + 2.
struct Film {
    const std::vector<Eigen::Vector3i>& triangles;
    std::vector<int> halves; ///< in the order of their nodes
    std::vector<int> first;  ///< of each side in `halves`; its halves end where those of the next side begin
    int fault = -1;          ///< first half-side whose triangle is repeated or the third at this side; -1: none
    bool repeated = false;   ///< which of the two the fault is

    int from(int half) const { return triangles[half / 3][(half + 1) % 3]; }
    int to(int half) const { return triangles[half / 3][(half + 2) % 3]; }
    int apex(int half) const { return triangles[half / 3][half % 3]; }
    NodePair nodes(int half) const { return ordered(from(half), to(half)); }

    explicit Film(const MeshInput& in) : triangles(in.triangles) {
        const int good = countGood(triangles, in.nodes.size());
        halves = sortedByNodes(3 * good, in.nodes.size(), [this](int half) { return nodes(half); });
        first.reserve(halves.size() / 2 + 1);
        for (std::size_t k = 0; k < halves.size(); ++k) {
            if (k == 0 || nodes(halves[k]) != nodes(halves[k - 1])) first.push_back(static_cast<int>(k));
            noteFault(first.back(), static_cast<int>(k));
        }
        first.push_back(static_cast<int>(halves.size()));
    }

    std::size_t sides() const { return first.size() - 1; }

private:
    /// `k` is the place of a half-side whose side begins at `begin`.
    void noteFault(int begin, int k) {
        const int half = halves[k];
        if (k == begin || (fault >= 0 && fault < half)) return;
        const bool again =
            apex(half) == apex(halves[begin]) || (k > begin + 1 && apex(half) == apex(halves[begin + 1]));
        if (!again && k < begin + 2) return;
        fault = half;
        repeated = again;
    }
};

/// The largest angle of a triangle [degrees] and its place, to explain a negative stiffness.
std::pair<double, int> largestAngle(const Eigen::Vector3d& lengths) {
    int longest = 0;
    lengths.maxCoeff(&longest);
    const double a = lengths[longest], b = lengths[(longest + 1) % 3], c = lengths[(longest + 2) % 3];
    const double cosine = std::max(-1., std::min(1., (b * b + c * c - a * a) / (2. * b * c)));
    return {std::acos(cosine) * 180. / 3.14159265358979323846, longest};
}

/// Stiffness [N/m] of the sides of a triangle of a film of plane stress.
Eigen::Vector3d planeStressStiffness(const MeshInput& in, const Eigen::Vector3i& triangle) {
    FilmLaw law;
    law.young = in.young;
    law.poisson = in.poisson;
    law.thickness = in.thickness;
    const FilmRest rest(in.nodes[triangle[0]], in.nodes[triangle[1]], in.nodes[triangle[2]]);
    Eigen::Vector3d k;
    for (int i = 0; i < 3; ++i) k[i] = filmSideStiffness(law, rest, i);
    return k;
}

/// Length below which a side of the film is buckled.
double criticalLengthOf(const MeshInput& in, const Side& side) {
    const bool crease = side.kind == SideKind::crease && !in.planeStress; // plane stress has no other buckling there
    const double stress = crease ? in.bucklingCrease : in.buckling;
    if (stress > 0. || in.planeStress) return criticalLengthAt(side.restLength, stress / in.young);
    return criticalLength(side.restLength, crease ? in.alphaCrease : in.alpha, in.thickness);
}

/// Sides with their stiffnesses, masses and area of the film.
void addFilm(const MeshInput& in, const Film& film, RestState& rest) {
    std::vector<int> sideOf(film.halves.size());
    for (std::size_t s = 0; s < film.sides(); ++s) {
        const auto [a, b] = film.nodes(film.halves[film.first[s]]);
        rest.sides.push_back({a, b, SideKind::film, 0., 0., 0.});
        for (int k = film.first[s]; k < film.first[s + 1]; ++k) sideOf[film.halves[k]] = static_cast<int>(s);
    }
    for (std::size_t t = 0; t < in.triangles.size(); ++t) {
        const Eigen::Vector3i& tri = in.triangles[t];
        const int half = static_cast<int>(3 * t);
        checkIndices("triangles", t, tri, in.nodes.size());
        if (film.repeated && film.fault / 3 == static_cast<int>(t))
            refuse("Membrane: triangles[", t, "] = (", tri.transpose(), ") is repeated");

        // Side i lies opposite corner i.
        Eigen::Vector3d lengths;
        for (int i = 0; i < 3; ++i) lengths[i] = (in.nodes[tri[(i + 1) % 3]] - in.nodes[tri[(i + 2) % 3]]).norm();
        const double area = triangleArea(in.nodes[tri[0]], in.nodes[tri[1]], in.nodes[tri[2]]);
        if (!(area > 1e-12 * lengths.maxCoeff() * lengths.maxCoeff()))
            refuse("Membrane: triangles[", t, "] = (", tri.transpose(), ") has area ", area, " m²; it must be > 0");

        const Eigen::Vector3d k = in.planeStress ? planeStressStiffness(in, tri)
                                                 : triangleStiffness(lengths, area, in.young, in.poisson, in.thickness);
        if (!k.allFinite()) {
            const auto [angle, apex] = largestAngle(lengths);
            refuse("Membrane: triangles[", t, "] = (", tri.transpose(),
                   ") has no stiffness by equation (5) at poisson = ", in.poisson, ": its angle of ", angle,
                   " degrees at node ", tri[apex], " makes the equations singular");
        }
        for (int i = 0; i < 3; ++i) {
            const int a = film.from(half + i), b = film.to(half + i);
            if (k[i] < 0. && !in.allowNegativeStiffness) {
                const auto [angle, apex] = largestAngle(lengths);
                refuse("Membrane: triangles[", t, "] = (", tri.transpose(), ") gives side (", a, ", ", b,
                       ") the stiffness ", k[i], " N/m; it must be >= 0. The angle of ", angle, " degrees at node ",
                       tri[apex], " is to blame: remesh, or set allowNegativeStiffness=True");
            }
            const int side = sideOf[half + i];
            if (film.fault == half + i) {
                const int* others = &film.halves[film.first[side]];
                refuse("Membrane: side (", a, ", ", b, ") has a third triangle, triangles[", t, "], besides ",
                       others[0] / 3, " and ", others[1] / 3, "; at most 2 may share a side");
            }
            rest.sides[side].stiffness += k[i];
        }
        rest.area += area;
        for (int i = 0; i < 3; ++i) rest.masses[tri[i]] += cornerMass(area, in.density, in.thickness);
    }
}

void addCrease(const MeshInput& in, std::size_t at, const Film& film, RestState& rest) {
    const Eigen::Vector2i& nodes = in.creases[at];
    const int sign = in.creaseSigns[at];
    checkIndices("creases", at, nodes, in.nodes.size());
    if (sign != 1 && sign != -1)
        refuse("Membrane: creaseSigns[", at, "] = ", sign, " must be +1 (mountain) or -1 (valley)");
    const int side = rest.sideBetween(nodes[0], nodes[1]);
    if (side < 0) refuse("Membrane: creases[", at, "] = (", nodes.transpose(), ") is not a side of any triangle");
    if (film.first[side + 1] - film.first[side] != 2)
        refuse("Membrane: creases[", at, "] = (", nodes.transpose(),
               ") lies on the edge; it must be shared by 2 triangles");
    int left = film.halves[film.first[side]], right = film.halves[film.first[side] + 1];
    if (film.from(left) == film.from(right))
        refuse("Membrane: triangles ", left / 3, " and ", right / 3, " run along creases[", at, "] = (",
               nodes.transpose(), ") in the same direction; orient them alike");

    // ABC is the triangle that runs from the lower node A to the higher node B.
    if (film.from(left) > film.to(left)) std::swap(left, right);
    Crease crease{film.from(left), film.to(left), film.apex(left), film.apex(right), {}};
    const Eigen::Vector3d &a = in.nodes[crease.a], &b = in.nodes[crease.b];
    crease.rest.length = (b - a).norm();
    crease.rest.heightC = 2. * triangleArea(a, b, in.nodes[crease.c]) / crease.rest.length;
    crease.rest.heightD = 2. * triangleArea(a, b, in.nodes[crease.d]) / crease.rest.length;
    crease.rest.sign = sign;
    rest.creases.push_back(crease);
    rest.sides[side].kind = SideKind::crease;
}

void addCreases(const MeshInput& in, const Film& film, RestState& rest) {
    const auto nodesOf = [&in](int i) { return ordered(in.creases[i]); };
    const std::vector<bool> repeated =
        findRepeated(in.creases, sortedByNodes(countGood(in.creases, in.nodes.size()), in.nodes.size(), nodesOf));
    rest.creases.reserve(in.creases.size());
    for (std::size_t i = 0; i < in.creases.size(); ++i) {
        addCrease(in, i, film, rest);
        if (repeated[i]) refuse("Membrane: creases[", i, "] = (", in.creases[i].transpose(), ") is repeated");
    }
}

void addCables(const MeshInput& in, RestState& rest) {
    const auto nodesOf = [&in](int i) { return ordered(in.cables[i]); };
    std::vector<int> order = sortedByNodes(countGood(in.cables, in.nodes.size()), in.nodes.size(), nodesOf);
    const std::vector<bool> repeated = findRepeated(in.cables, order);
    for (std::size_t i = 0; i < in.cables.size(); ++i) {
        checkIndices("cables", i, in.cables[i], in.nodes.size());
        const NodePair nodes = ordered(in.cables[i]);
        if (repeated[i] || rest.sideBetween(nodes.first, nodes.second) >= 0)
            refuse("Membrane: cables[", i, "] = (", in.cables[i].transpose(),
                   ") doubles another cable or a side of the film");
        const double length = (in.nodes[nodes.first] - in.nodes[nodes.second]).norm();
        if (!(length > 0.))
            refuse("Membrane: cables[", i, "] = (", in.cables[i].transpose(), ") has length 0; it must be > 0");
        rest.sides.push_back({nodes.first, nodes.second, SideKind::cable, length, in.cableStiffness / length, length});
        for (int node : {nodes.first, nodes.second}) rest.masses[node] += 0.5 * in.cableDensity * length;
    }
    for (int& cable : order) cable += static_cast<int>(rest.filmSides);
    rest.cablesByNodes = std::move(order);
}

} // namespace

int RestState::sideBetween(int a, int b) const {
    const NodePair wanted = ordered(a, b);
    const auto nodesOf = [](const Side& side) { return NodePair(side.a, side.b); };
    const auto filmEnd = sides.begin() + static_cast<std::ptrdiff_t>(filmSides);
    const auto side = std::lower_bound(sides.begin(), filmEnd, wanted,
                                       [&](const Side& s, const NodePair& nodes) { return nodesOf(s) < nodes; });
    if (side != filmEnd && nodesOf(*side) == wanted) return static_cast<int>(side - sides.begin());
    const auto cable = std::lower_bound(cablesByNodes.begin(), cablesByNodes.end(), wanted,
                                        [&](int s, const NodePair& nodes) { return nodesOf(sides[s]) < nodes; });
    return cable != cablesByNodes.end() && nodesOf(sides[*cable]) == wanted ? *cable : -1;
}

RestState restState(const MeshInput& in) {
    checkParameters(in);
    RestState rest;
    rest.masses.assign(in.nodes.size(), 0.);
    rest.planeStress = in.planeStress;
    {
        const Film film(in);
        rest.filmSides = film.sides();
        rest.sides.reserve(film.sides() + in.cables.size());
        addFilm(in, film, rest);
        addCreases(in, film, rest);
    }
    for (Side& side : rest.sides) {
        side.restLength = (in.nodes[side.a] - in.nodes[side.b]).norm();
        side.critical = criticalLengthOf(in, side);
    }
    addCables(in, rest);

    for (std::size_t i = 0; i < in.pointMasses.size(); ++i) rest.masses[i] += in.pointMasses[i];
    for (std::size_t i = 0; i < rest.masses.size(); ++i)
        if (!(rest.masses[i] > 0.))
            refuse("Membrane: nodes[", i, "] has mass ", rest.masses[i],
                   " kg; it must be > 0: put it in a triangle or a cable, or give it a point mass");
    return rest;
}

} // namespace membrane

// SPDX-License-Identifier: GPL-2.0-or-later
#include "RestState.hpp"
#include "SideForce.hpp"
#include "TriangleStiffness.hpp"
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace membrane {
namespace {

using NodePair = std::pair<int, int>;

NodePair ordered(int a, int b) {
    return {std::min(a, b), std::max(a, b)};
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

/// Node indices in range and all different.
template <class Indices> void checkIndices(const char* field, std::size_t at, const Indices& nodes, std::size_t count) {
    for (int i = 0; i < nodes.size(); ++i) {
        if (nodes[i] < 0 || nodes[i] >= static_cast<int>(count))
            refuse("Membrane: ", field, "[", at, "] = (", nodes.transpose(), ") names node ", nodes[i],
                   "; it must be in 0..", static_cast<long>(count) - 1);
        for (int j = 0; j < i; ++j)
            if (nodes[i] == nodes[j])
                refuse("Membrane: ", field, "[", at, "] = (", nodes.transpose(), ") repeats node ", nodes[i]);
    }
}

/// A film side while it is being collected: its spring and the triangles that share it.
struct FilmSide {
    double stiffness = 0.;
    std::array<int, 2> triangle{{-1, -1}};
    std::array<bool, 2> forward{}; ///< does the triangle run from the lower to the higher node?
    int triangles = 0;
};

/// The largest angle of a triangle [degrees] and its place, to explain a negative stiffness.
std::pair<double, int> largestAngle(const Eigen::Vector3d& lengths) {
    int longest = 0;
    lengths.maxCoeff(&longest);
    const double a = lengths[longest], b = lengths[(longest + 1) % 3], c = lengths[(longest + 2) % 3];
    const double cosine = std::max(-1., std::min(1., (b * b + c * c - a * a) / (2. * b * c)));
    return {std::acos(cosine) * 180. / 3.14159265358979323846, longest};
}

std::map<NodePair, FilmSide> collectFilm(const MeshInput& in, RestState& rest) {
    std::map<NodePair, FilmSide> film;
    std::set<std::array<int, 3>> seen;
    for (std::size_t t = 0; t < in.triangles.size(); ++t) {
        const Eigen::Vector3i& tri = in.triangles[t];
        checkIndices("triangles", t, tri, in.nodes.size());
        std::array<int, 3> key{{tri[0], tri[1], tri[2]}};
        std::sort(key.begin(), key.end());
        if (!seen.insert(key).second) refuse("Membrane: triangles[", t, "] = (", tri.transpose(), ") is repeated");

        // Side i lies opposite corner i.
        Eigen::Vector3d lengths;
        for (int i = 0; i < 3; ++i) lengths[i] = (in.nodes[tri[(i + 1) % 3]] - in.nodes[tri[(i + 2) % 3]]).norm();
        const double area = triangleArea(in.nodes[tri[0]], in.nodes[tri[1]], in.nodes[tri[2]]);
        if (!(area > 1e-12 * lengths.maxCoeff() * lengths.maxCoeff()))
            refuse("Membrane: triangles[", t, "] = (", tri.transpose(), ") has area ", area, " m²; it must be > 0");

        const Eigen::Vector3d k = triangleStiffness(lengths, area, in.young, in.poisson, in.thickness);
        const auto [angle, apex] = largestAngle(lengths);
        if (!k.allFinite())
            refuse("Membrane: triangles[", t, "] = (", tri.transpose(),
                   ") has no stiffness by equation (5) at poisson = ", in.poisson, ": its angle of ", angle,
                   " degrees at node ", tri[apex], " makes the equations singular");
        for (int i = 0; i < 3; ++i) {
            const int a = tri[(i + 1) % 3], b = tri[(i + 2) % 3];
            if (k[i] < 0. && !in.allowNegativeStiffness)
                refuse("Membrane: triangles[", t, "] = (", tri.transpose(), ") gives side (", a, ", ", b,
                       ") the stiffness ", k[i], " N/m; it must be >= 0. The angle of ", angle, " degrees at node ",
                       tri[apex], " is to blame: remesh, or set allowNegativeStiffness=True");
            FilmSide& side = film[ordered(a, b)];
            if (side.triangles == 2)
                refuse("Membrane: side (", a, ", ", b, ") has a third triangle, triangles[", t, "], besides ",
                       side.triangle[0], " and ", side.triangle[1], "; at most 2 may share a side");
            side.stiffness += k[i];
            side.triangle[side.triangles] = static_cast<int>(t);
            side.forward[side.triangles] = a < b;
            ++side.triangles;
        }
        rest.area += area;
        for (int i = 0; i < 3; ++i) rest.masses[tri[i]] += cornerMass(area, in.density, in.thickness);
    }
    return film;
}

int apexOf(const Eigen::Vector3i& triangle, const NodePair& side) {
    for (int i = 0; i < 3; ++i)
        if (triangle[i] != side.first && triangle[i] != side.second) return triangle[i];
    return -1;
}

Crease makeCrease(const MeshInput& in, std::size_t at, const std::map<NodePair, FilmSide>& film) {
    const Eigen::Vector2i& nodes = in.creases[at];
    const int sign = in.creaseSigns[at];
    checkIndices("creases", at, nodes, in.nodes.size());
    if (sign != 1 && sign != -1)
        refuse("Membrane: creaseSigns[", at, "] = ", sign, " must be +1 (mountain) or -1 (valley)");
    const NodePair key = ordered(nodes[0], nodes[1]);
    const auto found = film.find(key);
    if (found == film.end())
        refuse("Membrane: creases[", at, "] = (", nodes.transpose(), ") is no side of any triangle");
    const FilmSide& side = found->second;
    if (side.triangles != 2)
        refuse("Membrane: creases[", at, "] = (", nodes.transpose(),
               ") lies on the edge; it must be shared by 2 triangles");
    if (side.forward[0] == side.forward[1])
        refuse("Membrane: triangles ", side.triangle[0], " and ", side.triangle[1], " run along creases[", at, "] = (",
               nodes.transpose(), ") in the same direction; orient them alike");

    // ABC is the triangle that runs from the lower node A to the higher node B.
    const int ofC = side.forward[0] ? 0 : 1;
    Crease crease{key.first,
                  key.second,
                  apexOf(in.triangles[side.triangle[ofC]], key),
                  apexOf(in.triangles[side.triangle[1 - ofC]], key),
                  {}};
    const Eigen::Vector3d &a = in.nodes[crease.a], &b = in.nodes[crease.b];
    crease.rest.length = (b - a).norm();
    crease.rest.heightC = 2. * triangleArea(a, b, in.nodes[crease.c]) / crease.rest.length;
    crease.rest.heightD = 2. * triangleArea(a, b, in.nodes[crease.d]) / crease.rest.length;
    crease.rest.sign = -sign;
    return crease;
}

} // namespace

RestState restState(const MeshInput& in) {
    checkParameters(in);
    RestState rest;
    rest.masses.assign(in.nodes.size(), 0.);
    const std::map<NodePair, FilmSide> film = collectFilm(in, rest);

    std::set<NodePair> creased;
    for (std::size_t i = 0; i < in.creases.size(); ++i) {
        rest.creases.push_back(makeCrease(in, i, film));
        if (!creased.insert({rest.creases.back().a, rest.creases.back().b}).second)
            refuse("Membrane: creases[", i, "] = (", in.creases[i].transpose(), ") is repeated");
    }

    for (const auto& [key, side] : film) {
        const bool onCrease = creased.count(key) > 0;
        const double length = (in.nodes[key.first] - in.nodes[key.second]).norm();
        rest.sides.push_back({key.first, key.second, onCrease ? SideKind::crease : SideKind::film, length,
                              side.stiffness,
                              criticalLength(length, onCrease ? in.alphaCrease : in.alpha, in.thickness)});
    }

    std::set<NodePair> tied;
    for (std::size_t i = 0; i < in.cables.size(); ++i) {
        checkIndices("cables", i, in.cables[i], in.nodes.size());
        const NodePair key = ordered(in.cables[i][0], in.cables[i][1]);
        if (film.count(key) || !tied.insert(key).second)
            refuse("Membrane: cables[", i, "] = (", in.cables[i].transpose(),
                   ") doubles another cable or a side of the film");
        const double length = (in.nodes[key.first] - in.nodes[key.second]).norm();
        if (!(length > 0.))
            refuse("Membrane: cables[", i, "] = (", in.cables[i].transpose(), ") has length 0; it must be > 0");
        rest.sides.push_back({key.first, key.second, SideKind::cable, length, in.cableStiffness / length, length});
        for (int node : {key.first, key.second}) rest.masses[node] += 0.5 * in.cableDensity * length;
    }

    for (std::size_t i = 0; i < in.pointMasses.size(); ++i) rest.masses[i] += in.pointMasses[i];
    for (std::size_t i = 0; i < rest.masses.size(); ++i)
        if (!(rest.masses[i] > 0.))
            refuse("Membrane: nodes[", i, "] has mass ", rest.masses[i],
                   " kg; it must be > 0: put it in a triangle or a cable, or give it a point mass");
    return rest;
}

} // namespace membrane

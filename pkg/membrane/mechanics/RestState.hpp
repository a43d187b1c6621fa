// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Crease.hpp"
#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace membrane {

using Points = std::vector<Eigen::Vector3d>;

/// What a membrane is made of: mesh, film, cables.
struct MeshInput {
    Points nodes;                           ///< rest positions [m], one a node
    std::vector<Eigen::Vector3i> triangles; ///< node indices, consistently oriented across creases
    std::vector<Eigen::Vector2i> creases;   ///< sides on a fold line (node indices)
    std::vector<int> creaseSigns;           ///< +1 mountain, -1 valley, seen from the side of the triangles' normals
    std::vector<Eigen::Vector2i> cables;    ///< segments of cables (tethers), node indices
    std::vector<double> pointMasses;        ///< mass added to each node [kg], or empty
    double young = 0., poisson = 0., density = 0., thickness = 0.; ///< film [Pa], [-], [kg/m³], [m]
    double cableStiffness = 0.;                                    ///< EA [N]
    double cableDensity = 0.;                                      ///< mass a length [kg/m]
    double alpha = 0., alphaCrease = 0.;       ///< buckling parameter (6) of the film and of sides on creases [-]
    double buckling = 0., bucklingCrease = 0.; ///< stress [Pa] at which film and sides on creases buckle; 0: by alpha
    bool planeStress = false;                  ///< the film is one of plane stress, not of springs
    bool allowNegativeStiffness = false;       ///< accept sides whose stiffness (5) is not positive
};

enum class SideKind : int { film = 0, crease = 1, cable = 2 };

/// One spring of the membrane.
struct Side {
    int a, b; ///< node indices, a < b
    SideKind kind;
    double restLength; ///< L0 [m]
    double stiffness;  ///< k [N/m], (5) summed over the triangles of the side, or that of a film of plane stress with
                       ///< all other sides held; EA/L0 for a cable
    double critical;   ///< l_cr [m], (6); equal to L0 for a cable, which bears no compression
};

/// A crease: nodes A, B of the side, apices C (of the triangle that runs A to B) and D.
struct Crease {
    int a, b, c, d;
    CreaseRest rest;
};

/// Where a crease is among the nodes' places [m].
inline CreaseState creaseState(const Crease& c, const Points& x) {
    return creaseState(c.rest, x[c.a], x[c.b], x[c.c], x[c.d]);
}

/// Everything the forces need to know of the unloaded membrane. Sides of the film come first, sorted by (a, b), then
/// cables as they were given.
struct RestState {
    std::vector<Side> sides;
    std::size_t filmSides = 0;      ///< number of sides of the film
    bool planeStress = false;       ///< the film is one of plane stress: only cables are springs
    std::vector<int> cablesByNodes; ///< indices in `sides` of the cables, sorted by (a, b)
    std::vector<Crease> creases;
    std::vector<double> masses; ///< (4) summed over triangles, plus cables and point masses [kg]
    double area = 0.;           ///< of the film [m²]

    bool isSpring(const Side& side) const { return !planeStress || side.kind == SideKind::cable; }
    std::size_t firstSpring() const { return planeStress ? filmSides : 0; } ///< all that follow are springs, too
    /// Index in `sides` of the side between two nodes; -1 if there is none.
    int sideBetween(int a, int b) const;
};

/// Checks the input and computes the rest state.
/// \throws std::invalid_argument naming the field, the value and the range that it must lie in
RestState restState(const MeshInput& input);

} // namespace membrane

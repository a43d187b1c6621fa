// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "FilmTriangle.hpp"
#include "RestState.hpp"
#include <vector>

namespace membrane {

/// A side as if taut.
struct TautSide {
    int a, b;
    Eigen::Vector3d direction;
    double axial, lateral; ///< stiffness along and across the side [N/m], 0 <= lateral <= axial
    double damping;        ///< along the side [N s/m]
};

/// A crease: the moment against a change of theta, and a spring between each apex and its foot on AB.
struct StiffCrease {
    int a, b, c, d;
    double footC, footD;          ///< as in CreaseState
    Eigen::Vector3d gradC, gradD; ///< of theta by the displacements of C and D against their feet [1/m]
    double moment;                ///< stiffness against a change of theta [N m/rad]
    double turningC, turningD;    ///< stiffness of the springs, the same in all directions [N/m]
};

/// A triangle of a film as if taut.
struct StiffTriangle {
    int node[3];
    /// Changes of the strain's three parts by the displacements of the corners, times the root of their stiffness: the
    /// triangle answers with the sum of their squares [sqrt(N/m)].
    Eigen::Vector3d gradient[3][3];
    double lateral[3]; ///< stiffness of each side by its tension, the same in all directions [N/m], >= 0
    double time;       ///< damping over stiffness of the squares [s]
};

/// Symmetric positive matrices that bound how the forces answer to small displacements (K) and velocities (C).
///
/// What a force adds to them is up to it: see ElementForce. Every side counts as taut (a buckled one may become so in
/// the next step), with the stiffness of its direction under its present tension, and every crease with its penalty and
/// the turning of its forces; so does every triangle of a film; negative stiffness is left out.
struct LinearForces {
    std::vector<TautSide> sides;
    std::vector<StiffTriangle> triangles;
    std::vector<StiffCrease> creases;
    std::vector<double> drag;        ///< of each node, the same in all directions [N s/m]; or empty
    std::vector<double> ground;      ///< springs of each node to places at rest [N/m]; or empty
    std::vector<double> inverseRoot; ///< of each node, 1/sqrt(mass); 0: cannot move
    bool damped = false;             ///< C is not 0
    double beside = 0.; ///< square of the fastest frequency of what else moves with the nodes [1/s²]; 0: nothing

    /// No forces yet. \param masses of the nodes [kg]; one that cannot move has 0
    explicit LinearForces(const std::vector<double>& masses);
    void addSide(const TautSide& side);
    void addTriangle(const StiffTriangle& triangle);
    /// \param slope [N s/m]
    void addDrag(int node, double slope);
    /// \param stiffness [N/m]
    void addGround(int node, double stiffness);
};

/// A side at the present places of its nodes [m]. \param damping c [N s/m]
TautSide tautSide(const Side& side, double damping, const Points& x);
/// A triangle of a film. The relaxed energy is nowhere stiffer than the taut one.
StiffTriangle stiffTriangle(const Eigen::Vector3i& nodes, const FilmRest& rest, const FilmLaw& law, const Points& x);
StiffCrease stiffCrease(const Crease& crease, const CreaseLaw& law, const Points& x);

/// A vector for each node. The fourth number stays 0: four fill the CPU's vectors and three do not.
using NodeVectors = std::vector<Eigen::Vector4d>;

/// y += (k K + c C) x.
void addProduct(const LinearForces& forces, double k, double c, const NodeVectors& x, NodeVectors& y);

} // namespace membrane

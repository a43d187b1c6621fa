// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "RestState.hpp"
#include <vector>

namespace membrane {

/// What the forces on a membrane depend on besides its sides.
struct TimeStepInput {
    const RestState& rest;
    const std::vector<double>& masses;           ///< actual masses [kg]; a node that cannot move has 0
    const Points& positions;                     ///< current positions [m]
    const std::vector<double>& damping;          ///< c of each side [N s/m], or empty
    const std::vector<double>& drag;             ///< of each node, the same in all directions [N s/m], or empty
    CreaseLaw crease;                            ///< bending = 0: no creases
    const std::vector<double>* ground = nullptr; ///< springs of each node to places at rest [N/m]; null or empty: none
    double beside = 0.; ///< square of the fastest frequency of what else moves with the nodes [1/s²]; 0: nothing
};

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

/// Symmetric positive matrices that bound how the forces answer to small displacements (K) and velocities (C).
///
/// Every side counts as taut (a buckled one may become so in the next step), with the stiffness of its direction under
/// its present tension, and every crease with its penalty and the turning of its forces; negative stiffness is left
/// out.
struct LinearForces {
    std::vector<TautSide> sides; ///< in the order of the rest state
    std::vector<StiffCrease> creases;
    std::vector<double> drag;        ///< as in the input
    std::vector<double> ground;      ///< as in the input
    std::vector<double> inverseRoot; ///< of each node, 1/sqrt(mass); 0: cannot move
    bool damped;                     ///< C is not 0
};

LinearForces linearForces(const TimeStepInput& input);

/// A vector for each node. The fourth number stays 0: four fill the CPU's vectors and three do not.
using NodeVectors = std::vector<Eigen::Vector4d>;

/// y += (k K + c C) x.
void addProduct(const LinearForces& forces, double k, double c, const NodeVectors& x, NodeVectors& y);

} // namespace membrane

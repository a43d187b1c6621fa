// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Coordinates.hpp"
#include "Sums.hpp"
#include <Eigen/Core>

namespace membrane {

/// What moves the nodes, for one step.
struct Motion {
    Components x;                 ///< positions [m], of this step; then of the next
    Components v;                 ///< velocities [m/s], half a step before `x`; then half a step after
    Components u;                 ///< velocities [m/s] at the time of `x`; then extrapolated to the next
    Components elastic;           ///< forces [N] of the sides and from outside; then 0
    Components damping;           ///< forces [N] of damping, and
    Components crease;            ///< of creases, then 0; used only with sums, else they are in `elastic`
    double* dragWeight = nullptr; ///< see nodeDrag(); then 0; none: no drag
    const double* mass = nullptr; ///< [kg]
    double dt = 0.;               ///< [s]
    double airDensity = 0.;       ///< [kg/m³]
    double localDamping = 0.;     ///< YADE's damping of NewtonIntegrator [-]
    Eigen::Vector3d gravity = Eigen::Vector3d::Zero(); ///< [m/s²]
    double centrifugal = 0.; ///< omega² [1/s²] of a frame that turns about z; not counted in the sums
};

/// Sums over nodes for the energy ledger.
struct MotionSums {
    double power[3] = {0., 0., 0.}; ///< of creases, damping, drag at the mean of v- and v+ [W]
    double torque = 0.;             ///< about z, of all forces [N m]
    // Only with Sums::energies:
    double arriving[3] = {0., 0., 0.}; ///< power of creases, damping, drag at v- [W]
    double kinetic = 0.;               ///< m v- v+ / 2 [J]
    double potential = 0.;             ///< -m g x [J]
    double angularMomentum = 0.;       ///< about z, at the mean of v- and v+ [N m s]
};

/// Moves the nodes begin..end-1 by one step of YADE's leapfrog: v += dt a, x += dt v.
/// \param wanted sums, which are added to `sums`
/// \return 0 if all new positions are finite, else NaN
double moveNodes(int begin, int end, const Motion& motion, Sums wanted, MotionSums& sums);

} // namespace membrane

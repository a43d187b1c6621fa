// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Coordinates.hpp"
#include "Sums.hpp"
#include <Eigen/Core>

namespace membrane {

/// Channels by which forces are told apart: these, and those of other forces after them.
enum Channel : int { creaseChannel, dampingChannel, dragChannel, otherChannels };
constexpr int maxChannels = 8;

/// What moves the nodes, for one step.
struct Motion {
    Components x;                 ///< positions [m], of this step; then of the next
    Components v;                 ///< velocities [m/s], half a step before `x`; then half a step after
    Components u;                 ///< velocities [m/s] at the time of `x`; then extrapolated to the next
    Components elastic;           ///< forces [N] of the sides and from outside; then 0
    Components own[maxChannels];  ///< forces [N] of each channel, then 0; only with sums, else they are in `elastic`
    int channels = 0;             ///< their number; that of drag has weights instead of forces
    double* dragWeight = nullptr; ///< see nodeDrag(); then 0; none: no drag
    const double* mass = nullptr; ///< [kg]
    double dt = 0.;               ///< [s]
    double dragFactor = 0.;       ///< [kg/m³]
    double localDamping = 0.;     ///< YADE's damping of NewtonIntegrator [-]
    Eigen::Vector3d gravity = Eigen::Vector3d::Zero(); ///< [m/s²]
    double centrifugal = 0.; ///< omega² [1/s²] of a frame that turns about z; not counted in the sums
};

/// Sums over nodes for the energy ledger.
struct MotionSums {
    double power[maxChannels] = {}; ///< of each channel, at the mean of v- and v+ [W]
    double torque = 0.;             ///< about z, of all forces [N m]
    // Only with Sums::energies:
    double arriving[maxChannels] = {}; ///< power of each channel, at v- [W]
    double kinetic = 0.;               ///< m v- v+ / 2 [J]
    double potential = 0.;             ///< -m g x [J]
    double angularMomentum = 0.;       ///< about z, at the mean of v- and v+ [N m s]

    void add(const MotionSums& more);
};

/// Moves the nodes begin..end-1 by one step of YADE's leapfrog: v += dt a, x += dt v.
/// \param wanted sums, which are added to `sums`
/// \return 0 if all new positions are finite, else NaN
double moveNodes(int begin, int end, const Motion& motion, Sums wanted, MotionSums& sums);

} // namespace membrane

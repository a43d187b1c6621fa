// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace membrane {

/// Levers 1/l_AB in (8) and 1/height in the conservative law stay below 1/(this fraction of the rest length).
constexpr double leverFloor = 0.05;

/// A crease AB between the triangles ABC and BAD, at rest. Seen from the side where the corners of ABC run
/// counter-clockwise, a mountain (sign +1) closes away from the eye and a valley (sign -1) towards it.
struct CreaseRest {
    double length = 0.;  ///< l_AB [m]
    double heightC = 0.; ///< l_CE [m], E the foot of C on AB
    double heightD = 0.; ///< l_DF [m], F the foot of D on AB
    double sign = 1.;    ///< +1 mountain, -1 valley

    /// 1/l_AB does not exceed this in (8) [1/m].
    double steepestLever() const { return 1. / (leverFloor * length); }
    /// l_AB / l_CE² and l_AB / l_DF² in (7) [1/m].
    double slopeC() const { return length / (heightC * heightC); }
    double slopeD() const { return length / (heightD * heightD); }
};

/// Parameters of the crease law, paper equation (7).
struct CreaseLaw {
    double bending = 0.;       ///< beta E J [N m], J = h³/12
    double penalty = 100.;     ///< gamma [-], stiffens theta < 0 where the faces have passed through each other
    double naturalAngle = 0.;  ///< theta0 [rad]
    bool conservative = false; ///< false: (7) as printed; true: minus the gradient of creaseEnergy()
    double perLength = 0.;     ///< kappa [N], stiffness of a unit length, whatever the triangles; only conservative

    bool isThere() const { return bending > 0. || perLength > 0.; }
};

/// Where a crease is: its angle and how that angle changes as the four nodes move.
struct CreaseState {
    double theta = 0.;                 ///< angle between the triangles [rad], 0 closed, pi flat, in (-pi/2, 3 pi/2]
    Eigen::Vector3d openC, openD;      ///< unit vectors along which C and D move to open the crease; 0 if collapsed
    double heightC = 0., heightD = 0.; ///< current heights l_CE, l_DF [m]
    double footC = 0., footD = 0.; ///< l_AE / l_AB and l_AF / l_AB, signed: outside [0, 1] if the foot is outside AB
};

/// Forces [N] on the nodes of a crease.
struct CreaseForces {
    Eigen::Vector3d a, b, c, d;
};

/// Current heights and lengths below this fraction of the rest value count as collapsed: nothing is divided by them.
constexpr double collapsedFraction = 1e-6;

/// Angle and directions of a crease from its nodes' positions [m]. Without branches, so that loops over creases are
/// vectorised. Rest is CreaseRest, or what has the same members.
template <class Rest>
inline CreaseState creaseState(const Rest& rest, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                               const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
    CreaseState s;
    const Eigen::Vector3d span = b - a, toC = c - a, toD = d - a;
    const double length = span.norm();
    const bool whole = length > collapsedFraction * rest.length;
    const double inverse = whole ? 1. / length : 0.; // without an axis there is neither angle nor force
    // Twice the areas of ABC and ABD; as vectors they are the heights, turned about AB by a right angle.
    const Eigen::Vector3d areaC = span.cross(toC), areaD = span.cross(toD);
    const double doubleC = areaC.norm(), doubleD = areaD.norm();
    s.heightC = inverse * doubleC;
    s.heightD = inverse * doubleD;
    const double lever = std::min(inverse, rest.steepestLever()) * inverse;
    s.footC = lever * toC.dot(span);
    s.footD = lever * toD.dot(span);

    // The branch cut of atan2 is moved from pi (flat) to -pi/2, away from both closed and flat.
    constexpr double pi = 3.14159265358979323846;
    const double angle = atan2(-rest.sign * length * areaC.dot(toD), areaC.dot(areaD));
    s.theta = whole ? (angle <= -0.5 * pi ? angle + 2. * pi : angle) : 0.;

    const double inverseC = s.heightC > collapsedFraction * rest.heightC ? 1. / doubleC : 0.;
    const double inverseD = s.heightD > collapsedFraction * rest.heightD ? 1. / doubleD : 0.;
    s.openC = (rest.sign * inverseC) * areaC;
    s.openD = (-rest.sign * inverseD) * areaD;
    return s;
}

/// Stiffness K [N m/rad] of a crease: beta E J l_AB / l, l the mean of the two rest heights, or kappa l_AB.
template <class Rest> inline double creaseStiffness(const Rest& rest, const CreaseLaw& law) {
    return law.bending * rest.length / (0.5 * (rest.heightC + rest.heightD)) + law.perLength * rest.length;
}

/// Stiffness kappa [N] of a unit length of a crease: D / L*, D = E h³ / (12 (1 - nu²)) that of the film.
/// \param creaseLength L* [m] > 0, the crease's own length (Lechenault et al. 2014)
inline double creaseStiffnessPerLength(double young, double poisson, double thickness, double creaseLength) {
    return young * thickness * thickness * thickness / (12. * (1. - poisson * poisson) * creaseLength);
}

/// Energy [J] of the conservative law: K [ (theta - theta0)²/2 + (gamma - 1) min(theta, 0)²/2 ].
/// It is also the energy of (7) where the heights are equal, uncollapsed and theta0 = 0.
inline double creaseEnergy(const CreaseRest& rest, const CreaseLaw& law, double theta) {
    const double open = theta - law.naturalAngle, overlap = std::min(theta, 0.);
    return 0.5 * creaseStiffness(rest, law) * (open * open + (law.penalty - 1.) * overlap * overlap);
}

/// Forces on C and D by (7) or its conservative form, and on A and B by (8), which make the sum zero.
template <class Rest> inline CreaseForces creaseForces(const Rest& rest, const CreaseLaw& law, const CreaseState& s) {
    double forceC, forceD; // along openC and openD
    if (law.conservative) {
        const double moment =
            -creaseStiffness(rest, law) * (s.theta - law.naturalAngle + (law.penalty - 1.) * std::min(s.theta, 0.));
        forceC = moment / std::max(s.heightC, leverFloor * rest.heightC);
        forceD = moment / std::max(s.heightD, leverFloor * rest.heightD);
    } else {
        const double gamma = s.theta >= 0. ? 1. : law.penalty;
        const double moment = -law.bending * gamma * (s.theta - law.naturalAngle);
        forceC = moment * rest.slopeC();
        forceD = moment * rest.slopeD();
    }
    CreaseForces f;
    f.c = forceC * s.openC;
    f.d = forceD * s.openD;
    f.a = -(1. - s.footC) * f.c - (1. - s.footD) * f.d;
    f.b = -s.footC * f.c - s.footD * f.d;
    return f;
}

} // namespace membrane

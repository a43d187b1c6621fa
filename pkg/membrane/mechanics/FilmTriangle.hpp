// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace membrane {

/// A film in plane stress that wrinkles: a tension field with a buckling stress.
struct FilmLaw {
    double young = 0.;     ///< E [Pa] > 0
    double poisson = 0.;   ///< nu [-] in (-1, 1/2]
    double thickness = 0.; ///< h [m] > 0
    double buckling = 0.;  ///< sigma_b [Pa] >= 0, the compression that it bears at most
    double time = 0.;      ///< damping time tau [s] >= 0

    /// Mean stress by trace of strain, and difference of the principal stresses by that of the strains [Pa]; both taut.
    double meanModulus() const { return young / (2. * (1. - poisson)); }
    double shearModulus() const { return young / (1. + poisson); }
};

/// Stress [Pa] under which a film of thickness h buckles in half-waves of length l_b: E pi² h² / (12 (1 - nu²) l_b²).
/// \param length l_b [m] > 0
inline double bucklingStress(double young, double poisson, double thickness, double length) {
    constexpr double pi = 3.14159265358979323846;
    return young * pi * pi * thickness * thickness / (12. * (1. - poisson * poisson) * length * length);
}

/// A triangle at rest. Side i lies opposite corner i and runs from corner i + 1 to i + 2. With q_i = l_i² - L_i² of its
/// present sides the Green strain has the trace sum of trace_i q_i and, in axes of the triangle's own, the difference
/// E_xx - E_yy = sum of normal_i q_i and twice the shear 2 E_xy = sum of shear_i q_i.
struct FilmRest {
    double square[3] = {0., 0., 0.};                          ///< L_i² [m²]
    double trace[3] = {0., 0., 0.}, normal[3] = {0., 0., 0.}; ///< [1/m²]
    double shear[3] = {0., 0., 0.};                           ///< [1/m²]
    double area = 0.;                                         ///< S [m²]

    FilmRest() = default;
    /// \param a, b, c corners [m]; x runs along the side from b to c
    FilmRest(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
        const Eigen::Vector3d side[3] = {c - b, a - c, b - a};
        const Eigen::Vector3d along = side[0].normalized();
        area = 0.5 * side[0].cross(side[1]).norm();
        const Eigen::Vector3d across = side[0].cross(side[1]).cross(along).normalized();
        const double inverse = 1. / (8. * area * area);
        for (int i = 0; i < 3; ++i) {
            const Eigen::Vector3d &one = side[(i + 1) % 3], &other = side[(i + 2) % 3];
            const double x1 = one.dot(along), y1 = one.dot(across), x2 = other.dot(along), y2 = other.dot(across);
            square[i] = side[i].squaredNorm();
            trace[i] = -inverse * (x1 * x2 + y1 * y2);
            normal[i] = inverse * (x1 * x2 - y1 * y2);
            shear[i] = inverse * (x1 * y2 + y1 * x2);
        }
    }
};

/// Green strain of a triangle.
struct FilmStrain {
    double trace, normal, shear; ///< E1 + E2, E_xx - E_yy, 2 E_xy [-]
    double half;                 ///< half the difference E1 - E2 of the principal strains [-]

    double first() const { return 0.5 * trace + half; }
    double second() const { return 0.5 * trace - half; }
};

/// \param q l_i² - L_i² [m²];  \param rest FilmRest, or what has the same members
template <class Rest> inline FilmStrain filmStrain(const Rest& rest, const Eigen::Vector3d& q) {
    FilmStrain s;
    s.trace = rest.trace[0] * q[0] + rest.trace[1] * q[1] + rest.trace[2] * q[2];
    s.normal = rest.normal[0] * q[0] + rest.normal[1] * q[1] + rest.normal[2] * q[2];
    s.shear = rest.shear[0] * q[0] + rest.shear[1] * q[1] + rest.shear[2] * q[2];
    s.half = 0.5 * std::sqrt(s.normal * s.normal + s.shear * s.shear);
    return s;
}

enum class FilmState : int { taut = 0, wrinkled = 1, slack = 2 };

/// Whether a film bears its strain without wrinkles. The criterion is the one of stress and strain: strain alone fails
/// in uniaxial tension.
inline bool isTaut(const FilmLaw& law, const FilmStrain& strain) {
    const double e = law.buckling / law.young, nu = law.poisson;
    return 0.5 * (1. + nu) * strain.trace + (1. - nu * nu) * e >= (1. - nu) * strain.half;
}

/// By how much the first principal strain is above that of a slack film [-]; below 0 it is one, unless it is taut.
inline double beyondSlack(const FilmLaw& law, const FilmStrain& strain) {
    return strain.first() + (1. - law.poisson) * (law.buckling / law.young);
}

/// Taut without wrinkles, wrinkled across the first principal stress, or slack: compressed in both directions.
inline FilmState filmState(const FilmLaw& law, const FilmStrain& strain) {
    if (isTaut(law, strain)) return FilmState::taut;
    return beyondSlack(law, strain) >= 0. ? FilmState::wrinkled : FilmState::slack;
}

/// Second Piola-Kirchhoff stress, whose principal axes are those of the strain: E E1 - nu sigma_b and -sigma_b where
/// wrinkled, both -sigma_b where slack.
struct FilmStress {
    double mean;  ///< of the principal stresses [Pa]
    double shear; ///< their difference over that of the principal strains [Pa], in [0, shearModulus()]
};

/// Without branches, and without a quotient that may be unbounded: where the principal strains come close to one
/// another the film is taut or slack.
inline FilmStress filmStress(const FilmLaw& law, const FilmStrain& strain) {
    const double beyond = beyondSlack(law, strain);
    const bool taut = isTaut(law, strain);
    const double ratio = strain.half > 0. ? 0.5 * law.young * beyond / strain.half : 0.;
    const double wrinkledMean =
        beyond >= 0. ? 0.5 * (law.young * strain.first() - (1. + law.poisson) * law.buckling) : -law.buckling;
    const double wrinkledShear = beyond >= 0. ? std::min(ratio, law.shearModulus()) : 0.;
    return {taut ? law.meanModulus() * strain.trace : wrinkledMean, taut ? law.shearModulus() : wrinkledShear};
}

/// Energy [J/m³] of a strain, a convex function of it: the least over all wrinkles.
inline double filmEnergyDensity(const FilmLaw& law, const FilmStrain& strain) {
    const double e = law.buckling / law.young, nu = law.poisson, first = strain.first();
    const double ofTaut =
        0.5 * law.meanModulus() * strain.trace * strain.trace + law.shearModulus() * strain.half * strain.half;
    const double ofWrinkled = 0.5 * law.young * first * first - law.buckling * (nu * first + strain.second()) -
                              0.5 * law.buckling * e * (1. - nu * nu);
    const double ofSlack = -law.buckling * strain.trace - law.buckling * e * (1. - nu);
    return isTaut(law, strain) ? ofTaut : beyondSlack(law, strain) >= 0. ? ofWrinkled : ofSlack;
}

/// Energy [J] of a triangle. \param q l_i² - L_i² [m²]
inline double filmEnergy(const FilmLaw& law, const FilmRest& rest, const Eigen::Vector3d& q) {
    return law.thickness * rest.area * filmEnergyDensity(law, filmStrain(rest, q));
}

/// Its gradient g by q [N/m]: side i pulls its ends together with 2 g_i times its length.
///
/// With damping it is taken at q + tau dq/dt: Kelvin's and Voigt's film with one time tau, which never pushes with more
/// than the buckling stress, and takes energy, for the energy is convex in q.
template <class Rest>
inline Eigen::Vector3d filmGradient(const FilmLaw& law, const Rest& rest, const Eigen::Vector3d& q) {
    const FilmStrain strain = filmStrain(rest, q);
    const FilmStress stress = filmStress(law, strain);
    const double volume = law.thickness * rest.area, half = 0.5 * stress.shear;
    Eigen::Vector3d g;
    for (int i = 0; i < 3; ++i)
        g[i] = volume *
               (stress.mean * rest.trace[i] + half * (strain.normal * rest.normal[i] + strain.shear * rest.shear[i]));
    return g;
}

/// Present sides of a triangle [m].
struct FilmSides {
    Eigen::Vector3d side[3];

    FilmSides(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c)
        : side{c - b, a - c, b - a} {}

    /// l_i² - L_i² [m²].
    template <class Rest> Eigen::Vector3d grown(const Rest& rest) const {
        return {side[0].squaredNorm() - rest.square[0], side[1].squaredNorm() - rest.square[1],
                side[2].squaredNorm() - rest.square[2]};
    }
    /// Its rate [m²/s]. \param velocities of the corners [m/s]
    Eigen::Vector3d growing(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) const {
        return {2. * side[0].dot(c - b), 2. * side[1].dot(a - c), 2. * side[2].dot(b - a)};
    }
    /// Forces [N] on the corners. \param g filmGradient() [N/m]
    void forces(const Eigen::Vector3d& g, Eigen::Vector3d (&onCorner)[3]) const {
        const Eigen::Vector3d pull[3] = {2. * g[0] * side[0], 2. * g[1] * side[1], 2. * g[2] * side[2]};
        onCorner[0] = pull[2] - pull[1];
        onCorner[1] = pull[0] - pull[2];
        onCorner[2] = pull[1] - pull[0];
    }
};

/// Stiffness [N/m] of a triangle's side i for small strains, the other two held.
inline double filmSideStiffness(const FilmLaw& law, const FilmRest& rest, int i) {
    const double t = rest.trace[i], n = rest.normal[i], s = rest.shear[i];
    return 4. * rest.square[i] * law.thickness * rest.area *
           (law.meanModulus() * t * t + 0.5 * law.shearModulus() * (n * n + s * s));
}

} // namespace membrane

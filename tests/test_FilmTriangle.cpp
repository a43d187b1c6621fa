// SPDX-License-Identifier: GPL-2.0-or-later
// A film of plane stress that wrinkles: against Hooke's law written with tensors, and direct minimisation.
#include "pkg/membrane/mechanics/FilmTriangle.hpp"
#include "shapes.hpp"
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

using namespace membrane;
using Eigen::Matrix2d;
using Eigen::Vector2d;
using shapes::Vector3d;

namespace {

FilmLaw law(double buckling = 0.) {
    FilmLaw l;
    l.young = 3.2, l.poisson = 0.34, l.thickness = 0.7, l.buckling = buckling;
    return l;
}

/// Energy density of plane stress.
double hooke(const FilmLaw& l, const Matrix2d& e) {
    const double nu = l.poisson;
    return l.young / (2. * (1. - nu * nu)) * ((1. - nu) * e.squaredNorm() + nu * e.trace() * e.trace());
}

FilmStrain strainOf(const Matrix2d& e) {
    FilmStrain s;
    s.trace = e.trace(), s.normal = e(0, 0) - e(1, 1), s.shear = 2. * e(0, 1);
    s.half = 0.5 * std::hypot(s.normal, s.shear);
    return s;
}

Matrix2d turned(double first, double second, double angle) {
    const Matrix2d r = Eigen::Rotation2Dd(angle).toRotationMatrix();
    return r * Vector2d(first, second).asDiagonal() * r.transpose();
}

/// Least of hooke(e + p) + buckling trace(p) over wrinkles p = R diag(a², b²) R^T, by a search that narrows.
double relaxed(const FilmLaw& l, const Matrix2d& e) {
    Vector3d best(0., 0., 0.);
    const auto value = [&](const Vector3d& v) {
        const Matrix2d p = turned(v[0] * v[0], v[1] * v[1], v[2]);
        return hooke(l, e + p) + l.buckling * p.trace();
    };
    shapes::Random random(3);
    double least = value(best);
    for (double size = 0.5; size > 1e-9; size *= 0.93)
        for (int tried = 0; tried < 60; ++tried) {
            const Vector3d next = best + Vector3d(size, size, 6. * size).cwiseProduct(random.vector());
            if (const double found = value(next); found < least) least = found, best = next;
        }
    return least;
}

TEST(FilmTriangle, StrainIsThatOfTheDeformationGradient) {
    shapes::Random random(1);
    for (int tried = 0; tried < 50; ++tried) {
        const Vector2d x[3] = {random.vector().head<2>(), random.vector().head<2>(), random.vector().head<2>()};
        const auto flat = [&](int i) { return Vector3d(x[i][0], x[i][1], 0.); };
        const FilmRest rest(flat(0), flat(1), flat(2));
        if (rest.area < 0.02) continue;
        Eigen::Matrix<double, 3, 2> gradient;
        gradient << random.vector(), random.vector();
        const Vector3d now[3] = {gradient * x[0], gradient * x[1], gradient * x[2]};
        const FilmStrain found = filmStrain(rest, FilmSides(now[0], now[1], now[2]).grown(rest));
        const Matrix2d e = 0.5 * (gradient.transpose() * gradient - Matrix2d::Identity());
        const Vector2d principal = Eigen::SelfAdjointEigenSolver<Matrix2d>(e).eigenvalues();
        EXPECT_NEAR(found.second(), principal[0], 1e-12 / rest.area);
        EXPECT_NEAR(found.first(), principal[1], 1e-12 / rest.area);
    }
}

TEST(FilmTriangle, EnergyIsTheLeastOverAllWrinkles) {
    for (const double buckling : {0., 0.03, 0.3})
        for (const double first : {-0.3, -0.06, -0.01, 0.02, 0.1, 0.4})
            for (const double second : {-0.5, -0.1, -0.02, 0.01, 0.1}) {
                if (second > first) continue;
                const FilmLaw l = law(buckling);
                const Matrix2d e = turned(first, second, 0.7);
                EXPECT_NEAR(filmEnergyDensity(l, strainOf(e)), relaxed(l, e), 2e-7)
                    << buckling << " " << first << " " << second;
                EXPECT_LE(filmEnergyDensity(l, strainOf(e)), hooke(l, e) + 1e-14);
            }
}

TEST(FilmTriangle, TautFilmIsHookes) {
    const FilmLaw l = law(10.);
    const Matrix2d e = turned(0.3, -0.2, 0.4);
    EXPECT_EQ(filmState(l, strainOf(e)), FilmState::taut);
    EXPECT_NEAR(filmEnergyDensity(l, strainOf(e)), hooke(l, e), 1e-15);
}

TEST(FilmTriangle, UniaxialTensionIsTautWithoutCompressiveStrength) {
    // By strain alone it would be called wrinkled, as it contracts across.
    const FilmLaw l = law();
    EXPECT_EQ(filmState(l, strainOf(turned(0.1, -0.34 * 0.1 * (1. - 1e-9), 0.2))), FilmState::taut);
    EXPECT_EQ(filmState(l, strainOf(turned(0.1, -0.34 * 0.1 * (1. + 1e-9), 0.2))), FilmState::wrinkled);
}

TEST(FilmTriangle, PrincipalStressesAreThoseOfTheState) {
    const FilmLaw l = law(0.05);
    const auto stressOf = [&](double first, double second) {
        const FilmStrain s = strainOf(turned(first, second, 1.1));
        const FilmStress stress = filmStress(l, s);
        return Vector2d(stress.mean + stress.shear * s.half, stress.mean - stress.shear * s.half);
    };
    const Vector2d wrinkled = stressOf(0.1, -0.2), slack = stressOf(-0.2, -0.3);
    EXPECT_NEAR(wrinkled[0], 3.2 * 0.1 - 0.34 * 0.05, 1e-15);
    EXPECT_NEAR(wrinkled[1], -0.05, 1e-15);
    EXPECT_NEAR(slack[0], -0.05, 1e-15);
    EXPECT_NEAR(slack[1], -0.05, 1e-15);
}

TEST(FilmTriangle, GradientIsThatOfTheEnergyInEveryState) {
    shapes::Random random(2);
    int seen[3] = {0, 0, 0};
    for (int tried = 0; tried < 300; ++tried) {
        const FilmLaw l = law(tried % 3 * 0.02);
        const FilmRest rest(Vector3d(0.1, 0.2, 0.), Vector3d(1., 0., 0.), Vector3d(0.3, 0.9, 0.));
        const Vector3d q = random.vector(0.3);
        ++seen[static_cast<int>(filmState(l, filmStrain(rest, q)))];
        const Vector3d g = filmGradient(l, rest, q);
        for (int i = 0; i < 3; ++i) {
            const Vector3d step = 1e-6 * Vector3d::Unit(i);
            EXPECT_NEAR(g[i], (filmEnergy(l, rest, q + step) - filmEnergy(l, rest, q - step)) / 2e-6, 1e-8);
        }
    }
    for (const int times : seen) EXPECT_GT(times, 20);
}

TEST(FilmTriangle, GradientIsMonotoneSoThatDampingTakesEnergy) {
    shapes::Random random(4);
    const FilmRest rest(Vector3d(0., 0.8, 0.), Vector3d(1., 0., 0.), Vector3d(0.3, 0.9, 0.));
    for (int tried = 0; tried < 3000; ++tried) {
        const FilmLaw l = law(tried % 2 * 0.03);
        const Vector3d q = random.vector(0.2), rate = random.vector(0.2);
        EXPECT_GE((filmGradient(l, rest, q + rate) - filmGradient(l, rest, q)).dot(rate), -1e-15);
    }
}

TEST(FilmTriangle, StressStaysBoundedWherePrincipalStrainsMeet) {
    for (const double buckling : {0., 1e-12, 0.03, 1e6}) {
        const FilmLaw l = law(buckling);
        const double corner = -(1. - l.poisson) * buckling / l.young; // where all three states meet
        for (const double off : {0., 1e-300, 1e-18, 1e-9})
            for (const double across : {0., 1e-300, 1e-17, 1e-9}) {
                const FilmStrain s = strainOf(turned(corner + off, corner - across, 0.3));
                const FilmStress stress = filmStress(l, s);
                EXPECT_TRUE(std::isfinite(stress.mean) && std::isfinite(stress.shear));
                EXPECT_GE(stress.shear, 0.);
                EXPECT_LE(stress.shear, l.shearModulus());
            }
    }
}

TEST(FilmTriangle, AnEquilateralTriangleWithAThirdIsThreeSprings) {
    // The sides' coupling vanishes there, and each has the stiffness sqrt(3)/4 E h of (5).
    FilmLaw l = law();
    l.poisson = 1. / 3.;
    const FilmRest rest(Vector3d(0., 0., 0.), Vector3d(1., 0., 0.), Vector3d(0.5, std::sqrt(0.75), 0.));
    const double k = std::sqrt(3.) / 4. * l.young * l.thickness;
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(filmSideStiffness(l, rest, i), k, 1e-14);
        const Vector3d g = filmGradient(l, rest, 1e-3 * Vector3d::Unit(i));
        EXPECT_NEAR(g[(i + 1) % 3], 0., 1e-15);
        EXPECT_NEAR(g[(i + 2) % 3], 0., 1e-15);
    }
}

TEST(FilmTriangle, AnyTriangleHasAPositiveStiffness) {
    for (const double height : {1e-3, 0.1, 0.5, 3.})
        for (const double nu : {-0.5, 0., 0.34, 0.5}) {
            FilmLaw l = law();
            l.poisson = nu;
            const FilmRest rest(Vector3d(0.5, height, 0.), Vector3d(0., 0., 0.), Vector3d(1., 0., 0.));
            for (int i = 0; i < 3; ++i) EXPECT_GT(filmSideStiffness(l, rest, i), 0.);
        }
}

TEST(FilmTriangle, BucklingStressIsThatOfALongPlateStrip) {
    // 3.2 GPa, 7.5 um, nu 0.34, half-waves of 2.26 mm: 33 kPa (E pi² h² / (12 (1 - nu²) l²)).
    EXPECT_NEAR(bucklingStress(3.2e9, 0.34, 7.5e-6, 2.26e-3), 3.2775e4, 5.);
}

} // namespace

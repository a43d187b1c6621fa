// SPDX-License-Identifier: GPL-2.0-or-later
// Masses and stiffnesses of a triangle: paper equations (4) and (5).
#include "pkg/membrane/mechanics/TriangleStiffness.hpp"
#include "shapes.hpp"
#include <array>
#include <gtest/gtest.h>

using namespace membrane;
using shapes::Matrix3d;
using shapes::Vector3d;

namespace {

using Triangle = std::array<Vector3d, 3>;

const Triangle equilateral{Vector3d(0., 0., 0.), Vector3d(1., 0., 0.), Vector3d(0.5, std::sqrt(0.75), 0.)};
const Triangle rightIsosceles{Vector3d(0., 0., 0.), Vector3d(1., 0., 0.), Vector3d(0., 1., 0.)};
const Triangle flat{Vector3d(0.5, 0.1, 0.), Vector3d(0., 0., 0.), Vector3d(1., 0., 0.)};
const Triangle at120Degrees{Vector3d(0.5, 0.5 / std::sqrt(3.), 0.), Vector3d(0., 0., 0.), Vector3d(1., 0., 0.)};
const Triangle scalene{Vector3d(0., 0., 0.), Vector3d(1., 0.1, 0.), Vector3d(0.3, 0.8, 0.)};

/// Side i lies opposite corner i and runs from corner i + 1 to corner i + 2.
Vector3d side(const Triangle& t, int i) {
    return t[(i + 2) % 3] - t[(i + 1) % 3];
}

Vector3d lengths(const Triangle& t) {
    return {side(t, 0).norm(), side(t, 1).norm(), side(t, 2).norm()};
}

Triangle scaled(const Triangle& t, double scale) {
    return {scale * t[0], scale * t[1], scale * t[2]};
}

Vector3d stiffness(const Triangle& t, double young, double poisson, double thickness) {
    return triangleStiffness(lengths(t), triangleArea(t[0], t[1], t[2]), young, poisson, thickness);
}

void expectNear(const Vector3d& seen, const Vector3d& expected, double tolerance) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(seen[i], expected[i], tolerance) << "side " << i;
}

TEST(TriangleStiffness, EquilateralIs04330OnEverySide) {
    expectNear(stiffness(equilateral, 1., 0.34, 1.), Vector3d::Constant(0.4330), 1e-4);
}

TEST(TriangleStiffness, EquilateralAtPoissonOneThirdIsExactlySqrt3Over4) {
    // There each side keeps its length when another one is pulled, so its spring holds all the energy alone.
    expectNear(stiffness(equilateral, 1., 1. / 3., 1.), Vector3d::Constant(0.25 * std::sqrt(3.)), 1e-14);
}

TEST(TriangleStiffness, RightIsoscelesIs02056OnTheHypotenuseAnd04081OnTheLegs) {
    expectNear(stiffness(rightIsosceles, 1., 0.34, 1.), {0.2056, 0.4081, 0.4081}, 1e-4);
}

TEST(TriangleStiffness, BaseOfAFlatTriangleIsNegative) {
    expectNear(stiffness(flat, 1., 0.34, 1.), {-0.3209, 0.7928, 0.7928}, 1e-4);
}

TEST(TriangleStiffness, SignOfTheBaseAt120DegreesDependsOnPoisson) {
    EXPECT_NEAR(stiffness(at120Degrees, 1., 0., 1.)[0], -0.0210, 1e-4);
    EXPECT_NEAR(stiffness(at120Degrees, 1., 0.34, 1.)[0], 0.0274, 1e-4);
}

TEST(TriangleStiffness, UniaxialStressAlongEachSideStoresTheMembranesEnergy) {
    shapes::Random random(3);
    const double young = 3.2, thickness = 0.7, stress = 0.05;
    for (double scale : shapes::scales) {
        for (double poisson : {-0.5, 0., 0.34, 0.5}) {
            for (int trial = 0; trial < 20; ++trial) {
                const Matrix3d rotation = random.rotation();
                Triangle t = scalene;
                for (Vector3d& corner : t)
                    corner = scale * rotation *
                             (corner + Vector3d(random.between(-0.2, 0.2), random.between(-0.2, 0.2), 0.));
                const double area = triangleArea(t[0], t[1], t[2]);
                const Vector3d k = triangleStiffness(lengths(t), area, young, poisson, thickness);
                for (int i = 0; i < 3; ++i) {
                    // Plane stress: strain = [(1 + nu) e e - nu 1] sigma / E, e the direction of the stress.
                    const Vector3d e = side(t, i).normalized();
                    const Matrix3d strain =
                        stress / young * ((1. + poisson) * e * e.transpose() - poisson * Matrix3d::Identity());
                    double energy = 0.;
                    for (int j = 0; j < 3; ++j) {
                        const Vector3d along = side(t, j).normalized();
                        const double stretch = along.dot(strain * along) * side(t, j).norm();
                        energy += 0.5 * k[j] * stretch * stretch;
                    }
                    const double membraneEnergy = 0.5 * stress * stress / young * thickness * area;
                    EXPECT_NEAR(energy / membraneEnergy, 1., 1e-10) << "scale " << scale << " side " << i;
                }
            }
        }
    }
}

TEST(TriangleStiffness, DependsOnTheShapeAloneNotOnTheSize) {
    for (const Triangle& t : {equilateral, rightIsosceles, flat, scalene}) {
        const Vector3d k = stiffness(t, 1., 0.34, 1.);
        for (double scale : shapes::scales)
            EXPECT_LT((stiffness(scaled(t, scale), 1., 0.34, 1.) - k).norm(), 1e-11 * k.norm());
    }
}

TEST(TriangleStiffness, IsProportionalToYoungTimesThickness) {
    const Vector3d k = stiffness(scalene, 1., 0.34, 1.);
    expectNear(stiffness(scalene, 3.2e9, 0.34, 7.5e-6) / (3.2e9 * 7.5e-6), k, 1e-14);
}

TEST(TriangleStiffness, FollowsTheOrderOfTheSides) {
    const Vector3d k = stiffness(scalene, 1., 0.34, 1.);
    ASSERT_GT(std::abs(k[0] - k[1]), 0.01);
    expectNear(stiffness({scalene[1], scalene[2], scalene[0]}, 1., 0.34, 1.), {k[1], k[2], k[0]}, 1e-14);
    expectNear(stiffness({scalene[1], scalene[0], scalene[2]}, 1., 0.34, 1.), {k[1], k[0], k[2]}, 1e-14);
}

TEST(TriangleStiffness, WithoutAreaIsNotFinite) {
    EXPECT_FALSE(triangleStiffness({1., 0.4, 0.6}, 0., 1., 0.34, 1.).allFinite());
}

TEST(TriangleStiffness, OfASliverKeepsItsSignsOrIsNotFinite) {
    // The exact base stiffness tends to -0.03743 E h base / height, the sides' to 0.07485.
    for (double height : {1e-3, 1e-4, 3e-5, 1e-5, 1e-6}) {
        const double slanted = std::hypot(0.5, height);
        const Vector3d k = triangleStiffness({1., slanted, slanted}, 0.5 * height, 1., 0.34, 1.);
        if (!k.allFinite()) continue;
        EXPECT_NEAR(k[0] * height, -0.0374251, 1e-3) << "height " << height;
        EXPECT_NEAR(k[1] * height, 0.0748503, 2e-3) << "height " << height;
    }
}

TEST(TriangleArea, IsHalfBaseTimesHeightAtAnyPlaceAndScale) {
    shapes::Random random(4);
    EXPECT_DOUBLE_EQ(triangleArea(flat[0], flat[1], flat[2]), 0.05);
    for (double scale : shapes::scales) {
        const auto t = shapes::placed({flat[0], flat[1], flat[2]}, scale, random.rotation(), random.vector());
        EXPECT_NEAR(triangleArea(t[0], t[1], t[2]) / (scale * scale), 0.05, 1e-14);
    }
}

TEST(TriangleArea, IsZeroOnALine) {
    EXPECT_EQ(triangleArea({1., 1., 1.}, {2., 2., 2.}, {4., 4., 4.}), 0.);
}

TEST(CornerMass, IsAThirdOfTheFilms) {
    // 3 m² of 7.5 um of 1420 kg/m³ weigh 31.95 g.
    EXPECT_NEAR(cornerMass(3., 1420., 7.5e-6), 0.01065, 1e-12);
}

} // namespace

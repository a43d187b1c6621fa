// SPDX-License-Identifier: GPL-2.0-or-later
// Air drag on the corners of a triangle: paper equation (10).
#include "pkg/membrane/mechanics/Drag.hpp"
#include "shapes.hpp"
#include <gtest/gtest.h>

using membrane::cornerDrag;
using membrane::cornerDragSlope;
using shapes::Vector3d;

namespace {

constexpr double density = 1.2, area = 0.5;
const Vector3d facing(0., 0., 2. * area); // twice the area, along the normal

TEST(Drag, FaceOnItIsASixthOfRhoSVSquared) {
    const Vector3d force = cornerDrag(density, facing, {0., 0., 3.});
    EXPECT_NEAR(force.z(), -1.2 * 0.5 * 9. / 6., 1e-15);
    EXPECT_EQ(force.x(), 0.);
    EXPECT_EQ(force.y(), 0.);
}

TEST(Drag, EdgeOnAtRestOrWithoutAirThereIsNone) {
    EXPECT_EQ(cornerDrag(density, facing, {3., -4., 0.}), Vector3d::Zero());
    EXPECT_EQ(cornerDrag(density, facing, Vector3d::Zero()), Vector3d::Zero());
    EXPECT_EQ(cornerDrag(density, Vector3d::Zero(), {1., 2., 3.}), Vector3d::Zero());
    EXPECT_EQ(cornerDrag(0., facing, {1., 2., 3.}), Vector3d::Zero());
}

TEST(Drag, ObliqueItTakesTheAreaProjectedAlongTheVelocity) {
    for (double angle : {0.1, 0.7, 1.2, 2., 3.}) {
        const double speed = 4.;
        const Vector3d velocity = speed * Vector3d(std::sin(angle), 0., std::cos(angle));
        const double expected = density * area * std::abs(std::cos(angle)) * speed * speed / 6.;
        EXPECT_LT((cornerDrag(density, facing, velocity) + expected * velocity / speed).norm(), 1e-14);
    }
}

TEST(Drag, BothFacesAreAlikeAndReversedMotionReversesIt) {
    const Vector3d velocity(1., -2., 0.7), force = cornerDrag(density, facing, velocity);
    ASSERT_GT(force.norm(), 0.1);
    EXPECT_EQ(cornerDrag(density, -facing, velocity), force);
    EXPECT_EQ(cornerDrag(density, facing, -velocity), -force);
}

TEST(Drag, TurnsWithTriangleAndVelocity) {
    shapes::Random random(2);
    for (int i = 0; i < 20; ++i) {
        const Vector3d normal = random.vector(), velocity = random.vector();
        const auto rotation = random.rotation();
        const Vector3d expected = rotation * cornerDrag(density, normal, velocity);
        EXPECT_LT((cornerDrag(density, rotation * normal, rotation * velocity) - expected).norm(), 1e-14);
    }
}

TEST(Drag, GrowsWithTheSquareOfSpeedAndOfSize) {
    const Vector3d velocity(1., -2., 0.7), force = cornerDrag(density, facing, velocity);
    for (double scale : shapes::scales) {
        EXPECT_LT((cornerDrag(density, scale * scale * facing, velocity) / (scale * scale) - force).norm(), 1e-14);
        EXPECT_LT((cornerDrag(density, facing, scale * velocity) / (scale * scale) - force).norm(), 1e-14);
    }
}

TEST(Drag, SlopeIsNeverAboveItsBoundAndReachesItFaceOn) {
    shapes::Random random(3);
    const double step = 1e-6;
    for (int i = 0; i < 50; ++i) {
        const Vector3d normal = random.vector(), velocity = random.vector(), way = random.vector().normalized();
        const Vector3d change =
            (cornerDrag(density, normal, velocity + step * way) - cornerDrag(density, normal, velocity - step * way)) /
            (2. * step);
        EXPECT_LE(change.norm(), (1. + 1e-6) * cornerDragSlope(density, normal, velocity));
    }
    const Vector3d velocity = 3. * facing.normalized(), faster = velocity * (1. + step);
    const double slope =
        (cornerDrag(density, facing, faster) - cornerDrag(density, facing, velocity)).norm() / (3. * step);
    EXPECT_NEAR(slope / cornerDragSlope(density, facing, velocity), 1., 1e-5);
}

TEST(Drag, APlateThatFliesFaceOnSlowsDownAsTheClosedFormSays) {
    // Three corners of a third of the mass m each: m V' = -rho S V² / 2, so V = V0 / (1 + rho S V0 t / (2 m)).
    const double mass = 0.3, start = 5., end = 1.;
    const int steps = 20000;
    double speed = start;
    for (int i = 0; i < steps; ++i) { // midpoint rule
        const double half = speed + 0.5 * end / steps * cornerDrag(density, facing, {0., 0., speed}).z() / (mass / 3.);
        speed += end / steps * cornerDrag(density, facing, {0., 0., half}).z() / (mass / 3.);
    }
    EXPECT_NEAR(speed, start / (1. + density * area * start * end / (2. * mass)), 1e-7);
}

} // namespace

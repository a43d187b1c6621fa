// SPDX-License-Identifier: GPL-2.0-or-later
// Force of a side: paper equations (3), (6) and Figure 3.
#include "pkg/membrane/mechanics/SideForce.hpp"
#include "shapes.hpp"
#include <gtest/gtest.h>

using namespace membrane;
using shapes::Vector3d;

namespace {

constexpr double stiffness = 3., rest = 2., critical = 1.5;

TEST(SideForce, CriticalLengthOfATable1SideIsTheOneOfEquation6) {
    // 22 mm, 7.5 um: pi² h² / 12 = 4.6263771e-11 m², by hand.
    EXPECT_NEAR(0.022 - criticalLength(0.022, 100., 7.5e-6), 2.1028987e-7, 1e-14);
    EXPECT_NEAR(0.022 - criticalLength(0.022, 1000., 7.5e-6), 2.1028987e-6, 1e-13);
}

TEST(SideForce, CriticalStrainOfAMembraneSideIsThatOfAnEulerColumnTimesAlpha) {
    // A strip of length L and thickness h buckles at the strain pi² h² / (12 L²).
    for (double scale : shapes::scales) {
        const double length = 0.3 * scale, thickness = 0.001 * scale;
        const double euler = shapes::pi * shapes::pi * thickness * thickness / (12. * length * length);
        EXPECT_NEAR((1. - criticalLength(length, 7., thickness) / length) / (7. * euler), 1., 1e-9);
    }
}

TEST(SideForce, CriticalLengthIsNeverNegative) {
    EXPECT_EQ(criticalLength(1., 1e9, 1.), 0.);
}

TEST(SideForce, KinkEnergyIsWhatTheMeanTensionMissesOfTheWorkBetween) {
    for (double before : {0.9, 1.4, 1.6, 2.4}) {
        for (double after : {1.1, 1.45, 1.7, 2.6}) {
            const int parts = 100000; // midpoint rule for the work on the way
            double work = 0.;
            for (int i = 0; i < parts; ++i)
                work += sideTension(before + (i + 0.5) / parts * (after - before), stiffness, rest, critical) *
                        (after - before) / parts;
            const double mean =
                0.5 * (sideTension(before, stiffness, rest, critical) + sideTension(after, stiffness, rest, critical));
            const double missed = work - mean * (after - before);
            EXPECT_NEAR(kinkEnergy(before, after, stiffness, critical), missed, 1e-9) << before << " " << after;
            if ((before < critical) == (after < critical))
                EXPECT_EQ(kinkEnergy(before, after, stiffness, critical), 0.);
            else
                EXPECT_GT(std::abs(missed), 1e-3);
        }
    }
}

TEST(SideForce, CableBearsNoCompression) {
    const double slack = criticalLength(rest, 0., 1e-3);
    EXPECT_EQ(slack, rest);
    for (double length : {0., 0.5, 1.999, rest}) {
        EXPECT_EQ(sideTension(length, stiffness, rest, slack), 0.);
        EXPECT_EQ(sideEnergy(length, stiffness, rest, slack), 0.);
    }
    EXPECT_DOUBLE_EQ(sideTension(2.5, stiffness, rest, slack), 1.5);
}

TEST(SideForce, TensionIsLinearAboveTheCriticalLengthAndConstantBelowIt) {
    EXPECT_DOUBLE_EQ(sideTension(2.5, stiffness, rest, critical), 1.5);
    EXPECT_DOUBLE_EQ(sideTension(2., stiffness, rest, critical), 0.);
    EXPECT_DOUBLE_EQ(sideTension(1.75, stiffness, rest, critical), -0.75);
    for (double length : {1.5, 1.2, 0.1, 0.}) EXPECT_DOUBLE_EQ(sideTension(length, stiffness, rest, critical), -1.5);
}

TEST(SideForce, EnergyIsThatOfTheSpringUntilItBucklesAndThenGrowsLikeAConstantForce) {
    EXPECT_EQ(sideEnergy(rest, stiffness, rest, critical), 0.);
    EXPECT_DOUBLE_EQ(sideEnergy(3., stiffness, rest, critical), 1.5);
    EXPECT_DOUBLE_EQ(sideEnergy(1.75, stiffness, rest, critical), 0.09375);
    EXPECT_DOUBLE_EQ(sideEnergy(1.5, stiffness, rest, critical), 0.375);
    EXPECT_DOUBLE_EQ(sideEnergy(0.5, stiffness, rest, critical), 0.375 + 1.5);
}

TEST(SideForce, TensionIsTheSlopeOfTheEnergyAtEveryLengthAndScale) {
    for (double scale : shapes::scales) {
        for (double k : {3., -3.}) { // equation (5) gives flat triangles a negative stiffness
            for (double share : {0.2, 0.7, 0.76, 0.9, 1., 1.3, 4.}) {
                const double length = share * rest * scale, step = 1e-5 * scale;
                const auto energy = [&](double l) { return sideEnergy(l, k, rest * scale, critical * scale); };
                const double slope = (energy(length + step) - energy(length - step)) / (2. * step);
                const double tension = sideTension(length, k, rest * scale, critical * scale);
                EXPECT_NEAR(tension / scale, slope / scale, 1e-8) << "scale " << scale << " length " << share;
            }
        }
    }
}

TEST(SideForce, ForceOnTheNodesIsMinusTheEnergysGradientInRotatedStates) {
    shapes::Random random(1);
    for (double scale : shapes::scales) {
        for (double share : {0.4, 0.9, 1.2}) { // buckled, compressed, taut
            const Vector3d direction = random.rotation().col(0);
            const Vector3d a = scale * random.vector(), b = a + share * rest * scale * direction;
            const auto energy = [&](const Vector3d& end) {
                return sideEnergy((end - a).norm(), stiffness, rest * scale, critical * scale);
            };
            Vector3d slope;
            for (int i = 0; i < 3; ++i) {
                const Vector3d step = 1e-5 * scale * Vector3d::Unit(i);
                slope[i] = (energy(b + step) - energy(b - step)) / (2e-5 * scale);
            }
            const Vector3d force = -sideTension((b - a).norm(), stiffness, rest * scale, critical * scale) * direction;
            ASSERT_GT(force.norm(), 0.1 * scale);
            EXPECT_LT((force + slope).norm(), 1e-8 * force.norm()) << "scale " << scale << " length " << share;
        }
    }
}

} // namespace

// SPDX-License-Identifier: GPL-2.0-or-later
// The cheap bound of the critical time step against dense eigenvalues.
#include "pkg/membrane/mechanics/TimeStepBound.hpp"
#include <gtest/gtest.h>

#include "dense_forces.hpp"
#include <limits>

using namespace membrane;

namespace {

/// Nodes on a line, joined by sides of stiffness 100 N/m and damping `damping` [N s/m]; masses [kg].
LinearForces chain(const std::vector<double>& masses, double damping) {
    LinearForces forces(masses);
    for (int i = 1; i < static_cast<int>(masses.size()); ++i)
        forces.addSide({i - 1, i, Eigen::Vector3d::UnitY(), 100., 0., damping});
    return forces;
}

TEST(TimeStepBound, IsNeverAboveTheDenseStepAndWorthHaving) {
    double least = 1.;
    dense::forSheets([&least](const dense::Sheet& sheet) {
        const LinearForces forces = sheet.forces();
        const double share = timeStepBound(forces).step / dense::criticalStep(forces);
        EXPECT_LE(share, 1. + 1e-12);
        EXPECT_GE(share, 0.6);
        least = std::min(least, share);
    });
    EXPECT_LT(least, 0.9); // else a run close to the critical step would tell nothing
}

TEST(TimeStepBound, OfTwoEqualMassesOnASpringIsExact) {
    EXPECT_NEAR(timeStepBound(chain({0.2, 0.2}, 0.)).step / (2. / std::sqrt(2. * 100. / 0.2)), 1., 1e-12);
    EXPECT_NEAR(timeStepBound(chain({0., 0.2}, 0.)).step / (2. / std::sqrt(100. / 0.2)), 1., 1e-12);
}

TEST(TimeStepBound, TakesHeavyNodesForNearlyHeld) {
    // Damping beside a mass of 1 kg would count twice by sums that weigh all displacements alike.
    for (double damping : {0., 30.}) {
        const LinearForces forces = chain({1., 1e-3, 1.}, damping);
        EXPECT_GT(timeStepBound(forces).step, 0.95 * dense::criticalStep(forces));
        EXPECT_LE(timeStepBound(forces).step, (1. + 1e-12) * dense::criticalStep(forces));
    }
}

TEST(TimeStepBound, TellsHowTheForcesGrowWithTheStep) {
    EXPECT_EQ(timeStepBound(chain({0.2, 0.2}, 0.)).exponent, 2.);
    EXPECT_NEAR(timeStepBound(chain({0.2, 0.2}, 1e6)).exponent, 1., 1e-6);
    const TimeStepBound both = timeStepBound(chain({0.2, 0.2}, 1.));
    const double k = both.step * both.step * 2. * 100. / 0.2, c = 4. * both.step * 2. * 1. / 0.2;
    EXPECT_NEAR(k + c, 4., 1e-12);
    EXPECT_NEAR(both.exponent, (2. * k + c) / (k + c), 1e-12);
}

TEST(TimeStepBound, IsInfiniteIfNothingCanMoveOrNothingPulls) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(timeStepBound(chain({0., 0.}, 1.)).step, infinity);
    EXPECT_EQ(timeStepBound(chain({1.}, 0.)).step, infinity);
    EXPECT_EQ(timeStepBound(chain({}, 0.)).step, infinity);
}

} // namespace

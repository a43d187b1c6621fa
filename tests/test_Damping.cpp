// SPDX-License-Identifier: GPL-2.0-or-later
// Damping coefficient of a side: paper equation (9).
#include "pkg/membrane/mechanics/Damping.hpp"
#include "shapes.hpp"
#include <gtest/gtest.h>

using membrane::dampingCoefficient;

namespace {

TEST(Damping, CoefficientIsTheOneOfEquation9) {
    EXPECT_DOUBLE_EQ(dampingCoefficient(0.02, 8., 2.), 0.16);
    EXPECT_DOUBLE_EQ(dampingCoefficient(2., 0.25, 4.), 4.);
}

TEST(Damping, RatioOneDampsAMassOnTheSpringCritically) {
    // m x'' + c x' + k x = 0 has a double root where c² = 4 k m.
    for (double scale : shapes::scales) {
        const double k = 3. * scale, m = 0.7 / scale, c = dampingCoefficient(1., k, m);
        EXPECT_NEAR(c * c / (4. * k * m), 1., 1e-14);
    }
}

TEST(Damping, RatioGivesTheLogarithmicDecrementOfAFreeSwing) {
    const double ratio = 0.05, k = 40., m = 0.1, c = dampingCoefficient(ratio, k, m);
    // Exact motion of m x'' + c x' + k x = 0 from rest, after one period of the damped swing.
    const double decay = c / (2. * m), frequency = std::sqrt(k / m - decay * decay);
    const double after = std::exp(-decay * 2. * shapes::pi / frequency);
    EXPECT_NEAR(std::log(after), -2. * shapes::pi * ratio / std::sqrt(1. - ratio * ratio), 1e-12);
}

TEST(Damping, NothingIsDampedWithoutRatioOrByANegativeStiffness) {
    EXPECT_EQ(dampingCoefficient(0., 8., 2.), 0.);
    EXPECT_EQ(dampingCoefficient(0.02, 0., 2.), 0.);
    EXPECT_EQ(dampingCoefficient(0.02, -8., 2.), 0.);
}

} // namespace

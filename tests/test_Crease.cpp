// SPDX-License-Identifier: GPL-2.0-or-later
// Angle, forces and energy of a crease: paper equations (7), (8) and the conservative law.
#include "pkg/membrane/mechanics/Crease.hpp"
#include "shapes.hpp"
#include <gtest/gtest.h>

using namespace membrane;
using shapes::Hinge;
using shapes::pi;
using shapes::Vector3d;

namespace {

/// Angles in every branch: passed through, closed, open, flat, folded the other way.
const double angles[] = {-1.5, -0.3, -1e-3, 1e-3, 0.2, 1., 1.7, 3.1, 3.2, 4.7};

constexpr CreaseLaw paper(double naturalAngle = 0., double penalty = 100.) {
    return {2.5, penalty, naturalAngle, false};
}
constexpr CreaseLaw conservative(double naturalAngle = 0., double penalty = 100.) {
    return {2.5, penalty, naturalAngle, true};
}

CreaseState stateOf(const CreaseRest& rest, const Points& x) {
    return creaseState(rest, x[0], x[1], x[2], x[3]);
}

Points forcesOn(const CreaseRest& rest, const CreaseLaw& law, const Points& x) {
    const CreaseForces f = creaseForces(rest, law, stateOf(rest, x));
    return {f.a, f.b, f.c, f.d};
}

Vector3d sum(const Points& forces) {
    return forces[0] + forces[1] + forces[2] + forces[3];
}

Vector3d moment(const Points& x, const Points& forces) {
    Vector3d result = Vector3d::Zero();
    for (int i = 0; i < 4; ++i) result += x[i].cross(forces[i]);
    return result;
}

double largest(const Points& forces) {
    double result = 0.;
    for (const Vector3d& f : forces) result = std::max(result, f.norm());
    return result;
}

/// A crease like `hinge`, but with other lengths: a state in which the film around it has buckled or is stretched.
Hinge deformed(Hinge hinge) {
    hinge.length *= 0.7;
    hinge.heightC *= 0.5;
    hinge.heightD *= 1.1;
    hinge.footC += 0.2;
    hinge.footD -= 0.9;
    return hinge;
}

/// Hinges of both signs with equal and unequal heights and with feet inside and outside AB.
std::vector<Hinge> hinges() {
    std::vector<Hinge> all;
    for (double sign : {1., -1.})
        for (double heightD : {0.8, 0.3})
            for (double footD : {0.7, 1.6, -0.8}) {
                Hinge h;
                h.sign = sign;
                h.heightD = heightD;
                h.footD = footD;
                all.push_back(h);
            }
    return all;
}

// ---------------------------------------------------------------------------------------------------------------------
// Angle

TEST(CreaseState, AngleIsTheConstructedOneInRotatedAndScaledStates) {
    shapes::Random random(5);
    for (double scale : shapes::scales) {
        for (Hinge h : hinges()) {
            for (double theta : angles) {
                h.theta = theta;
                const Points x = shapes::placed(h.nodes(), scale, random.rotation(), random.vector());
                const CreaseRest rest{scale * h.length, scale * h.heightC, scale * h.heightD, h.sign};
                const CreaseState s = stateOf(rest, x);
                EXPECT_NEAR(s.theta, theta, 1e-13) << "scale " << scale;
                EXPECT_NEAR(s.heightC / scale, h.heightC, 1e-13);
                EXPECT_NEAR(s.heightD / scale, h.heightD, 1e-13);
                EXPECT_NEAR(s.footC, h.footC, 1e-13);
                EXPECT_NEAR(s.footD, h.footD, 1e-13);
            }
        }
    }
}

TEST(CreaseState, AngleIsContinuousThroughClosedAndFlat) {
    for (Hinge h : hinges()) {
        for (double where : {0., pi}) {
            for (double offset : {-1e-9, -1e-15, 0., 1e-15, 1e-9}) {
                h.theta = where + offset;
                EXPECT_NEAR(stateOf(h.rest(), h.nodes()).theta, where + offset, 1e-14);
            }
        }
    }
}

TEST(CreaseState, AngleJumpsByAFullTurnAtMinusHalfPiOnly) {
    Hinge h;
    h.theta = -0.5 * pi + 1e-6;
    EXPECT_NEAR(stateOf(h.rest(), h.nodes()).theta, -0.5 * pi + 1e-6, 1e-13);
    h.theta = -0.5 * pi - 1e-6;
    EXPECT_NEAR(stateOf(h.rest(), h.nodes()).theta, 1.5 * pi - 1e-6, 1e-13);
}

TEST(CreaseState, MountainAndValleySeeTheSameStateFromOppositeSides) {
    Hinge h;
    for (double theta : angles) {
        h.theta = theta;
        const Points x = h.nodes();
        CreaseRest valley = h.rest();
        valley.sign = -1.;
        const double expected = theta < 0.5 * pi ? -theta : 2. * pi - theta;
        EXPECT_NEAR(stateOf(valley, x).theta, expected, 1e-13);
    }
}

TEST(CreaseState, OpenDirectionsOverHeightsAreTheAnglesGradient) {
    shapes::Random random(6);
    for (Hinge h : hinges()) {
        for (double theta : {-0.4, 0.9, 3.1, 4.}) {
            h.theta = theta;
            const Points x = shapes::placed(h.nodes(), 1., random.rotation(), random.vector());
            const CreaseState s = stateOf(h.rest(), x);
            const Vector3d c = s.openC / s.heightC, d = s.openD / s.heightD;
            const Vector3d expected[] = {-(1. - s.footC) * c - (1. - s.footD) * d, -s.footC * c - s.footD * d, c, d};
            for (int node = 0; node < 4; ++node) {
                Vector3d slope;
                for (int i = 0; i < 3; ++i) {
                    Points up = x, down = x;
                    up[node][i] += 1e-5;
                    down[node][i] -= 1e-5;
                    slope[i] = (stateOf(h.rest(), up).theta - stateOf(h.rest(), down).theta) / 2e-5;
                }
                EXPECT_GT(slope.norm(), 0.01);
                EXPECT_LT((slope - expected[node]).norm(), 1e-8) << "node " << node << " theta " << theta;
            }
        }
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// Equations (7) and (8) as printed

TEST(PaperCrease, ForcesOnTheApicesAreThoseOfEquation7WithRestLengths) {
    for (Hinge rest : hinges()) {
        for (double theta : angles) {
            for (double theta0 : {0., 0.6}) {
                rest.theta = theta;
                for (const Hinge& now : {rest, deformed(rest)}) {
                    const Points f = forcesOn(rest.rest(), paper(theta0), now.nodes());
                    const double common = 2.5 * (theta < 0. ? 100. : 1.) * rest.length * std::abs(theta - theta0);
                    EXPECT_NEAR(f[2].norm() / (common / (rest.heightC * rest.heightC)), 1., 1e-10);
                    EXPECT_NEAR(f[3].norm() / (common / (rest.heightD * rest.heightD)), 1., 1e-10);
                }
            }
        }
    }
}

TEST(PaperCrease, ForcesOnTheApicesAreNormalToTheirTriangles) {
    shapes::Random random(7);
    for (Hinge h : hinges()) {
        for (double theta : angles) {
            h.theta = theta;
            const Points x = shapes::placed(deformed(h).nodes(), 1., random.rotation(), random.vector());
            const Points f = forcesOn(h.rest(), paper(), x);
            const Vector3d normalC = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
            const Vector3d normalD = (x[1] - x[0]).cross(x[3] - x[0]).normalized();
            ASSERT_GT(f[2].norm(), 0.);
            EXPECT_LT(f[2].cross(normalC).norm(), 1e-12 * f[2].norm());
            EXPECT_LT(f[3].cross(normalD).norm(), 1e-12 * f[3].norm());
        }
    }
}

TEST(PaperCrease, PenaltyHoldsBelowZeroOnly) {
    Hinge h;
    const auto force = [&h](double theta) {
        h.theta = theta;
        return forcesOn(h.rest(), paper(), h.nodes())[2].norm();
    };
    EXPECT_NEAR(force(-0.2) / force(0.2), 100., 1e-9);
    EXPECT_NEAR(force(0.4) / force(0.2), 2., 1e-9);
}

TEST(PaperCrease, NetMomentOfUnequalHeightsIsNotZeroAsDocumented) {
    // About AB: beta E J l_AB (theta - theta0) (1/l_CE - 1/l_DF).
    shapes::Random random(8);
    Hinge h;
    h.heightD = 0.3;
    h.theta = 1.2;
    const Points x = shapes::placed(h.nodes(), 1., random.rotation(), random.vector());
    const Vector3d net = moment(x, forcesOn(h.rest(), paper(), x));
    const double expected = 2.5 * h.length * 1.2 * (1. / 0.3 - 1. / 0.8);
    EXPECT_NEAR(net.norm() / expected, 1., 1e-12);
    EXPECT_NEAR(std::abs(net.dot((x[1] - x[0]).normalized())) / expected, 1., 1e-12);
}

TEST(PaperCrease, ForceJumpsAtClosedFacesIfTheNaturalAngleIsNotZeroAsDocumented) {
    Hinge h;
    const double theta0 = 0.6, perAngle = 2.5 * h.length / (h.heightC * h.heightC);
    h.theta = 1e-12;
    EXPECT_NEAR(forcesOn(h.rest(), paper(theta0), h.nodes())[2].norm(), perAngle * theta0, 1e-9);
    h.theta = -1e-12;
    EXPECT_NEAR(forcesOn(h.rest(), paper(theta0), h.nodes())[2].norm(), 100. * perAngle * theta0, 1e-7);
}

// ---------------------------------------------------------------------------------------------------------------------
// The conservative law

TEST(ConservativeCrease, StiffnessTakesTheMeanOfTheRestHeights) {
    EXPECT_DOUBLE_EQ(creaseStiffness(membrane::CreaseRest{3., 0.5, 1.5, 1.}, {2., 100., 0., true}), 6.);
    EXPECT_DOUBLE_EQ(creaseStiffness(membrane::CreaseRest{3., 2., 2., -1.}, {2., 100., 0., false}), 3.);
}

TEST(ConservativeCrease, EnergyIsAParabolaStiffenedByThePenaltyBelowZero) {
    const CreaseRest rest{3., 0.5, 1.5, 1.}; // K = 7.5
    EXPECT_EQ(creaseEnergy(rest, conservative(), 0.), 0.);
    EXPECT_DOUBLE_EQ(creaseEnergy(rest, conservative(), 0.2), 0.15);
    EXPECT_DOUBLE_EQ(creaseEnergy(rest, conservative(), -0.2), 15.);
    EXPECT_DOUBLE_EQ(creaseEnergy(rest, conservative(0.5), 0.5), 0.);
    EXPECT_DOUBLE_EQ(creaseEnergy(rest, conservative(0.5), -0.1), 3.75 * (0.36 + 99. * 0.01));
}

TEST(ConservativeCrease, ForceIsMinusTheEnergysGradientInEveryBranchRotatedDeformedAndScaled) {
    shapes::Random random(9);
    for (double scale : shapes::scales) {
        for (Hinge h : hinges()) {
            for (double theta : angles) {
                for (double theta0 : {0., 0.7, pi}) {
                    for (double penalty : {100., 1., 0.}) {
                        h.theta = theta;
                        const CreaseRest rest{scale * h.length, scale * h.heightC, scale * h.heightD, h.sign};
                        const Points x = shapes::placed(deformed(h).nodes(), scale, random.rotation(), random.vector());
                        const CreaseLaw law = conservative(theta0, penalty);
                        const auto energy = [&](const Points& at) {
                            return creaseEnergy(rest, law, stateOf(rest, at).theta);
                        };
                        const Points f = forcesOn(rest, law, x);
                        double error = 0.;
                        for (int node = 0; node < 4; ++node) {
                            for (int i = 0; i < 3; ++i) {
                                Points up = x, down = x;
                                up[node][i] += 1e-5 * scale;
                                down[node][i] -= 1e-5 * scale;
                                const double slope = (energy(up) - energy(down)) / (2e-5 * scale);
                                error = std::max(error, std::abs(slope + f[node][i]));
                            }
                        }
                        EXPECT_LT(error * scale, 2e-5 + 1e-8 * largest(f) * scale)
                            << "scale " << scale << " theta " << theta << " theta0 " << theta0;
                        const double strength = theta - theta0 + (penalty - 1.) * std::min(theta, 0.);
                        EXPECT_GE(largest(f) * scale, 2. * std::abs(strength));
                    }
                }
            }
        }
    }
}

TEST(ConservativeCrease, ForceIsContinuousThroughClosedFacesAtAnyNaturalAngle) {
    Hinge h;
    for (double theta0 : {0., 0.6, pi}) {
        h.theta = 1e-9;
        const Points above = forcesOn(h.rest(), conservative(theta0), h.nodes());
        h.theta = -1e-9;
        const Points below = forcesOn(h.rest(), conservative(theta0), h.nodes());
        for (int node = 0; node < 4; ++node) EXPECT_LT((above[node] - below[node]).norm(), 1e-6);
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// Both laws

TEST(BothCreaseLaws, ForcesSumToZeroForFeetInsideAndOutside) {
    shapes::Random random(10);
    for (Hinge h : hinges()) {
        for (double theta : angles) {
            for (const CreaseLaw& law : {paper(0.6), conservative(0.6)}) {
                h.theta = theta;
                const Points x = shapes::placed(deformed(h).nodes(), 1., random.rotation(), random.vector());
                const Points f = forcesOn(h.rest(), law, x);
                ASSERT_GT(largest(f), 1e-3);
                EXPECT_LT(sum(f).norm(), 1e-13 * largest(f));
            }
        }
    }
}

TEST(BothCreaseLaws, NetMomentIsZeroForEqualHeightsAndForTheConservativeLawAlways) {
    shapes::Random random(11);
    for (const Hinge& rest : hinges()) {
        for (double theta : angles) {
            Hinge h = rest;
            h.theta = theta;
            const Points x = shapes::placed(h.nodes(), 1., random.rotation(), random.vector());
            const Points f = forcesOn(h.rest(), conservative(0.6), x);
            ASSERT_GT(largest(f), 1e-3);
            EXPECT_LT(moment(x, f).norm(), 1e-12 * largest(f));
            if (h.heightC == h.heightD) {
                const Points g = forcesOn(h.rest(), paper(0.6), x);
                EXPECT_LT(moment(x, g).norm(), 1e-12 * largest(g));
            }
            const Points buckled = shapes::placed(deformed(h).nodes(), 1., random.rotation(), random.vector());
            const Points k = forcesOn(h.rest(), conservative(0.6), buckled);
            EXPECT_LT(moment(buckled, k).norm(), 1e-12 * largest(k));
        }
    }
}

TEST(BothCreaseLaws, AgreeWhereHeightsAreEqualAndTheNaturalAngleIsZero) {
    shapes::Random random(12);
    for (Hinge h : hinges()) {
        if (h.heightC != h.heightD) continue;
        for (double theta : angles) {
            h.theta = theta;
            const Points x = shapes::placed(h.nodes(), 1., random.rotation(), random.vector());
            const Points f = forcesOn(h.rest(), paper(), x), g = forcesOn(h.rest(), conservative(), x);
            for (int node = 0; node < 4; ++node) EXPECT_LT((f[node] - g[node]).norm(), 1e-12 * largest(f));
        }
    }
}

TEST(BothCreaseLaws, ForcesBringTheAngleToItsNaturalValue) {
    for (Hinge h : hinges()) {
        for (double theta : angles) {
            for (double theta0 : {0., 0.6, pi}) {
                for (const CreaseLaw& law : {paper(theta0, 1.), conservative(theta0, 1.)}) {
                    h.theta = theta;
                    Points x = h.nodes();
                    const Points f = forcesOn(h.rest(), law, x);
                    for (int node = 2; node < 4; ++node) x[node] += 1e-5 / largest(f) * f[node];
                    EXPECT_LT(std::abs(stateOf(h.rest(), x).theta - theta0), std::abs(theta - theta0));
                }
            }
        }
    }
}

TEST(BothCreaseLaws, TwoEqualTrianglesSwingAboutTheirCreaseAtTheClosedFormFrequency) {
    // A and B held, masses m at C and D: m h² theta'' = -2 K (theta - theta0), K = beta E J l_AB / h.
    const double mass = 0.01, theta0 = 1., swing = 1e-5;
    Hinge h;
    h.theta = theta0 + swing;
    const double frequency = std::sqrt(2. * 2.5 * h.length / h.heightC / mass) / h.heightC;
    for (const CreaseLaw& law : {paper(theta0), conservative(theta0)}) {
        Points x = h.nodes();
        Vector3d velocity[2] = {Vector3d::Zero(), Vector3d::Zero()};
        const int steps = 2000; // in half a period, after which the angle is theta0 - swing
        const double dt = pi / frequency / steps;
        for (int i = 0; i < steps; ++i) {
            const Points f = forcesOn(h.rest(), law, x);
            for (int k = 0; k < 2; ++k) {
                velocity[k] += (i == 0 ? 0.5 : 1.) * dt / mass * f[2 + k];
                x[2 + k] += dt * velocity[k];
            }
            const double expected = theta0 + swing * std::cos(frequency * dt * (i + 1));
            ASSERT_NEAR(stateOf(h.rest(), x).theta, expected, 1e-4 * swing) << "step " << i;
        }
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// Degenerate states

TEST(DegenerateCrease, CollapsedSideGivesNoForce) {
    Hinge h;
    Points x = h.nodes();
    for (double left : {0., 0.5 * collapsedFraction}) {
        x[1] = x[0] + left * h.length * Vector3d::UnitX();
        EXPECT_EQ(stateOf(h.rest(), x).openC, Vector3d::Zero());
        EXPECT_EQ(stateOf(h.rest(), x).openD, Vector3d::Zero());
        for (const CreaseLaw& law : {paper(0.6), conservative(0.6)}) EXPECT_EQ(largest(forcesOn(h.rest(), law, x)), 0.);
    }
}

TEST(DegenerateCrease, CollapsedTriangleGetsNoForceAndTheOtherFiniteOnes) {
    Hinge h;
    Points x = h.nodes();
    x[2] = 0.4 * x[1];
    EXPECT_EQ(stateOf(h.rest(), x).openC, Vector3d::Zero());
    EXPECT_NEAR(stateOf(h.rest(), x).openD.norm(), 1., 1e-14);
    for (const CreaseLaw& law : {paper(0.6), conservative(0.6)}) {
        const Points f = forcesOn(h.rest(), law, x);
        EXPECT_EQ(f[2], Vector3d::Zero());
        EXPECT_GT(f[3].norm(), 0.);
        EXPECT_LT(sum(f).norm(), 1e-13 * largest(f));
    }
}

TEST(DegenerateCrease, PaperForceDoesNotGrowAsAHeightCollapses) {
    Hinge h;
    const double expected = forcesOn(h.rest(), paper(), h.nodes())[2].norm();
    for (double left : {0.5, 1e-2, 1e-5}) {
        Hinge now = h;
        now.heightC *= left;
        EXPECT_NEAR(forcesOn(h.rest(), paper(), now.nodes())[2].norm() / expected, 1., 1e-9) << left;
    }
}

TEST(DegenerateCrease, ConservativeForceIsBoundedAsAHeightCollapses) {
    Hinge h;
    const double bound = creaseStiffness(h.rest(), conservative()) * h.theta / (leverFloor * h.heightC);
    for (double left : {1e-2, 1e-4, 2e-6}) {
        Hinge now = h;
        now.heightC *= left;
        EXPECT_NEAR(forcesOn(h.rest(), conservative(), now.nodes())[2].norm() / bound, 1., 1e-9) << left;
    }
}

TEST(DegenerateCrease, ForcesOnTheSideAreBoundedAsItCollapsesAndStillSumToZero) {
    Hinge h;
    for (double left : {1e-2, 1e-5}) {
        Hinge now = h;
        now.length *= left;
        now.footC /= left; // C and D stay where they are
        now.footD /= left;
        for (const CreaseLaw& law : {paper(), conservative()}) {
            const Points f = forcesOn(h.rest(), law, now.nodes());
            EXPECT_GT(f[2].norm(), 1.);
            EXPECT_LT(largest(f), (1. + 1. / leverFloor) * (f[2].norm() + f[3].norm()));
            EXPECT_LT(sum(f).norm(), 1e-13 * largest(f));
        }
    }
}

TEST(DegenerateCrease, StateWithoutCollapseIsNotTakenForOne) {
    // Just above the limit the directions are there.
    Hinge h;
    h.length = 2e-6;
    h.footC = h.footD = 0.;
    CreaseRest rest = h.rest();
    rest.length = 1.;
    EXPECT_NEAR(stateOf(rest, h.nodes()).theta, h.theta, 1e-9);
    EXPECT_NEAR(stateOf(rest, h.nodes()).openC.norm(), 1., 1e-9);
}

} // namespace

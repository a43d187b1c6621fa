// SPDX-License-Identifier: GPL-2.0-or-later
// The estimate of the critical time step against closed forms and dense eigenvalues.
#include "pkg/membrane/mechanics/CriticalTimeStep.hpp"
#include "pkg/membrane/mechanics/Damping.hpp"
#include "pkg/membrane/mechanics/SideForce.hpp"
#include "shapes.hpp"
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "dense_forces.hpp"
#include <limits>
#include <set>

using namespace membrane;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using shapes::Vector3d;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A membrane in some state. All sides pull and push like springs, as the estimate takes them.
struct Model {
    RestState rest;
    Points positions;
    std::vector<double> masses; ///< 0: held
    std::vector<double> damping;
    std::vector<double> drag;
    CreaseLaw crease;

    Model(const MeshInput& in, double ratio) : rest(restState(in)), positions(in.nodes), masses(rest.masses) {
        for (const Side& s : rest.sides)
            damping.push_back(dampingCoefficient(ratio, s.stiffness, 0.5 * (masses[s.a] + masses[s.b])));
    }

    double estimate() const { return criticalTimeStep(dense::linearForces(*this)); }

    Points forces(const Points& x) const {
        Points f(x.size(), Vector3d::Zero());
        for (const Side& s : rest.sides) {
            const Vector3d span = x[s.b] - x[s.a];
            const Vector3d pull = s.stiffness * (span.norm() - s.restLength) * span.normalized();
            f[s.a] += pull;
            f[s.b] -= pull;
        }
        for (const Crease& c : rest.creases) {
            if (crease.bending == 0.) continue;
            const CreaseForces g = creaseForces(c.rest, crease, creaseState(c.rest, x[c.a], x[c.b], x[c.c], x[c.d]));
            f[c.a] += g.a;
            f[c.b] += g.b;
            f[c.c] += g.c;
            f[c.d] += g.d;
        }
        return f;
    }

    std::vector<int> freeNodes() const {
        std::vector<int> free;
        for (int i = 0; i < static_cast<int>(masses.size()); ++i)
            if (masses[i] > 0.) free.push_back(i);
        return free;
    }

    /// Minus the slope of forces(), by central differences, over the free nodes and divided by their masses' roots.
    MatrixXd stiffness() const {
        const std::vector<int> free = freeNodes();
        const double step = 1e-6 * rest.sides[0].restLength;
        MatrixXd k(3 * free.size(), 3 * free.size());
        for (std::size_t column = 0; column < 3 * free.size(); ++column) {
            Points up = positions, down = positions;
            up[free[column / 3]][column % 3] += step;
            down[free[column / 3]][column % 3] -= step;
            const Points above = forces(up), below = forces(down);
            for (std::size_t row = 0; row < free.size(); ++row)
                k.block<3, 1>(3 * row, column) = (below[free[row]] - above[free[row]]) / (2. * step) /
                                                 std::sqrt(masses[free[row]] * masses[free[column / 3]]);
        }
        return k;
    }

    MatrixXd dampers() const {
        MatrixXd all = MatrixXd::Zero(3 * masses.size(), 3 * masses.size());
        for (std::size_t i = 0; i < rest.sides.size(); ++i) {
            const Side& s = rest.sides[i];
            const Vector3d d = (positions[s.b] - positions[s.a]).normalized();
            VectorXd along = VectorXd::Zero(all.rows());
            along.segment<3>(3 * s.a) = -d;
            along.segment<3>(3 * s.b) = d;
            all += damping[i] * along * along.transpose();
        }
        const std::vector<int> free = freeNodes();
        MatrixXd c(3 * free.size(), 3 * free.size());
        for (std::size_t i = 0; i < free.size(); ++i)
            for (std::size_t j = 0; j < free.size(); ++j)
                c.block<3, 3>(3 * i, 3 * j) =
                    all.block<3, 3>(3 * free[i], 3 * free[j]) / std::sqrt(masses[free[i]] * masses[free[j]]);
        return c;
    }

    /// The time step at which the largest eigenvalue of dt² K/M + 4 dt C/M is 4.
    double denseLimit() const {
        const MatrixXd k = stiffness(), symmetric = 0.5 * (k + k.transpose()), c = dampers();
        const auto unstable = [&](double dt) {
            const MatrixXd a = dt * dt * symmetric + 4. * dt * c;
            return Eigen::SelfAdjointEigenSolver<MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff() > 4.;
        };
        double low = 0., high = 1e-9;
        while (!unstable(high)) high *= 2.;
        while (high - low > 1e-6 * high) (unstable(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
        return low;
    }

    /// Growth of the fastest growing mode in one step of the leapfrog, velocity first; dampers see 1.5 of the last
    /// velocity less 0.5 of the one before.
    double growth(double dt) const {
        const MatrixXd k = dt * dt * stiffness(), c = dt * dampers(), one = MatrixXd::Identity(k.rows(), k.cols());
        const MatrixXd none = MatrixXd::Zero(k.rows(), k.cols());
        MatrixXd step(3 * k.rows(), 3 * k.rows()); // of x, dt v and dt v of the step before
        step << one - k, one - 1.5 * c, 0.5 * c, -k, one - 1.5 * c, 0.5 * c, none, one, none;
        return Eigen::EigenSolver<MatrixXd>(step, false).eigenvalues().cwiseAbs().maxCoeff();
    }

    void stretch(double factor) {
        for (Vector3d& x : positions) x *= factor;
    }
    void crumple(double size, unsigned seed) {
        shapes::Random random(seed);
        for (Vector3d& x : positions) x += random.vector(size);
    }
    void hold(const std::vector<int>& nodes) {
        for (int node : nodes) masses[node] = 0.;
    }
};

constexpr double ratios[] = {0., 0.02, 0.5, 2.};

/// Two masses 0.3 and 0.2 kg on a cable of stiffness 100 N/m.
MeshInput spring() {
    MeshInput in;
    in.nodes = {{0., 0., 0.}, {0., 2., 0.}};
    in.cables = {{0, 1}};
    in.cableStiffness = 200.;
    in.pointMasses = {0.3, 0.2};
    return in;
}

TEST(CriticalTimeStep, OfASpringIsOnePercentBelowTheClosedForm) {
    // dt² k/m + 4 dt c/m = 4, m the reduced mass.
    for (double ratio : ratios) {
        const double k = 100., reduced = 0.3 * 0.2 / 0.5, c = 2. * ratio * std::sqrt(k * 0.25);
        const double exact = 2. * (std::sqrt(c * c + k * reduced) - c) / k;
        EXPECT_NEAR(Model(spring(), ratio).estimate() / exact, 0.99, 1e-9) << "ratio " << ratio;
    }
}

TEST(CriticalTimeStep, OfAMassOnAFixedSpringIsTwoOverItsFrequency) {
    Model model(spring(), 0.);
    model.hold({0});
    EXPECT_NEAR(model.estimate() / (2. * std::sqrt(0.2 / 100.)), 0.99, 1e-9);
}

TEST(CriticalTimeStep, OfAMassHeldBackByDragAloneIsItsMassOverTheDragSlope) {
    Model model(spring(), 0.);
    model.rest.sides[0].stiffness = 0.;
    model.drag = {0., 7.};
    EXPECT_NEAR(model.estimate() / (0.2 / 7.), 0.99, 1e-9);
}

TEST(CriticalTimeStep, DragOfItsNodesAddsToTheDampingOfASpring) {
    // A drag of d m on each mass damps a spring like c/m on top of its own.
    const double rate = 13., c = 2. * 0.1 * std::sqrt(100. * 0.25), k = 100., reduced = 0.3 * 0.2 / 0.5;
    Model model(spring(), 0.1);
    model.drag = {rate * 0.3, rate * 0.2};
    const double both = c + rate * reduced;
    EXPECT_NEAR(model.estimate() / (2. * (std::sqrt(both * both + k * reduced) - both) / k), 0.99, 1e-6);
}

TEST(CriticalTimeStep, DenseLimitSeparatesStableFromUnstableLeapfrogs) {
    // Holds the criterion itself, which the other tests rest on, against the growth of one step's map.
    for (double ratio : ratios) {
        Model model(shapes::sheet(2, 2, 0.01, 21, false), ratio);
        model.stretch(1.05);
        model.crumple(1e-3, 22);
        model.hold({0, 2, 6, 8});
        const double limit = model.denseLimit();
        EXPECT_LE(model.growth(0.999 * limit), 1. + 1e-9) << "ratio " << ratio;
        EXPECT_GT(model.growth(1.001 * limit), 1. + 1e-5) << "ratio " << ratio;
    }
}

TEST(CriticalTimeStep, OfRandomSheetsIsNeverAboveTheDenseLimitAndWithin5PercentBelow) {
    unsigned seed = 30;
    for (double ratio : ratios) {
        for (double stretch : {1., 1.01, 1.3}) {
            for (double crumple : {0., 1e-3, 0.01}) {
                for (bool held : {false, true}) {
                    Model model(shapes::sheet(3, 3, 0.01, ++seed, false), ratio);
                    model.stretch(stretch);
                    model.crumple(crumple, ++seed);
                    if (held) model.hold({0, 5, 9});
                    const double share = model.estimate() / model.denseLimit();
                    EXPECT_LE(share, 1.) << "ratio " << ratio << " stretch " << stretch << " crumple " << crumple;
                    EXPECT_GE(share, 0.95) << "ratio " << ratio << " stretch " << stretch << " crumple " << crumple;
                }
            }
        }
    }
}

TEST(CriticalTimeStep, OfASheetWithHeavyTipsAndACableIsWithin5PercentBelowToo) {
    MeshInput in = shapes::sheet(3, 3, 0.01, 41, false);
    in.nodes.emplace_back(-0.1, -0.1, 0.);
    in.cables = {{16, 0}};
    in.cableStiffness = 1e5, in.cableDensity = 1e-3;
    in.pointMasses.assign(17, 0.);
    in.pointMasses[15] = 0.5;
    for (double ratio : ratios) {
        Model model(in, ratio);
        model.stretch(1.01);
        const double share = model.estimate() / model.denseLimit();
        EXPECT_LE(share, 1.);
        EXPECT_GE(share, 0.95);
    }
}

TEST(CriticalTimeStep, CountsBuckledSidesAsTaut) {
    Model model(shapes::sheet(3, 3, 0.01, 42, false), 0.02);
    const double flat = model.estimate();
    model.stretch(0.9);
    for (const Side& s : model.rest.sides) ASSERT_LT((model.positions[s.b] - model.positions[s.a]).norm(), s.critical);
    EXPECT_NEAR(model.estimate() / flat, 1., 1e-6);
}

TEST(CriticalTimeStep, LeavesOutNegativeStiffnessAndStaysBelowTheDenseLimit) {
    MeshInput in = shapes::sheet(1, 1, 0., 0, false);
    in.nodes = {{0., 0., 0.}, {1., 0., 0.}, {0.5, 0.1, 0.}, {0.5, 1., 0.}}; // the lowest triangle is flat
    in.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 3, 2}};
    in.allowNegativeStiffness = true;
    for (double ratio : ratios) {
        Model model(in, ratio);
        ASSERT_LT(model.rest.sides[0].stiffness, 0.);
        const double limit = model.denseLimit();
        EXPECT_LE(model.estimate(), limit);
        EXPECT_GE(model.estimate(), 0.8 * limit);
    }
}

TEST(CriticalTimeStep, IsBoundByStiffCreasesWithin5PercentOfTheDenseLimit) {
    // At their natural angle; the sheet is flat, so that the creases' own moments are zero.
    for (double ratio : ratios) {
        Model model(shapes::sheet(3, 3, 0.01, 44, true), ratio);
        const double without = model.estimate();
        model.crease = {1e7, 1., shapes::pi, true};
        const double share = model.estimate() / model.denseLimit();
        ASSERT_LT(model.estimate(), 0.5 * without);
        EXPECT_LE(share, 1.);
        EXPECT_GE(share, 0.95);
    }
}

/// Two triangles on a crease at the angle theta, whose moment counts far more than the film.
Model hinge(double heightD, double theta, const CreaseLaw& law) {
    shapes::Hinge shape;
    shape.heightD = heightD;
    shape.theta = shapes::pi;
    MeshInput in = shapes::sheet(1, 1, 0., 0, false);
    in.nodes = shape.nodes();
    in.triangles = {{0, 1, 2}, {1, 0, 3}};
    in.creases = {{0, 1}};
    in.creaseSigns = {-1};
    in.allowNegativeStiffness = true;
    Model model(in, 0.);
    shape.theta = theta;
    model.positions = shape.nodes();
    model.crease = law;
    return model;
}

TEST(CriticalTimeStep, OfACreaseUnderMomentIsNeverAboveTheDenseLimit) {
    for (double theta : {0.5, 1.5, 3.}) {
        const Model model = hinge(0.8, theta, {1e8, 1., 0., true});
        EXPECT_LE(model.estimate(), model.denseLimit()) << "theta " << theta;
    }
}

TEST(CriticalTimeStep, OfAPaperCreaseWithUnequalHeightsIsNeverAboveTheLimitOfGrowth) {
    const Model model = hinge(0.1, 1e-6, {1e8, 1., 0., false});
    const double largest = Eigen::EigenSolver<MatrixXd>(model.stiffness(), false).eigenvalues().real().maxCoeff();
    EXPECT_LE(model.estimate(), 2. / std::sqrt(largest));
}

TEST(CriticalTimeStep, CountsEveryCreaseWithItsPenalty) {
    Model model(shapes::sheet(3, 3, 0.01, 45, true), 0.02);
    model.crease = {1e5, 1., shapes::pi, true};
    const double soft = model.estimate();
    model.crease.penalty = 100.;
    const double stiff = model.estimate();
    model.crease = {1e7, 1., shapes::pi, true};
    EXPECT_NEAR(stiff / model.estimate(), 1., 1e-12);
    EXPECT_LT(stiff, 0.2 * soft);
}

TEST(CriticalTimeStep, IsProportionalToTheSizeOfTheSheet) {
    const MeshInput in = shapes::sheet(3, 3, 0.01, 46, false);
    const double step = Model(in, 0.02).estimate();
    for (double scale : shapes::scales) {
        MeshInput large = in;
        for (Vector3d& node : large.nodes) node *= scale;
        large.thickness *= scale;
        EXPECT_NEAR(Model(large, 0.02).estimate() / (scale * step), 1., 1e-9);
    }
}

TEST(CriticalTimeStep, IsOnePercentBelowTheDenseStepOfItsMatrices) {
    dense::forSheets([](const dense::Sheet& sheet) {
        const double share = criticalTimeStep(sheet.forces()) / dense::criticalStep(sheet.forces());
        EXPECT_LE(share, 0.99 * (1. + 1e-4));
        EXPECT_GE(share, 0.99 * (1. - 2e-3));
    });
}

TEST(CriticalTimeStep, CountsDampingThatActsElsewhereThanStiffness) {
    // Springs without dampers in one half and the other way round: which half decides depends on the step.
    for (double share : {0.5, 0.8, 0.95, 1., 1.05, 1.2, 2.}) {
        dense::Sheet sheet(7, 1e-3, 0., 0.);
        const double stiff = dense::criticalStep(sheet.forces());
        sheet.damping.assign(sheet.rest.sides.size(), 0.);
        for (std::size_t i = 0; i < sheet.damping.size() / 2; ++i) {
            sheet.rest.sides[i].stiffness = 0.;
            sheet.damping[i] = 1.;
        }
        const double damped = dense::criticalStep(sheet.forces());
        for (double& c : sheet.damping) c *= damped / (share * stiff);
        const double ratio = criticalTimeStep(sheet.forces()) / dense::criticalStep(sheet.forces());
        EXPECT_LE(ratio, 0.99 * (1. + 1e-4)) << "share " << share;
        EXPECT_GE(ratio, 0.99 * (1. - 2e-3)) << "share " << share;
    }
}

TEST(CriticalTimeStep, IsTheLongestStepWithin) {
    dense::forSheets([](const dense::Sheet& sheet) {
        const double step = criticalTimeStep(sheet.forces());
        for (double share : {1e-6, 0.3, 0.7, 0.95, 1.})
            EXPECT_TRUE(withinCriticalTimeStep(sheet.forces(), share * step));
        EXPECT_FALSE(withinCriticalTimeStep(sheet.forces(), std::nextafter(step, infinity)));
        EXPECT_FALSE(withinCriticalTimeStep(sheet.forces(), 2. * step));
        EXPECT_FALSE(withinCriticalTimeStep(sheet.forces(), infinity));
        EXPECT_FALSE(withinCriticalTimeStep(sheet.forces(), std::nan("")));
    });
}

TEST(CriticalTimeStep, RepeatsToTheLastDigit) {
    dense::forSheets([](const dense::Sheet& sheet) {
        const dense::Sheet same = sheet;
        EXPECT_EQ(criticalTimeStep(sheet.forces()), criticalTimeStep(same.forces()));
    });
}

TEST(CriticalTimeStep, IsInfiniteIfNothingCanMoveOrNothingPulls) {
    Model held(shapes::sheet(2, 2, 0., 48, false), 0.02);
    held.hold({0, 1, 2, 3, 4, 5, 6, 7, 8});
    EXPECT_EQ(held.estimate(), infinity);
    EXPECT_EQ(criticalTimeStep(LinearForces({})), infinity);
    EXPECT_EQ(criticalTimeStep(LinearForces({1., 1.})), infinity);
}

} // namespace

// SPDX-License-Identifier: GPL-2.0-or-later
// The largest eigenvalue by Lanczos' method against dense eigenvalues and the bound of its error.
#include "pkg/membrane/mechanics/Lanczos.hpp"
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <random>

using namespace membrane;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

NodeVectors normalVectors(std::size_t count, unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    NodeVectors vectors(count, Eigen::Vector4d::Zero());
    for (Eigen::Vector4d& v : vectors)
        for (int k = 0; k < 3; ++k) v[k] = normal(generator);
    return vectors;
}

double ofMatrix(const MatrixXd& matrix, unsigned seed, int steps) {
    const auto multiply = [&matrix](const NodeVectors& x, NodeVectors& y) {
        VectorXd in(matrix.rows());
        for (std::size_t i = 0; i < x.size(); ++i) in.segment<3>(3 * i) = x[i].head<3>();
        const VectorXd out = matrix * in;
        for (std::size_t i = 0; i < y.size(); ++i) y[i] << out.segment<3>(3 * i), 0.;
    };
    return largestEigenvalue(multiply, normalVectors(matrix.rows() / 3, seed), steps);
}

double ofDiagonal(const NodeVectors& diagonal, unsigned seed, int steps) {
    const auto multiply = [&diagonal](const NodeVectors& x, NodeVectors& y) {
        for (std::size_t i = 0; i < y.size(); ++i) y[i] = diagonal[i].cwiseProduct(x[i]);
    };
    return largestEigenvalue(multiply, normalVectors(diagonal.size(), seed), steps);
}

TEST(Lanczos, FindsTheLargestEigenvalueOfRandomMatrices) {
    std::mt19937 generator(1);
    std::normal_distribution<double> normal;
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const MatrixXd root = MatrixXd::NullaryExpr(30, 10, [&] { return normal(generator); });
        const MatrixXd matrix = root * root.transpose(); // of rank 10
        const double exact = Eigen::SelfAdjointEigenSolver<MatrixXd>(matrix).eigenvalues().maxCoeff();
        EXPECT_NEAR(ofMatrix(matrix, seed, 60) / exact, 1., 1e-12);
        for (int steps : {1, 2, 3, 5, 8}) EXPECT_LE(ofMatrix(matrix, seed, steps), exact * (1. + 1e-13));
    }
}

TEST(Lanczos, ComesCloserWithEveryStep) {
    NodeVectors diagonal(500);
    for (int i = 0; i < 500; ++i) diagonal[i] = {1. * i, i + 0.3, i + 0.6, 0.};
    double before = 0.;
    for (int steps = 1; steps < 40; ++steps) {
        const double now = ofDiagonal(diagonal, 1, steps);
        EXPECT_GT(now, before);
        before = now;
    }
    EXPECT_LE(before, 499.6 * (1. + 1e-13));
    EXPECT_GE(before, 499.);
}

TEST(Lanczos, SurvivesToRunOutOfVectors) {
    for (int steps : {1, 2, 3, 50}) {
        EXPECT_NEAR(ofMatrix(7. * MatrixXd::Identity(9, 9), 1, steps), 7., 1e-12);
        EXPECT_EQ(ofMatrix(MatrixXd::Zero(9, 9), 1, steps), 0.);
    }
    VectorXd two = VectorXd::Zero(9);
    two[4] = 5.;
    for (int steps : {2, 3, 50}) EXPECT_NEAR(ofMatrix(two.asDiagonal(), 1, steps), 5., 1e-12);
    const auto none = [](const NodeVectors&, NodeVectors&) {};
    EXPECT_EQ(largestEigenvalue(none, {}, 5), 0.);
    EXPECT_EQ(largestEigenvalue(none, NodeVectors(3, Eigen::Vector4d::Zero()), 5), 0.);
}

TEST(Lanczos, IsIndifferentToTheSizeOfTheNumbers) {
    const MatrixXd matrix = VectorXd::LinSpaced(30, 0., 1.).asDiagonal();
    const double one = ofMatrix(matrix, 1, 12);
    for (double scale : {1e-40, 1e40}) EXPECT_NEAR(ofMatrix(scale * matrix, 1, 12) / (scale * one), 1., 1e-12);
}

TEST(Lanczos, MissesByMoreThanTheErrorAsRarelyAsPromised) {
    // One eigenvalue just above a crowd: the start has little of its vector.
    constexpr double error = 0.01, risk = 0.1;
    NodeVectors diagonal(300, {1. - 1.05 * error, 1. - 1.05 * error, 1. - 1.05 * error, 0.});
    for (int i = 0; i < 299; ++i) diagonal[i] *= std::sqrt(i / 299.);
    diagonal[150][1] = 1.;
    const int promised = lanczosSteps(900, error, risk), trials = 200;
    const auto misses = [&](int steps) {
        int count = 0;
        for (int seed = 1; seed <= trials; ++seed) count += ofDiagonal(diagonal, seed, steps) < 1. - error;
        return count;
    };
    EXPECT_LE(misses(promised), risk * trials);
    EXPECT_GT(misses(promised / 3), risk * trials);
}

TEST(Lanczos, TakesMoreStepsForMoreCertainty) {
    EXPECT_EQ(lanczosSteps(1452, 0.0199, 1e-4), 48); // (1 + ln(1.648 sqrt(1452) / 1e-4) / sqrt(0.0199)) / 2 = 47.8
    EXPECT_GT(lanczosSteps(1452, 0.0199, 1e-8), 60);
    EXPECT_GT(lanczosSteps(3000000, 0.0199, 1e-4), 60);
    EXPECT_EQ(lanczosSteps(1452, 0.0199 / 4., 1e-4), 96);
    EXPECT_EQ(lanczosSteps(1, 1., 0.9), 1);
}

} // namespace

// SPDX-License-Identifier: GPL-2.0-or-later
#include "CriticalTimeStep.hpp"
#include "Lanczos.hpp"
#include "TimeStepBound.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace membrane {
namespace {

constexpr double margin = 0.99;
constexpr double infinity = std::numeric_limits<double>::infinity();

NodeVectors randomStart(const std::vector<double>& inverseRoot) {
    std::mt19937 generator(1); // fixed: the estimate must repeat
    std::normal_distribution<double> normal;
    NodeVectors start(inverseRoot.size(), Eigen::Vector4d::Zero());
    for (std::size_t i = 0; i < start.size(); ++i)
        if (inverseRoot[i] > 0.)
            for (int k = 0; k < 3; ++k) start[i][k] = normal(generator);
    return start;
}

/// Largest eigenvalue of (step² K + 4 step C)/M.
double largestEigenvalue(const LinearForces& forces, const NodeVectors& start, double step, int iterations) {
    NodeVectors moved(start.size());
    const auto multiply = [&](const NodeVectors& x, NodeVectors& y) { // 1/sqrt(M) on both sides: symmetric
        for (std::size_t i = 0; i < x.size(); ++i) {
            moved[i] = forces.inverseRoot[i] * x[i];
            y[i].setZero();
        }
        addProduct(forces, step * step, 4. * step, moved, y);
        for (std::size_t i = 0; i < x.size(); ++i) y[i] *= forces.inverseRoot[i];
    };
    return membrane::largestEigenvalue(multiply, start, iterations);
}

/// A step and its largest eigenvalue.
struct Sample {
    double step, eigenvalue;
};

/// Iterations after which what the eigenvalue lacks shortens the step by less than the margin.
/// \param exponent with which the eigenvalue grows with the step
int iterationsFor(const LinearForces& forces, double exponent) {
    constexpr double risk = 1e-4;
    return lanczosSteps(3 * forces.inverseRoot.size(), 1. - std::pow(margin, exponent), risk);
}

/// The step whose eigenvalue is 4, with damping.
///
/// The eigenvalue's logarithm is a convex function of the step's, for it is the largest of log(exp(2 s) k + exp(s) c)
/// over all vectors, and its slope lies between 1 and 2. So with the slope 2 upwards from a step that is too short, and
/// along a chord downwards, the result is not above the exact step.
double dampedTimeStep(const LinearForces& forces, const NodeVectors& start, const TimeStepBound& bound) {
    const auto sample = [&](double step, int iterations) {
        return Sample{step, largestEigenvalue(forces, start, step, iterations)};
    };
    // The first two only tell where to look.
    const int few = iterationsFor(forces, 2.) / 3;
    Sample low = sample(bound.step, few);
    if (!(low.eigenvalue > 0.)) return infinity;
    double slope = bound.exponent;
    constexpr int most = 10;
    for (int round = 0;; ++round) {
        const double step = low.step * std::pow(4. / low.eigenvalue, 1. / slope);
        const Sample next = sample(step, round == 0 ? few : iterationsFor(forces, slope));
        const double climb = std::log(next.step / low.step), gap = std::log(4. / next.eigenvalue);
        // Over less, the slope would be that of the errors.
        if (climb > 0.03) slope = std::clamp(std::log(next.eigenvalue / low.eigenvalue) / climb, 1., 2.);
        const bool close = gap > -0.01 && std::abs(gap) * (1. / slope - 0.5) < 3e-4;
        if ((round > 0 && close) || round == most) return next.step * std::exp(gap > 0. ? 0.5 * gap : gap / slope);
        if (gap > 0.) low = next;
    }
}

/// The step whose eigenvalue is 4.
double exactTimeStep(const LinearForces& forces) {
    const TimeStepBound bound = timeStepBound(forces);
    if (!(bound.step < infinity)) return infinity;
    const NodeVectors start = randomStart(forces.inverseRoot);
    if (forces.damped) return dampedTimeStep(forces, start, bound);
    const double eigenvalue = largestEigenvalue(forces, start, bound.step, iterationsFor(forces, 2.));
    return eigenvalue > 0. ? bound.step * std::sqrt(4. / eigenvalue) : infinity;
}

/// The longest step of what moves beside the nodes.
double stepBeside(const LinearForces& forces) {
    return forces.beside > 0. ? 2. / std::sqrt(forces.beside) : infinity;
}

} // namespace

double criticalTimeStep(const LinearForces& forces) {
    return margin * std::min(exactTimeStep(forces), stepBeside(forces));
}

bool withinCriticalTimeStep(const LinearForces& forces, double dt) {
    if (!(dt <= margin * stepBeside(forces))) return false;
    return dt <= margin * timeStepBound(forces).step || dt <= margin * exactTimeStep(forces);
}

} // namespace membrane

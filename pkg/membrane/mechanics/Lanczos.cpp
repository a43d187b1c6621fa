// SPDX-License-Identifier: GPL-2.0-or-later
#include "Lanczos.hpp"
#include <algorithm>
#include <cmath>

namespace membrane {
namespace {

using Eigen::Vector4d;

/// y = f x + g y; returns y times z. One pass: at a million nodes memory is what takes the time. Four sums at a time
/// are as many independent additions, in the same order on every CPU.
double combine(double f, const NodeVectors& x, double g, NodeVectors& y, const NodeVectors& z) {
    Vector4d sum = Vector4d::Zero();
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Vector4d next = f * x[i] + g * y[i];
        y[i] = next;
        sum += next.cwiseProduct(z[i]);
    }
    return sum.sum();
}

/// Largest eigenvalue of a symmetric tridiagonal matrix without negative eigenvalues, by bisection.
double largestOfTridiagonal(const std::vector<double>& diagonal, const std::vector<double>& beside) {
    const std::size_t size = diagonal.size();
    double low = 0., high = 0.;
    for (std::size_t i = 0; i < size; ++i) {
        low = std::max(low, diagonal[i]);
        high = std::max(high, diagonal[i] + (i > 0 ? beside[i - 1] : 0.) + (i + 1 < size ? beside[i] : 0.));
    }
    const auto aboveAll = [&](double value) { // value - matrix is positive: all its pivots are
        double pivot = value - diagonal[0];
        for (std::size_t i = 1; i < size && pivot > 0.; ++i)
            pivot = value - diagonal[i] - beside[i - 1] * beside[i - 1] / pivot;
        return pivot > 0.;
    };
    while (high - low > 1e-14 * high) {
        const double middle = 0.5 * (low + high);
        if (!(low < middle && middle < high)) break;
        (aboveAll(middle) ? high : low) = middle;
    }
    return low;
}

} // namespace

int lanczosSteps(std::size_t size, double error, double risk) {
    const double needed = std::log(1.648 * std::sqrt(static_cast<double>(size)) / risk) / std::sqrt(error);
    return std::max(1, static_cast<int>(std::ceil(0.5 * (needed + 1.))));
}

double largestEigenvalue(const std::function<void(const NodeVectors&, NodeVectors&)>& multiply, NodeVectors start,
                         int steps) {
    double square = 0.;
    for (const Vector4d& x : start) square += x.squaredNorm();
    if (!(square > 0.)) return 0.;
    NodeVectors v = std::move(start), next(v.size(), Vector4d::Zero()), product(v.size());
    for (Vector4d& x : v) x /= std::sqrt(square);
    // The vectors lose their orthogonality as eigenvalues are found, which only finds the same ones again.
    std::vector<double> diagonal, beside;
    for (int step = 0;; ++step) {
        multiply(v, product);
        diagonal.push_back(combine(1., product, step > 0 ? -beside.back() : 0., next, v));
        if (step + 1 == steps) break;
        const double rest = std::sqrt(combine(-diagonal.back(), v, 1., next, next));
        if (!(rest > 0.)) break;
        beside.push_back(rest);
        for (Vector4d& x : next) x *= 1. / rest;
        v.swap(next);
    }
    return largestOfTridiagonal(diagonal, beside);
}

} // namespace membrane

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "LinearForces.hpp"
#include <functional>

namespace membrane {

/// Steps after which largestEigenvalue() is too small by more than a share `error` with a probability of at most
/// `risk`, whatever the matrix: Kuczynski and Wozniakowski, SIAM J. Matrix Anal. Appl. 13 (1992) 1094-1122, bound it
/// by 1.648 sqrt(size) exp(-sqrt(error) (2 steps - 1)). As a rule it is far more exact.
/// \param size rows of the matrix
int lanczosSteps(std::size_t size, double error, double risk);

/// Largest eigenvalue of a symmetric positive matrix by Lanczos' method; never too large, but for rounding.
/// \param multiply y = matrix times x; the fourth number of each vector stays 0
/// \param start components independent and normally distributed, of any length: the bound above rests on that
double largestEigenvalue(const std::function<void(const NodeVectors& x, NodeVectors& y)>& multiply, NodeVectors start,
                         int steps);

} // namespace membrane

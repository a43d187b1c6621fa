// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// How a loop over elements becomes one over several at a time: everything is inlined into a function marked
// MEMBRANE_VECTORISED, of which the compiler makes a version for CPUs with 256-bit vectors and one for the rest. Its
// loops carry `#pragma GCC ivdep`; with `omp simd` vectors of Eigen would stay in memory. Built without contraction to
// fused multiply-add, both versions give the same digits, but for atan2.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) &&               \
    !defined(__SANITIZE_THREAD__)
#define MEMBRANE_VECTORISED __attribute__((flatten, target_clones("avx2", "default")))
// What sets errno is not vectorised, and the flags of MathFlags.hpp do not tell the compiler that these need not.
extern "C" __attribute__((const)) double sqrt(double) noexcept;
// The C library's vectors of atan2: see crease kernel.
#include <features.h>
#if __GLIBC_PREREQ(2, 35)
extern "C" __attribute__((const, simd("notinbranch"))) double atan2(double, double) noexcept;
#endif
#else
#define MEMBRANE_VECTORISED
#endif

namespace membrane {

/// Loops over a block's elements run on to a multiple of this, so that none is left over to be computed singly.
constexpr int lanes = 4;

inline int wholeLanes(int count) {
    return (count + lanes - 1) / lanes * lanes;
}

/// Elements that a kernel takes at once: what it holds of them in between stays in the first-level cache.
constexpr int blockSize = 128;

} // namespace membrane

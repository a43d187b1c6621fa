// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/base/Math.hpp>

namespace yade {

// A struct of constants, as in Mathr::PI.
struct Mathr {
    static constexpr Real PI = 3.14159265358979323846;
    static constexpr Real TWO_PI = 2 * PI;
    static constexpr Real HALF_PI = PI / 2;
    static constexpr Real E = 2.71828182845904523536;
    static constexpr Real DEG_TO_RAD = PI / 180;
    static constexpr Real RAD_TO_DEG = 180 / PI;
    static constexpr Real EPSILON = std::numeric_limits<Real>::epsilon();
    static constexpr Real MAX_REAL = std::numeric_limits<Real>::max();
};

} // namespace yade

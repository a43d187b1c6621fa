// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneMat.hpp"
#include <cmath>
#include <sstream>

namespace yade {

YADE_PLUGIN((MembraneMat));

void MembraneMat::postLoad(MembraneMat&) {
    const auto refuse = [](const char* field, Real value, const char* range) {
        std::ostringstream message;
        message << "MembraneMat: " << field << " = " << value << " must be " << range;
        throw std::invalid_argument(message.str());
    };
    const auto positive = [](Real value) { return value > 0. && std::isfinite(value); };
    if (!positive(thickness)) refuse("thickness", thickness, "finite and > 0");
    if (!positive(young)) refuse("young", young, "finite and > 0");
    if (!positive(density)) refuse("density", density, "finite and > 0");
    if (!(poisson > -1. && poisson <= 0.5)) refuse("poisson", poisson, "in (-1, 0.5]");
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/base/Math.hpp>

#include <ctime>

namespace yade {

struct TimingInfo {
    using delta = unsigned long long;
    long nExec = 0;
    delta nsec = 0;

    static bool enabled;
    static delta getNow(bool evenIfDisabled = false) {
        if (!enabled && !evenIfDisabled) return 0;
        timespec now;
        clock_gettime(CLOCK_MONOTONIC, &now);
        return delta(now.tv_sec) * 1000000000 + delta(now.tv_nsec);
    }
};

class TimingDeltas;

YADE_ABI_LAYOUT(TimingInfo, 16, ((nExec, 0))((nsec, 8)));

} // namespace yade

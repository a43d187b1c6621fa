// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <atomic>
#include <mutex>
#include <thread>

namespace yade {

/// Lets a thread that only looks, as YADE's 3D view does, in between two steps of the thread that computes.
class StepGuard {
public:
    /// To be kept while a step changes what others look at.
    std::unique_lock<std::mutex> step() {
        while (lookers_ > 0) std::this_thread::yield(); // a mutex is not fair: the next step would take it again
        return std::unique_lock<std::mutex>(mutex_);
    }
    /// To be kept while looking; waits for the step under way.
    std::unique_lock<std::mutex> look() {
        ++lookers_;
        std::unique_lock<std::mutex> held(mutex_);
        --lookers_;
        return held;
    }

private:
    std::mutex mutex_;
    std::atomic<int> lookers_{0};
};

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#include "StepGuard.hpp"
#include <chrono>
#include <condition_variable>
#include <core/Engine.hpp>
#include <core/Omega.hpp>
#include <mutex>
#include <thread>

namespace yade {

namespace {

using Clock = std::chrono::steady_clock;

std::mutex guard;
std::condition_variable changed;
std::thread::id computing;      ///< the thread in whose engine a step is, if any
Clock::time_point lastArrival;  ///< when a step last arrived at an engine
Clock::duration betweenSteps{}; ///< time between the last two arrivals
bool looking = false;
bool saving = false; ///< the next step to arrive waits for Python's lock
// Who wants to look has a number. A step that arrives admits all that have come by then, and no more: else many of
// them would never let it go on.
unsigned long given = 0, admitted = 0; ///< numbers below these
int waiting = 0, pending = 0;          ///< who wait or look; those of them that are admitted

thread_local bool runsScene = false; ///< this thread was made by YADE to run a scene
thread_local bool looksHere = false; ///< this thread holds a Look

/// Gives up Python's lock for its lifetime, if this thread has it: whom we wait for may need it.
class WithoutPython {
public:
    WithoutPython() : state_(PyGILState_Check() ? PyEval_SaveThread() : nullptr) {}
    ~WithoutPython() {
        if (state_) PyEval_RestoreThread(state_);
    }

private:
    PyThreadState* state_;
};

} // namespace

StepGuard::Step::Step() {
    std::unique_lock<std::mutex> lock(guard);
    if (Omega::instance().isRunning() && !PyGILState_Check()) runsScene = true;
    const auto now = Clock::now();
    betweenSteps = now - lastArrival;
    lastArrival = now;
    for (bool letIn = true; letIn;) {
        admitted = given;
        pending = waiting;
        if (pending > 0) {
            changed.notify_all();
            lock.unlock();
            {
                const WithoutPython without;
                lock.lock();
                changed.wait(lock, [] { return pending == 0; });
                lock.unlock();
            }
            lock.lock();
        }
        letIn = saving && !PyGILState_Check();
        if (!letIn) break;
        lock.unlock();
        const auto state = PyGILState_Ensure(); // which the thread that saves has until it is done
        saving = false;
        PyGILState_Release(state);
        lock.lock();
    }
    computing = std::this_thread::get_id();
}

StepGuard::Step::~Step() {
    {
        const std::lock_guard<std::mutex> lock(guard);
        computing = std::thread::id();
    }
    changed.notify_all();
}

StepGuard::Look::Look(bool between) : holds_(false) {
    if (runsScene || looksHere) return;
    {
        const std::lock_guard<std::mutex> lock(guard);
        if (computing == std::this_thread::get_id()) return;
        number_ = given++; // before Python's lock is given up, which a step may wait for
        ++waiting;
    }
    const WithoutPython without;
    std::unique_lock<std::mutex> lock(guard);
    // A step that never arrives, for another engine keeps it or none of ours is there, must not be waited for.
    const auto patience = Clock::now() + std::max<Clock::duration>(std::chrono::seconds(1), 3 * betweenSteps);
    const auto comesIn = [&] {
        const bool mayEnter =
            number_ < admitted || !between || !Omega::instance().isRunning() || Clock::now() > patience;
        return mayEnter && !looking && computing == std::thread::id();
    };
    while (!comesIn()) changed.wait_for(lock, std::chrono::milliseconds(5)); // the end of a run tells nobody
    looking = looksHere = holds_ = true;
}

StepGuard::Look::~Look() {
    if (!holds_) return;
    {
        const std::lock_guard<std::mutex> lock(guard);
        looking = looksHere = false;
        --waiting;
        if (number_ < admitted) --pending;
    }
    changed.notify_all();
}

bool StepGuard::othersRun() {
    return !runsScene && Omega::instance().isRunning();
}

#ifdef YADE_ABI_TYPE // not in a YADE source tree, whose attributes are read and set at any time
abi::Access::Access() : held_(std::make_shared<StepGuard::Look>()) {}
abi::Access::~Access() {}
#endif

void StepGuard::refuseCall(const Engine& engine) {
    if (othersRun() && PyGILState_Check())
        throw std::runtime_error(engine.getClassName() +
                                 ": the scene is running, with its own calls of this engine; pause it");
}

void StepGuard::holdForSave() {
    if (!othersRun()) return;
    const std::lock_guard<std::mutex> lock(guard);
    saving = true;
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneFault.hpp"
#include "StepGuard.hpp"
#include <algorithm>
#include <core/Scene.hpp>
#include <mutex>

namespace yade {

YADE_PLUGIN((MembraneFault));

namespace {

std::mutex noting;

/// The fault that waits for the next step, or none.
shared_ptr<MembraneFault> waitingFault(const Scene& scene) {
    return scene._nextEngines.empty() ? shared_ptr<MembraneFault>()
                                      : boost::dynamic_pointer_cast<MembraneFault>(scene._nextEngines.front());
}

} // namespace

void MembraneFault::note(Scene& scene, const std::string& what) {
    const std::lock_guard<std::mutex> lock(noting);
    shared_ptr<MembraneFault> fault = waitingFault(scene);
    if (!fault) {
        fault = shared_ptr<MembraneFault>(new MembraneFault);
        fault->message = what;
        if (scene._nextEngines.empty()) scene._nextEngines = scene.engines;
        scene._nextEngines.insert(scene._nextEngines.begin(), fault);
    }
    ++fault->count;
}

void MembraneFault::raise(Scene& scene) {
    const shared_ptr<MembraneFault> fault = waitingFault(scene);
    if (!fault) return;
    scene._nextEngines.erase(scene._nextEngines.begin());
    fault->stop();
}

void MembraneFault::action() {
    StepGuard::refuseCall(*this);
    const auto self = shared_from_this(); // which the list alone may keep alive
    auto& engines = scene->engines;
    engines.erase(std::remove(engines.begin(), engines.end(), self), engines.end());
    stop();
}

void MembraneFault::stop() const {
    if (message.empty()) throw std::runtime_error("MembraneFault: nothing was noted");
    throw std::runtime_error(message + (count > 1 ? " (and " + std::to_string(count - 1) + " more in this step)" : ""));
}

} // namespace yade

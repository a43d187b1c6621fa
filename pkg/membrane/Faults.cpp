// SPDX-License-Identifier: GPL-2.0-or-later
#include "Faults.hpp"
#include <atomic>
#include <map>
#include <mutex>
#include <stdexcept>

namespace yade {
namespace faults {

namespace {
struct Noted {
    std::string first;
    long count = 0;
};
std::mutex guard;
std::atomic<bool> any{false}; // spares raise() the lock in every step without faults
std::map<const Scene*, Noted> noted;
} // namespace

void record(const Scene* scene, const std::string& what) {
    const std::lock_guard<std::mutex> lock(guard);
    Noted& n = noted[scene];
    if (n.count++ == 0) n.first = what;
    any = true;
}

void raise(const Scene* scene) {
    if (!any) return;
    const std::lock_guard<std::mutex> lock(guard);
    const auto found = noted.find(scene);
    if (found == noted.end()) return;
    const Noted n = found->second;
    noted.erase(found);
    any = !noted.empty();
    throw std::runtime_error(n.first +
                             (n.count > 1 ? " (and " + std::to_string(n.count - 1) + " more in this step)" : ""));
}

} // namespace faults
} // namespace yade

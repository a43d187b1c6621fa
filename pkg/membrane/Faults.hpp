// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <string>

namespace yade {

class Scene;

/// Faults met inside functors. An exception may not leave YADE's interaction loop (it would end the process), so a
/// functor notes the fault here and the MembraneForceEngine raises it in the same step. Safe from any thread.
namespace faults {
void record(const Scene* scene, const std::string& what);
/// \throws std::runtime_error with the first fault of this scene and how many there were; forgets them
void raise(const Scene* scene);
} // namespace faults

} // namespace yade

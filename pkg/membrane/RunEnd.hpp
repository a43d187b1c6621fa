// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <core/Omega.hpp>
#include <core/Scene.hpp>

namespace yade {

/// Whether somebody may look at the bodies after this step: it is the last that O.run was asked for, or that of O.step.
inline bool endsRun(const Scene& scene) {
    if (scene.stopAtIter == scene.iter + 1) return true;
    if (scene.stopAtTime > 0. && scene.time + scene.dt >= scene.stopAtTime) return true;
    return scene.stopAtIter <= scene.iter && !Omega::instance().isRunning();
}

} // namespace yade

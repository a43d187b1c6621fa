// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <core/BodyContainer.hpp>
#include <core/Scene.hpp>

namespace yade {

/// The body of an id in a scene, or none. Body::byId does not ask whether there is such an id.
inline shared_ptr<Body> bodyAt(const Scene& scene, Body::id_t id) {
    return scene.bodies->exists(id) ? (*scene.bodies)[id] : shared_ptr<Body>();
}

} // namespace yade

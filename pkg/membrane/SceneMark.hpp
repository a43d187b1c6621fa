// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <boost/weak_ptr.hpp>
#include <core/Scene.hpp>

namespace yade {

/// Remembers a scene without keeping it alive, and takes no other for it that lies where it lay.
class SceneMark {
public:
    void set(Scene& scene) {
        at_ = &scene;
        alive_ = scene.shared_from_this();
    }
    void clear() { *this = SceneMark(); }
    bool is(const Scene* scene) const { return at_ && at_ == scene && !alive_.expired(); }

private:
    const Scene* at_ = nullptr;
    boost::weak_ptr<Factorable> alive_;
};

} // namespace yade

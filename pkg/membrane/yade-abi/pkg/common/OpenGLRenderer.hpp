// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>

namespace yade {

class Scene;

// Draws what it likes in the 3D view, after the bodies; called by the renderer, which sets `scene` before.
struct GlExtraDrawer : public Serializable {
    Scene* scene;
    virtual void render();
    bool dead;

    GlExtraDrawer() : scene(nullptr), dead(false) {}
    virtual ~GlExtraDrawer();
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(GlExtraDrawer, 40, ((scene, 24))((dead, 32)));
YADE_ABI_TAIL(GlExtraDrawer, 33);
YADE_ABI_SAVED(GlExtraDrawer)

// Of the renderer no more than these is known here: it is never made, copied or looked into.
class OpenGLRenderer : public Serializable {
public:
    // makes the functors of drawing anew, with room for all classes of shapes that there are
    void initgl();
    void hide(Body::id_t);
    void show(Body::id_t);
    OpenGLRenderer() = delete;
};

} // namespace yade

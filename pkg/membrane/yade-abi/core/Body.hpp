// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Bound.hpp>
#include <core/Material.hpp>
#include <core/Shape.hpp>
#include <core/State.hpp>

#include <map>

namespace yade {

class Scene;
class Interaction;

class Body : public Serializable {
public:
    using id_t = int;
    using MapId2IntrT = std::map<Body::id_t, shared_ptr<Interaction>>;

    enum { FLAG_BOUNDED = 1, FLAG_ASPHERICAL = 2, FLAG_SUBDOMAIN = 4, FLAG_FLUIDDOMAINBBOX = 8 };
    static const Body::id_t ID_NONE;

    // of the current scene unless one is given
    static const shared_ptr<Body>& byId(Body::id_t, Scene* = nullptr);
    static const shared_ptr<Body>& byId(Body::id_t, shared_ptr<Scene>);

    bool isClump() const;
    bool isClumpMember() const;
    bool isStandalone() const;
    // dynamic: not all degrees of freedom blocked
    bool isDynamic() const;
    void setDynamic(bool);
    bool isBounded() const;
    void setBounded(bool);
    bool isAspherical() const;
    void setAspherical(bool);

    virtual void userForcedDisplacementRedrawHook();

    Body::id_t getId() const { return id; }
    unsigned int coordNumber() const;
    mask_t getGroupMask() const { return groupMask; }
    bool maskOk(int mask) const;
    bool maskCompatible(int mask) const;

    Body::id_t id;
    mask_t groupMask;
    int flags;
    int subdomain;
    shared_ptr<Material> material;
    shared_ptr<State> state;
    shared_ptr<Shape> shape;
    shared_ptr<Bound> bound;
    // by id of the other body; kept by InteractionContainer
    MapId2IntrT intrs;
    Body::id_t clumpId;
    long iterBorn;
    Real timeBorn;

    Body();
    virtual ~Body();
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(Body, 176,
                ((id, 24))((groupMask, 28))((flags, 32))((subdomain, 36))((material, 40))((state, 56))((shape, 72))(
                    (bound, 88))((intrs, 104))((clumpId, 152))((iterBorn, 160))((timeBorn, 168)));
YADE_ABI_SAVED(Body)

} // namespace yade

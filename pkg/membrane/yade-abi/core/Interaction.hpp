// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <core/IGeom.hpp>
#include <core/IPhys.hpp>

namespace yade {

class IGeomFunctor;
class IPhysFunctor;
class LawFunctor;
class Scene;

class Interaction : public Serializable {
public:
    bool isReal() const;
    // became real in this step
    bool isFresh(Scene*);
    bool isActive;

    // leaves iterLastSeen, linIx and iterBorn unset
    Interaction(Body::id_t, Body::id_t);
    const Body::id_t& getId1() const { return id1; }
    const Body::id_t& getId2() const { return id2; }
    // possible only while neither geom nor phys is set
    void swapOrder();
    bool operator<(const Interaction& other) const { return id1 < other.id1 || (id1 == other.id1 && id2 < other.id2); }

    // survives a change of the engines
    struct {
        bool geomExists;
        shared_ptr<IGeomFunctor> geom;
        shared_ptr<IPhysFunctor> phys;
        shared_ptr<LawFunctor> constLaw;
    } functorCache;

    // forgets everything but the ids and cellDist
    void reset();
    void init();
    ::boost::python::dict pyDictCustom() const override;

    Body::id_t id1;
    Body::id_t id2;
    long iterMadeReal;
    long iterLastSeen;
    shared_ptr<IGeom> geom;
    shared_ptr<IPhys> phys;
    // of body 2, in periods
    Vector3i cellDist;
    int linIx;
    long iterBorn;

    Interaction();
    virtual ~Interaction();
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(Interaction, 168,
                ((isActive, 24))((functorCache.geomExists, 32))((functorCache.geom, 40))((functorCache.phys, 56))(
                    (functorCache.constLaw, 72))((id1, 88))((id2, 92))((iterMadeReal, 96))((iterLastSeen, 104))(
                    (geom, 112))((phys, 128))((cellDist, 144))((linIx, 156))((iterBorn, 160)));
YADE_ABI_SAVED(Interaction)

} // namespace yade

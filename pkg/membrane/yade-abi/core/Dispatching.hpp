// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Aabb.hpp>
#include <core/Functor.hpp>
#include <core/IGeom.hpp>
#include <core/IPhys.hpp>
#include <core/Interaction.hpp>
#include <core/Scene.hpp>
#include <core/Shape.hpp>
#include <core/State.hpp>

namespace yade {

class BoundFunctor
    : public Functor1D<Shape, void,
                       boost::mpl::vector<const shared_ptr<Shape>&, shared_ptr<Bound>&, const Se3r&, const Body*>> {
public:
    BoundFunctor() {}
    virtual ~BoundFunctor();
    YADE_ABI_SERIALIZABLE
};

// true if there is, or if force demands, a geometry for the pair; shift2 is the period of the second body
class IGeomFunctor
    : public Functor2D<
          Shape, Shape, bool,
          boost::mpl::vector<const shared_ptr<Shape>&, const shared_ptr<Shape>&, const State&, const State&,
                             const Vector3r&, // shift2
                             const bool&,     // force
                             const shared_ptr<Interaction>&>> {
public:
    IGeomFunctor() {}
    virtual ~IGeomFunctor();
    // before the interactions of a step
    virtual void preStep();
    YADE_ABI_SERIALIZABLE
};

// called in every step: leaves an existing phys alone
class IPhysFunctor : public Functor2D<Material, Material, void,
                                      boost::mpl::vector<const shared_ptr<Material>&, const shared_ptr<Material>&,
                                                         const shared_ptr<Interaction>&>> {
public:
    IPhysFunctor() {}
    virtual ~IPhysFunctor();
    YADE_ABI_SERIALIZABLE
};

// false ends the interaction
class LawFunctor
    : public Functor2D<IGeom, IPhys, bool, boost::mpl::vector<shared_ptr<IGeom>&, shared_ptr<IPhys>&, Interaction*>> {
public:
    LawFunctor() {}
    virtual ~LawFunctor();

    void addForce(const Body::id_t id, const Vector3r& force, Scene* s) { s->forces.addForce(id, force); }
    void addTorque(const Body::id_t id, const Vector3r& torque, Scene* s) { s->forces.addTorque(id, torque); }
    // force on body 1, its opposite on body 2, and the moments of both about pos1 and pos2
    void applyForceAtContactPoint(const Vector3r& force, const Vector3r& contactPoint, const Body::id_t id1,
                                  const Vector3r& pos1, const Body::id_t id2, const Vector3r& pos2) {
        addForce(id1, force, scene);
        addForce(id2, -force, scene);
        const Vector3r arm1 = contactPoint - pos1, arm2 = contactPoint - pos2;
        addTorque(id1, arm1.cross(force), scene);
        addTorque(id2, force.cross(arm2), scene);
    }
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(BoundFunctor, 88, );
YADE_ABI_LAYOUT(IGeomFunctor, 88, );
YADE_ABI_LAYOUT(IPhysFunctor, 88, );
YADE_ABI_LAYOUT(LawFunctor, 88, );
YADE_ABI_SAVED(BoundFunctor)
YADE_ABI_SAVED(IGeomFunctor)
YADE_ABI_SAVED(IPhysFunctor)
YADE_ABI_SAVED(LawFunctor)

} // namespace yade

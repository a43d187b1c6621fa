// SPDX-License-Identifier: GPL-2.0-or-later
// The Python extension module `_membrane`: registers the plugin's classes with a YADE that is running already.
// In a YADE tree the classes are native: nothing of this is compiled there.
#ifdef MEMBRANE_MODULE
#include "Membrane.hpp"
#include <core/BodyContainer.hpp>
#include <core/Dispatching.hpp>
#include <core/Engine.hpp>
#include <core/Interaction.hpp>
#include <core/InteractionContainer.hpp>
#include <core/Omega.hpp>
#include <core/PartialEngine.hpp>
#include <core/Scene.hpp>
#include <core/TimeStepper.hpp>
#include <cstdint>
#include <lib/factory/ClassFactory.hpp>
#include <pkg/common/FieldApplier.hpp>
#include <pkg/common/NormShearPhys.hpp>
#include <pkg/common/OpenGLRenderer.hpp>
#include <pkg/common/Sphere.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>
#include <pkg/dem/ScGeom.hpp>

// The release of YADE whose classes this was compiled for. Found in the file, before it is loaded, by the package.
extern "C" const char membrane_release[] = "membrane for YADE " MEMBRANE_YADE;

namespace {

namespace py = boost::python;
using namespace yade;

// Omega::buildDynlibDatabase is private; an explicit instantiation may name it all the same.
struct BuildDatabase {
    using Member = void (Omega::*)(const vector<string>&);
    friend Member memberOf(BuildDatabase);
};
template <class Tag, typename Tag::Member member> struct Expose {
    friend typename Tag::Member memberOf(Tag) { return member; }
};
template struct Expose<BuildDatabase, &Omega::buildDynlibDatabase>;

/// Makes the classes of these names known to YADE's class list and to yade.wrapper.
void registerClasses(const vector<string>& names) {
    (Omega::instance().*memberOf(BuildDatabase()))(names);
    // Left in the list of plugins, they would be registered a second time when another plugin is loaded.
    for (const string& name : names) ClassFactory::instance().pluginClasses.remove(name);
}

/// Lets a 3D view that was opened before the classes came know their shapes: YADE would stop at the first node.
void renewDrawing(const shared_ptr<Serializable>& renderer) {
    if (renderer->getClassName() != "OpenGLRenderer") throw std::invalid_argument("renew_drawing: no OpenGLRenderer");
    static_cast<OpenGLRenderer&>(*renderer).initgl();
}

// What the layout check shows of a member: numbers as they are, of what must not be followed to a wrong place only
// where it points to or how long it is.
template <class T, std::enable_if_t<std::is_arithmetic_v<T>, int> = 0> py::object shown(T number) {
    return py::object(number);
}
py::object shown(const Vector3r& v) {
    return py::make_tuple(v[0], v[1], v[2]);
}
py::object shown(const Quaternionr& q) {
    return py::make_tuple(q.x(), q.y(), q.z(), q.w());
}
py::object shown(const void* place) {
    return py::object(reinterpret_cast<std::uintptr_t>(place));
}
template <class T> py::object shown(const shared_ptr<T>& object) {
    return shown(static_cast<const void*>(object.get()));
}
template <class T> py::object shown(const vector<T>& several) {
    return py::object(several.size());
}
py::object shown(const string& text) {
    return py::object(text.size());
}

#define MEMBRANE_SEE_ONE(r, object, member) seen[BOOST_PP_STRINGIZE(member)] = shown((object)->member);
#define MEMBRANE_SEE(Class, members)                                                                                   \
    if (const auto* const object = dynamic_cast<const Class*>(&given)) {                                               \
        BOOST_PP_SEQ_FOR_EACH(MEMBRANE_SEE_ONE, object, members)                                                       \
    }

/// What the compiled offsets find in a native object, of all members that the plugin uses; the package compares it with
/// what Python wrote there.
py::dict fieldsOf(const Serializable& given) {
    py::dict seen;
    MEMBRANE_SEE(Scene, (dt)(iter)(subStep)(time)(speed)(stopAtIter)(stopAtTime)(isPeriodic)(trackEnergy)(doSort))
    MEMBRANE_SEE(Scene, (engines)(_nextEngines)(energy)(materials))
    MEMBRANE_SEE(Body, (id)(groupMask)(flags)(material)(state)(shape)(bound)(clumpId))
    MEMBRANE_SEE(State, (pos)(ori)(vel)(mass)(angVel)(inertia)(refPos)(blockedDOFs))
    MEMBRANE_SEE(Sphere, (radius))
    MEMBRANE_SEE(Bound, (refPos)(sweepLength))
    MEMBRANE_SEE(Material, (id)(density))
    MEMBRANE_SEE(ElastMat, (young)(poisson))
    MEMBRANE_SEE(FrictMat, (frictionAngle))
    MEMBRANE_SEE(Interaction, (id1)(id2)(iterMadeReal)(geom)(phys)(linIx))
    MEMBRANE_SEE(GenericSpheresContact, (normal)(contactPoint)(refR1)(refR2))
    MEMBRANE_SEE(ScGeom, (penetrationDepth)(shearInc))
    MEMBRANE_SEE(NormPhys, (kn)(normalForce))
    MEMBRANE_SEE(NormShearPhys, (ks)(shearForce))
    MEMBRANE_SEE(Functor, (label))
    MEMBRANE_SEE(Engine, (scene)(dead)(ompThreads)(label))
    MEMBRANE_SEE(PartialEngine, (ids))
    MEMBRANE_SEE(TimeStepper, (active)(timeStepUpdateInterval))
    MEMBRANE_SEE(FieldApplier, (fieldWorkIx))
    MEMBRANE_SEE(NewtonIntegrator, (damping)(gravity)(maxVelocitySq)(mask))
    MEMBRANE_SEE(GlExtraDrawer, (dead))
    return seen;
}

/// What the compiled offsets find where Python sees nothing: in the containers of a new scene, once YADE has put two
/// bodies, their interaction and a force into them.
py::dict fieldsOfContainers(Scene& scene) {
    for (int i = 0; i < 2; ++i) scene.bodies->body.push_back(shared_ptr<Body>(new Body));
    const shared_ptr<Interaction> link(new Interaction(0, 1));
    py::dict seen;
    seen["bodies"] = scene.bodies->size();
    scene.interactions->insert(link);
    seen["interactions"] = scene.interactions->size();
    seen["interactions listed"] = scene.interactions->end() - scene.interactions->begin();
    seen["interactions found"] = scene.interactions->found(1, 0);
    // as many as of the running scene's bodies, by which YADE sums and resets them
    scene.forces.addForce(static_cast<Body::id_t>(Omega::instance().getScene()->bodies->size()), Vector3r(1., 2., 3.));
    seen["forces added"] = scene.forces.synced;
    scene.forces.sync();
    seen["forces summed"] = scene.forces.synced;
    seen["sums of forces"] = scene.forces.syncCount;
    scene.forces.reset(7);
    seen["forces last reset"] = scene.forces.lastReset;
    return seen;
}

std::uintptr_t placeOf(const shared_ptr<Serializable>& object) {
    return reinterpret_cast<std::uintptr_t>(object.get());
}

/// Writes through the compiled offsets; the package reads it back from Python.
void writeState(const shared_ptr<State>& state, const Vector3r& vel, Real mass) {
    state->vel = vel;
    state->mass = mass;
}

} // namespace

BOOST_PYTHON_MODULE(_membrane) {
    py::def("register_classes", registerClasses);
    py::def("renew_drawing", renewDrawing);
    py::def("fields_of", fieldsOf);
    py::def("fields_of_containers", fieldsOfContainers);
    py::def("place_of", placeOf);
    py::def("write_state", writeState);
}
#endif

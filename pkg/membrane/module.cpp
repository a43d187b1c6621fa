// SPDX-License-Identifier: GPL-2.0-or-later
// The Python extension module `_membrane`: registers the plugin's classes with a YADE that is running already.
// In a YADE tree the classes are native: nothing of this is compiled there.
#ifdef MEMBRANE_MODULE
#include "Membrane.hpp"
#include <core/BodyContainer.hpp>
#include <core/Engine.hpp>
#include <core/Interaction.hpp>
#include <core/InteractionContainer.hpp>
#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include <lib/factory/ClassFactory.hpp>
#include <pkg/common/NormShearPhys.hpp>
#include <pkg/common/OpenGLRenderer.hpp>
#include <pkg/common/Sphere.hpp>
#include <pkg/dem/ScGeom.hpp>

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

py::tuple asTuple(const Vector3r& v) {
    return py::make_tuple(v[0], v[1], v[2]);
}

/// What the compiled offsets find in native objects; the package compares it with what Python wrote there.
py::dict fieldsOfBody(const shared_ptr<Body>& body) {
    py::dict seen;
    seen["mask"] = body->groupMask;
    seen["bounded"] = body->isBounded();
    seen["pos"] = asTuple(body->state->pos);
    seen["refPos"] = asTuple(body->state->refPos);
    seen["vel"] = asTuple(body->state->vel);
    seen["angVel"] = asTuple(body->state->angVel);
    seen["inertia"] = asTuple(body->state->inertia);
    seen["mass"] = body->state->mass;
    seen["blockedDOFs"] = body->state->blockedDOFs;
    seen["radius"] = dynamic_cast<Sphere&>(*body->shape).radius;
    const auto& material = dynamic_cast<FrictMat&>(*body->material);
    seen["density"] = material.density;
    seen["young"] = material.young;
    seen["poisson"] = material.poisson;
    seen["frictionAngle"] = material.frictionAngle;
    return seen;
}

py::dict fieldsOfInteraction(const shared_ptr<ScGeom>& geom, const shared_ptr<NormShearPhys>& phys) {
    py::dict seen;
    seen["normal"] = asTuple(geom->normal);
    seen["contactPoint"] = asTuple(geom->contactPoint);
    seen["refR1"] = geom->refR1;
    seen["refR2"] = geom->refR2;
    seen["penetrationDepth"] = geom->penetrationDepth;
    seen["kn"] = phys->kn;
    seen["ks"] = phys->ks;
    seen["normalForce"] = asTuple(phys->normalForce);
    seen["shearForce"] = asTuple(phys->shearForce);
    return seen;
}

py::dict fieldsOfEngine(const shared_ptr<Engine>& engine) {
    py::dict seen;
    seen["dead"] = engine->dead;
    seen["ompThreads"] = engine->ompThreads;
    seen["label"] = engine->label;
    return seen;
}

py::dict fieldsOfDrawer(const shared_ptr<GlExtraDrawer>& drawer) {
    py::dict seen;
    seen["dead"] = drawer->dead;
    return seen;
}

py::dict fieldsOfScene() {
    const shared_ptr<Scene> scene = Omega::instance().getScene();
    py::dict seen;
    seen["dt"] = scene->dt;
    seen["iter"] = scene->iter;
    seen["time"] = scene->time;
    seen["trackEnergy"] = scene->trackEnergy;
    seen["bodies"] = scene->bodies->size();
    seen["interactions"] = scene->interactions->size();
    seen["materials"] = scene->materials.size();
    seen["engines"] = scene->engines.size();
    return seen;
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
    py::def("fields_of_body", fieldsOfBody);
    py::def("fields_of_interaction", fieldsOfInteraction);
    py::def("fields_of_engine", fieldsOfEngine);
    py::def("fields_of_drawer", fieldsOfDrawer);
    py::def("fields_of_scene", fieldsOfScene);
    py::def("write_state", writeState);
}
#endif

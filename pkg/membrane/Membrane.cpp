// SPDX-License-Identifier: GPL-2.0-or-later
#include "Membrane.hpp"
#include "BodyAt.hpp"
#include "Buffers.hpp"
#include "MembraneGeom.hpp"
#include "MembraneNode.hpp"
#include "MembranePhys.hpp"
#include "mechanics/SideForce.hpp"
#include <algorithm>
#include <cmath>
#include <core/Interaction.hpp>
#include <core/InteractionContainer.hpp>
#include <core/Omega.hpp>
#include <numeric>
#include <utility>

namespace yade {

YADE_PLUGIN((Membrane));

namespace {

/// One value a side, computed from the side.
template <class Get> auto ofSides(const ::membrane::RestState& rest, Get get) {
    vector<decltype(get(rest.sides[0]))> values;
    values.reserve(rest.sides.size());
    for (const ::membrane::Side& side : rest.sides) values.push_back(get(side));
    return values;
}

/// Fills an attribute from an array among the constructor's keywords; a list is left to YADE.
template <class T> void takeArray(boost::python::dict& keywords, const char* name, vector<T>& attribute) {
    if (keywords.has_key(name) &&
        copyBuffer(boost::python::object(keywords[name]), string("Membrane: ") + name, attribute))
        keywords[name].del();
}

/// A triangle of a film of plane stress at some places of the nodes.
struct FilmTriangle {
    ::membrane::FilmRest rest;
    ::membrane::FilmSides atRest, sides;
    Vector3r grown; ///< l² - L² of the sides [m²]

    FilmTriangle(const Membrane& of, const Vector3i& t, const ::membrane::Points& x)
        : rest(of.nodes[t[0]], of.nodes[t[1]], of.nodes[t[2]]), atRest(of.nodes[t[0]], of.nodes[t[1]], of.nodes[t[2]]),
          sides(x[t[0]], x[t[1]], x[t[2]]), grown(sides.grown(rest)) {}

    /// Unit vector along the material line of the first principal strain.
    Vector3r alongFirst(const ::membrane::FilmStrain& strain) const {
        const Real angle = 0.5 * std::atan2(strain.shear, strain.normal); // from side 0, the x axis at rest
        const Vector3r x = atRest.side[0].normalized();
        const Vector3r z = atRest.side[0].cross(atRest.side[1]).normalized();
        const Vector3r along = std::cos(angle) * x + std::sin(angle) * z.cross(x);
        // along = p side 0 + q side 1, which the film carries along
        const Vector3r p = atRest.side[1].cross(z), q = z.cross(atRest.side[0]);
        const Real size = p.dot(atRest.side[0]);
        return (along.dot(p) / size * sides.side[0] + along.dot(q) / size * sides.side[1]).normalized();
    }
};

vector<FilmTriangle> filmTriangles(const Membrane& of, const ::membrane::Points& x) {
    vector<FilmTriangle> all;
    all.reserve(of.triangles.size());
    for (const Vector3i& t : of.triangles) all.emplace_back(of, t, x);
    return all;
}

} // namespace

void Membrane::pyHandleCustomCtorArgs(boost::python::tuple&, boost::python::dict& keywords) {
    const bool any = boost::python::len(keywords) > 0;
    takeArray(keywords, "nodes", nodes);
    takeArray(keywords, "triangles", triangles);
    takeArray(keywords, "creases", creases);
    takeArray(keywords, "creaseSigns", creaseSigns);
    takeArray(keywords, "cables", cables);
    takeArray(keywords, "pointMasses", pointMasses);
    if (any && boost::python::len(keywords) == 0)
        callPostLoad(); // which YADE does only if it finds keywords
    else
        isAboutToLoadTwice_ = any;
}

void Membrane::postLoad(Membrane&) {
    if (std::exchange(isAboutToLoadTwice_, false)) return; // YADE's constructor calls it twice, and it takes long
    const StepGuard::Look look;
    ++version_;
    rest_ = ::membrane::RestState();                                  // what follows may refuse the attributes
    if (nodes.empty() && triangles.empty() && cables.empty()) return; // default constructed: filled in later by loading
    if (!material && !triangles.empty())
        throw std::invalid_argument("Membrane: material is missing; give a MembraneMat");
    ::membrane::MeshInput input;
    input.nodes = nodes;
    input.triangles = triangles;
    input.creases = creases;
    input.creaseSigns = creaseSigns;
    input.cables = cables;
    input.pointMasses = pointMasses;
    if (material) {
        input.young = young_ = material->young;
        input.poisson = poisson_ = material->poisson;
        input.thickness = thickness_ = material->thickness;
        input.density = material->density;
    }
    input.cableStiffness = cableStiffness;
    input.cableDensity = cableDensity;
    if (film != "springs" && film != "plane_stress")
        throw std::invalid_argument("Membrane: film = " + film + " must be 'springs' or 'plane_stress'");
    for (const auto& [name, length] : {std::pair<const char*, Real>("bucklingLength", bucklingLength),
                                       std::pair<const char*, Real>("creaseBucklingLength", creaseBucklingLength)})
        if (!(length >= 0.) || !std::isfinite(length))
            throw std::invalid_argument(string("Membrane: ") + name + " = " + std::to_string(length) +
                                        " m must be finite and >= 0");
    input.planeStress = film == "plane_stress";
    const auto stressOf = [&](Real length) {
        return length > 0. ? ::membrane::bucklingStress(input.young, input.poisson, input.thickness, length) : 0.;
    };
    input.buckling = stressOf(bucklingLength);
    input.bucklingCrease = stressOf(creaseBucklingLength);
    input.alpha = alpha;
    input.alphaCrease = alphaCrease;
    input.allowNegativeStiffness = allowNegativeStiffness;
    rest_ = ::membrane::restState(input);
    if (!bodyIds.empty()) indexBodies();
}

::membrane::FilmLaw Membrane::filmLaw(Real dampingTime) const {
    ::membrane::FilmLaw law;
    law.young = young_;
    law.poisson = poisson_;
    law.thickness = thickness_;
    law.buckling = bucklingStress();
    law.time = dampingTime;
    return law;
}

Real Membrane::bucklingStress() const {
    return bucklingLength > 0. && young_ > 0. ? ::membrane::bucklingStress(young_, poisson_, thickness_, bucklingLength)
                                              : 0.;
}

void Membrane::checkUnchanged() const {
    if (material && (material->young != young_ || material->poisson != poisson_ || material->thickness != thickness_))
        throw std::runtime_error(
            "Membrane: young, poisson or thickness of its material was changed after the membrane was "
            "made; make a new one");
}

void Membrane::indexBodies() {
    if (bodyIds.size() != nodes.size())
        throw std::invalid_argument("Membrane: bodyIds has " + std::to_string(bodyIds.size()) +
                                    " entries; it must have one for each of the " + std::to_string(nodes.size()) +
                                    " nodes");
    nodesByBody_.clear();
    if (std::is_sorted(bodyIds.begin(), bodyIds.end())) return;
    nodesByBody_.resize(bodyIds.size());
    std::iota(nodesByBody_.begin(), nodesByBody_.end(), 0);
    std::sort(nodesByBody_.begin(), nodesByBody_.end(), [this](int a, int b) { return bodyIds[a] < bodyIds[b]; });
}

int Membrane::nodeOf(Body::id_t body) const {
    if (nodesByBody_.empty()) {
        if (bodyIds.empty() || body < bodyIds.front() || body > bodyIds.back()) return -1; // most are others'
        const auto found = std::lower_bound(bodyIds.begin(), bodyIds.end(), body);
        return found != bodyIds.end() && *found == body ? static_cast<int>(found - bodyIds.begin()) : -1;
    }
    const auto found = std::lower_bound(nodesByBody_.begin(), nodesByBody_.end(), body,
                                        [this](int node, Body::id_t wanted) { return bodyIds[node] < wanted; });
    return found != nodesByBody_.end() && bodyIds[*found] == body ? *found : -1;
}

int Membrane::sideBetween(Body::id_t a, Body::id_t b) const {
    return rest_.sideBetween(nodeOf(a), nodeOf(b));
}

bool Membrane::isNode(const Body& body, int node) const {
    const auto* const shape = dynamic_cast<const MembraneNode*>(body.shape.get());
    return shape && body.state && shape->membrane.get() == this && shape->node == node;
}

int Membrane::nodeWithoutBody(const Scene& scene) const {
    for (std::size_t i = 0; i < bodyIds.size(); ++i) {
        const shared_ptr<Body> body = bodyAt(scene, bodyIds[i]);
        if (!body || !isNode(*body, static_cast<int>(i))) return static_cast<int>(i);
    }
    return -1;
}

vector<shared_ptr<Body>> Membrane::bodies(const Scene& scene) const {
    if (bodyIds.size() != nodes.size() || nodes.empty())
        throw std::runtime_error("Membrane: its nodes have no bodies yet; call addBodies() first");
    if (const int lost = nodeWithoutBody(scene); lost >= 0)
        throw std::runtime_error("Membrane: body #" + std::to_string(bodyIds[lost]) + " of node " +
                                 std::to_string(lost) + " is not in the scene");
    vector<shared_ptr<Body>> found;
    found.reserve(bodyIds.size());
    for (const int id : bodyIds) found.push_back((*scene.bodies)[id]);
    return found;
}

vector<shared_ptr<State>> Membrane::states(const Scene& scene) const {
    vector<shared_ptr<State>> states;
    states.reserve(bodyIds.size());
    for (const auto& body : bodies(scene)) states.push_back(body->state);
    return states;
}

::membrane::Points Membrane::positions(const Scene& scene, const vector<Vector3r>& given) const {
    if (given.size() == nodes.size()) return given;
    if (!given.empty())
        throw std::invalid_argument("Membrane: positions has " + std::to_string(given.size()) +
                                    " points; it must have one for each of the " + std::to_string(nodes.size()) +
                                    " nodes");
    ::membrane::Points x;
    x.reserve(nodes.size());
    for (const auto& state : states(scene)) x.push_back(state->pos);
    return x;
}

vector<int> Membrane::addBodies(const vector<Vector3r>& at, Real radius) {
    const shared_ptr<Scene> scene = Omega::instance().getScene();
    const vector<Vector3r>& place = at.empty() ? nodes : at;
    if (nodes.empty()) throw std::invalid_argument("Membrane: nodes is empty; give it to the constructor");
    if (!bodyIds.empty()) throw std::runtime_error("Membrane: its bodies were added already");
    if (!material) throw std::invalid_argument("Membrane: material is missing; give a MembraneMat");
    if (place.size() != nodes.size())
        throw std::invalid_argument("Membrane.addBodies: positions has " + std::to_string(place.size()) +
                                    " points; it must have one for each of the " + std::to_string(nodes.size()) +
                                    " nodes");
    if (!(radius > 0.) || !std::isfinite(radius))
        throw std::invalid_argument("Membrane.addBodies: radius = " + std::to_string(radius) +
                                    " must be finite and > 0");
    for (std::size_t i = 0; i < place.size(); ++i)
        if (!place[i].allFinite())
            throw std::invalid_argument("Membrane.addBodies: positions[" + std::to_string(i) + "] must be finite");

    if (material->id < 0) scene->addMaterial(material);
    const auto self = boost::static_pointer_cast<Membrane>(shared_from_this());
    bodyIds.reserve(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const shared_ptr<Body> body(new Body);
        const shared_ptr<MembraneNode> node(new MembraneNode);
        node->radius = radius;
        node->membrane = self;
        node->node = static_cast<int>(i);
        body->shape = node;
        body->material = material;
        body->setBounded(false);
        body->state->pos = body->state->refPos = place[i];
        body->state->mass = rest_.masses[i];
        body->state->inertia = Vector3r::Constant(0.4 * rest_.masses[i] * radius * radius);
        body->state->blockedDOFs = State::DOF_RXRYRZ;
        bodyIds.push_back(scene->bodies->insert(body));
    }
    indexBodies();
    return bodyIds;
}

vector<int> Membrane::addBodiesPy(const boost::python::object& at, Real radius) {
    return addBodies(pointsFrom(at, "Membrane.addBodies: positions"), radius);
}

void Membrane::addInteractions() {
    const shared_ptr<Scene> scene = Omega::instance().getScene();
    const ::membrane::Points x = positions(*scene);
    for (const ::membrane::Side& side : rest_.sides) {
        if (!rest_.isSpring(side)) continue;
        const shared_ptr<Interaction> link(new Interaction(bodyIds[side.a], bodyIds[side.b]));
        const shared_ptr<MembraneGeom> geom(new MembraneGeom);
        geom->refR1 = geom->refR2 = 0.5 * side.restLength;
        geom->update(x[side.a], x[side.b]);
        link->geom = geom;
        link->phys = shared_ptr<MembranePhys>(new MembranePhys(side));
        link->iterMadeReal = scene->iter;
        if (!scene->interactions->insert(link))
            throw std::runtime_error("Membrane.addInteractions: bodies #" + std::to_string(bodyIds[side.a]) + " and #" +
                                     std::to_string(bodyIds[side.b]) + " interact already");
    }
}

void Membrane::removeInteractions() {
    if (bodyIds.empty()) return;
    const shared_ptr<Scene> scene = Omega::instance().getScene();
    bodies(*scene); // refuses those of another scene
    InteractionContainer& interactions = *scene->interactions;
    for (const ::membrane::Side& side : rest_.sides) {
        const shared_ptr<Interaction>& link = interactions.find(bodyIds[side.a], bodyIds[side.b]);
        if (link && dynamic_cast<MembranePhys*>(link->phys.get()))
            interactions.erase(link->getId1(), link->getId2(), link->linIx);
    }
}

bool Membrane::hasInteractions() const {
    const shared_ptr<Scene> scene = Omega::instance().getScene();
    const auto isThere = [&](const ::membrane::Side& side) {
        const auto& link = scene->interactions->find(bodyIds[side.a], bodyIds[side.b]);
        return rest_.isSpring(side) && link && dynamic_cast<MembranePhys*>(link->phys.get());
    };
    return !bodyIds.empty() && nodeWithoutBody(*scene) < 0 &&
           std::any_of(rest_.sides.begin(), rest_.sides.end(), isThere);
}

Real Membrane::elasticEnergy() const {
    const shared_ptr<Scene> scene = Omega::instance().getScene();
    const ::membrane::Points x = positions(*scene);
    Real energy = 0.;
    for (const ::membrane::Side& s : rest_.sides)
        if (rest_.isSpring(s))
            energy += ::membrane::sideEnergy((x[s.b] - x[s.a]).norm(), s.stiffness, s.restLength, s.critical);
    if (!rest_.planeStress) return energy;
    const ::membrane::FilmLaw law = filmLaw();
    for (const FilmTriangle& t : filmTriangles(*this, x)) energy += ::membrane::filmEnergy(law, t.rest, t.grown);
    return energy;
}

vector<Real> Membrane::lengths(const boost::python::object& at) const {
    const ::membrane::Points x =
        positions(*Omega::instance().getScene(), pointsFrom(at, "Membrane.lengths: positions"));
    return ofSides(rest_, [&x](const ::membrane::Side& s) -> Real { return (x[s.b] - x[s.a]).norm(); });
}

vector<Real> Membrane::tensions(const boost::python::object& at) const {
    const ::membrane::Points x =
        positions(*Omega::instance().getScene(), pointsFrom(at, "Membrane.tensions: positions"));
    vector<Real> tensions = ofSides(rest_, [&](const ::membrane::Side& s) -> Real {
        const Real length = (x[s.b] - x[s.a]).norm();
        return rest_.isSpring(s) ? ::membrane::sideTension(length, s.stiffness, s.restLength, s.critical) : 0.;
    });
    if (!rest_.planeStress) return tensions;
    const ::membrane::FilmLaw law = filmLaw();
    const auto all = filmTriangles(*this, x);
    for (std::size_t i = 0; i < all.size(); ++i) { // those of the triangles, along their sides
        const Vector3r g = ::membrane::filmGradient(law, all[i].rest, all[i].grown);
        const Vector3i& t = triangles[i];
        for (int k = 0; k < 3; ++k)
            tensions[rest_.sideBetween(t[(k + 1) % 3], t[(k + 2) % 3])] += 2. * g[k] * all[i].sides.side[k].norm();
    }
    return tensions;
}

vector<::membrane::FilmState> Membrane::filmStatesAt(const ::membrane::Points& x) const {
    vector<::membrane::FilmState> states(triangles.size(), ::membrane::FilmState::taut);
    if (!rest_.planeStress) return states;
    const ::membrane::FilmLaw law = filmLaw();
    std::transform(triangles.begin(), triangles.end(), states.begin(), [&](const Vector3i& corners) {
        const FilmTriangle t(*this, corners, x);
        return ::membrane::filmState(law, ::membrane::filmStrain(t.rest, t.grown));
    });
    return states;
}

vector<int> Membrane::filmStates(const boost::python::object& at) const {
    vector<int> numbers;
    for (const ::membrane::FilmState state :
         filmStatesAt(positions(*Omega::instance().getScene(), pointsFrom(at, "Membrane.filmStates: positions"))))
        numbers.push_back(static_cast<int>(state));
    return numbers;
}

vector<Vector2r> Membrane::filmStresses(const boost::python::object& at) const {
    requirePlaneStress("filmStresses");
    const ::membrane::Points x =
        positions(*Omega::instance().getScene(), pointsFrom(at, "Membrane.filmStresses: positions"));
    const ::membrane::FilmLaw law = filmLaw();
    vector<Vector2r> stresses;
    for (const FilmTriangle& t : filmTriangles(*this, x)) {
        const ::membrane::FilmStrain strain = ::membrane::filmStrain(t.rest, t.grown);
        const ::membrane::FilmStress stress = ::membrane::filmStress(law, strain);
        stresses.emplace_back(stress.mean + stress.shear * strain.half, stress.mean - stress.shear * strain.half);
    }
    return stresses;
}

vector<Vector3r> Membrane::wrinkleDirections(const boost::python::object& at) const {
    requirePlaneStress("wrinkleDirections");
    const ::membrane::Points x =
        positions(*Omega::instance().getScene(), pointsFrom(at, "Membrane.wrinkleDirections: positions"));
    const ::membrane::FilmLaw law = filmLaw();
    vector<Vector3r> directions;
    for (const FilmTriangle& t : filmTriangles(*this, x)) {
        const ::membrane::FilmStrain strain = ::membrane::filmStrain(t.rest, t.grown);
        const bool wrinkled = ::membrane::filmState(law, strain) == ::membrane::FilmState::wrinkled;
        directions.push_back(wrinkled ? t.alongFirst(strain) : Vector3r(Vector3r::Zero()));
    }
    return directions;
}

void Membrane::requirePlaneStress(const char* method) const {
    if (!rest_.planeStress)
        throw std::invalid_argument(string("Membrane.") + method + ": film = " + film + " must be 'plane_stress'");
}

boost::python::list Membrane::sidesPy() const {
    boost::python::list pairs;
    for (const ::membrane::Side& s : rest_.sides) pairs.append(boost::python::make_tuple(s.a, s.b));
    return pairs;
}

vector<int> Membrane::sideKinds() const {
    return ofSides(rest_, [](const ::membrane::Side& s) { return static_cast<int>(s.kind); });
}

vector<Real> Membrane::restLengths() const {
    return ofSides(rest_, [](const ::membrane::Side& s) { return s.restLength; });
}

vector<Real> Membrane::stiffnesses() const {
    return ofSides(rest_, [](const ::membrane::Side& s) { return s.stiffness; });
}

vector<Real> Membrane::criticalLengths() const {
    return ofSides(rest_, [](const ::membrane::Side& s) { return s.critical; });
}

} // namespace yade

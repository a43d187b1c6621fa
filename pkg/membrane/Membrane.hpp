// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "MembraneMat.hpp"
#include "StepGuard.hpp"
#include "mechanics/FilmTriangle.hpp"
#include "mechanics/RestState.hpp"
#include <core/Body.hpp>
#include <core/State.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class Scene;

class Membrane : public Serializable {
public:
    void postLoad(Membrane&);
    void pyHandleCustomCtorArgs(boost::python::tuple& args, boost::python::dict& keywords) override;

    const ::membrane::RestState& rest() const { return rest_; }
    /// Changes whenever rest() does.
    long version() const { return version_; }
    /// Throws std::runtime_error if the material is no longer the one from which the rest state was computed.
    void checkUnchanged() const;
    /// Node whose body has this id; -1 if none has.
    int nodeOf(Body::id_t body) const;
    /// Index in rest().sides of the side between two bodies; -1 if there is none.
    int sideBetween(Body::id_t a, Body::id_t b) const;
    /// The nodes' bodies in the scene. Throws std::runtime_error naming a node without a body there.
    vector<shared_ptr<Body>> bodies(const Scene& scene) const;
    vector<shared_ptr<State>> states(const Scene& scene) const;
    /// Whether a body is that of a node of this membrane, and not another scene's of the same id.
    bool isNode(const Body& body, int node) const;
    /// `given` if it has a point for each node, the present positions in the scene if it is empty [m].
    ::membrane::Points positions(const Scene& scene, const vector<Vector3r>& given = {}) const;

    /// The film, if it is one of plane stress. \param dampingTime tau [s]
    ::membrane::FilmLaw filmLaw(Real dampingTime = 0.) const;
    /// States of the triangles at some places of the nodes [m]; all taut where the film is one of springs.
    vector<::membrane::FilmState> filmStatesAt(const ::membrane::Points& x) const;

    vector<int> addBodies(const vector<Vector3r>& at, Real radius);
    vector<int> addBodiesPy(const boost::python::object& at, Real radius);
    void addInteractions();
    void removeInteractions();
    bool hasInteractions() const;
    Real elasticEnergy() const;

    boost::python::list sidesPy() const;
    vector<int> sideKinds() const;
    vector<Real> restLengths() const;
    vector<Real> stiffnesses() const;
    vector<Real> criticalLengths() const;
    vector<Real> masses() const { return rest_.masses; }
    vector<Real> lengths(const boost::python::object& at) const;
    vector<Real> tensions(const boost::python::object& at) const;
    vector<int> filmStates(const boost::python::object& at) const;
    vector<Vector2r> filmStresses(const boost::python::object& at) const;
    vector<Vector3r> wrinkleDirections(const boost::python::object& at) const;
    Real bucklingStress() const;
    Real area() const { return rest_.area; }

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(Membrane, Serializable,
        "Mesh and rest state of a membrane: a film of triangles, creases on some of its sides, and cables. The attributes are "
        "given once, as keywords of the constructor (lists, or numpy arrays, which take less time), and checked there; everything else "
        "follows from them. Sides are numbered film first, then cables.",
        ((shared_ptr<MembraneMat>, material, , Attr::readonly, "Film: E [Pa], nu [-], rho [kg/m³], thickness h [m]."))
        ((vector<Vector3r>, nodes, , Attr::readonly, "Rest positions of the N nodes [m]; only the distances in triangles and cables count."))
        ((vector<Vector3i>, triangles, , Attr::readonly, "Nodes of each of the T triangles (0..N-1); those that share a crease must run the same way round."))
        ((vector<Vector2i>, creases, , Attr::readonly, "Nodes of each of the C creases: sides of two triangles on a fold line."))
        ((vector<int>, creaseSigns, , Attr::readonly, "+1 mountain, -1 valley for each crease, seen from where the triangles run counter-clockwise."))
        ((vector<Vector2i>, cables, , Attr::readonly, "Nodes of each of the K cable segments (tethers), which bear no compression."))
        ((vector<Real>, pointMasses, , Attr::readonly, "Mass added to each node [kg], N values >= 0, or empty."))
        ((Real, cableStiffness, 200., Attr::readonly, "Axial stiffness EA of the cables [N], > 0."))
        ((Real, cableDensity, 2e-4, Attr::readonly, "Mass a length of the cables [kg/m], >= 0."))
        ((string, film, "springs", Attr::readonly, "'springs': paper equations (3), (5), (6), whose stiffness and buckling depend on the mesh; 'plane_stress': the same film on any mesh, "
            "with a tension field and the buckling stress of bucklingLength. Then only cables are sides that pull, and interactions; the film is a force of the MembraneForceEngine, without which it has none. Triangles of any shape are taken."))
        ((Real, alpha, 100., Attr::readonly, "Buckling parameter alpha of the film [-], >= 0, paper equation (6); of springs, unless bucklingLength is given."))
        ((Real, alphaCrease, 100., Attr::readonly, "Buckling parameter alpha_c of sides on creases [-], >= 0; of springs, unless creaseBucklingLength is given."))
        ((Real, bucklingLength, 0., Attr::readonly, "Half-wavelength l_b [m] at which the film buckles, under E pi² h² / (12 (1 - nu²) l_b²), on any mesh; 0: springs by alpha, plane stress bears no compression."))
        ((Real, creaseBucklingLength, 0., Attr::readonly, "The same of sides on creases [m]; 0: by alphaCrease. Only of springs."))
        ((bool, allowNegativeStiffness, false, Attr::readonly, "Accept flat triangles, to which equation (5) gives a negative stiffness [-]."))
        ((vector<int>, bodyIds, , Attr::readonly, "Body of each node; filled by addBodies."))
        ,
        ,
        .add_property("sides", &Membrane::sidesPy, "Node pairs (a, b), a < b, of the S sides.")
        .add_property("sideKinds", &Membrane::sideKinds, "Kind of each side: 0 film, 1 crease, 2 cable.")
        .add_property("restLengths", &Membrane::restLengths, "Rest length L0 of each side [m].")
        .add_property("stiffnesses", &Membrane::stiffnesses, "Stiffness k of each side [N/m], paper equation (5).")
        .add_property("criticalLengths", &Membrane::criticalLengths, "Length l_cr of each side below which it is buckled [m], paper equation (6).")
        .add_property("masses", &Membrane::masses, "Mass of each node [kg], paper equation (4), with cables and point masses.")
        .add_property("bucklingStress", &Membrane::bucklingStress, "Compression sigma_b that the film bears at most [Pa], of bucklingLength; 0 without it.")
        .def("filmStates", &Guarded<&Membrane::filmStates>::call, (boost::python::arg("positions") = boost::python::list()), "State of each triangle of a film of plane stress: 0 taut, "
            "1 wrinkled, 2 slack; at given positions of the N nodes [m], default: the present ones. Springs: all 0.")
        .def("filmStresses", &Guarded<&Membrane::filmStresses>::call, (boost::python::arg("positions") = boost::python::list()), "Principal stresses (first, second) of each triangle of a film of plane "
            "stress [Pa], second Piola-Kirchhoff; positions as of filmStates.")
        .def("wrinkleDirections", &Guarded<&Membrane::wrinkleDirections>::call, (boost::python::arg("positions") = boost::python::list()), "Unit vector along the first principal stress of each triangle, "
            "along which wrinkles run; 0 unless wrinkled. Positions as of filmStates.")
        .add_property("area", &Membrane::area, "Area of the film [m²].")
        .def("addBodies", &Guarded<&Membrane::addBodiesPy>::call, (boost::python::arg("positions") = boost::python::list(), boost::python::arg("radius") = 1e-3),
            "Add one sphere a node to the scene, without bound and with blocked rotations; returns the ids.\n\n"
            ":param positions: where to put the nodes [m], N points; default: the rest positions\n"
            ":param radius: of the spheres [m], > 0; it counts only for drawing and for contacts of bounded bodies")
        .def("addInteractions", &Guarded<&Membrane::addInteractions>::call, "Add one interaction a side, real from the start. Call addBodies first.")
        .def("removeInteractions", &Guarded<&Membrane::removeInteractions>::call, "Remove the interactions of the sides, if there are any.")
        .add_property("hasInteractions", &Guarded<&Membrane::hasInteractions>::call, "Whether the sides are interactions of the scene.")
        .def("elasticEnergy", &Guarded<&Membrane::elasticEnergy>::call, "Strain energy of all sides in the scene's present state [J].")
        .def("lengths", &Guarded<&Membrane::lengths>::call, (boost::python::arg("positions") = boost::python::list()), "Length of each side [m] at given positions of "
            "the N nodes [m]; default: the present ones.")
        .def("tensions", &Guarded<&Membrane::tensions>::call, (boost::python::arg("positions") = boost::python::list()), "Elastic tension of each side [N], negative in "
            "compression, at given positions of the N nodes [m]; default: the present ones.")
    );
    // clang-format on

private:
    ::membrane::RestState rest_;
    long version_ = 0;
    bool isAboutToLoadTwice_ = false;
    Real young_ = 0., poisson_ = 0., thickness_ = 0.; ///< with which rest_ was computed
    vector<int> nodesByBody_; ///< nodes in the order of their bodies' ids; empty if that is their own order

    void indexBodies();
    void requirePlaneStress(const char* method) const;
    /// The first node whose body is not in the scene; -1: all are there.
    int nodeWithoutBody(const Scene& scene) const;
};
REGISTER_SERIALIZABLE(Membrane);

} // namespace yade

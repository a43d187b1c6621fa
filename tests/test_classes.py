# SPDX-License-Identifier: GPL-2.0-or-later
"""The plugin's classes behave as YADE's own."""

import re
import unittest

import membrane
import numpy as np
from membrane import _load, scene
from support import VIEW, O, SceneTest, Sheet, grid, interaction_loop
from yade import system
from yade import wrapper as yade
from yade.minieigenHP import Vector3

BASES = {
    "MembraneMat": ("FrictMat", "ElastMat", "Material", "Serializable"),
    "Membrane": ("Serializable",),
    "MembraneNode": ("Sphere", "Shape", "Serializable"),
    "MembraneGeom": ("ScGeom", "GenericSpheresContact", "IGeom"),
    "Ig2_MembraneNode_MembraneNode_MembraneGeom": ("IGeomFunctor", "Functor"),
    "MembranePhys": ("NormShearPhys", "NormPhys", "IPhys"),
    "Ip2_MembraneMat_MembraneMat_MembranePhys": ("IPhysFunctor", "Functor"),
    "Law2_MembraneGeom_MembranePhys_Buckling": ("LawFunctor", "Functor"),
    "MembraneForceEngine": ("GlobalEngine", "Engine"),
    "MembraneIntegrator": ("MembraneForceEngine", "GlobalEngine", "Engine"),
    "CentrifugalField": ("FieldApplier", "GlobalEngine", "Engine"),
    "SpoolRotation": ("PartialEngine", "Engine"),
    "FreeHub": ("GlobalEngine", "Engine"),
    "MembraneLedger": ("GlobalEngine", "Engine"),
    "MembraneTimeStepper": ("TimeStepper", "GlobalEngine", "Engine"),
    "MembraneWatch": ("GlobalEngine", "Engine"),
    "MembraneFault": ("GlobalEngine", "Engine"),
    "GlExtra_Membrane": ("GlExtraDrawer", "Serializable"),
}
SETTINGS = {
    "MembraneMat": {"thickness": 1e-5, "young": 2e9, "label": "film"},
    "Membrane": {"alpha": 5.0, "cableStiffness": 30.0},
    "MembraneNode": {"radius": 0.25},
    "MembraneGeom": {"length": 0.5, "penetrationDepth": 0.1},
    "Ig2_MembraneNode_MembraneNode_MembraneGeom": {},
    "MembranePhys": {"restLength": 0.5, "criticalLength": 0.4, "kn": 3.0},
    "Ip2_MembraneMat_MembraneMat_MembranePhys": {},
    "Law2_MembraneGeom_MembranePhys_Buckling": {},
    "MembraneForceEngine": {"beta": 3.0, "creaseLaw": "conservative", "dead": True},
    "MembraneIntegrator": {"zeta": 0.1, "exchangePeriod": 7, "dead": True},
    "CentrifugalField": {"omega": 2.0},
    "SpoolRotation": {"angularVelocity": 3.0, "reach": 0.1},
    "FreeHub": {"inertia": 2.0, "spin": 3.0},
    "MembraneLedger": {"gravity": Vector3(0, 0, -1), "dead": True},
    "MembraneTimeStepper": {"fraction": 0.3, "active": False},
    "MembraneWatch": {"tolerance": 0.3, "period": 7},
    "MembraneFault": {"dead": True},
    "GlExtra_Membrane": {"strainRange": 1e-4, "wire": True, "dead": True},
}
FORCE = ("GlobalEngine", "Engine")
for name in _load.CLASSES:  # further forces
    if issubclass(getattr(membrane, name), membrane.MembraneForce):
        BASES[name] = FORCE if name == "MembraneForce" else ("MembraneForce", *FORCE)
        SETTINGS[name] = {"dead": True}
if not VIEW:
    del BASES["GlExtra_Membrane"]
NUMBERS = ("Real", "Vector3r", "vector<Real>", "vector<Vector3r>")


class TestClasses(SceneTest):
    def each(self):
        """The classes by name."""
        self.assertEqual(set(membrane.__all__), {*BASES, *_load.ALIASES})
        for name in BASES:
            with self.subTest(name):
                yield name, getattr(membrane, name)

    def test_classes_are_in_the_wrapper(self):
        for name, cls in self.each():
            self.assertIs(getattr(yade, name), cls)

    def test_keywords_of_the_constructor_set_attributes(self):
        for name, cls in self.each():
            made = cls(**SETTINGS[name])
            for key, value in SETTINGS[name].items():
                self.assertEqual(getattr(made, key), value)

    def test_wrong_keyword_raises_attribute_error(self):
        for _, cls in self.each():
            with self.assertRaisesRegex(AttributeError, "thicknes_"):
                cls(thicknes_=1.0)

    def test_positional_argument_raises(self):
        for _, cls in self.each():
            with self.assertRaises(Exception):
                cls(1.0)

    def test_wrong_type_raises(self):
        for cls, key in ((membrane.MembraneMat, "thickness"), (membrane.MembranePhys, "kn")):
            with self.assertRaises(TypeError):
                cls(**{key: "thin"})

    def test_dict_holds_own_and_inherited_attributes(self):
        for name, cls in self.each():
            self.assertLessEqual(SETTINGS[name].items(), cls(**SETTINGS[name]).dict().items())
        for name, own, inherited in (
            ("MembraneMat", "thickness", "young"),
            ("MembraneGeom", "length", "normal"),
            ("MembranePhys", "restLength", "kn"),
            ("MembraneForceEngine", "seenPositions", "dead"),
        ):
            self.assertLessEqual({own, inherited}, getattr(membrane, name)().dict().keys())

    def test_update_attributes_sets_several_at_once(self):
        engine = membrane.MembraneForceEngine()
        engine.updateAttrs({"beta": 4.0, "zeta": 0.1})
        self.assertEqual((engine.beta, engine.zeta), (4.0, 0.1))

    def test_objects_are_instances_of_the_native_bases(self):
        for name, cls in self.each():
            made = cls()
            for base in BASES[name]:
                self.assertIsInstance(made, getattr(yade, base))

    def test_yade_knows_them_as_children_of_the_native_bases(self):
        for name, _ in self.each():
            for base in BASES[name]:
                self.assertTrue(O.isChildClassOf(name, base), base)
                if base != "Serializable":
                    self.assertIn(name, system.childClasses(base))
            self.assertEqual(O.isChildClassOf(name, "Shape"), name == "MembraneNode")

    def test_attributes_can_be_read_only(self):
        net = membrane.Membrane(alpha=3.0)
        with self.assertRaises(AttributeError):
            net.alpha = 4.0
        with self.assertRaises(AttributeError):
            membrane.MembraneForceEngine().seenPositions = []

    def test_dispatchers_find_the_functors(self):
        sheet = Sheet(*grid(1))
        loop = yade.InteractionLoop(
            [membrane.Ig2_MembraneNode_MembraneNode_MembraneGeom(), yade.Ig2_Facet_Sphere_ScGeom()],
            [
                membrane.Ip2_MembraneMat_MembraneMat_MembranePhys(membrane=sheet.membrane),
                yade.Ip2_FrictMat_FrictMat_FrictPhys(),
            ],
            [
                membrane.Law2_MembraneGeom_MembranePhys_Buckling(),
                yade.Law2_ScGeom_FrictPhys_CundallStrack(),
            ],
        )
        geometry = loop.geomDispatcher.dispMatrix()
        self.assertEqual(
            geometry["MembraneNode", "MembraneNode"], "Ig2_MembraneNode_MembraneNode_MembraneGeom"
        )
        physics = loop.physDispatcher.dispMatrix()
        self.assertEqual(
            physics["MembraneMat", "MembraneMat"], "Ip2_MembraneMat_MembraneMat_MembranePhys"
        )
        self.assertEqual(physics["FrictMat", "FrictMat"], "Ip2_FrictMat_FrictMat_FrictPhys")
        laws = loop.lawDispatcher.dispMatrix()
        self.assertEqual(
            laws["MembraneGeom", "MembranePhys"], "Law2_MembraneGeom_MembranePhys_Buckling"
        )
        self.assertEqual(laws["ScGeom", "FrictPhys"], "Law2_ScGeom_FrictPhys_CundallStrack")
        found = loop.physDispatcher.dispFunctor(membrane.MembraneMat(), yade.FrictMat())
        self.assertIsInstance(found, yade.Ip2_FrictMat_FrictMat_FrictPhys)

    def test_loop_makes_the_plugins_geometry_and_physics_from_scratch(self):
        sheet = Sheet(*grid(1))
        expected = {(i.id1, i.id2): i.phys.dict() for i in O.interactions}
        self.assertEqual(len(expected), 5)
        O.interactions.clear()
        O.engines = [sheet.loop]
        from yade import utils

        for pair in expected:
            made = utils.createInteraction(*pair)
            self.assertIsInstance(made.geom, membrane.MembraneGeom)
        found = {(i.id1, i.id2): i.phys.dict() for i in O.interactions}
        self.assertEqual(found, expected)

    def test_sides_are_found_whatever_bodies_their_nodes_have(self):
        nodes, triangles = grid(3, jitter=0.1, rng=np.random.default_rng(3))
        lone = [len(nodes), len(nodes) + 1]
        nodes = np.concatenate([nodes, [[1.0, 0, 0], [2.0, 0, 0]]])
        cables = [lone, [lone[0], 7], [3, lone[1]]]
        Sheet(nodes, triangles, cables=cables)
        O.interactions.clear()
        bodies = np.random.default_rng(4).permutation(len(nodes))
        net = membrane.Membrane(
            material=scene.film(),
            nodes=nodes.tolist(),
            triangles=triangles.tolist(),
            cables=cables,
            bodyIds=bodies.tolist(),
        )
        for node, body in enumerate(bodies.tolist()):
            O.bodies[body].shape = membrane.MembraneNode(membrane=net, node=node, radius=1e-3)
        O.engines = [interaction_loop(net)]
        from yade import utils

        for (a, b), length, kind in zip(net.sides, net.restLengths, net.sideKinds):
            for pair in ((bodies[a], bodies[b]), (bodies[b], bodies[a])):
                made = utils.createInteraction(*map(int, pair))
                self.assertEqual(made.phys.restLength, length, kind)
                O.interactions.clear()
        self.assertEqual(utils.createInteraction(int(bodies[0]), int(bodies[15])).phys.kn, 0)

    def test_membrane_takes_arrays_of_any_kind_and_layout_as_it_takes_lists(self):
        rng = np.random.default_rng(5)
        nodes, triangles = grid(3, length=0.5, jitter=0.1, rng=rng)
        mesh = {
            "nodes": nodes.astype(np.float32).astype(float),
            "triangles": triangles,
            "creases": np.array([[5, 6], [9, 10]]),
            "creaseSigns": np.array([1, -1]),
            "cables": np.array([[0, 15]]),
            "pointMasses": rng.integers(0, 9, len(nodes)).astype(float),
        }
        lists = {name: array.tolist() for name, array in mesh.items()}
        expected = membrane.Membrane(material=scene.film(), **lists).dict()
        self.assertEqual(len(expected["nodes"]), 16)
        single = {"f": np.float32, "i": np.int32}
        arrays = [mesh, {k: array.astype(single[array.dtype.kind]) for k, array in mesh.items()}]
        arrays.append({name: np.asfortranarray(array) for name, array in mesh.items()})
        arrays.append({name: np.repeat(array, 2, axis=0)[::2] for name, array in mesh.items()})
        arrays.append({**mesh, "pointMasses": mesh["pointMasses"].astype(int)})
        for number, given in enumerate(arrays):
            made = membrane.Membrane(material=scene.film(), **given).dict()
            for name in mesh:
                self.assertEqual(made[name], expected[name], (number, name))

    def test_arrays_without_entries_are_empty_lists(self):
        nodes, triangles = grid(1)
        for none in (np.empty(0, dtype=int), np.empty((0, 2), dtype=int), np.empty(0)):
            net = membrane.Membrane(
                material=scene.film(), nodes=nodes, triangles=triangles, creases=none, cables=none
            )
            self.assertEqual((len(net.creases), len(net.cables), len(net.sides)), (0, 0, 5))

    def test_bodies_are_put_where_an_array_says(self):
        nodes, triangles = grid(1)
        net = membrane.Membrane(material=scene.film(), nodes=nodes, triangles=triangles)
        places = nodes + [1.0, 2.0, 3.0]
        ids = net.addBodies(places)
        self.assertEqual(ids, net.bodyIds)
        np.testing.assert_array_equal([O.bodies[i].state.pos for i in ids], places)

    def test_interactions_are_real_from_the_start_and_stay(self):
        nodes, triangles = grid(2)
        sheet = Sheet(nodes, triangles)
        self.assertEqual(O.interactions.countReal(), 16)
        sheet.place(10 * nodes).side_forces()
        self.assertEqual(O.interactions.countReal(), 16)

    def test_penetration_depth_is_rest_length_minus_length(self):
        nodes, triangles = grid(2)
        sheet = Sheet(nodes, triangles)
        sheet.place(nodes * [1.1, 0.9, 1.0]).side_forces()
        for i in O.interactions:
            depth = i.phys.restLength - i.geom.length
            self.assertAlmostEqual(i.geom.penetrationDepth, depth, delta=1e-15)
        self.assertGreater(np.ptp([i.geom.penetrationDepth for i in O.interactions]), 1e-3)

    def test_every_class_and_attribute_is_documented_and_numbers_have_units(self):
        checked = 0
        for name, cls in self.each():
            self.assertGreater(len(cls.__doc__), 60)
            for key, member in vars(cls).items():
                if key.startswith("_") or key in ("dispIndex", "dispHierarchy"):
                    continue
                doc = member.__doc__ or ""
                self.assertGreater(len(doc), 10, key)
                kind = re.search(r":yattrtype:`([^`]*)`", doc)
                if kind and kind.group(1).replace("Vector3r ", "Vector3r") in NUMBERS:
                    self.assertRegex(doc, r"\[[^\]]+\]", key)
                    checked += 1
        self.assertGreater(checked, 25)

    def test_density_and_poisson_of_the_material_are_yades(self):
        film = scene.film(young=1e9, poisson=0.2, density=900.0, thickness=1e-5)
        self.assertEqual((film.young, film.poisson, film.density), (1e9, 0.2, 900.0))


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""Bad input is refused before any step, in words that name the field, the value and the range."""

import math
import unittest

import membrane
import numpy as np
from membrane import scene
from membrane.parameters import SailParameters
from membrane.run.driver import deploy
from support import O, SceneTest, Sheet, grid, quiet, scratch
from yade import utils
from yade import wrapper as yade

NODES = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.4, 0.9, 0.0), (0.5, -0.9, 0.0), (0.5, 0.1, 0.9)]
MESH = {
    "nodes": NODES[:4],
    "triangles": [(0, 1, 2), (1, 0, 3)],
    "creases": [(0, 1)],
    "creaseSigns": [1],
}


class Refusals(SceneTest):
    def refused(self, error, make, *parts):
        """`make` raises `error`, whose text holds all `parts`, on one line."""
        with self.assertRaises(error) as caught:
            make()
        text = str(caught.exception)
        for part in parts:
            self.assertIn(part, text)
        self.assertNotIn("\n", text)
        self.assertEqual(O.iter, 0)
        return text


class TestMesh(Refusals):
    def mesh_refused(self, changes, *parts, error=ValueError):
        def make():
            membrane.Membrane(**{"material": scene.film(), **MESH, **changes})

        return self.refused(error, make, *parts)

    def test_the_mesh_itself_is_accepted(self):
        net = membrane.Membrane(material=scene.film(), **MESH)
        self.assertEqual(len(net.sides), 5)

    def test_node_that_is_not_finite(self):
        for bad in (math.nan, math.inf):
            nodes = [*NODES[:2], (0.4, bad, 0.0), NODES[3]]
            self.mesh_refused({"nodes": nodes}, "nodes[2]", str(bad), "must be finite")

    def test_triangle_without_area(self):
        nodes = [*NODES[:3], (0.5, 0.0, 0.0)]
        self.mesh_refused({"nodes": nodes}, "triangles[1] = (1 0 3)", "area 0", "must be > 0")

    def test_triangle_with_a_node_twice_or_none(self):
        for bad, parts in (((0, 1, 1), "repeats node 1"), ((0, 1, 4), "names node 4")):
            self.mesh_refused({"triangles": [bad], "creases": [], "creaseSigns": []}, parts)
        text = self.mesh_refused({"triangles": [(0, 1, -1)], "creases": [], "creaseSigns": []})
        self.assertIn("0..3", text)

    def test_repeated_triangle_in_any_order_of_its_nodes(self):
        for again in ((0, 1, 2), (2, 1, 0), (1, 2, 0)):
            triangles = [*MESH["triangles"], again]
            text = " ".join(map(str, again))
            self.mesh_refused({"triangles": triangles}, f"triangles[2] = ({text})", "repeated")

    def test_side_with_three_triangles(self):
        self.mesh_refused(
            {"nodes": NODES, "triangles": [*MESH["triangles"], (0, 1, 4)]},
            "side (",
            "third triangle",
            "triangles[2]",
            "at most 2",
        )

    def test_crease_that_is_no_side(self):
        self.mesh_refused({"creases": [(2, 3)]}, "creases[0] = (2 3)", "not a side of any triangle")

    def test_crease_on_the_edge(self):
        self.mesh_refused({"creases": [(0, 2)]}, "creases[0] = (0 2)", "edge", "2 triangles")

    def test_repeated_crease(self):
        self.mesh_refused(
            {"creases": [(0, 1), (1, 0)], "creaseSigns": [1, 1]}, "creases[1] = (1 0)", "repeated"
        )

    def test_crease_between_triangles_of_opposed_orientation(self):
        self.mesh_refused({"triangles": [(0, 1, 2), (0, 1, 3)]}, "creases[0]", "same direction")

    def test_crease_sign_other_than_one(self):
        for sign in (0, 2, -3):
            text = f"creaseSigns[0] = {sign}"
            self.mesh_refused({"creaseSigns": [sign]}, text, "+1 (mountain) or -1 (valley)")

    def test_wrong_number_of_signs(self):
        for signs in ([], [1, -1]):
            self.mesh_refused({"creaseSigns": signs}, f"creaseSigns has {len(signs)} entries", "1 ")

    def test_point_masses_of_wrong_number_or_sign(self):
        self.mesh_refused({"pointMasses": [1e-3]}, "pointMasses has 1 entries", "4 nodes")
        for bad in (-1e-3, math.nan, math.inf):
            masses = [0.0, 0.0, bad, 0.0]
            self.mesh_refused({"pointMasses": masses}, f"pointMasses[2] = {bad:g}", ">= 0")

    def test_node_without_mass(self):
        nodes = [*NODES[:4], (3.0, 3.0, 0.0)]
        self.mesh_refused({"nodes": nodes}, "nodes[4]", "mass 0", "must be > 0")

    def test_cables(self):
        self.mesh_refused({"cables": [(0, 1)]}, "cables[0] = (0 1)", "doubles")
        self.mesh_refused({"cables": [(2, 3), (3, 2)]}, "cables[1] = (3 2)", "doubles")
        self.mesh_refused({"cables": [(2, 9)]}, "cables[0]", "node 9", "0..3")
        for name, bad in (
            ("cableStiffness", 0.0),
            ("cableStiffness", -1.0),
            ("cableDensity", -1.0),
        ):
            self.mesh_refused({"cables": [(2, 3)], name: bad}, f"{name} = {bad:g}", "must be")
        nodes = [*NODES[:4], NODES[2]]
        self.mesh_refused({"nodes": nodes, "cables": [(2, 4)]}, "cables[0] = (2 4)", "length 0")

    def test_arrays_of_another_shape_or_with_numbers_too_large(self):
        for name, array, parts in (
            ("nodes", np.zeros((4, 2)), ("nodes has the shape (4, 2)", "must be (n, 3)")),
            ("nodes", np.zeros(12), ("nodes has the shape (12,)", "must be (n, 3)")),
            ("triangles", np.array([[0, 1]]), ("triangles has the shape (1, 2)", "(n, 3)")),
            ("creases", np.array([0, 1]), ("creases has the shape (2,)", "(n, 2)")),
            ("creaseSigns", np.array([[1]]), ("creaseSigns has the shape (1, 1)", "(n,)")),
            ("pointMasses", np.ones((4, 1)), ("pointMasses has the shape (4, 1)", "(n,)")),
            ("triangles", np.array([[0, 1, 2**32 + 2]]), ("triangles[0] holds 4294967298", "32")),
        ):
            self.mesh_refused({name: array}, *parts)
        for name in ("triangles", "creases", "creaseSigns"):
            whole = np.asarray(MESH[name])
            self.mesh_refused({name: whole.astype(float)}, error=TypeError)
            self.mesh_refused({name: whole.astype(complex)}, error=TypeError)

    def test_arrays_are_checked_as_lists_are(self):
        triangles = np.array([(0, 1, 4)])
        self.mesh_refused({"triangles": triangles}, "triangles[0] = (0 1 4) names node 4", "0..3")
        arrays = {name: np.array(value) for name, value in MESH.items()}
        self.refused(ValueError, lambda: membrane.Membrane(**arrays), "material is missing")

    def test_buckling_parameters_below_zero(self):
        for name in ("alpha", "alphaCrease"):
            for bad in (-1.0, math.nan):
                self.mesh_refused({name: bad}, f"{name} = {bad:g}", "finite and >= 0")

    def test_missing_material(self):
        self.mesh_refused({"material": None}, "material is missing")

    def test_negative_stiffness_is_refused_with_triangle_side_and_angle_unless_allowed(self):
        flat = {
            "nodes": [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, 0.1, 0.0)],
            "triangles": [(0, 1, 2)],
            "creases": [],
            "creaseSigns": [],
        }
        angle = 180 - 2 * math.degrees(math.atan(0.1 / 0.5))
        text = self.mesh_refused(
            flat,
            "triangles[0] = (0 1 2)",
            "side (0, 1)",
            "must be >= 0",
            "at node 2",
            "allowNegativeStiffness=True",
            f"angle of {angle:.4f}",
        )
        stiffness = -0.3209 * 3.2e9 * 7.5e-6
        named = float(text.split("stiffness ")[1].split(" N/m")[0])
        self.assertAlmostEqual(named / stiffness, 1, delta=1e-3)
        net = membrane.Membrane(material=scene.film(), allowNegativeStiffness=True, **flat)
        self.assertLess(min(net.stiffnesses), 0)

    def test_bodies_are_added_once_and_at_places_that_fit(self):
        net = membrane.Membrane(material=scene.film(), **MESH)
        self.refused(
            ValueError, lambda: net.addBodies(positions=[(0, 0, 0)]), "positions has 1", "4 nodes"
        )
        bad = [*NODES[:3], (0.0, math.nan, 0.0)]
        self.refused(ValueError, lambda: net.addBodies(positions=bad), "positions[3]", "finite")
        self.refused(
            ValueError, lambda: net.addBodies(np.zeros((4, 2))), "positions has the shape (4, 2)"
        )
        self.refused(TypeError, lambda: net.addBodies("here"), "str")
        for radius in (0.0, -1.0, math.nan):
            self.refused(ValueError, lambda: net.addBodies(radius=radius), "radius = ", "> 0")
        self.assertEqual(len(O.bodies), 0)
        self.refused(RuntimeError, net.addInteractions, "addBodies")
        net.addBodies()
        self.refused(RuntimeError, net.addBodies, "added already")
        net.addInteractions()
        self.refused(RuntimeError, net.addInteractions, "interact already")


class TestParameters(Refusals):
    def test_material(self):
        for name, bad, limits in (
            ("thickness", -7.5e-6, "> 0"),
            ("thickness", 0.0, "> 0"),
            ("thickness", math.nan, "finite"),
            ("young", -1.0, "> 0"),
            ("density", 0.0, "> 0"),
            ("poisson", 0.6, "(-1, 0.5]"),
            ("poisson", -1.0, "(-1, 0.5]"),
        ):
            self.refused(
                ValueError,
                lambda: scene.film(**{name: bad}),
                f"{name} = {bad:g}",
                "must be",
                limits,
            )

    def test_material_made_bad_later_is_refused_by_the_membrane(self):
        film = scene.film()
        film.poisson = 0.6
        self.refused(
            ValueError,
            lambda: membrane.Membrane(material=film, **MESH),
            "poisson = 0.6",
            "(-1, 0.5]",
        )

    def test_engine(self):
        for name, bad, limits in (
            ("beta", -1.0, ">= 0"),
            ("beta", math.nan, ">= 0"),
            ("gamma", -1.0, ">= 0"),
            ("zeta", -0.02, ">= 0"),
            ("airDensity", -1.0, ">= 0"),
            ("airDensity", math.inf, "finite"),
            ("theta0", 3.2, "[0, pi]"),
            ("theta0", -0.1, "[0, pi]"),
            ("timeStepCheckPeriod", 0, "> 0"),
        ):
            text = f"{name} = {bad:g}"
            make = membrane.MembraneForceEngine
            self.refused(ValueError, lambda: make(**{name: bad}), text, "must be", limits)
            engine = make()
            self.refused(ValueError, lambda: setattr(engine, name, bad), text, "must be", limits)

    def test_crease_law(self):
        self.refused(
            ValueError,
            lambda: membrane.MembraneForceEngine(creaseLaw="papper"),
            "creaseLaw = papper",
            "'paper' or 'conservative'",
        )

    def test_engines_without_what_they_act_on(self):
        for engine, text in (
            (membrane.MembraneForceEngine(), "membrane is not set"),
            (membrane.CentrifugalField(), "membrane is not set"),
            (membrane.MembraneLedger(), "forces is not set"),
        ):
            O.engines = [yade.ForceResetter(), engine]
            self.refused(RuntimeError, O.step, text)

    def test_membrane_without_bodies(self):
        net = membrane.Membrane(material=scene.film(), **MESH)
        O.engines = [yade.ForceResetter(), membrane.MembraneForceEngine(membrane=net)]
        self.refused(RuntimeError, O.step, "addBodies")

    def test_scene_parameters(self):
        for name, bad, limits in (
            ("thickness", -7.5e-6, "> 0"),
            ("young", 0.0, "> 0"),
            ("poisson", 0.6, "<= 0.5"),
            ("beta", -1.0, ">= 0"),
            ("fold_lines", 0, ">= 1"),
            ("dt", math.nan, ">= 0"),
        ):
            self.refused(
                ValueError, lambda: SailParameters(**{name: bad}), f"{name} = {bad}", limits
            )
        self.refused(
            ValueError, lambda: SailParameters(crease_law="papper"), "crease_law", "papper", "paper"
        )
        self.refused(ValueError, lambda: SailParameters(refine=1.5), "refine = 1.5", "whole number")

    def test_scene_with_too_long_a_step_is_refused_before_the_spin_up(self):
        def make():
            with quiet():
                deploy(SailParameters(dt=1e-4), scratch() / "refused", pictures=False)

        self.refused(ValueError, make, "dt = 0.0001", "must be <=", "force_time_step")


class TestRuns(Refusals):
    """Faults that only a running scene can meet."""

    def test_pair_that_is_no_side_is_reported_by_the_engine(self):
        nodes, triangles = grid(2)
        sheet = Sheet(nodes, triangles)
        sheet.run_engines()
        O.dt = 1e-9
        pair = sheet.membrane.bodyIds[0], sheet.membrane.bodyIds[8]
        self.assertNotIn(pair, sheet.membrane.sides)
        made = utils.createInteraction(*pair)
        self.assertEqual(made.phys.kn, 0)
        with self.assertRaises(RuntimeError) as caught:
            O.step()
        for part in (f"#{pair[0]}", f"#{pair[1]}", "no side of the membrane"):
            self.assertIn(part, str(caught.exception))

    def test_touching_spheres_of_the_film_do_not_interact(self):
        nodes, triangles = grid(2)
        sheet = Sheet(nodes, triangles, radius=0.05)
        for i in sheet.membrane.bodyIds:
            O.bodies[i].bounded = True
        sheet.run_engines()
        collider = yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb()])
        O.engines = [O.engines[0], collider, *O.engines[1:]]
        O.dt = 1e-9
        for _ in range(3):
            O.step()
        self.assertGreater(len(list(O.interactions.all(onlyReal=False))), 16)
        self.assertEqual(O.interactions.countReal(), 16)

    def test_velocity_that_is_not_a_number_stops_the_run_and_names_the_node(self):
        nodes, triangles = grid(2)
        sheet = Sheet(nodes, triangles, engine={"zeta": 0.02})
        sheet.run_engines()
        O.dt = 1e-7
        O.step()
        sheet.states[5].vel = (0, math.nan, 0)
        with self.assertRaisesRegex(RuntimeError, "node 5 .*body #5.* not finite"):
            O.step()
        self.assertTrue(np.all(np.isfinite(sheet.positions())))

    def test_place_that_is_not_finite_stops_the_run_and_names_a_body(self):
        nodes, triangles = grid(2)
        sheet = Sheet(nodes, triangles)
        sheet.run_engines()
        O.dt = 1e-7
        for bad in (math.nan, math.inf):
            sheet.place(nodes)
            sheet.states[5].pos = (bad, 0, 0)
            with self.assertRaisesRegex(RuntimeError, "#5"):
                scene.advance(3)

    def test_material_changed_after_the_membrane_was_made_is_refused(self):
        for name in ("young", "poisson", "thickness"):
            O.reset()
            nodes, triangles = grid(2)
            sheet = Sheet(nodes, triangles)
            sheet.run_engines()
            O.dt = 1e-7
            setattr(sheet.membrane.material, name, 1.1 * getattr(scene.film(), name))
            with self.assertRaisesRegex(RuntimeError, f"{name}.* was changed"):
                O.step()

    def test_mass_that_is_not_positive_is_named(self):
        nodes, triangles = grid(2)
        for bad in (0.0, -1.0, math.nan):
            O.reset()
            sheet = Sheet(nodes, triangles)
            sheet.run_engines()
            O.dt = 1e-7
            sheet.states[3].mass = bad
            with self.assertRaisesRegex(RuntimeError, "mass .*body #3 must be finite and > 0"):
                O.step()

    def test_erased_body_is_named(self):
        nodes, triangles = grid(2)
        sheet = Sheet(nodes, triangles)
        O.bodies.erase(4)
        sheet.run_engines()
        with self.assertRaisesRegex(RuntimeError, "body #4 of node 4 is not in the scene"):
            O.step()


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""Building blocks of a scene: spool, engines, spin, release; progress of its building."""

import io
import unittest
from contextlib import redirect_stderr
from dataclasses import fields
from unittest import mock

import numpy as np
from membrane import scene
from membrane.parameters import SceneParameters, attributes
from membrane.scene import bodies, spool
from support import O, SceneTest, engines_by_class, grid, set_engines


class TestSpool(SceneTest):
    def test_facets_close_a_cylinder_about_the_axis(self):
        ids = spool.add_spool(0.025, 0.06, 36)
        self.assertEqual(len(ids), 72)
        area = 0.0
        for body in (O.bodies[i] for i in ids):
            corners = np.array([body.state.pos + v for v in body.shape.vertices])
            np.testing.assert_allclose(np.hypot(*corners[:, :2].T), 0.025, rtol=1e-12)
            np.testing.assert_allclose(np.abs(corners[:, 2]), 0.03, rtol=1e-12)
            area += 0.5 * np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0]))
        self.assertAlmostEqual(area, 36 * 2 * 0.025 * np.sin(np.pi / 36) * 0.06, delta=1e-12)

    def test_bad_values_are_refused_by_name(self):
        for name, bad in (
            ("radius", 0.0),
            ("height", -1.0),
            ("facets", 2),
            ("young", 0.0),
            ("friction_angle", -0.1),
        ):
            with self.assertRaisesRegex(ValueError, f"{name} = {bad}.* must be >"):
                spool.add_spool(**{name: bad})
        self.assertEqual(len(O.bodies), 0)


class TestDrivenBodies(SceneTest):
    def setUp(self):
        super().setUp()
        self.omega = 20.0
        nodes = [[0.025, 0, 0], [0.04, 0, 0]]
        net = scene.add_membrane(nodes, [], cables=[(0, 1)], pointMasses=[0.0, 1e-4])
        self.facets = spool.add_spool()
        self.sail = set_engines(
            net,
            driven=[*self.facets, net.bodyIds[0]],
            touching=[net.bodyIds[1]],
            omega=self.omega,
            zeta=0.02,
        )
        self.sail.hold([0])
        O.dt = 0.2 * self.sail.forces.criticalTimeStep()

    def test_spool_and_tether_ends_turn_at_the_spin_rate(self):
        corner = O.bodies[self.facets[0]]
        start = np.array(corner.state.pos)
        scene.set_spin(self.sail, self.omega)
        scene.advance(2000)
        angle = self.omega * O.time
        self.assertGreater(angle, 0.02)
        end = O.bodies[self.sail.membrane.bodyIds[0]].state.pos
        expected = [0.025 * np.cos(angle), 0.025 * np.sin(angle), 0]
        np.testing.assert_allclose(end, expected, atol=1e-15)
        turned = np.array(corner.state.pos)
        moved = np.arctan2(turned[1], turned[0]) - np.arctan2(start[1], start[0])
        self.assertAlmostEqual(moved, angle, delta=1e-12)

    def test_spin_is_that_of_half_a_step_before(self):
        scene.set_spin(self.sail, self.omega)
        half = 0.5 * self.omega * O.dt
        expected = 0.04 * self.omega * np.array([np.sin(half), np.cos(half), 0])
        found = O.bodies[self.sail.membrane.bodyIds[1]].state.vel
        np.testing.assert_allclose(found, expected, rtol=1e-12)

    def test_residual_energy_is_kinetic_over_that_of_the_spin(self):
        scene.set_spin(self.sail, self.omega)
        self.assertAlmostEqual(scene.residual_energy(self.sail, self.omega), 1, delta=1e-12)
        self.assertAlmostEqual(scene.residual_energy(self.sail, 2 * self.omega), 0.25, delta=1e-12)

    def test_held_nodes_stay_and_released_ones_move(self):
        x = self.sail.positions()
        self.sail.rotation.dead = True
        self.sail.hold([1])
        O.bodies[self.sail.membrane.bodyIds[1]].state.pos = (0.041, 0, 0)
        scene.advance(10)
        self.assertEqual(self.sail.positions()[1, 0], 0.041)
        self.sail.hold([1], False)
        scene.advance(10)
        self.assertLess(self.sail.positions()[1, 0], 0.041)
        np.testing.assert_array_equal(self.sail.positions()[0], x[0])

    def test_only_tether_and_spool_collide(self):
        self.assertIn("InsertionSortCollider", engines_by_class())
        scene.advance(2)
        pairs = [(i.id1, i.id2) for i in O.interactions.all(onlyReal=False)]
        facets = set(self.facets)
        self.assertFalse([pair for pair in pairs if set(pair) <= facets])

    def test_spin_up_that_finds_no_rest_says_so(self):
        with self.assertRaisesRegex(RuntimeError, "no equilibrium in 0.001 s: residual"):
            scene.spin_up(self.sail, self.omega, tolerance=1e-30, batch=100, max_time=1e-3)

    def test_released_nodes_spin_at_the_release_whatever_pulls_at_them(self):
        free = O.bodies[self.sail.membrane.bodyIds[1]].state
        free.pos = (0.0401, 0.001, 0.0005)  # taut
        scene.release(self.sail, self.omega, [])
        self.assertEqual(tuple(free.pos), (0.0401, 0.001, 0.0005))
        before = np.array(free.vel)
        scene.advance(1)
        middle = 0.5 * (before + np.array(free.vel))
        spin = self.omega * np.array([-0.001, 0.0401, 0])
        gained = np.linalg.norm(np.array(free.vel) - before)
        self.assertGreater(gained, 0.01)
        # But for the damping, of which the first step sees a velocity half a step old.
        np.testing.assert_allclose(middle, spin, rtol=0, atol=0.02 * gained)

    def test_release_leaves_no_field_and_starts_the_spool_and_the_ledger(self):
        scene.spin_up(self.sail, self.omega, tolerance=0.5, batch=10)
        self.assertEqual(
            (self.sail.field.dead, self.sail.rotation.dead, self.sail.ledger.dead),
            (False, True, True),
        )
        self.assertGreater(self.sail.newton.damping, 0)
        scene.release(self.sail, self.omega, [])
        self.assertEqual(
            (self.sail.field.dead, self.sail.rotation.dead, self.sail.ledger.dead),
            (True, False, False),
        )
        self.assertEqual(self.sail.newton.damping, 0)


class TestParameters(SceneTest):
    def test_attributes_of_engines_and_membrane_follow_from_parameters(self):
        told = {item.name: item.metadata["sets"] for item in fields(SceneParameters)}
        told = {name: place.split(".") for name, place in told.items() if place}
        self.assertGreaterEqual(len(told), 13)
        given = {"crease_law": "conservative", "force_time_step": True, "exchange_period": 7}
        given |= {"film": "plane_stress", "zeta": 0.0, "beta": 0.0}
        rest = {name for name in told if name not in given}
        changed = {name: 0.5 * getattr(SceneParameters(), name) or 0.25 for name in rest}
        changed |= dict.fromkeys(("alpha", "alpha_crease"), 0.0)  # given in SI
        p = SceneParameters(path="fused", **given, **changed)
        nodes, triangles = grid(3)
        net = scene.add_membrane(
            nodes,
            triangles,
            material=scene.film(**attributes("MembraneMat", p)),
            **attributes("Membrane", p),
        )
        made = scene.set_engines(net, p)
        owners = dict.fromkeys(("MembraneForceEngine", "MembraneIntegrator"), made.forces)
        owners |= {"Membrane": net, "MembraneMat": net.material}
        for name, (kind, attribute) in told.items():
            with self.subTest(parameter=name):
                self.assertEqual(getattr(owners[kind], attribute), getattr(p, name))


class TestProgress(SceneTest):
    def built(self, large):
        """What is shown while a sheet of 9 nodes is added, `large` nodes being many."""
        O.reset()
        with redirect_stderr(io.StringIO()) as shown, mock.patch.object(bodies, "LARGE", large):
            scene.add_membrane(*grid(2))
        return shown.getvalue().splitlines()

    def test_building_of_a_large_membrane_names_its_stages(self):
        lines = self.built(large=9)
        self.assertEqual(len(lines), 4)
        for line, text in zip(lines, ("rest state", "bodies", "interactions", "done in")):
            self.assertRegex(line, rf"^building +\d+ %  {text}")
        self.assertIn("100 %", lines[-1])

    def test_building_of_a_small_one_is_silent(self):
        self.assertEqual(self.built(large=10), [])


class TestFreeScene(SceneTest):
    def test_sheet_that_touches_nothing_has_no_collider(self):
        nodes, triangles = grid(1)
        net = scene.add_membrane(nodes, triangles)
        set_engines(net)
        self.assertNotIn("InsertionSortCollider", engines_by_class())

    def test_advance_raises_what_an_engine_raises(self):
        nodes, triangles = grid(1)
        sail = set_engines(scene.add_membrane(nodes, triangles))
        O.dt = 2 * sail.forces.criticalTimeStep()
        for _ in range(3):
            with self.assertRaisesRegex(RuntimeError, "critical time step"):
                scene.advance(5)
        O.dt /= 4
        start = O.iter
        scene.advance(5)
        self.assertEqual(O.iter, start + 5)


if __name__ == "__main__":
    unittest.main()

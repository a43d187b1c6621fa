# SPDX-License-Identifier: GPL-2.0-or-later
"""Pressure of sunlight: closed forms of flat plates, its work, its place beside other engines."""

import math
import unittest

import membrane
import numpy as np
from membrane import scene
from support import O, SceneTest, Sheet, grid, rotation, set_engines
from yade import wrapper as yade

P, SIDE = 4.54e-6, 0.3  # pressure [Pa]; of the plate [m]
SHARES = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.7, 0.1))  # specular, diffuse


def of_a_plate(area, normal, sun, specular, diffuse):
    """Force (3,) [N] on a flat plate, photon by photon: what comes, and what leaves how."""
    sun = np.asarray(sun) / np.linalg.norm(sun)
    normal = np.asarray(normal) * math.copysign(1.0, np.dot(normal, sun))  # away from the sun
    caught = P * area * np.dot(normal, sun)
    mirrored = sun - 2 * np.dot(sun, normal) * normal
    scattered = -2 / 3 * normal  # mean of Lambert's cosine law over the half space
    return caught * (sun - specular * mirrored - diffuse * scattered)


class TestPlate(SceneTest):
    def setUp(self):
        super().setUp()
        nodes, triangles = grid(3, SIDE / 3, jitter=0.2, rng=np.random.default_rng(2))
        self.nodes = nodes
        self.sheet = Sheet(nodes, triangles)
        self.area = self.sheet.membrane.area
        self.sun = membrane.SolarPressure(membrane=self.sheet.membrane, pressure=P)

    def forces(self):
        """Forces (N, 3) [N] of the light on the nodes."""
        return self.sheet._forces(self.sun, self.sheet.engine)

    def centroid(self):
        """Of the film where it is (3,) [m]."""
        places = self.sheet.positions()[np.array(self.sheet.membrane.triangles)]
        twice = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
        return np.average(places.mean(axis=1), axis=0, weights=np.linalg.norm(twice, axis=1))

    def test_force_and_moment_of_a_plate_at_any_angle(self):
        rng = np.random.default_rng(3)
        for specular, diffuse in SHARES:
            self.sun.updateAttrs({"specular": 0, "diffuse": 0})
            self.sun.updateAttrs({"specular": specular, "diffuse": diffuse})
            for _ in range(5):
                turn, sun = rotation(rng), rng.normal(size=3)
                self.sheet.place(self.nodes @ turn.T + [0.1, -0.2, 0.3])
                self.sun.direction = sun
                found = self.forces()
                expected = of_a_plate(self.area, turn[:, 2], sun, specular, diffuse)
                size = np.linalg.norm(expected)
                np.testing.assert_allclose(found.sum(axis=0), expected, atol=1e-12 * size)
                moment = np.cross(self.sheet.positions(), found).sum(axis=0)
                np.testing.assert_allclose(
                    moment, np.cross(self.centroid(), expected), atol=1e-12 * size
                )

    def test_figures_of_a_plate_across_the_light(self):
        for (specular, diffuse), factor in zip(SHARES, (1, 2, 5 / 3, 1.7 + 2 / 30)):
            self.sun.updateAttrs({"specular": 0, "diffuse": 0})
            self.sun.updateAttrs({"specular": specular, "diffuse": diffuse})
            total = self.forces().sum(axis=0)
            np.testing.assert_allclose(total, [0, 0, -factor * P * self.area], rtol=1e-12, atol=0)

    def test_edge_on_and_collapsed_there_is_none(self):
        self.sun.updateAttrs({"direction": (1, 0, 0), "specular": 0.5, "diffuse": 0.5})
        self.assertEqual(np.abs(self.forces()).max(), 0)
        self.sheet.place(np.zeros_like(self.nodes) + 0.1)
        self.assertEqual(np.abs(self.forces()).max(), 0)

    def test_both_sides_are_alike(self):
        self.sun.updateAttrs({"direction": (0.3, 0.1, -1), "specular": 0.6, "diffuse": 0.2})
        one = self.forces()
        self.sheet.place(self.nodes * [1, -1, 1])  # every triangle runs the other way round
        np.testing.assert_allclose(
            self.forces() * [1, -1, 1] - one, 2 * self.side_force(one), atol=1e-12 * P
        )

    def side_force(self, forces):
        """What changes where the plate is mirrored and the light is not: its part along y."""
        along = np.zeros_like(forces)
        along[:, 1] = -forces[:, 1]
        return along


class TestRun(SceneTest):
    def sail(self, path, **options):
        """A free square sheet in the light, in the engines of a path: membrane, engines."""
        nodes, triangles = grid(4, 0.05)
        net = scene.add_membrane(nodes, triangles, interactions=path == "law2")
        made = set_engines(net, path=path, **options)
        sun = membrane.SolarPressure(membrane=net, pressure=1.0, direction=(0, 0, -2))
        O.engines = [sun, *O.engines]
        O.dt = 0.2 * made.forces.criticalTimeStep()
        return net, made, sun

    def test_a_black_sheet_falls_as_a_stone_and_the_work_is_booked(self):
        for path in scene.PATHS:
            O.reset()
            net, made, _ = self.sail(path)
            scene.advance(400)
            time, mass, force = O.time, sum(net.masses), -net.area
            fallen = np.average([O.bodies[i].state.pos[2] for i in net.bodyIds], weights=net.masses)
            self.assertAlmostEqual(fallen / (force / mass * time**2 / 2), 1, delta=0.01)
            work = made.ledger.workOf("sunlight")
            self.assertGreater(work, 0)
            self.assertAlmostEqual(work / made.ledger.total, 1, delta=1e-9)
            self.assertLess(abs(made.ledger.balance), 1e-9 * work)

    def test_both_paths_and_any_threads_agree(self):
        ends = []
        for path, threads in (("law2", -1), ("fused", -1), ("fused", 3)):
            O.reset()
            net, made, sun = self.sail(path, beta=3.0, zeta=0.02, air_density=1.2)
            sun.updateAttrs({"direction": (1, 2, -3), "specular": 0.8, "diffuse": 0.1})
            made.forces.ompThreads = threads
            scene.advance(200)
            ends.append([tuple(O.bodies[i].state.pos) for i in net.bodyIds])
        for end in ends[1:]:
            np.testing.assert_allclose(end, ends[0], atol=1e-12)

    def test_what_changes_while_it_runs_counts_from_the_next_step(self):
        net, made, sun = self.sail("fused")
        made.forces.moveNodes = False
        made.ledger.dead = made.watch.dead = True

        def total():
            scene.advance(1)
            return np.sum(made.forces.nodeForces(), axis=0)[2]

        self.assertAlmostEqual(total() / -net.area, 1, delta=1e-12)
        sun.specular = 1
        self.assertAlmostEqual(total() / -net.area, 2, delta=1e-12)
        sun.dead = True
        self.assertEqual(total(), 0)
        sun.dead = False
        O.engines = [membrane.SolarPressure(membrane=net, pressure=0.5), *O.engines]
        self.assertAlmostEqual(total() / -net.area, 2.5, delta=1e-12)
        O.engines = O.engines[2:]
        self.assertEqual(total(), 0)

    def test_forces_by_name(self):
        net, made, _ = self.sail("law2")
        scene.advance(1)
        self.assertAlmostEqual(
            np.sum(made.forces.forcesOf("sunlight"), axis=0)[2] / -net.area, 1, delta=1e-12
        )
        self.assertEqual(np.abs(made.forces.forcesOf("drag")).max(), 0)
        with self.assertRaisesRegex(ValueError, "channel = 'moonlight' must be a kind"):
            made.forces.forcesOf("moonlight")
        self.assertEqual(made.ledger.workOf("moonlight"), 0)

    def test_it_goes_on_after_a_save(self):
        ends = []
        for path in scene.PATHS:
            for saved in (False, True):
                O.reset()
                net, made, _ = self.sail(path)
                scene.advance(100)
                if saved:
                    O.save(":memory:sun", quiet=True)
                    O.reset()
                    O.load(":memory:sun", quiet=True)
                scene.advance(100)
                book = next(e for e in O.engines if isinstance(e, membrane.MembraneLedger))
                ends.append([*O.bodies[0].state.pos, book.workOf("sunlight"), book.total])
            np.testing.assert_array_equal(ends[-1], ends[-2])

    def test_it_hardly_changes_the_critical_time_step(self):
        net, made, sun = self.sail("fused")
        strong = made.forces.criticalTimeStep()
        sun.dead = True
        without = made.forces.criticalTimeStep()
        self.assertLess(strong, without)
        self.assertGreater(strong, 0.99 * without)


class TestRefusals(SceneTest):
    def test_values(self):
        for values, message in (
            ({"pressure": -1.0}, r"pressure = -1.* must be finite and >= 0"),
            ({"specular": 0.6, "diffuse": 0.5}, "together <= 1"),
            ({"diffuse": -0.1}, "must be >= 0"),
            ({"direction": (0, 0, 0)}, "direction must be finite and not 0"),
            ({"direction": (math.nan, 0, 1)}, "direction must be finite"),
        ):
            with self.assertRaisesRegex(ValueError, f"SolarPressure: .*{message}"):
                membrane.SolarPressure(**values)

    def test_nobody_who_computes_it(self):
        nodes, triangles = grid(1)
        net = scene.add_membrane(nodes, triangles)
        for engine, message in (
            (membrane.SolarPressure(), "SolarPressure: membrane is not set"),
            (membrane.SolarPressure(membrane=net), "SolarPressure: no MembraneForceEngine"),
        ):
            O.engines = [yade.ForceResetter(), engine]
            with self.assertRaisesRegex(RuntimeError, message):
                O.step()

    def test_what_is_no_force(self):
        nodes, triangles = grid(1)
        net = scene.add_membrane(nodes, triangles)
        set_engines(net, path="fused")
        O.engines = [membrane.MembraneForce(membrane=net), *O.engines]
        with self.assertRaisesRegex(RuntimeError, "MembraneForce is not a force itself"):
            O.step()


if __name__ == "__main__":
    unittest.main()

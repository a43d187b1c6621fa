# SPDX-License-Identifier: GPL-2.0-or-later
"""Air drag, paper equation (10): plates normal, oblique and edge-on to their velocity."""

import unittest

import numpy as np
from support import O, SceneTest, Sheet, grid, rotation

AIR, SIDE = 1.2e-3, 0.1
TRIANGLE = SIDE * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, np.sqrt(0.75), 0.0]])
AREA = np.sqrt(3) / 4 * SIDE**2


class TestPlate(SceneTest):
    def setUp(self):
        super().setUp()
        self.sheet = Sheet(TRIANGLE, [(0, 1, 2)], engine={"airDensity": AIR})

    def forces(self, velocity):
        """Forces (3, 3) [N] at one velocity for all nodes or (3, 3) [m/s]."""
        velocities = np.broadcast_to(velocity, (3, 3))
        return self.sheet.place(TRIANGLE, velocities).engine_forces()

    def test_plate_normal_to_its_velocity(self):
        for speed in (3.0, -3.0):
            expected = [0, 0, -AIR * AREA * speed * abs(speed) / 6]
            np.testing.assert_allclose(self.forces([0, 0, speed]), [expected] * 3, rtol=1e-12)

    def test_oblique_plate_shows_its_projected_area(self):
        for angle in (0.1, 0.7, 1.4, 2.5):
            for azimuth in (0.0, 2.0):
                direction = np.array(
                    [
                        np.sin(angle) * np.cos(azimuth),
                        np.sin(angle) * np.sin(azimuth),
                        np.cos(angle),
                    ]
                )
                expected = -AIR * AREA * abs(np.cos(angle)) * 9.0 / 6 * direction
                np.testing.assert_allclose(self.forces(3.0 * direction), [expected] * 3, rtol=1e-12)

    def test_plate_edge_on_to_its_velocity_has_no_drag(self):
        normal = np.abs(self.forces([0, 0, 3.0])).max()
        self.assertGreater(normal, 1e-7)
        self.assertLess(np.abs(self.forces([3.0, -1.0, 0.0])).max(), 1e-15 * normal)

    def test_each_corner_is_held_back_by_its_own_velocity(self):
        velocities = np.array([[0, 0, 1.0], [0, 0, -2.0], [0, 3.0, 4.0]])
        expected = np.zeros((3, 3))
        for i, v in enumerate(velocities):
            speed = np.linalg.norm(v)
            projected = AREA * abs(v[2]) / speed
            expected[i] = -AIR * projected * speed**2 / 6 * v / speed
        np.testing.assert_allclose(self.forces(velocities), expected, rtol=1e-12, atol=1e-20)

    def test_force_does_not_depend_on_the_frame(self):
        rng = np.random.default_rng(1)
        velocities, turn = rng.normal(size=(3, 3)), rotation(rng)
        expected = self.forces(velocities) @ turn.T
        turned = self.sheet.place(TRIANGLE @ turn.T + 0.3, velocities @ turn.T).engine_forces()
        np.testing.assert_allclose(turned, expected, rtol=1e-10, atol=1e-20)

    def test_area_is_the_present_one(self):
        self.sheet.place(2 * TRIANGLE, np.broadcast_to([0, 0, 3.0], (3, 3)))
        expected = [0, 0, -AIR * 4 * AREA * 9.0 / 6]
        np.testing.assert_allclose(self.sheet.engine_forces(), [expected] * 3, rtol=1e-12)

    def test_without_air_there_is_no_force(self):
        O.reset()
        sheet = Sheet(TRIANGLE, [(0, 1, 2)], engine={"airDensity": 0.0})
        forces = sheet.place(TRIANGLE, np.ones((3, 3))).engine_forces()
        np.testing.assert_array_equal(forces, 0)
        np.testing.assert_array_equal(sheet.engine.dragForces(), 0)

    def test_plate_slows_down_as_one_over_time(self):
        start, air, dt = 50.0, 0.2, 2e-6
        O.reset()
        thick = Sheet(TRIANGLE, [(0, 1, 2)], engine={"airDensity": air})
        thick.place(TRIANGLE, np.broadcast_to([0, 0, start], (3, 3)))
        thick.run_engines()
        O.dt = dt
        for _ in range(2500):
            O.step()
        mass = 1420.0 * 7.5e-6 * AREA
        elapsed = 2500 * dt
        expected = start / (1 + 0.5 * air * AREA * start * elapsed / mass)
        self.assertLess(expected, 0.5 * start)
        np.testing.assert_allclose(thick.velocities()[:, 2] / expected, 1, rtol=2e-3)


class TestSheetInAir(SceneTest):
    def test_drag_never_adds_energy(self):
        rng = np.random.default_rng(2)
        nodes, triangles = grid(3, jitter=0.1, rng=rng)
        sheet = Sheet(nodes, triangles, engine={"airDensity": AIR})
        for _ in range(50):
            x = nodes + 5e-3 * rng.normal(size=nodes.shape)
            v = rng.normal(size=nodes.shape)
            forces = sheet.place(x, v).engine_forces()
            self.assertLess(np.sum(forces * v), -1e-9)
            np.testing.assert_array_equal(sheet.engine.dragForces(), forces)
            self.assertTrue(np.all(np.sum(forces * v, axis=1) < 0))

    def test_flat_sheet_has_the_drag_of_its_whole_area(self):
        nodes, triangles = grid(4, length=0.025)
        sheet = Sheet(nodes, triangles, engine={"airDensity": AIR})
        forces = sheet.place(nodes, np.broadcast_to([0, 0, 2.0], nodes.shape)).engine_forces()
        np.testing.assert_allclose(forces.sum(axis=0), [0, 0, -0.5 * AIR * 0.01 * 4.0], atol=1e-15)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""Damping of the sides, paper equation (9): coefficient, branches, power, decay."""

import unittest

import numpy as np
from support import O, SceneTest, Sheet, grid, plane_stress_stiffness

LENGTH, ZETA = 0.02, 0.05
TRIANGLE = LENGTH * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, 0.9, 0.0]])
POINTS = [1e-6, 4e-6, 2e-5]
# Masses of the nodes [kg]: a third of the film and the points.
MASSES = 1420.0 * 7.5e-6 * 0.5 * 0.9 * LENGTH**2 / 3 + np.array(POINTS)


def coefficient(first, second, opposite):
    """c [N s/m] of the triangle's side first-second by equation (9)."""
    stiffness = plane_stress_stiffness(TRIANGLE, 3.2e9, 0.34, 7.5e-6)[opposite]
    return 2 * ZETA * np.sqrt(stiffness * 0.5 * (MASSES[first] + MASSES[second]))


class TestCoefficient(SceneTest):
    def setUp(self):
        super().setUp()
        self.sheet = Sheet(
            TRIANGLE, [(0, 1, 2)], alpha=1e4, pointMasses=POINTS, engine={"zeta": ZETA}
        )

    def test_force_is_the_coefficient_times_the_rate_of_the_length(self):
        speed = 0.7
        for first, second, opposite in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
            # `first` moves away from `second`, so only its two sides change their length.
            along = (TRIANGLE[first] - TRIANGLE[second]) / LENGTH
            along /= np.linalg.norm(along)
            velocity = np.zeros((3, 3))
            velocity[first] = speed * along
            forces = self.sheet.place(TRIANGLE, velocity).engine_forces()
            expected = coefficient(first, second, opposite) * speed * along
            np.testing.assert_allclose(forces[second], expected, rtol=1e-9, atol=1e-12)
            np.testing.assert_allclose(forces.sum(axis=0), 0, atol=1e-12)

    def test_buckled_side_is_damped_like_a_taut_one(self):
        along = (TRIANGLE[2] - TRIANGLE[0]) / np.linalg.norm(TRIANGLE[2] - TRIANGLE[0])
        velocity = np.zeros((3, 3))
        velocity[2] = along
        net = self.sheet.membrane
        side = net.sides.index((0, 2))
        for share, buckled in ((1.001, False), (0.8, True)):
            x = TRIANGLE.copy()
            x[2] = TRIANGLE[0] + share * (TRIANGLE[2] - TRIANGLE[0])
            forces = self.sheet.place(x, velocity).engine_forces()
            self.assertEqual(net.lengths()[side] < net.criticalLengths[side], buckled)
            np.testing.assert_allclose(forces[0], coefficient(0, 2, 1) * along, rtol=1e-9)

    def test_without_zeta_there_is_no_force(self):
        velocity = np.random.default_rng(1).normal(size=(3, 3))
        self.assertGreater(np.abs(self.sheet.place(TRIANGLE, velocity).engine_forces()).max(), 1e-6)
        O.reset()
        sheet = Sheet(TRIANGLE, [(0, 1, 2)], engine={"zeta": 0.0})
        np.testing.assert_array_equal(sheet.place(TRIANGLE, velocity).engine_forces(), 0)
        np.testing.assert_array_equal(sheet.engine.dampingForces(), 0)

    def test_coefficient_follows_zeta_when_it_is_changed(self):
        velocity = np.random.default_rng(2).normal(size=(3, 3))
        once = self.sheet.place(TRIANGLE, velocity).engine_forces()
        self.sheet.engine.zeta = 3 * ZETA
        np.testing.assert_allclose(self.sheet.engine_forces(), 3 * once, rtol=1e-12)


class TestPower(SceneTest):
    def test_damping_never_adds_energy(self):
        rng = np.random.default_rng(3)
        nodes, triangles = grid(3, jitter=0.1, rng=rng)
        sheet = Sheet(nodes, triangles, cables=[(0, 15)], engine={"zeta": 0.3})
        for _ in range(50):
            x = nodes + 5e-3 * rng.normal(size=nodes.shape)
            v = rng.normal(size=nodes.shape)
            forces = sheet.place(x, v).engine_forces()
            self.assertLess(np.sum(forces * v), -1e-3)
            np.testing.assert_array_equal(sheet.engine.dampingForces(), forces)

    def test_damping_has_no_net_force_and_moment(self):
        rng = np.random.default_rng(4)
        nodes, triangles = grid(3, jitter=0.1, rng=rng)
        sheet = Sheet(nodes, triangles, engine={"zeta": 0.3})
        x = nodes + 5e-3 * rng.normal(size=nodes.shape)
        forces = sheet.place(x, rng.normal(size=nodes.shape)).engine_forces()
        size = np.abs(forces).sum()
        self.assertGreater(size, 1e-3)
        np.testing.assert_allclose(forces.sum(axis=0) / size, 0, atol=1e-15)
        np.testing.assert_allclose(np.cross(x, forces).sum(axis=0) / size, 0, atol=1e-15)


class TestDecay(SceneTest):
    """A mass hangs on a tether whose other end is held, and bounces without going slack."""

    def test_taut_tether_rings_down_at_the_rate_of_equation_9(self):
        stiffness, hanging, held, zeta = 200.0 / LENGTH, 3e-3, 1e-3, 0.03
        sheet = Sheet(
            [[0, 0, 0], [0, 0, -LENGTH]],
            cables=[(0, 1)],
            cableDensity=0.0,
            pointMasses=[held, hanging],
            engine={"zeta": zeta},
        )
        sheet.states[0].blockedDOFs = "xyzXYZ"
        sag = hanging * 9.81 / stiffness
        damping = 2 * zeta * np.sqrt(stiffness * 0.5 * (held + hanging))
        decay = damping / (2 * hanging)
        angular = np.sqrt(stiffness / hanging - decay**2)
        swing = 0.8 * sag
        sheet.place([[0, 0, 0], [0, 0, -LENGTH - sag - swing]])
        sheet.run_engines(gravity=(0, 0, -9.81))
        O.dt = 0.002 / angular
        # From rest the leapfrog's first velocity must be that of half a step.
        sheet.states[1].vel = (0, 0, -0.5 * O.dt * angular**2 * swing)
        times, heights = [], []
        while O.time < 5 * 2 * np.pi / angular:
            O.step()
            times.append(O.time)
            heights.append(sheet.states[1].pos[2] + LENGTH + sag)
        times, heights = np.array(times), np.array(heights)
        exact = np.exp(-decay * times) * (
            -swing * np.cos(angular * times) - swing * decay / angular * np.sin(angular * times)
        )
        self.assertLess(heights.max(), sag, "it went slack")
        self.assertLess(np.exp(-decay * times[-1]), 0.6, "it hardly rang down")
        np.testing.assert_allclose(heights, exact, atol=5e-3 * swing)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""Force of a side with buckling, paper equations (3) and (6), in YADE's interaction loop."""

import unittest

import numpy as np
from membrane import Membrane, scene
from membrane.mesh import sail_mesh
from support import O, SceneTest, Sheet, grid, plane_stress_stiffness

LENGTH, ALPHA = 0.02, 1e4
TRIANGLE = LENGTH * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, np.sqrt(0.75), 0.0]])
STIFFNESS = plane_stress_stiffness(TRIANGLE, 3.2e9, 0.34, 7.5e-6)[1]
CRITICAL = LENGTH - ALPHA * np.pi**2 * 7.5e-6**2 / (12 * LENGTH)


class TestFilmSide(SceneTest):
    """The side between the nodes 0 and 2 of a triangle; the side 0-1 keeps its rest length."""

    def setUp(self):
        super().setUp()
        self.sheet = Sheet(TRIANGLE, [(0, 1, 2)], alpha=ALPHA)

    def stretch(self, length):
        """Give the side a length [m]."""
        direction = (TRIANGLE[2] - TRIANGLE[0]) / LENGTH
        self.sheet.place([TRIANGLE[0], TRIANGLE[1], TRIANGLE[0] + length * direction])
        return direction

    def tension(self, length):
        """Pull of the side on node 0 [N]; negative when it pushes."""
        direction = self.stretch(length)
        force = self.sheet.side_forces()[0]
        np.testing.assert_allclose(force, np.dot(force, direction) * direction, atol=1e-9)
        return float(np.dot(force, direction))

    def test_buckling_sets_in_well_below_the_rest_length(self):
        self.assertGreater(LENGTH - CRITICAL, 1e-3 * LENGTH)
        found = dict(zip(self.sheet.membrane.sides, self.sheet.membrane.criticalLengths))
        self.assertAlmostEqual(found[0, 2], CRITICAL, delta=1e-15)

    def test_slope_is_the_stiffness(self):
        for share in (-0.9, -0.5, 0.5, 1.0, 5.0):
            stretch = share * (LENGTH - CRITICAL)
            force = self.tension(LENGTH + stretch)
            self.assertAlmostEqual(force / (STIFFNESS * stretch), 1, delta=1e-9)

    def test_force_is_constant_below_the_critical_length(self):
        expected = STIFFNESS * (CRITICAL - LENGTH)
        for share in (0.999999, 0.99, 0.7, 0.3, 0.01):
            self.assertAlmostEqual(self.tension(share * CRITICAL) / expected, 1, delta=1e-9)

    def test_force_is_continuous_at_the_critical_length(self):
        step = 1e-9 * LENGTH
        above, below = self.tension(CRITICAL + step), self.tension(CRITICAL - step)
        self.assertLess(abs(above - below), 1.01 * STIFFNESS * step)
        self.assertNotEqual(above, below)

    def test_force_is_the_slope_of_the_energy(self):
        net, step = self.sheet.membrane, 1e-4 * (LENGTH - CRITICAL)
        for length in (1.003 * LENGTH, 0.9999 * LENGTH, 0.99 * CRITICAL, 0.5 * CRITICAL):
            # Of all three sides, moving node 2 along the one to node 0.
            direction = self.stretch(length)
            pull = -float(np.dot(self.sheet.side_forces()[2], direction))
            energies = []
            for moved in (length + step, length - step):
                self.stretch(moved)
                energies.append(net.elasticEnergy())
            slope = (energies[0] - energies[1]) / (2 * step)
            self.assertAlmostEqual(slope / pull, 1, delta=1e-6)

    def test_energy_of_the_law_and_of_the_tracker_is_that_of_the_membrane(self):
        self.stretch(0.9 * LENGTH)
        O.trackEnergy = True
        self.sheet.side_forces()
        energy = self.sheet.membrane.elasticEnergy()
        law = self.sheet.loop.lawDispatcher.functors[0]
        self.assertGreater(energy, 0)
        self.assertAlmostEqual(law.elasticEnergy() / energy, 1, delta=1e-12)
        self.assertAlmostEqual(O.energy["membraneElastic"] / energy, 1, delta=1e-12)

    def test_normal_force_has_yades_sign(self):
        for share in (1.001, 0.9):
            force = self.tension(share * LENGTH)
            ids = self.sheet.membrane.bodyIds
            link = O.interactions[ids[0], ids[2]]
            first_to_second = np.array(O.bodies[link.id2].state.pos) - O.bodies[link.id1].state.pos
            first_to_second /= np.linalg.norm(first_to_second)
            np.testing.assert_allclose(link.geom.normal, first_to_second, atol=1e-12)
            np.testing.assert_allclose(link.phys.normalForce, -force * first_to_second, rtol=1e-9)
            np.testing.assert_array_equal(link.phys.shearForce, 0)
            self.assertLess(force * (0.95 - share), 0, "tension positive")

    def test_coinciding_nodes_give_finite_forces(self):
        self.sheet.place([TRIANGLE[0], TRIANGLE[1], TRIANGLE[0]])
        self.assertTrue(np.all(np.isfinite(self.sheet.side_forces())))


class TestSheetOfSides(SceneTest):
    def test_sides_pull_without_net_force_and_moment_in_any_state(self):
        rng = np.random.default_rng(1)
        nodes, triangles = grid(4, jitter=0.1, rng=rng)
        sheet = Sheet(nodes, triangles)
        for amplitude in (1e-6, 1e-4, 5e-3):
            x = nodes + amplitude * rng.normal(size=nodes.shape)
            forces = sheet.place(x).side_forces()
            size = np.abs(forces).sum()
            self.assertGreater(size, 1e-4)
            np.testing.assert_allclose(forces.sum(axis=0) / size, 0, atol=1e-14)
            np.testing.assert_allclose(np.cross(x, forces).sum(axis=0) / size, 0, atol=1e-15)

    def test_forces_are_the_slope_of_the_energy_at_random_states(self):
        rng = np.random.default_rng(2)
        nodes, triangles = grid(2, jitter=0.1, rng=rng)
        sheet = Sheet(nodes, triangles, alpha=ALPHA, cables=[(0, 8)])
        buckled, step = 0, 1e-9
        for amplitude in (1e-5, 1e-3):
            x = nodes + amplitude * rng.normal(size=nodes.shape)
            forces = sheet.place(x).side_forces()
            buckled += np.sum(
                np.array(sheet.membrane.lengths()) < np.array(sheet.membrane.criticalLengths)
            )
            slope = np.zeros_like(forces)
            for node, axis in np.ndindex(*x.shape):
                for sign in (1, -1):
                    moved = x.copy()
                    moved[node, axis] += sign * step
                    slope[node, axis] += sign * sheet.place(moved).membrane.elasticEnergy()
            np.testing.assert_allclose(
                -slope / (2 * step), forces, rtol=0, atol=1e-5 * np.abs(forces).max()
            )
        self.assertGreater(buckled, 2)

    def test_tensions_and_lengths_are_those_of_the_loop(self):
        rng = np.random.default_rng(3)
        nodes, triangles = grid(2)
        sheet = Sheet(nodes, triangles)
        x = nodes + 1e-3 * rng.normal(size=nodes.shape)
        expected = np.zeros_like(x)
        sheet.place(x)
        for (a, b), length, tension in zip(
            sheet.membrane.sides, sheet.membrane.lengths(), sheet.membrane.tensions()
        ):
            self.assertAlmostEqual(length, np.linalg.norm(x[b] - x[a]), delta=1e-16)
            expected[a] += tension * (x[b] - x[a]) / length
            expected[b] -= tension * (x[b] - x[a]) / length
        np.testing.assert_allclose(sheet.side_forces(), expected, rtol=1e-10, atol=1e-14)

    def test_film_creases_and_cables_buckle_by_their_own_parameters(self):
        mesh = sail_mesh()
        net = Membrane(
            material=scene.film(),
            nodes=mesh.nodes.tolist(),
            triangles=mesh.triangles.tolist(),
            creases=mesh.creases.tolist(),
            creaseSigns=mesh.crease_signs.tolist(),
            cables=mesh.cables.tolist(),
            alpha=100.0,
            alphaCrease=1000.0,
        )
        creases = {tuple(sorted(pair)) for pair in mesh.creases.tolist()}
        cables = {tuple(sorted(pair)) for pair in mesh.cables.tolist()}
        count = {0.0: 0, 100.0: 0, 1000.0: 0}
        for pair, rest, critical in zip(net.sides, net.restLengths, net.criticalLengths):
            alpha = 1000.0 if pair in creases else 0.0 if pair in cables else 100.0
            count[alpha] += 1
            expected = rest - alpha * np.pi**2 * 7.5e-6**2 / (12 * rest)
            self.assertAlmostEqual(critical / expected, 1, delta=1e-14)
        self.assertEqual(count, {0.0: 16, 100.0: 936, 1000.0: 364})


class TestTether(SceneTest):
    """A cable between two masses."""

    def setUp(self):
        super().setUp()
        self.sheet = Sheet(
            [[0, 0, 0], [LENGTH, 0, 0]],
            cables=[(0, 1)],
            cableStiffness=200.0,
            pointMasses=[1e-4, 3e-4],
            engine={"zeta": 0.5},
        )

    def pull(self, length, rate):
        """Total pull of the tether on node 0 [N] at a length [m] growing at `rate` [m/s]."""
        self.sheet.place([[0, 0, 0], [length, 0, 0]], np.array([[0, 0, 0], [rate, 0, 0.0]]))
        return self.sheet.all_forces()[0, 0]

    def test_taut_tether_pulls_with_its_stiffness(self):
        self.assertAlmostEqual(self.pull(1.01 * LENGTH, 0.0) / (200.0 * 0.01), 1, delta=1e-9)

    def test_slack_tether_has_no_force_and_no_damping(self):
        for length in (0.999999 * LENGTH, 0.5 * LENGTH):
            for rate in (-10.0, 0.0, 10.0):
                self.assertEqual(self.pull(length, rate), 0)
                np.testing.assert_array_equal(self.sheet.all_forces(), 0)

    def test_tether_never_pushes_though_damped_while_it_slackens_fast(self):
        damped = 0
        for strain in (1e-6, 1e-4, 1e-2):
            free = self.pull((1 + strain) * LENGTH, 0.0)
            for rate in (-100.0, -1.0, -0.01, 0.01, 1.0):
                pull = self.pull((1 + strain) * LENGTH, rate)
                self.assertGreaterEqual(pull, -1e-12 * free)
                damped += abs(pull - free) > 0.01 * free
        self.assertGreater(damped, 5)

    def test_tether_never_pushes_in_a_run_that_slackens_it(self):
        self.sheet.place([[0, 0, 0], [1.01 * LENGTH, 0, 0]])
        self.sheet.run_engines()
        O.dt = 0.05 * self.sheet.engine.criticalTimeStep()
        pulls = []
        for _ in range(400):
            O.step()
            pulls.append(O.forces.f(self.sheet.membrane.bodyIds[0], True)[0])
        self.assertGreater(max(pulls), 1.0)
        self.assertGreaterEqual(min(pulls), -1e-12)
        self.assertEqual(pulls[-1], 0, "it never went slack")


if __name__ == "__main__":
    unittest.main()

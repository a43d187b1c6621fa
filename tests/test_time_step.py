# SPDX-License-Identifier: GPL-2.0-or-later
"""The estimate of the critical time step against dense eigenvalues, and against runs.

With damping at velocities extrapolated to the time of the positions, the leapfrog is stable while
the largest eigenvalue of (dt2 K + 4 dt C) / M stays below 4.
"""

import unittest

import numpy as np
from membrane import scene
from support import O, SceneTest, Sheet, film_of_the_sail, fold_angle, grid, set_engines

CREASES = [(4, 5), (5, 6), (9, 10)]
SIGNS = [1, 1, -1]


def side_matrices(sheet, positions, zeta):
    """K and C (3 N, 3 N) of all sides, taut, with the tension's stiffness across them."""
    net, size = sheet.membrane, 3 * len(positions)
    stiff, damped = np.zeros((size, size)), np.zeros((size, size))
    for (a, b), k, rest in zip(net.sides, net.stiffnesses, net.restLengths):
        span = positions[b] - positions[a]
        length = np.linalg.norm(span)
        along = np.outer(span, span) / length**2
        across = max(0.0, k * (length - rest) / length) * (np.eye(3) - along)
        c = 2 * zeta * np.sqrt(k * 0.5 * (sheet.masses[a] + sheet.masses[b]))
        for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            block = np.s_[3 * i : 3 * i + 3, 3 * j : 3 * j + 3]
            stiff[block] += sign * (k * along + across)
            damped[block] += sign * c * along
    return stiff, damped


def crease_matrix(sheet, positions, beta, gamma):
    """K (3 N, 3 N) of the creases, as stiff as where the faces passed through each other."""
    net, rest = sheet.membrane, sheet.rest
    bending = beta * net.material.young * net.material.thickness**3 / 12
    size, step = 3 * len(positions), 1e-8
    stiff = np.zeros((size, size))
    for (a, b), sign in zip(net.creases, net.creaseSigns):
        c, d = apices(net.triangles, a, b)
        length = np.linalg.norm(rest[b] - rest[a])
        heights = [np.linalg.norm(np.cross(rest[b] - rest[a], rest[i] - rest[a])) for i in (c, d)]
        stiffness = gamma * bending * length / (np.mean(heights) / length)
        gradient = np.zeros(size)
        for node in (a, b, c, d):
            for axis in range(3):
                angles = []
                for side in (1, -1):
                    moved = positions.copy()
                    moved[node, axis] += side * step
                    angles.append(fold_angle(*moved[[a, b, c, d]], valley=sign < 0))
                gradient[3 * node + axis] = (angles[0] - angles[1]) / (2 * step)
        stiff += stiffness * np.outer(gradient, gradient)
    return stiff


def apices(triangles, a, b):
    """The third nodes of the triangles that run from a to b and from b to a."""
    found = {}
    for triangle in map(tuple, triangles):
        for i in range(3):
            found[triangle[i], triangle[i - 2]] = triangle[i - 1]
    return found[a, b], found[b, a]


def exact_step(stiff, damped, masses):
    """Largest stable step [s] by dense eigenvalues; masses (N,) [kg]."""
    scale = 1 / np.sqrt(np.repeat(masses, 3))
    stiff, damped = stiff * np.outer(scale, scale), damped * np.outer(scale, scale)
    undamped = np.linalg.eigvalsh(stiff)[-1]
    step, change = 2 / np.sqrt(undamped), 1.0
    while damped.any() and abs(change) > 1e-9:
        # At the largest eigenvalue's vector the condition is a quadratic equation for the step.
        _, vectors = np.linalg.eigh(step * stiff + 4 * damped)
        k, c = (vectors[:, -1] @ matrix @ vectors[:, -1] for matrix in (stiff, damped))
        change, step = -step, 2 * (np.sqrt(c**2 + k) - c) / k
        change = (change + step) / step
    return step


class TimeStepTest(SceneTest):
    def make(self, *, seed=1, stretch=1.0, point_masses=None, **engine):
        """A jittered 3 x 3 sheet, perhaps stretched; its engine's parameters as given."""
        O.reset()
        rng = np.random.default_rng(seed)
        nodes, triangles = grid(3, jitter=0.15, rng=rng)
        self.sheet = Sheet(
            nodes,
            triangles,
            creases=CREASES,
            crease_signs=SIGNS,
            alpha=1e12,
            alphaCrease=1e12,
            pointMasses=[] if point_masses is None else point_masses,
            engine=engine,
        )
        self.sheet.place(stretch * nodes)
        return self.sheet


class TestEstimate(TimeStepTest):
    def check(self, exact):
        ratio = self.sheet.engine.criticalTimeStep() / exact
        self.assertLessEqual(ratio, 1.0)
        self.assertGreater(ratio, 0.95)

    def test_sides(self):
        for seed in range(5):
            sheet = self.make(seed=seed)
            self.check(exact_step(*side_matrices(sheet, sheet.rest, 0.0), sheet.masses))

    def test_uneven_masses(self):
        heavy = np.zeros(16)
        heavy[[0, 3, 5]] = [1e-4, 3e-6, 1e-5]
        sheet = self.make(point_masses=heavy.tolist())
        self.check(exact_step(*side_matrices(sheet, sheet.rest, 0.0), sheet.masses))

    def test_damping_shortens_the_step(self):
        undamped = self.make().engine.criticalTimeStep()
        for zeta in (0.02, 0.3, 1.0):
            sheet = self.make(zeta=zeta)
            self.check(exact_step(*side_matrices(sheet, sheet.rest, zeta), sheet.masses))
            self.assertLess(sheet.engine.criticalTimeStep(), undamped)

    def test_tension_adds_stiffness_across_the_sides(self):
        for stretch in (1.05, 1.5):
            sheet = self.make(stretch=stretch)
            x = stretch * sheet.rest
            self.check(exact_step(*side_matrices(sheet, x, 0.0), sheet.masses))

    def test_creases_that_rule_the_step(self):
        sides = self.make().engine.criticalTimeStep()
        for beta, zeta in ((3e7, 0.0), (3e7, 0.1)):
            # At the natural angle, where the creases' own forces turn with nothing.
            sheet = self.make(beta=beta, zeta=zeta, theta0=np.pi, creaseLaw="conservative")
            stiff, damped = side_matrices(sheet, sheet.rest, zeta)
            stiff += crease_matrix(sheet, sheet.rest, beta, 100.0)
            self.check(exact_step(stiff, damped, sheet.masses))
            self.assertLess(sheet.engine.criticalTimeStep(), 0.7 * sides)

    def test_strained_creases_are_never_taken_for_softer(self):
        beta = 3e5
        sheet = self.make(beta=beta, creaseLaw="conservative")
        bent = sheet.rest + 3e-3 * np.random.default_rng(9).normal(size=sheet.rest.shape)
        sheet.place(bent)
        stiff, damped = side_matrices(sheet, bent, 0.0)
        stiff += crease_matrix(sheet, bent, beta, 100.0)
        exact = exact_step(stiff, damped, sheet.masses)
        self.assertLessEqual(sheet.engine.criticalTimeStep(), exact)
        self.assertGreater(sheet.engine.criticalTimeStep(), 0.5 * exact)

    def test_held_nodes_do_not_count(self):
        sheet = self.make()
        held, free = [0, 1, 2, 3], np.arange(4, 16)
        for node in held:
            sheet.states[node].blockedDOFs = "xyzXYZ"
        stiff, damped = side_matrices(sheet, sheet.rest, 0.0)
        kept = np.concatenate([3 * free + axis for axis in range(3)])
        kept.sort()
        exact = exact_step(
            stiff[np.ix_(kept, kept)], damped[np.ix_(kept, kept)], sheet.masses[free]
        )
        self.check(exact)

    def test_whole_sail(self):
        for zeta in (0.0, 0.02):
            O.reset()
            mesh, flat = film_of_the_sail()
            self.sheet = Sheet(flat, mesh.triangles, engine={"zeta": zeta})
            self.check(exact_step(*side_matrices(self.sheet, flat, zeta), self.sheet.masses))

    def test_nothing_that_moves_has_no_critical_step(self):
        sheet = self.make()
        self.assertLess(sheet.engine.criticalTimeStep(), 1e-3)
        for state in sheet.states:
            state.blockedDOFs = "xyzXYZ"
        self.assertEqual(sheet.engine.criticalTimeStep(), np.inf)


class TestRuns(TimeStepTest):
    def growth(self, share, zeta, steps):
        """Kinetic energy after `steps` over that at the start, in the plane of the flat sheet."""
        sheet = self.make(zeta=zeta)
        exact = exact_step(*side_matrices(sheet, sheet.rest, zeta), sheet.masses)
        velocity = np.random.default_rng(3).normal(size=sheet.rest.shape) * [1, 1, 0]
        sheet.place(sheet.rest, 1e-7 * velocity)
        sheet.run_engines()
        O.dt = share * exact
        start = np.sum(sheet.masses[:, None] * sheet.velocities() ** 2)
        largest = 0.0
        for _ in range(steps):
            O.step()
            largest = max(largest, np.sum(sheet.masses[:, None] * sheet.velocities() ** 2))
        return largest / start

    def test_above_the_exact_limit_a_run_blows_up_and_below_it_stays_bounded(self):
        for zeta in (0.0, 0.1):
            self.assertLess(self.growth(0.98, zeta, 3000), 30)
            self.assertGreater(self.growth(1.1, zeta, 60), 1e8)
            # Above the limit damped modes grow, but slowly.
            self.assertGreater(self.growth(1.02, zeta, 400 if zeta else 120), 1e6)

    def test_step_above_the_estimate_is_refused_unless_forced(self):
        sheet = self.make(zeta=0.02)
        sheet.run_engines()
        limit = sheet.engine.criticalTimeStep()
        sheet.engine.forceTimeStep = False
        O.dt = 1.001 * limit
        with self.assertRaisesRegex(RuntimeError, r"O\.dt = .* must be <= .* critical time step"):
            O.step()
        np.testing.assert_array_equal(sheet.positions(), sheet.rest)
        sheet.engine.forceTimeStep = True
        O.step()
        sheet.engine.forceTimeStep = False
        O.dt = 0.999 * limit
        O.step()

    def test_step_is_checked_again_as_the_state_stiffens(self):
        sheet = self.make(zeta=0.02)
        sheet.run_engines()
        sheet.engine.forceTimeStep, sheet.engine.timeStepCheckPeriod = False, 10
        O.dt = 0.99 * sheet.engine.criticalTimeStep()
        for _ in range(15):
            O.step()
        sheet.place(3 * sheet.rest)
        self.assertLess(sheet.engine.criticalTimeStep(), O.dt)
        with self.assertRaisesRegex(RuntimeError, "critical time step"):
            for _ in range(10):
                sheet.place(3 * sheet.rest)
                O.step()

    def test_how_often_it_is_checked_is_a_parameter(self):
        nodes, triangles = grid(4)
        for period, refused in ((5, 5), (9, 9)):
            O.reset()
            net = scene.add_membrane(nodes, triangles)
            made = set_engines(net, zeta=0.02, check_period=period, energy_tolerance=0)
            O.dt = 0.99 * made.forces.criticalTimeStep()
            O.step()
            with self.assertRaisesRegex(RuntimeError, "critical time step"):
                for _ in range(20):
                    made.place(3 * nodes)
                    O.step()
            self.assertEqual(O.iter, refused)

    def test_longest_step_that_is_accepted_is_the_estimate(self):
        for engine in ({}, {"beta": 3e6, "zeta": 0.1}, {"airDensity": 1e3}):
            sheet = self.make(**engine)
            sheet.states[5].blockedDOFs = "xyzXYZ"
            sheet.place(1.01 * sheet.rest, 10 * sheet.rest)
            sheet.run_engines()
            sheet.engine.forceTimeStep = False
            limit = sheet.engine.criticalTimeStep()
            for step, refused in ((0.3, False), (0.9, False), (1.0, False), (1 + 1e-12, True)):
                sheet.place(1.01 * sheet.rest, 10 * sheet.rest)
                O.dt = step * limit
                self.assertEqual(sheet.engine.criticalTimeStep(), limit)
                if refused:
                    with self.assertRaisesRegex(RuntimeError, "critical time step"):
                        O.step()
                else:
                    O.step()

    def test_step_raised_during_a_run_is_refused(self):
        sheet = self.make(zeta=0.02)
        sheet.run_engines()
        sheet.engine.forceTimeStep = False
        limit = sheet.engine.criticalTimeStep()
        O.dt = 0.5 * limit
        O.step()
        O.dt = 2 * limit
        with self.assertRaisesRegex(RuntimeError, "critical time step"):
            O.step()


if __name__ == "__main__":
    unittest.main()

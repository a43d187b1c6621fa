# SPDX-License-Identifier: GPL-2.0-or-later
"""Creases, paper equations (7) and (8): angle, force, energy, and a swing about the rest angle.

A hinge is two triangles ABC and BAD on a crease AB along x. Triangle ABC lies in the plane z = 0
with C at y > 0 and its upper side towards +z; D stands at the angle theta from C. Seen from above,
a valley closes upwards and a mountain downwards.
"""

import unittest

import numpy as np
from membrane import scene
from support import O, SceneTest, Sheet, fold_angle, grid, rotation

MOUNTAIN, VALLEY = 1, -1
YOUNG, THICKNESS, BETA, GAMMA = 3.2e9, 7.5e-6, 30.0, 100.0
BENDING = BETA * YOUNG * THICKNESS**3 / 12
LAWS = ("paper", "conservative")
TRIANGLES = [(0, 1, 2), (1, 0, 3)]

LENGTH = 0.02  # of the crease AB
# Along AB: feet of C and D, as shares of AB; heights of C and D [m].
EQUAL = (0.5, 0.4, 0.015, 0.015)
UNEQUAL = (0.3, 0.6, 0.012, 0.020)
OUTSIDE = (-0.4, 1.7, 0.015, 0.015)
OUTSIDE_UNEQUAL = (1.5, -0.3, 0.010, 0.017)
SHAPES = {
    "equal": EQUAL,
    "unequal": UNEQUAL,
    "outside": OUTSIDE,
    "outside, unequal": OUTSIDE_UNEQUAL,
}


def hinge(shape, theta, sign):
    """Nodes A, B, C, D (4, 3) [m] of a hinge at an angle [rad]."""
    foot_c, foot_d, high_c, high_d = shape
    rise = -sign * np.sin(theta)
    return np.array(
        [
            [0.0, 0.0, 0.0],
            [LENGTH, 0.0, 0.0],
            [foot_c * LENGTH, high_c, 0.0],
            [foot_d * LENGTH, high_d * np.cos(theta), high_d * rise],
        ]
    )


class HingeTest(SceneTest):
    """Tests on one hinge."""

    def make(self, shape=EQUAL, sign=VALLEY, law="paper", theta0=0.0, beta=BETA, gamma=GAMMA):
        O.reset()
        self.shape, self.sign = shape, sign
        self.sheet = Sheet(
            hinge(shape, np.pi, sign),
            TRIANGLES,
            creases=[(0, 1)],
            crease_signs=[sign],
            allowNegativeStiffness=True,
            engine=dict(beta=beta, gamma=gamma, theta0=theta0, creaseLaw=law),
        )
        return self.sheet

    def forces(self, theta, turn=None, shift=0.0):
        """Forces (4, 3) [N] of the hinge at an angle [rad]."""
        turn = np.eye(3) if turn is None else turn
        return self.sheet.place(
            hinge(self.shape, theta, self.sign) @ turn.T + shift
        ).engine_forces()

    def opening_force(self, theta):
        """Force on D [N] in the direction in which it moves to open the hinge."""
        force = self.forces(theta)[3]
        outward = np.array([0.0, -np.sin(theta), -self.sign * np.cos(theta)])
        np.testing.assert_allclose(force, np.dot(force, outward) * outward, atol=1e-18)
        return float(np.dot(force, outward))


class TestAngle(HingeTest):
    ANGLES = (-1.5, -0.5, -1e-3, -1e-9, 0.0, 1e-9, 0.3, 1.6, 3.1, np.pi, 3.2, 4.0, 4.7)

    def test_angle_goes_from_passed_through_over_closed_and_flat_without_a_jump(self):
        rng = np.random.default_rng(1)
        for sign in (MOUNTAIN, VALLEY):
            for shape in SHAPES.values():
                sheet = self.make(shape, sign)
                for theta in self.ANGLES:
                    nodes = hinge(shape, theta, sign) @ rotation(rng).T + rng.normal(size=3)
                    self.assertAlmostEqual(
                        sheet.place(nodes).engine.creaseAngles()[0], theta, delta=1e-12
                    )

    def test_angle_is_the_one_measured_by_turning_the_faces_in_random_states(self):
        rng = np.random.default_rng(2)
        for sign in (MOUNTAIN, VALLEY):
            sheet = self.make(UNEQUAL, sign)
            found, expected = [], []
            for _ in range(50):
                nodes = rng.normal(size=(4, 3))
                found.append(sheet.place(nodes).engine.creaseAngles()[0])
                expected.append(fold_angle(*nodes, valley=sign == VALLEY))
            self.assertLess(min(expected), -0.5)
            self.assertGreater(max(expected), 4.0)
            np.testing.assert_allclose(found, expected, atol=1e-12)

    def test_order_of_nodes_in_crease_and_triangles_does_not_matter(self):
        nodes = hinge(UNEQUAL, 0.8, MOUNTAIN)
        for crease in ((0, 1), (1, 0)):
            for triangles in (TRIANGLES, [(0, 3, 1), (2, 0, 1)]):
                O.reset()
                sheet = Sheet(
                    hinge(UNEQUAL, np.pi, MOUNTAIN),
                    triangles,
                    creases=[crease],
                    crease_signs=[MOUNTAIN],
                    engine={"beta": BETA},
                )
                angle = sheet.place(nodes).engine.creaseAngles()[0]
                self.assertAlmostEqual(angle, 0.8, delta=1e-13)

    def test_turning_the_triangles_over_turns_mountain_into_valley(self):
        nodes = hinge(UNEQUAL, 0.8, MOUNTAIN)
        sheet = Sheet(
            hinge(UNEQUAL, np.pi, MOUNTAIN),
            [(0, 2, 1), (1, 3, 0)],
            creases=[(0, 1)],
            crease_signs=[VALLEY],
            engine={"beta": BETA},
        )
        self.assertAlmostEqual(sheet.place(nodes).engine.creaseAngles()[0], 0.8, delta=1e-13)


class TestForce(HingeTest):
    def test_forces_on_apices_are_those_of_equation_7_with_rest_lengths(self):
        for shape in SHAPES.values():
            for sign in (MOUNTAIN, VALLEY):
                for theta0 in (0.0, 0.7):
                    self.make(shape, sign, theta0=theta0)
                    for theta in (0.1, 1.5, np.pi, 4.5):
                        forces = self.forces(theta)
                        expected = BENDING * LENGTH * (theta - theta0)
                        on_c, on_d = expected / shape[2] ** 2, expected / shape[3] ** 2
                        # Closing: C towards its upper side in a valley, D against its opening.
                        closing_d = np.array([0.0, np.sin(theta), sign * np.cos(theta)])
                        np.testing.assert_allclose(
                            forces[2], [0, 0, -sign * on_c], rtol=1e-10, atol=1e-9 * abs(on_c)
                        )
                        np.testing.assert_allclose(
                            forces[3], on_d * closing_d, rtol=1e-9, atol=1e-9 * abs(on_d)
                        )

    def test_forces_on_the_crease_are_those_of_equation_8(self):
        for law in LAWS:
            for shape in SHAPES.values():
                self.make(shape, law=law)
                forces = self.forces(1.0)
                (foot_c, foot_d), (on_c, on_d) = shape[:2], forces[2:]
                self.assertGreater(np.linalg.norm(on_c), 1e-6)
                scale = np.abs(forces).max()
                on_a = -(1 - foot_c) * on_c - (1 - foot_d) * on_d
                np.testing.assert_allclose(forces[0], on_a, atol=1e-12 * scale)
                on_b = -foot_c * on_c - foot_d * on_d
                np.testing.assert_allclose(forces[1], on_b, atol=1e-12 * scale)

    def test_a_tenth_of_the_height_leaves_the_force_of_the_paper_as_it_is(self):
        self.make()
        whole = np.linalg.norm(self.forces(1.0)[2])
        nodes = hinge((0.5, 0.4, 0.0015, 0.015), 1.0, VALLEY)
        collapsed = np.linalg.norm(self.sheet.place(nodes).engine_forces()[2])
        self.assertAlmostEqual(collapsed / whole, 1, delta=1e-9)

    def test_collapsed_triangles_give_bounded_forces(self):
        for law in LAWS:
            self.make(law=law)
            largest = np.abs(self.forces(1.0)).max()
            for shape in ((0.5, 0.4, 1e-12, 0.015), (0.5, 0.4, 0.0, 0.015), (0.5, 0.4, 0.0, 0.0)):
                forces = self.sheet.place(hinge(shape, 1.0, VALLEY)).engine_forces()
                self.assertLess(np.abs(forces).max(), 100 * largest)
            point = self.sheet.place(np.zeros((4, 3))).engine_forces()
            np.testing.assert_array_equal(point, 0)

    def test_net_force_is_zero_for_feet_inside_and_outside(self):
        rng = np.random.default_rng(3)
        for law in LAWS:
            for shape in SHAPES.values():
                self.make(shape, law=law, theta0=0.5)
                for theta in (-1.2, -0.1, 0.2, 2.0, 4.0):
                    forces = self.forces(theta, rotation(rng), rng.normal(size=3))
                    size = np.abs(forces).max()
                    self.assertGreater(size, 1e-5)
                    np.testing.assert_allclose(forces.sum(axis=0) / size, 0, atol=1e-12)

    def test_net_moment_is_zero_for_equal_heights_in_both_laws(self):
        for law in LAWS:
            for shape in (EQUAL, OUTSIDE):
                self.make(shape, law=law)
                for theta in (-0.5, 0.5, 2.5, 4.0):
                    forces = self.forces(theta)
                    moment = np.cross(hinge(shape, theta, VALLEY), forces).sum(axis=0)
                    size = np.abs(forces).max() * LENGTH
                    self.assertGreater(size, 1e-8)
                    np.testing.assert_allclose(moment / size, 0, atol=1e-12)

    def test_unequal_heights_give_a_net_moment_about_the_crease_in_the_paper_only(self):
        theta = 1.0
        for shape in (UNEQUAL, OUTSIDE_UNEQUAL):
            expected = BENDING * LENGTH * theta * (1 / shape[3] - 1 / shape[2])
            for law, wanted in (("paper", expected), ("conservative", 0.0)):
                self.make(shape, law=law)
                forces = self.forces(theta)
                moment = np.cross(hinge(shape, theta, VALLEY), forces).sum(axis=0)
                np.testing.assert_allclose(
                    np.abs(moment), [abs(wanted), 0, 0], atol=1e-9 * abs(expected)
                )

    def test_force_is_continuous_from_passed_through_to_turned_inside_out(self):
        step = 1e-3
        sweep = np.arange(-np.pi / 2 + step, 3 * np.pi / 2, step)
        for law, theta0 in (("paper", 0.0), ("conservative", 0.0), ("conservative", 2.0)):
            for sign in (MOUNTAIN, VALLEY):
                self.make(EQUAL, sign, law=law, theta0=theta0)
                forces = np.array([self.forces(theta) for theta in sweep])
                jump = np.abs(np.diff(forces, axis=0)).max(axis=(1, 2))
                slope = BENDING * LENGTH / EQUAL[2] ** 2
                # |d(force direction)/d theta| = 1, so no component changes faster than this.
                largest = np.abs(forces).max(axis=(1, 2))[1:]
                stiff = np.where(sweep[:-1] < 0, GAMMA, 1)
                bound = (slope * stiff + largest) * step * 2.0
                self.assertTrue(np.all(jump < bound), np.max(jump / bound))
                self.assertGreater(np.ptp(forces), 1e-3)

    def test_paper_jumps_by_the_penalty_at_closed_where_it_is_not_the_natural_angle(self):
        self.make(theta0=1.0)
        above, below = self.opening_force(1e-9), self.opening_force(-1e-9)
        self.assertGreater(above, 0)
        self.assertAlmostEqual(below / above, GAMMA, delta=1e-6)

    def test_passing_through_is_held_back_gamma_times_as_strongly(self):
        for law in LAWS:
            for gamma in (GAMMA, 3.0):
                self.make(law=law, gamma=gamma)
                for theta in (0.01, 0.5, 1.5):
                    closing, opening = self.opening_force(theta), self.opening_force(-theta)
                    self.assertLess(closing, 0)
                    self.assertAlmostEqual(opening / -closing, gamma, delta=1e-9 * gamma)

    def test_force_brings_the_angle_to_the_natural_one_for_mountain_and_valley(self):
        step = 1e-5
        for law in LAWS:
            for sign in (MOUNTAIN, VALLEY):
                self.make(UNEQUAL, sign, law=law, theta0=1.0)
                for theta in (-1.0, 0.1, 0.9, 1.1, 2.0, 3.1, 3.3, 4.5):
                    nodes = hinge(UNEQUAL, theta, sign)
                    forces = self.forces(theta)
                    moved = nodes + step * LENGTH * forces / np.abs(forces).max()
                    change = fold_angle(*moved, valley=sign == VALLEY) - theta
                    self.assertGreater(abs(change), 0.1 * step)
                    self.assertEqual(np.sign(change), np.sign(1.0 - theta), (law, sign, theta))

    def test_no_force_at_the_natural_angle(self):
        for law in LAWS:
            self.make(law=law, theta0=1.0)
            self.assertGreater(abs(self.opening_force(1.1)), 1e-6)
            self.assertLess(abs(self.opening_force(1.0)), 1e-18)

    def test_laws_agree_at_equal_heights_and_natural_angle_zero(self):
        for shape in (EQUAL, OUTSIDE):
            for theta in (-1.0, -0.01, 0.02, 1.0, 3.0, 4.5):
                found = []
                for law in LAWS:
                    self.make(shape, law=law)
                    found.append(self.forces(theta))
                size = np.abs(found[0]).max()
                self.assertGreater(size, 1e-6)
                np.testing.assert_allclose(found[0] / size, found[1] / size, atol=1e-12)

    def test_forces_turn_with_the_hinge(self):
        rng = np.random.default_rng(4)
        for law in LAWS:
            self.make(UNEQUAL, law=law)
            turn = rotation(rng)
            expected = self.forces(0.7) @ turn.T
            found = self.forces(0.7, turn, rng.normal(size=3))
            np.testing.assert_allclose(found, expected, atol=1e-11 * np.abs(expected).max())

    def test_without_beta_there_is_no_force_and_no_energy(self):
        self.make(beta=0.0)
        np.testing.assert_array_equal(self.forces(1.0), 0)
        self.assertEqual(self.sheet.engine.creaseEnergy(), 0)
        np.testing.assert_array_equal(self.sheet.engine.creaseForces(), 0)

    def test_switching_beta_off_ends_the_forces(self):
        self.make()
        self.assertGreater(np.abs(self.forces(1.0)).max(), 1e-6)
        self.forces(1.0)
        self.sheet.engine.beta = 0.0
        np.testing.assert_array_equal(self.forces(1.0), 0)
        np.testing.assert_array_equal(self.sheet.engine.creaseForces(), 0)


class TestEnergy(HingeTest):
    def energy(self, theta):
        """Energy [J] of the hinge at an angle."""
        self.sheet.place(hinge(self.shape, theta, self.sign))
        return self.sheet.engine.creaseEnergy()

    def test_energy_is_that_of_a_hinge_with_a_stiffer_side(self):
        mean = 0.5 * (UNEQUAL[2] + UNEQUAL[3])
        stiffness = BENDING * LENGTH / mean
        self.make(UNEQUAL, law="conservative", theta0=0.4)
        for theta in (-1.0, 0.1, 0.4, 2.0, 4.5):
            through = (GAMMA - 1) * theta**2 if theta < 0 else 0.0
            expected = 0.5 * stiffness * ((theta - 0.4) ** 2 + through)
            self.assertAlmostEqual(self.energy(theta), expected, delta=1e-10 * stiffness)

    def test_conservative_force_is_the_slope_of_the_energy_in_random_states(self):
        rng = np.random.default_rng(5)
        step, passed = 1e-7 * LENGTH, 0
        for sign in (MOUNTAIN, VALLEY):
            for shape in SHAPES.values():
                sheet = self.make(shape, sign, law="conservative", theta0=0.5)
                for theta in (-1.2, -0.3, 0.05, 1.0, 3.1, 3.3, 4.4):
                    nodes = hinge(shape, theta, sign)
                    nodes = (nodes + 0.1 * LENGTH * rng.normal(size=(4, 3))) @ rotation(rng).T
                    passed += fold_angle(*nodes, valley=sign == VALLEY) < 0
                    forces = sheet.place(nodes).engine_forces()
                    slope = np.zeros((4, 3))
                    for node, axis in np.ndindex(4, 3):
                        for side in (1, -1):
                            moved = nodes.copy()
                            moved[node, axis] += side * step
                            energy = sheet.place(moved).engine.creaseEnergy()
                            slope[node, axis] -= side * energy / (2 * step)
                    size = np.abs(forces).max()
                    self.assertGreater(size, 1e-6)
                    np.testing.assert_allclose(slope / size, forces / size, atol=2e-6)
        self.assertGreater(passed, 5)

    def test_conservative_forces_have_no_net_moment_in_random_states(self):
        rng = np.random.default_rng(6)
        sheet = self.make(UNEQUAL, law="conservative", theta0=0.5)
        for _ in range(20):
            nodes = LENGTH * rng.normal(size=(4, 3))
            forces = sheet.place(nodes).engine_forces()
            size = np.abs(forces).max() * LENGTH
            self.assertGreater(size, 1e-8)
            np.testing.assert_allclose(np.cross(nodes, forces).sum(axis=0) / size, 0, atol=1e-11)

    def test_forces_of_a_creased_sheet_are_the_sum_over_its_creases(self):
        nodes, triangles = grid(3)
        creases, signs = [(4, 5), (5, 6), (8, 9), (5, 10)], [1, 1, -1, -1]
        rng = np.random.default_rng(7)
        x = nodes + 2e-3 * rng.normal(size=nodes.shape)
        total = np.zeros_like(x)
        for crease, sign in zip(creases, signs):
            O.reset()
            alone = Sheet(
                nodes, triangles, creases=[crease], crease_signs=[sign], engine={"beta": BETA}
            )
            forces = alone.place(x).engine_forces()
            self.assertEqual(np.count_nonzero(np.abs(forces).sum(axis=1)), 4)
            total += forces
        O.reset()
        sheet = Sheet(nodes, triangles, creases=creases, crease_signs=signs, engine={"beta": BETA})
        found = sheet.place(x).engine_forces()
        np.testing.assert_allclose(found, total, atol=1e-13 * np.abs(total).max())


class TestSwing(SceneTest):
    """Two equal triangles on a crease, free in space, swing about their natural angle."""

    def frequency(self, law, theta0, apex_mass):
        """Measured and exact angular frequency [rad/s]."""
        O.reset()
        shape = (0.5, 0.5, 0.015, 0.015)
        sheet = Sheet(
            hinge(shape, np.pi, VALLEY),
            TRIANGLES,
            creases=[(0, 1)],
            crease_signs=[VALLEY],
            pointMasses=[0, 0, apex_mass, apex_mass],
            engine=dict(beta=BETA, theta0=theta0, creaseLaw=law),
        )
        self.assertEqual(sheet.masses[2], sheet.masses[3])
        apex, end = sheet.masses[2], sheet.masses[0]
        # Half the angle turns each apex about the crease, which moves against both.
        reduced = apex * end / (apex + end)
        half = 0.5 * theta0
        inertia = 0.5 * shape[2] ** 2 * (apex * np.cos(half) ** 2 + reduced * np.sin(half) ** 2)
        exact = np.sqrt(BENDING * LENGTH / shape[2] / inertia)

        swing = 0.01
        sheet.place(hinge(shape, theta0 + swing, VALLEY))
        sheet.run_engines()
        O.dt = 0.5 * sheet.engine.criticalTimeStep()
        stride = 8
        O.step()
        times, angles = [0.0], [swing]
        while times[-1] < 5.2 * 2 * np.pi / exact:
            for _ in range(stride):
                O.step()
            times.append(times[-1] + stride * O.dt)
            angles.append(sheet.engine.creaseAngles()[0] - theta0)
        angles = np.array(angles)
        self.assertAlmostEqual(np.max(angles) / swing, 1, delta=0.02)
        down = np.flatnonzero((angles[:-1] > 0) & (angles[1:] <= 0))
        self.assertEqual(len(down), 5)
        share = angles[down] / (angles[down] - angles[down + 1])
        crossings = np.array(times)[down] + share * stride * O.dt
        return 2 * np.pi * 4 / (crossings[-1] - crossings[0]), exact

    def test_frequency_is_that_of_stiffness_and_masses(self):
        for law in LAWS:
            for theta0, apex_mass in ((np.pi, 0.0), (2.0, 0.0), (1.0, 2e-6)):
                found, exact = self.frequency(law, theta0, apex_mass)
                self.assertAlmostEqual(found / exact, 1, delta=1e-3)


class TestMaterialOfTheHinge(SceneTest):
    def test_force_grows_with_the_cube_of_the_thickness(self):
        found = []
        for thickness in (5e-6, 1e-5):
            O.reset()
            sheet = Sheet(
                hinge(EQUAL, np.pi, VALLEY),
                TRIANGLES,
                creases=[(0, 1)],
                crease_signs=[VALLEY],
                material=scene.film(thickness=thickness),
                engine={"beta": BETA},
            )
            found.append(sheet.place(hinge(EQUAL, 1.0, VALLEY)).engine_forces()[2])
        np.testing.assert_allclose(found[1], 8 * found[0], rtol=1e-12)


if __name__ == "__main__":
    unittest.main()

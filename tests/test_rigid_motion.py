# SPDX-License-Identifier: GPL-2.0-or-later
"""A sail that moves as a rigid body feels no elastic, crease or damping force."""

import unittest

import numpy as np
from support import Sheet, SceneTest, film_of_the_sail, rotation


class TestRigidMotion(SceneTest):
    """The flat sail without tethers; its creases are at rest when flat."""

    def setUp(self):
        super().setUp()
        self.mesh, self.flat = film_of_the_sail()
        self.sheet = Sheet(
            self.flat,
            self.mesh.triangles,
            creases=self.mesh.creases,
            crease_signs=self.mesh.crease_signs,
        )
        self.rng = np.random.default_rng(1)
        self.turn, self.shift = rotation(self.rng), self.rng.normal(size=3)
        self.moved = self.flat @ self.turn.T + self.shift

    def rigid_velocity(self):
        """Velocities (N, 3) [m/s] of a turn and a shift at once, at the moved place."""
        return np.cross([1.0, -20.0, 6 * np.pi], self.moved) + [3.0, 4.0, -5.0]

    def test_moved_sail_has_no_elastic_force(self):
        stretched = np.abs(self.sheet.place(1.001 * self.moved).side_forces()).max()
        self.assertGreater(stretched, 0.01)
        moved = np.abs(self.sheet.place(self.moved, self.rigid_velocity()).side_forces()).max()
        # Coordinates are rounded to 2e-16 m: strains of 1e-14, against 1e-3.
        self.assertLess(moved, 1e-10 * stretched)

    def test_moved_sail_at_its_natural_angle_has_no_crease_force(self):
        for law in ("paper", "conservative"):
            self.sheet.engine.beta, self.sheet.engine.creaseLaw = 30.0, law
            self.sheet.place(self.moved, self.rigid_velocity())
            self.sheet.engine.theta0 = 0.0
            closing = np.abs(self.sheet.engine_forces()).max()
            self.assertGreater(closing, 1e-4)
            self.assertGreater(self.sheet.engine.creaseEnergy(), 1e-6)
            self.sheet.engine.theta0 = np.pi
            self.assertLess(np.abs(self.sheet.engine_forces()).max(), 1e-12 * closing)
            self.assertLess(self.sheet.engine.creaseEnergy(), 1e-25)

    def test_crease_forces_and_angles_depend_on_the_shape_alone(self):
        bent = self.flat + 1e-3 * self.rng.normal(size=self.flat.shape)
        self.sheet.engine.beta = 30.0
        here = self.sheet.place(bent).engine_forces()
        angles = self.sheet.engine.creaseAngles()
        self.assertGreater(np.ptp(angles), 0.1)
        there = self.sheet.place(bent @ self.turn.T + self.shift).engine_forces()
        np.testing.assert_allclose(there, here @ self.turn.T, atol=1e-10 * np.abs(here).max())
        np.testing.assert_allclose(self.sheet.engine.creaseAngles(), angles, atol=1e-11)

    def test_elastic_forces_depend_on_the_shape_alone(self):
        bent = self.flat + 1e-3 * self.rng.normal(size=self.flat.shape)
        here = self.sheet.place(bent).side_forces()
        self.assertGreater(np.abs(here).max(), 0.01)
        there = self.sheet.place(bent @ self.turn.T + self.shift).side_forces()
        np.testing.assert_allclose(there, here @ self.turn.T, atol=1e-10 * np.abs(here).max())

    def test_rigid_velocity_has_no_damping_force(self):
        self.sheet.engine.zeta = 0.02
        bent = self.moved + 1e-3 * self.rng.normal(size=self.flat.shape)
        rigid = self.rigid_velocity()
        for x in (self.moved, bent):
            velocity = rigid + np.cross([1.0, -20.0, 6 * np.pi], x - self.moved)
            shaken = self.rng.permutation(velocity)
            forces = self.sheet.place(x, shaken).engine_forces()
            damped = np.abs(forces).max()
            self.assertGreater(damped, 0.01)
            self.assertLess(np.sum(forces * shaken), -0.01)
            self.sheet.place(x, velocity)
            self.assertLess(np.abs(self.sheet.engine_forces()).max(), 1e-12 * damped)


if __name__ == "__main__":
    unittest.main()

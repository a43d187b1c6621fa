# SPDX-License-Identifier: GPL-2.0-or-later
"""Energy and momentum of undamped and of free sails in YADE's leapfrog.

The leapfrog's energy is m v- v+ / 2 + U(x) with the velocities half a step before and after: in a
linear system it is constant at any stable step. With the mean velocity instead, the error is
O(dt2) and bounded. The sums here are the tests' own, not the ledger's.

Amplitude and step of the main test: random velocities of 1 mm/s, so that strains (1e-6) stay below
those of buckling (1e-5) and the sail is almost linear; the step of the main run, 0.36 of the
critical one. Faster nodes buckle the sides, whose force then bends at l_cr: that test takes a
shorter step.
"""

import unittest

import numpy as np
from support import O, SceneTest, Sheet, film_of_the_sail, long

STEP = 5e-6


class FreeSail(SceneTest):
    """The flat sail without tethers, free in space, its creases at rest when flat."""

    def make(self, speed, engine=None, **parameters):
        O.reset()
        mesh, flat = film_of_the_sail(**parameters)
        self.sheet = Sheet(
            flat,
            mesh.triangles,
            creases=mesh.creases,
            crease_signs=mesh.crease_signs,
            engine={"theta0": np.pi, "creaseLaw": "conservative", **(engine or {})},
        )
        velocities = speed * np.random.default_rng(0).normal(size=flat.shape)
        self.sheet.place(flat, velocities).run_engines()
        self.mass = self.sheet.masses[:, None]

    def step(self, count):
        """Run `count` steps."""
        for _ in range(count):
            O.step()

    def energies(self):
        """Energy stored, kinetic energy of the leapfrog and of the mean velocity [J]; one step."""
        stored = self.sheet.membrane.elasticEnergy() + self.sheet.engine.creaseEnergy()
        before = self.sheet.velocities()
        O.step()
        after = self.sheet.velocities()
        mean = 0.5 * (before + after)
        return stored, 0.5 * np.sum(self.mass * before * after), 0.5 * np.sum(self.mass * mean**2)

    def momenta(self):
        """Linear and angular momentum (2, 3) about the origin [N s], [N m s]."""
        momentum = self.mass * self.sheet.velocities()
        angular = np.cross(self.sheet.positions(), momentum)
        return np.array([momentum.sum(axis=0), angular.sum(axis=0)])


class TestEnergy(FreeSail):
    def drift(self, samples, between):
        """Largest relative change of the leapfrog's energy, and of the mean velocity's."""
        found = []
        for _ in range(samples):
            found.append(self.energies())
            self.step(between)
        stored, leapfrog, mean = np.array(found).T
        self.assertGreater(np.max(stored / (stored + leapfrog)), 0.2, "nothing was stored")
        self.assertLess(np.min(stored / (stored + leapfrog)), 0.1)
        return [np.max(np.abs((stored + k) / (stored + k)[0] - 1)) for k in (leapfrog, mean)]

    def test_leapfrog_energy_of_the_undamped_flat_sail_stays_within_1e_6(self):
        for beta in (0.0, 30.0):
            self.make(1e-3, {"beta": beta})
            O.dt = STEP
            self.assertLess(STEP, self.sheet.engine.criticalTimeStep())
            self.assertLess(self.drift(40, 99)[0], 1e-6)

    @long
    def test_leapfrog_energy_does_not_drift_in_a_long_run(self):
        self.make(1e-3, {"beta": 30.0})
        O.dt = STEP
        self.assertLess(self.drift(100, 999)[0], 1e-6)

    def test_error_at_the_mean_velocity_is_of_second_order_in_the_step(self):
        errors = []
        for share in (0.1, 0.05):
            self.make(1e-3, {"beta": 30.0}, inner_width=0.2, fold_lines=3)
            O.dt = share * self.sheet.engine.criticalTimeStep()
            errors.append(self.drift(round(40 / share), 0)[1])
        self.assertAlmostEqual(errors[0] / errors[1], 4, delta=0.2)

    def test_energy_of_a_buckling_sail_is_kept_too(self):
        self.make(0.1, {"beta": 30.0}, inner_width=0.2, fold_lines=3)
        O.dt = 0.01 * self.sheet.engine.criticalTimeStep()
        self.assertLess(self.drift(300, 9)[0], 1e-4)
        net = self.sheet.membrane
        buckled = np.array(net.lengths()) < np.array(net.criticalLengths)
        self.assertGreater(buckled.sum(), 20)


class TestMomentum(FreeSail):
    def check_kept(self, engine, speed=0.1):
        self.make(speed, engine)
        O.dt = STEP
        O.step()
        momentum, angular = self.momenta()
        sizes = np.linalg.norm(self.mass * self.sheet.velocities(), axis=1)
        arms = np.linalg.norm(self.sheet.positions(), axis=1)
        self.step(2000)
        moved = np.abs(self.sheet.positions() - self.sheet.rest).max()
        self.assertGreater(moved, 1e-4)
        later, angular_later = self.momenta()
        self.assertLess(np.abs(later - momentum).max(), 1e-12 * sizes.sum())
        self.assertLess(np.abs(angular_later - angular).max(), 1e-12 * np.sum(sizes * arms))

    def test_momentum_and_angular_momentum_are_kept_by_sides(self):
        self.check_kept({})

    def test_momentum_and_angular_momentum_are_kept_by_creases_and_damping(self):
        self.check_kept({"beta": 30.0, "theta0": 0.0, "zeta": 0.02})

    def test_drag_takes_momentum(self):
        with self.assertRaises(AssertionError):
            self.check_kept({"airDensity": 1.2e-3})


if __name__ == "__main__":
    unittest.main()

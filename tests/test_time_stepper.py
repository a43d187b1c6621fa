# SPDX-License-Identifier: GPL-2.0-or-later
"""The time stepper, which keeps O.dt below the critical time step by itself."""

import unittest

import membrane
from support import O, SceneTest, Sheet, grid


class TestTimeStepper(SceneTest):
    def setUp(self):
        super().setUp()
        self.sheet = Sheet(*grid(2))
        self.sheet.run_engines()
        self.stepper = membrane.MembraneTimeStepper(
            forces=self.sheet.engine, fraction=0.4, timeStepUpdateInterval=10
        )
        O.engines = [self.stepper] + list(O.engines)

    def test_step_is_the_given_fraction_of_the_critical_one(self):
        O.dt = 1.0
        O.step()
        self.assertAlmostEqual(O.dt / self.sheet.engine.criticalTimeStep(), 0.4, delta=1e-12)

    def test_step_follows_a_change_of_stiffness(self):
        O.dt = 1.0
        O.step()
        before = O.dt
        self.sheet.engine.zeta = 1.0
        for _ in range(10):
            O.step()
        self.assertLess(O.dt, 0.9 * before)

    def test_bad_fraction_is_refused(self):
        for value in (0.0, -1.0, 1.1, float("nan")):
            with self.assertRaisesRegex(ValueError, "fraction = .* must be in"):
                membrane.MembraneTimeStepper(fraction=value)


if __name__ == "__main__":
    unittest.main()

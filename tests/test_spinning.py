# SPDX-License-Identifier: GPL-2.0-or-later
"""Spinning bodies vibrate at the frequencies of their closed forms; coarse meshes, see verify."""

import unittest

import numpy as np
from membrane.study.verification import spinning
from support import SceneTest


class TestTether(SceneTest):
    """A light tether on a hub of a tenth of its length, with a mass at its tip."""

    def test_tip_mass_swings_as_a_pendulum_in_the_centrifugal_field(self):
        spun = spinning.spin_tether(0.1)
        # The tether's own mass, a thousandth of the tip's, shifts both squares by 1.7e-5.
        np.testing.assert_allclose(spun.flap, [1.1], rtol=1e-4)
        np.testing.assert_allclose(spun.in_plane, [0.1], rtol=2e-4)


class TestString(SceneTest):
    """A string of 20 segments."""

    def test_frequencies_of_the_closed_form_are_those_of_the_literature(self):
        for hub, flap in ((0.0, [1, 2.4495, 3.8730]), (0.1, [1.0721, 2.6047, 4.1141])):
            computed = [spinning.string_flap(mode, hub) for mode in (1, 2, 3)]
            np.testing.assert_allclose(computed, flap, atol=5e-5)

    def test_string_on_the_axis_tilts_once_a_turn_and_turns_freely(self):
        spun = spinning.spin_string(20, 0.0, modes=1)
        np.testing.assert_allclose(spun.flap, [1.0], atol=1e-5)  # exact on every mesh
        np.testing.assert_allclose(spun.in_plane, [0.0], atol=1e-6)

    def test_string_on_a_hub_has_the_first_frequencies_of_the_closed_form(self):
        spun = spinning.spin_string(20, 0.1)
        flap2 = np.array([spinning.string_flap(mode, 0.1) for mode in (1, 2, 3)]) ** 2
        # Errors found: 0.02 %, 1.2 %, 5 %; a quarter of that on 40 segments.
        for measured, exact in ((spun.flap, flap2), (spun.in_plane, flap2 - 1)):
            off = measured / exact - 1
            self.assertTrue(np.all(np.abs(off) < [2e-3, 2e-2, 6e-2]), off)
            self.assertTrue(np.all(off < 0), off)
        self.assertLess(spun.tension_error, 1e-3)
        self.assertLess(spun.imbalance, 1e-7)


class TestDisk(SceneTest):
    """A free disk of film, 8 cells from the centre to the edge."""

    @classmethod
    def setUpClass(cls):
        cls.spun = spinning.spin_disk(8)

    def test_sides_balance_the_centrifugal_field(self):
        self.assertLess(self.spun.imbalance, 1e-8)

    def test_stress_is_that_of_the_closed_form_and_nothing_buckles(self):
        self.assertLess(np.abs(self.spun.film_error).max(), 1e-2)  # found: 0.7 %
        self.assertEqual(self.spun.compression, 0)
        self.assertEqual(self.spun.buckled, 0)

    def test_tilted_disk_stays_tilted(self):
        self.assertAlmostEqual(self.spun.frequency["(1,0)"], 1, delta=1e-6)

    def test_modes_have_the_frequencies_of_the_closed_form(self):
        # Errors found: 0.63 %, 1.46 %, 1.55 %; a quarter of that, and less than 0.5 %, on 16 cells.
        for mode, allowed in (("(2,0)", 0.01), ("(0,1)", 0.02), ("(3,0)", 0.02)):
            exact = spinning.disk_frequency(*spinning.DISK_MODES[mode], spinning.DISK_POISSON)
            off = self.spun.frequency[mode] / exact - 1
            self.assertTrue(-allowed < off < 0, f"{mode}: {off}")
        self.assertLess(self.spun.split, 2e-3)

    def test_limit_of_the_modes_is_that_of_the_closed_form(self):
        """Extrapolated from 8 and 16 cells by order 2; the net's Poisson ratio is 1/3."""
        finer = spinning.spin_disk(16)
        for mode in ("(2,0)", "(0,1)", "(3,0)"):
            limit = (4 * finer.frequency[mode] - self.spun.frequency[mode]) / 3
            shape = spinning.DISK_MODES[mode]
            exact = spinning.disk_frequency(*shape, spinning.LATTICE_POISSON)
            self.assertAlmostEqual(limit / exact, 1, delta=5e-4, msg=mode)


if __name__ == "__main__":
    unittest.main()

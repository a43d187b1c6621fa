# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs that take longer: a finer sail, both crease laws, a repeated run."""

import unittest
from dataclasses import replace

import numpy as np
from membrane.parameters import SailParameters
from membrane.results.output import read_history
from membrane.run import driver
from support import O, long, main_run, quiet, scratch


def deploy(name, **changes):
    """Summary and history of a run of the sail with changed parameters."""
    O.reset()
    folder = scratch() / name
    with quiet():
        summary = driver.deploy(replace(SailParameters(), **changes), folder, pictures=False)
    return summary, read_history(folder / "history.csv")


@long
class TestLongRuns(unittest.TestCase):
    @unittest.skipUnless(O.numThreads == 1, "sums are in a fixed order with one thread only")
    def test_run_repeats_bit_for_bit(self):
        expected = main_run().history
        _, found = deploy("repeated", duration=0.1)
        for name, values in found.items():
            self.assertEqual(len(values), 101)
            np.testing.assert_array_equal(values, expected[name][:101], name)

    def test_finer_sail_opens_in_the_same_way_at_first(self):
        coarse = main_run().history
        _, fine = deploy("finer", refine=2, dt=2.5e-6, duration=0.06)
        # The spool has hardly worked yet; what turns into one another is the kinetic energy.
        self.assertLess(np.abs(fine["energy_balance"]).max(), 1e-3 * fine["kinetic_energy"].max())
        tips = coarse["mean_tip_radius"][:61]
        self.assertGreater(np.ptp(tips), 0.02)
        np.testing.assert_allclose(fine["mean_tip_radius"], tips, atol=0.1 * np.ptp(tips))

    def test_both_crease_laws_open_the_sail_alike_at_first(self):
        expected = main_run().history
        _, found = deploy("conservative", crease_law="conservative", duration=0.05)
        for name in ("deployment_rate", "phase_difference", "mean_tip_radius"):
            values = expected[name][:51]
            np.testing.assert_allclose(found[name], values, atol=0.01 * np.ptp(values))


if __name__ == "__main__":
    unittest.main()

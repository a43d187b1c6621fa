# SPDX-License-Identifier: GPL-2.0-or-later
"""Two threads give the result of one, but for the order of sums."""

import unittest
from pathlib import Path

import numpy as np
from membrane import scene
from support import O, force_engine, node_states, released_sail, run_yade, scratch

DRIVER = Path(__file__).with_name("continue_saved.py")
STEPS, SAIL_SIZE = 1000, 0.455


class TestThreads(unittest.TestCase):
    def run_on(self, threads, path, *order):
        """Positions (N, 3) [m] after STEPS steps of the released sail on so many threads.

        And the strain energy [J] of the first step.
        """
        out = scratch() / f"threads_{threads}_{path}.npz"
        done = run_yade(DRIVER, released_sail(path), STEPS, out, *order, threads=threads)
        self.assertEqual(done.returncode, 0, done.stderr)
        with np.load(out) as found:
            self.assertEqual(found["threads"], threads)
            return found["positions"], float(found["energy"])

    def test_two_threads_give_the_positions_of_one(self):
        for path in scene.PATHS:
            with self.subTest(path):
                self.check(path)

    def test_sorted_interactions_give_the_same_digits_on_two_threads(self):
        """As a case of path law2 promises; else sides add up by chance."""
        ends = [self.run_on(2, "law2", "sorted")[0] for _ in range(2)]
        one = self.run_on(1, "law2", "sorted")[0]
        np.testing.assert_array_equal(ends[1], ends[0])
        np.testing.assert_array_equal(one, ends[0])

    def check(self, path):
        (one, energy), (two, energy_of_two) = self.run_on(1, path), self.run_on(2, path)
        self.assertGreater(energy, 1e-9)
        self.assertAlmostEqual(energy_of_two / energy, 1, delta=1e-9)
        O.reset()
        O.load(str(released_sail(path)), quiet=True)
        start = node_states(force_engine().membrane)[0]
        self.assertGreater(np.abs(one - start).max(), 1e-3, "the sail hardly moved")
        self.assertLess(np.abs(two - one).max(), 1e-9 * SAIL_SIZE)
        if O.numThreads == 1:
            scene.advance(STEPS)
            here = node_states(force_engine().membrane)[0]
            np.testing.assert_array_equal(one, here)


if __name__ == "__main__":
    unittest.main()

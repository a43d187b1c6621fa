# SPDX-License-Identifier: GPL-2.0-or-later
"""The further scenes as a user runs them: IKAROS on its free hub, the spinning disk."""

import json
import re
import unittest

import numpy as np
from membrane.results.output import read_history
from membrane.results.case_folder import LAST_GOOD
from membrane.run import driver
from membrane.run.last_good import Diverged
from membrane.run.sails.ikaros import IkarosParameters
from support import O, ROOT, CommandTest, long, quiet, run_yade, scratch


class TestIkaros(CommandTest):
    SCRIPT = ROOT / "scripts" / "ikaros.py"

    def test_hub_slows_as_the_sail_opens_and_momentum_is_kept(self):
        folder = scratch() / "ikaros"
        done = run_yade(
            self.SCRIPT, "--out", folder, "--duration", "6", "--fold-lines", "4", "--spin", "5"
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads((folder / "summary.json").read_text())
        history = read_history(folder / "history.csv")
        self.assertAlmostEqual(found["measures"]["spin_before"], np.pi / 6, delta=1e-4)
        self.assertLess(history["hub_spin"][-1], 0.9 * history["hub_spin"][0])
        self.assertGreater(history["inertia"][-1], 1.5 * history["inertia"][0])
        measured = found["measures"]
        self.assertLess(measured["angular_momentum_drift"], 1e-12)
        energy = history["kinetic_energy"][0]
        self.assertGreater(measured["largest_change_of_hub_energy"], 1e-2 * energy)
        self.assertLess(measured["largest_unexplained_energy"], 1e-4 * energy)
        self.assertGreater((folder / "ikaros.png").stat().st_size, 50_000)
        self.assertEqual(found["versions"], driver.versions())

    def test_sunlight_presses_on_the_film(self):
        sun = run_yade(
            self.SCRIPT,
            "--out",
            scratch() / "lit",
            "--duration",
            "0.5",
            "--fold-lines",
            "4",
            "--sun",
            "30",
        )
        self.assertEqual(sun.returncode, 0, sun.stderr)
        found = json.loads((scratch() / "lit" / "summary.json").read_text())["measures"]
        self.assertNotEqual(found["sunlight_work"], 0)
        self.assertLess(found["largest_unexplained_energy"], 1e-4 * found["largest_energy"])

    def test_a_run_that_goes_wrong_leaves_its_last_good_state(self):
        """The watch is told to stop at what is rounding."""
        O.reset()
        folder = scratch() / "ikaros_wrong"
        folder.mkdir()
        strict = {"energy_tolerance": 1e-9, "spin_up_tolerance": 1e-2, "duration": 6.0}
        with quiet(), self.assertRaises(Diverged) as caught:
            driver.deploy(IkarosParameters(fold_lines=4, spin=5.0, **strict), folder)
        self.assertIn("from nowhere", str(caught.exception))
        self.assertIn(str(folder / LAST_GOOD), str(caught.exception))
        O.load(str(folder / LAST_GOOD), quiet=True)
        self.assertGreater(O.iter, 0)
        O.reset()

    def test_bad_values_end_with_one_sentence(self):
        for option, said in (
            ("--zeta=-1", "zeta = -1.0 must be >= 0"),
            ("--spin=-1", "spin = -1.0 rpm must be >= 0"),
        ):
            done = run_yade(self.SCRIPT, "--out", scratch() / "refused", option, "--duration", "1")
            self.ends_with_one_sentence(done, "ikaros", f"ikaros: {said}")


class TestDisk(unittest.TestCase):
    @long
    def test_errors_fall_with_the_square_of_the_cells(self):
        done = run_yade(ROOT / "scripts" / "disk.py", folder=scratch())
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = re.findall(r"error ([0-9.]+) % on 16 cells, order ([0-9.]+)", done.stdout)
        self.assertEqual(len(lines), 3, done.stdout)
        for error, order in lines:
            self.assertLess(float(error), 0.5)
            self.assertAlmostEqual(float(order), 2, delta=0.15)
        self.assertGreater((scratch() / "out" / "disk" / "disk.png").stat().st_size, 50_000)


if __name__ == "__main__":
    unittest.main()

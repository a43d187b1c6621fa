# SPDX-License-Identifier: GPL-2.0-or-later
"""The command `deploy.py`: refusals in one sentence, and a short run with pictures."""

import json
import unittest

from membrane.view import report
from support import ROOT, CommandTest, run_yade, scratch

SCRIPT = ROOT / "scripts" / "deploy.py"


class TestDeployCommand(CommandTest):
    def refused(self, arguments, *parts):
        done = run_yade(SCRIPT, "--out", scratch() / "refused_command", *arguments)
        self.ends_with_one_sentence(done, "deploy", *parts)

    def test_bad_value_ends_with_one_sentence(self):
        self.refused(["--thickness=-7.5e-6"], "thickness = -7.5e-06 m", "must be > 0")

    def test_step_above_the_critical_one_ends_with_one_sentence(self):
        self.refused(["--dt", "1e-4"], "dt = 0.0001 s", "must be <=", "critical time step")

    def test_unknown_choice_ends_with_one_sentence(self):
        self.refused(["--crease-law", "papper"], "papper", "paper", "conservative")

    def test_short_run_leaves_files_and_names_them(self):
        folder = scratch() / "short"
        done = run_yade(
            SCRIPT,
            "--out",
            folder,
            "--duration",
            "0.004",
            "--shapes-interval",
            "0.001",
            "--spin-up-tolerance",
            "0.01",
            "--beta",
            "3",
            "--alpha-crease",
            "100",
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        summary = json.loads((folder / "summary.json").read_text())
        self.assertEqual(summary["parameters"]["beta"], 3.0)
        self.assertEqual(summary["parameters"]["alpha_crease"], 100.0)
        self.assertEqual(summary["parameters"]["duration"], 0.004)
        listed = done.stdout.split("Look at:")[1].split()
        self.assertGreaterEqual(len(listed), 6)
        for name in listed:
            self.assertGreater((scratch() / name).stat().st_size, 100, name)
        self.assertEqual(str(folder / "report.html") in listed, report.TEMPLATE.is_file())
        for picture in ("shapes.png", "deployment.png"):
            self.assertEqual((folder / picture).read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(len((folder / "history.csv").read_text().splitlines()), 1 + 5)
        for wanted in ("%", "simulated s per s", "s left"):
            self.assertIn(wanted, done.stderr)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""How commands end on bad days: one sentence, an exit status other than 0, no traceback."""

import signal
import subprocess
import unittest
from pathlib import Path

from support import scratch

SCRIPTS = Path(__file__).resolve().parents[1] / "scripts"
SMALL = ["--fold-lines", "3", "--inner-width", "0.15", "--no-pictures"]
STOPPED = 130


def start(script, *options):
    """A command that runs in a process of its own."""
    command = ["yade", "-n", "-x", str(SCRIPTS / script), *map(str, options)]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=scratch()
    )


class TestCommands(unittest.TestCase):
    def ends(self, process, status, sentence):
        """It ends with a status and a sentence that stands alone on the last line."""
        _, said = process.communicate()
        self.assertEqual(process.returncode, status, said)
        self.assertNotIn("Traceback", said)
        self.assertRegex(said.strip().splitlines()[-1], sentence)

    def test_folder_below_a_file_is_refused(self):
        file = scratch() / "no_folder"
        file.write_text("")
        for script in ("deploy.py", "case.py", "ikaros.py"):
            name = script.removesuffix(".py")
            process = start(script, "--out", file / "out")
            self.ends(process, 1, f"^{name}: .*Not a directory")

    def test_missing_file_is_named(self):
        self.ends(start("sail.py", "missing.fold"), 1, "^sail: .*'missing.fold'")

    def test_wrong_option_and_value(self):
        self.ends(start("deploy.py", "--bogus", "1"), 2, "^deploy: error: .*--bogus")
        self.ends(start("deploy.py", "--beta", "-3"), 1, "^deploy: beta = -3.0 must be >= 0")

    def test_control_c_stops_with_a_sentence(self):
        # In the spin-up, and in the run.
        for script, wanted in (("deploy.py", "spin-up"), ("case.py", "deploying")):
            folder = scratch() / f"stopped_{wanted}"
            process = start(script, *SMALL, "--spin-up-tolerance", "1e-3", "--out", folder)
            said = ""
            while wanted not in said:
                line = process.stderr.readline()
                self.assertNotEqual(line, "", "it came to its end")
                said += line
            process.send_signal(signal.SIGINT)
            self.ends(process, STOPPED, "stopped by Ctrl-C")


if __name__ == "__main__":
    unittest.main()

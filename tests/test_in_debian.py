# SPDX-License-Identifier: GPL-2.0-or-later
"""Commands in another Debian: what is said where there can be none, as .ci/run counts on."""

import os
import subprocess
import unittest

from support import ROOT

SCRIPTS = ROOT / "scripts"
NOT_TRIED = 77


class TestWithoutOne(unittest.TestCase):
    def said(self, status, *command, **environment):
        """The one line of a command that ends with a status."""
        environment = {**os.environ, **environment}
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (status, ""), done.stderr)
        self.assertRegex(done.stderr, r"\A.*\n\Z")
        return done.stderr

    def test_machine_that_cannot_have_one_says_so_in_a_line(self):
        command = SCRIPTS / "in_debian.sh", "trixie", "check"
        said = self.said(NOT_TRIED, *command, XDG_CACHE_HOME="/proc/nowhere")
        why = "/proc/nowhere/yade-membrane cannot be made|only root can make it"
        self.assertRegex(said, f"^in_debian.sh: no trixie here: ({why})\n$")

    def test_unknown_release_is_refused(self):
        said = self.said(1, SCRIPTS / "run.sh", "check", "--in", "nowhere")
        self.assertRegex(said, "^run.sh: --in takes one of bookworm trixie.*, not 'nowhere'\n$")

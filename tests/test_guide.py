# SPDX-License-Identifier: GPL-2.0-or-later
"""The guide's scripts run as a reader would run them, and do what it says; its HTML site."""

import json
import os
import re
import shutil
import subprocess
import unittest
from dataclasses import fields
from pathlib import Path

import membrane
import numpy as np
from membrane.results.history import read_history
from membrane.run.sails import SAILS
from membrane.run.sails.sheet import PatternParameters, read_sheet
from support import ROOT, long, of_the_view, run_yade, scratch, short_run, yade_environment
from test_drawing import run_on_screen
from test_pages import GUIDE, PAGES, README, blocks, text


def scripts():
    """Scripts of the guide by the names in their first lines; its blocks without a name by None."""
    found = {}
    for page in PAGES:
        for block in blocks(page, "python") if page != README else ():
            name = re.match(r"# ([\w.]+)\n", block)
            found[name and name[1]] = block
    return found


def saved(name):
    """A script of the guide, saved."""
    path = scratch() / name
    path.write_text(scripts()[name], encoding="utf-8")
    return path


class TestScripts(unittest.TestCase):
    def run_script(self, path):
        """What a script prints that YADE runs."""
        done = run_yade(path)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def run_plainly(self, name):
        """What a script of the guide prints that Python runs."""
        done = subprocess.run(
            ["/usr/bin/python3", saved(name)], cwd=scratch(), capture_output=True, text=True
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_each_is_tested(self):
        tests = {name for name in dir(self) if name.startswith("test_")}
        for name in scripts():
            self.assertIn(f"test_{Path(name).stem}", tests)

    def test_example(self):
        said = self.run_script(ROOT / "scripts" / "examples" / "example.py")
        angles = [int(angle) for angle in re.findall(r"open to (\d+) degrees", said)]
        self.assertEqual(len(angles), 8, said)
        self.assertGreater(min(angles), 65)  # from 60
        self.assertGreater(max(angles), 150)

    def test_sheet(self):
        said = self.run_script(saved("sheet.py"))
        said = re.search(r"opened to (\d+) degrees; energy from nowhere (\S+) J", said)
        self.assertGreater(int(said[1]), 120)  # from 60
        self.assertLess(abs(float(said[2])), 1e-3)  # of some 0.03 J
        self.assertEqual(len(list((scratch() / "sheet").glob("*.vtu"))), 40)

    @long
    def test_my_sail(self):
        self.run_script(saved("my_sail.py"))
        self.assertGreater((scratch() / "my_sail.png").stat().st_size, 10000)

    def test_deployed(self):
        said = self.run_script(saved("deployed.py"))
        rates = read_history(scratch() / "out" / "deployed" / "history.csv")["deployment_rate"]
        self.assertGreater(rates[-1], rates[0])
        self.assertIn(f"open to {rates[-1]:.3f}", said)

    def test_balls(self):
        said = self.run_script(saved("balls.py"))
        heights = re.findall(r"sheet at (\S+) mm, ball at (\S+) mm", said)
        self.assertEqual(len(heights), 6, said)
        sheet, ball = map(float, heights[-1])
        self.assertAlmostEqual(sheet, -17, delta=0.5)  # a node's radius above the floor
        self.assertAlmostEqual(ball, -17 + 13, delta=5)  # both radii above that, or bouncing

    def test_jet(self):
        said = self.run_script(saved("jet.py"))
        middle, corner, height = map(float, re.findall(r"(-?[\d.]+) mm", said))
        self.assertGreater(middle, corner + 1)  # it hangs over the jet
        self.assertLess(abs(height), 1e-6)
        work, unexplained = map(float, re.findall(r"(\S+) J", said))
        self.assertGreater(work, 0)
        self.assertLess(abs(unexplained), 1e-6 * work)

    def test_hexagon(self):
        self.run_plainly("hexagon.py")
        sheet = read_sheet(PatternParameters(file=str(scratch() / "hexagon.msh")))
        self.assertEqual(len(sheet.groups["tips"]), 6)
        ends = sheet.nodes[sheet.creases]
        angles = np.degrees(np.arctan2(ends[:, :, 1], ends[:, :, 0])) % 360
        np.testing.assert_allclose((angles + 30) % 60, 30, atol=1e-6)  # on six spokes
        for sign in (1, -1):
            self.assertEqual(len(set(np.round(angles[sheet.crease_signs == sign].ravel()))), 3)

    def test_look(self):
        folder = scratch() / "out"
        folder.mkdir(exist_ok=True)
        shutil.copy(short_run() / "history.csv", folder)
        said = self.run_plainly("look.py")
        history = read_history(folder / "history.csv")
        self.assertIn(f"open to {history['deployment_rate'][-1]:.3f} at 0.1 s", said)
        lag = -np.degrees(history["phase_difference"].min())
        self.assertIn(f"lag by up to {lag:.0f} degrees", said)

    @of_the_view
    def test_window(self):
        status, said = run_on_screen(saved("window.py"))
        self.assertEqual(status, 0, said)
        self.assertGreater((scratch() / "now.png").stat().st_size, 10000)

    def test_a_sweep_from_a_file(self):
        (config,) = blocks(GUIDE / "many-runs.md", "yaml")
        (scratch() / "mine.yaml").write_text(config, encoding="utf-8")
        sweep = ["/usr/bin/python3", ROOT / "scripts" / "sweep.py", "--config", "mine.yaml"]
        done = subprocess.run(
            [*sweep, "--dry-run"],
            cwd=scratch(),
            env=yade_environment(),
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(done.stdout.splitlines()), 4)  # two values of two parameters

    def test_tiny(self):
        """As a file among the kinds of sails it is one, whose name the commands know."""
        package, home = Path(membrane.__file__).parent, scratch() / "with_tiny"
        shutil.copytree(package, home / "membrane", copy_function=os.symlink)
        shutil.copy(saved("tiny.py"), home / "membrane" / "run" / "sails")
        options = ["--duration", "0.005", "--spin-up-tolerance", "1e-2", "--no-pictures"]
        done = run_yade(
            ROOT / "scripts" / "deploy.py",
            *["tiny", *options, "--no-report"],
            environment={**yade_environment(), "PYTHONPATH": str(home)},
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads((scratch() / "out" / "tiny" / "summary.json").read_text())
        self.assertEqual((found["sail"], found["parameters"]["omega"]), ("tiny", 30.0))
        self.assertEqual(found["parameters"]["young"], 3.2e9)


@long
@unittest.skipUnless(shutil.which("sphinx-build", path="/usr/bin"), "no Sphinx here")
class TestSite(unittest.TestCase):
    def test_it_has_every_page_class_and_room(self):
        done = run_yade(GUIDE / "make_site.py")
        self.assertEqual(done.returncode, 0, done.stderr)
        site = ROOT / "build" / "docs"
        for page in PAGES:
            html = site / page.relative_to(ROOT).with_suffix(".html")
            title = re.search(r"(?m)^# (.*)$", text(page))[1].replace("'", "’")
            self.assertIn(f"<h1>{title}<", html.read_text(encoding="utf-8"))
        plugin = (site / "api" / "plugin.html").read_text(encoding="utf-8")
        for name in membrane.__all__:
            self.assertIn(f'id="membrane.{name}"', plugin)
        scene = (site / "api" / "scene.html").read_text(encoding="utf-8")
        self.assertIn('id="membrane.scene.engines.set_engines"', scene)
        parameters = (site / "api" / "parameters.html").read_text(encoding="utf-8")
        for kind in SAILS.values():
            for item in fields(kind.parameters):
                self.assertIn(f">{item.name}<", parameters)


if __name__ == "__main__":
    unittest.main()

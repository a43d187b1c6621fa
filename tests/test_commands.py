# SPDX-License-Identifier: GPL-2.0-or-later
"""How commands end on bad days: one sentence, an exit status other than 0, no traceback, and
earlier results whole."""

import io
import os
import shutil
import signal
import subprocess
import unittest
from contextlib import redirect_stderr
from functools import lru_cache
from pathlib import Path
from unittest.mock import patch

import numpy as np
from membrane import Membrane, scene
from membrane.cli import errors
from membrane.measures import tip_azimuths
from membrane.parameters import SailParameters
from membrane.results.unfinished import UNFINISHED
from membrane.results.case_folder import LAST_GOOD
from processes import Halt
from support import O, ROOT, scratch, yade_environment

SCRIPTS = ROOT / "scripts"
PATTERN = SCRIPTS / "patterns" / "miura.fold"
SMALL = ["--fold-lines", "3", "--inner-width", "0.15", "--spin-up-tolerance", "1e-3"]
SHORT = [*SMALL, "--duration", "0.005", "--shapes-interval", "0.002", "--no-report"]
ENDLESS = [*SMALL, "--duration", "20"]  # far longer than any test waits
DIVERGES = [*SMALL, "--duration", "0.2", "--dt", "2.3e-5", "--force-time-step"]
STOPPED, TERMINATED = 130, 143

# Mounts a small file system, copies earlier results onto it, runs a command, and says at the end
# whether those results are still what they were.
ON_SMALL_DISK = """
mount -t tmpfs -o size="$2" none "$1" && cp -r "$3/." "$1" && mount -o remount,"$4" "$1" || exit 77
folder=$1 earlier=$3
shift 4
"$@"
status=$?
diff -r "$earlier" "$folder" --exclude='unfinished*' || exit 78
exit $status
"""


def start(script, *options, **environment):
    """A command that runs in a process of its own."""
    command = ["yade", "-n", "-x", SCRIPTS / script, *options]
    if script in ("sweep.py", "calibrate.py"):
        command = [shutil.which("python3", path="/usr/bin"), SCRIPTS / script, *options]
    return subprocess.Popen(
        [*map(str, command)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=scratch(),
        env={**yade_environment(), **environment},
    )


def tree(folder):
    """Contents of all files by path, but for what an unfinished run left."""
    files = (path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    return {path: (folder / path).read_bytes() for path in files if path.parts[0] != UNFINISHED}


@lru_cache(maxsize=None)
def earlier():
    """Results of a short run."""
    folder = scratch() / "earlier"
    process = start("deploy.py", *SHORT, "--out", folder)
    _, said = process.communicate()
    assert process.returncode == 0, said
    return folder


class BadDayTest(unittest.TestCase):
    def ends(self, process, status, sentence):
        """It ends with a status and a sentence that stands alone on the last line."""
        _, said = process.communicate()
        self.ended(process.returncode, said, status, sentence)

    def ended(self, returned, said, status, sentence):
        """The same of one that has ended already."""
        self.assertEqual(returned, status, said)
        self.assertNotIn("Traceback", said)
        self.assertRegex(said.strip().splitlines()[-1], sentence)


class TestCommandLines(BadDayTest):
    def test_folder_below_a_file_is_refused(self):
        file = scratch() / "no_folder"
        file.write_text("")
        for script in ("deploy.py", "case.py", "ikaros.py", "miura.py", "disk.py"):
            name = script.removesuffix(".py")
            process = start(script, "--out", file / "out")
            self.ends(process, 1, f"^{name}: .*Not a directory")

    def test_missing_file_is_named(self):
        self.ends(start("sail.py", "missing.fold"), 1, "^sail: .*'missing.fold'")
        self.ends(start("calibrate.py", "missing.csv"), 1, "^calibrate: .*missing.csv")
        for script in ("report.py", "animate.py"):
            name = script.removesuffix(".py")
            self.ends(start(script, "missing_folder"), 1, f"^{name}: .*missing_folder")

    def test_sizes_without_sense_are_refused_at_once(self):
        for option, value, sentence in (
            ("--fold-lines", "1000000", "must be .*1000"),
            ("--spool-facets", "100000000", "must be"),
            ("--out", "", "--out: must name a folder"),
            ("--parameters", "", "No such file"),
        ):
            status = 2 if option == "--out" else 1
            self.ends(start("deploy.py", option, value), status, f"^deploy: .*{sentence}")
        self.ends(start("sweep.py", "--out", ""), 2, "^sweep: error: .*name a folder")
        self.ends(start("chart.py", "--steps", "0"), 2, "^chart: error: .*--steps: 0: must be")
        self.ends(start("parts.py", "--members", "1"), 2, "^parts: error: --members 1: must be")
        huge = scratch() / "huge.json"
        huge.write_text('{"omega": 1' + "0" * 400 + "}")
        self.ends(start("deploy.py", "--parameters", huge), 1, "^deploy: .*omega .*too large")

    def test_wrong_option_and_value(self):
        self.ends(start("deploy.py", "--bogus", "1"), 2, "^deploy: error: .*--bogus")
        self.ends(start("deploy.py", "--beta", "-3"), 1, "^deploy: beta = -3.0 must be >= 0")


class TestTables(BadDayTest):
    """Rows of a table of yade-batch."""

    def run_row(self, script, header, row):
        table = scratch() / "cases.table"
        table.write_text(f"{header}\n{row}\n")
        return start(script, *SMALL, "--out", scratch() / "row", YADE_BATCH=f"{table}:2")

    def test_unknown_column_is_named(self):
        process = self.run_row("deploy.py", "betta", "3")
        self.ends(process, 1, "cases.table: .* 'betta'; did you mean 'beta'")

    def test_unreadable_and_wrong_values(self):
        for value, sentence in (
            ("abc", "cases.table, line 2: 'abc' cannot be read"),
            ("1/0", "cases.table, line 2: '1/0' cannot be read"),
            ("'x'", "beta = 'x' must be a number"),
            ("-3", "beta = -3 must be >= 0"),
        ):
            with self.subTest(value=value):
                self.ends(self.run_row("deploy.py", "beta", value), 1, f"^deploy: .*{sentence}")

    def test_description_that_would_lead_elsewhere_is_refused(self):
        table = scratch() / "descriptions.table"
        table.write_text("description beta\n.. 3\n")
        process = start("deploy.py", *SMALL, YADE_BATCH=f"{table}:2")
        self.ends(process, 1, "^deploy: description = '..' must be the name of a folder")


class TestMissingPackages(BadDayTest):
    def without(self, *packages):
        """Environment in which Python packages cannot be imported."""
        shadows = scratch() / f"without_{'_'.join(packages)}"
        for package in packages:
            (shadows / package).mkdir(parents=True, exist_ok=True)
            missing = f"raise ModuleNotFoundError('No module named {package}', name='{package}')\n"
            (shadows / package / "__init__.py").write_text(missing)
        path = os.pathsep.join([str(shadows), yade_environment()["PYTHONPATH"]])
        return {"PYTHONPATH": path}

    def test_package_is_named_with_what_installs_it(self):
        for script, package, options in (
            ("deploy.py", "vtkmodules", []),
            ("case.py", "vtkmodules", []),
            ("report.py", "vtkmodules", [scratch()]),
            ("animate.py", "vtkmodules", [scratch()]),
            ("ikaros.py", "matplotlib", []),
            ("disk.py", "matplotlib", []),
            ("miura.py", "gmsh", []),
            ("sail.py", "gmsh", [PATTERN]),
            ("sweep.py", "jinja2", []),
            ("calibrate.py", "scipy", ["target.csv"]),
        ):
            with self.subTest(script=script):
                process = start(script, *options, **self.without(package))
                debian = {"vtkmodules": "vtk9"}.get(package, package)
                self.ends(process, 1, f"{script[:-3]}: .*apt-get install python3-{debian}")


class TestEarlierResults(BadDayTest):
    def setUp(self):
        self.folder = scratch() / self.id().rpartition(".")[2]
        shutil.copytree(earlier(), self.folder)

    def tearDown(self):
        self.assertGreater(len(tree(self.folder)), 8)
        self.assertEqual(tree(self.folder), tree(earlier()))

    def test_run_that_diverges_leaves_them_whole(self):
        process = start("deploy.py", *DIVERGES, "--out", self.folder)
        self.ends(process, 1, f"^deploy: .* from nowhere.*{UNFINISHED}/{LAST_GOOD}")
        self.assertTrue((self.folder / UNFINISHED / LAST_GOOD).exists())

    def test_refused_run_leaves_them_whole_and_nothing_else(self):
        self.ends(start("deploy.py", "--dt", "1", "--out", self.folder), 1, "^deploy: dt = 1.0 s")
        self.ends(start("sail.py", PATTERN, "--out", self.folder, "--dt", "1"), 1, "^sail: dt = ")
        self.assertFalse((self.folder / UNFINISHED).exists())

    def test_control_c_leaves_them_whole(self):
        # In the spin-up, where nothing is worth keeping, and in the run.
        for script, wanted, options in (
            ("deploy.py", "spin-up", ENDLESS),
            ("deploy.py", "deploying", ENDLESS),
            ("sail.py", "deploying", [PATTERN, "--size", "0.05", "--duration", "20"]),
            ("ikaros.py", "deploying", ["--fold-lines", "4", "--duration", "1000"]),
        ):
            process = start(script, *options, "--out", self.folder)
            said = ""
            while wanted not in said:
                line = process.stderr.readline()
                self.assertNotEqual(line, "", f"it came to its end: {said}")
                said += line
            process.send_signal(signal.SIGINT)
            self.ends(process, STOPPED, "stopped by Ctrl-C")
            kept = self.folder / UNFINISHED / LAST_GOOD
            self.assertEqual(kept.exists(), wanted == "deploying")
            if kept.exists():
                self.goes_on(kept)

    def goes_on(self, kept):
        """A saved state is that of a sail that moves, and can be run on."""
        O.load(str(kept), quiet=True)
        time, step = O.time, O.iter
        self.assertGreater(step, 0)
        scene.advance(100)
        self.assertAlmostEqual(O.time, time + 100 * O.dt)
        self.assertGreater(scene.loaded().ledger.kinetic, 0)
        O.reset()

    def test_sigterm_and_the_end_of_the_terminal_leave_them_whole(self):
        for number in (signal.SIGTERM, signal.SIGHUP):
            if signal.getsignal(number) == signal.SIG_IGN:  # as under nohup
                continue
            process = start("deploy.py", *ENDLESS, "--out", self.folder)
            while "deploying" not in process.stderr.readline():
                self.assertIsNone(process.poll())
            process.send_signal(number)
            self.ends(process, TERMINATED, f"^deploy: terminated. The last good .*{LAST_GOOD}")

    def check_on_disk(self, size, mode, sentence, script="deploy.py", out="", options=SHORT):
        """How a run ends on a file system of its own, where earlier results are, too."""
        place = scratch() / "disk"
        place.mkdir(exist_ok=True)
        run = ["yade", "-n", "-x", SCRIPTS / script, *options, "--out", place / out]
        mounted = ["sh", "-c", ON_SMALL_DISK, "sh", place, size, earlier(), mode, *run]
        done = subprocess.run(
            ["unshare", "--map-root-user", "--mount", *map(str, mounted)],
            env=yade_environment(),
            capture_output=True,
            text=True,
        )
        if done.returncode == 77 or done.stderr.startswith("unshare"):
            self.skipTest("no file system can be mounted here")
        self.ended(done.returncode, done.stderr, 1, sentence)

    def test_full_disk_leaves_them_whole(self):
        for room in (1, 40):
            sentence = "^deploy: .*[Nn]o space left on device"
            self.check_on_disk(self.leaving(room), "rw", sentence)

    def leaving(self, room):
        """Size of a disk that leaves so many pages of 4 KiB beside the earlier results."""
        files = sum(path.stat().st_size // 4096 + 1 for path in earlier().rglob("*"))
        return f"{4 * (files + room)}k"

    def test_full_disk_ends_a_case_that_saves_itself(self):
        options = [*SMALL, "--duration", "0.02", "--checkpoint-every", "0", "--no-pictures"]
        for room in (2, 20):
            sentence = "^case: .*checkpoint.*[Nn]o space left on device"
            where = {"script": "case.py", "out": UNFINISHED, "options": options}
            self.check_on_disk(self.leaving(room), "rw", sentence, **where)

    def test_read_only_disk_leaves_them_whole(self):
        self.check_on_disk("8m", "ro", "^deploy: .*Read-only file system")


class TestErrors(unittest.TestCase):
    def ends(self, fail, debug=None):
        """What is printed, and the last sentence, where a command calls a function that fails."""
        given = {} if debug is None else {errors.DEBUG: debug}
        said = io.StringIO()
        with patch.dict(os.environ, given), redirect_stderr(said):
            with self.assertRaises(SystemExit) as caught, errors.plain_errors("fold"):
                fail()
        return said.getvalue(), caught.exception.code

    def test_what_is_foreseen_is_one_sentence(self):
        for debug in (None, "", "0"):
            said, end = self.ends(lambda: SailParameters(beta=-1), debug)
            self.assertEqual((said, end), ("", "fold: beta = -1 must be >= 0"))
            said, end = self.ends(lambda: Membrane(nodes=[(0, 0, 0)]), debug)
            self.assertRegex(end, "^fold: Membrane: nodes.0. has mass 0 kg")
            said, end = self.ends(lambda: Path("/nowhere/at/all").read_bytes(), debug)
            self.assertRegex(end, "^fold: .*No such file")

    def test_its_traceback_is_shown_to_those_who_ask(self):
        said, end = self.ends(lambda: SailParameters(beta=-1), "1")
        self.assertEqual(end, "fold: beta = -1 must be >= 0")
        self.assertRegex(said, r"Traceback (?s:.*)in ends\n *fail\(\)\n(?s:.*)ValueError: beta")

    def test_a_fault_of_the_program_is_a_traceback_and_a_word(self):
        shapes = "could not be broadcast together"
        for fail, words in (
            (lambda: {}["sides"], "KeyError: 'sides'"),
            (lambda: np.zeros(2) + np.zeros(3), f"ValueError: operands {shapes}"),
            (lambda: tip_azimuths(None, np.zeros(3)), "AttributeError: 'NoneType'"),
            (lambda: int("many"), "ValueError: invalid literal"),
        ):
            said, end = self.ends(fail)
            self.assertRegex(said, rf"Traceback (?s:.*){words}")
            self.assertRegex(end, "^fold: this is a bug in the program.* please report it")


class TestReadOnlyBuild(BadDayTest):
    @unittest.skipUnless((ROOT / "build" / "python").is_dir(), "the build is elsewhere")
    def test_without_a_home_settings_go_to_a_folder_of_the_users(self):
        read_only = 'mount --bind "$0" "$0" && mount -o remount,bind,ro "$0" || exit 77; exec "$@"'
        report = [SCRIPTS / "run.sh", "report", scratch() / "nowhere"]
        inside = ["sh", "-c", read_only, ROOT / "build", *report]
        environment = {**os.environ, "TMPDIR": str(scratch())}
        environment.pop("HOME", None)
        done = subprocess.run(
            ["unshare", "--map-root-user", "--mount", *map(str, inside)],
            env=environment,
            capture_output=True,
            text=True,
        )
        if done.returncode == 77 or done.stderr.startswith("unshare"):
            self.skipTest("no file system can be mounted here")
        self.ended(done.returncode, done.stderr, 1, "^report: .*nowhere/summary.json|viewer")
        (home,) = scratch().glob("membrane-home-*")
        self.assertEqual(home.stat().st_mode & 0o777, 0o700)


class TestOutput(BadDayTest):
    def test_output_that_nobody_reads_is_a_sentence(self):
        halt = Halt(r"summary\.json")
        options = [*SHORT, "--no-pictures", "--out", scratch() / "unread"]
        process = start("deploy.py", *options, **halt.environment())
        stopped = halt.wait(process)
        halt.lift()
        process.stdout.close()
        os.kill(stopped, signal.SIGCONT)
        self.ends(process, 1, "^deploy: its output is no longer read")
        self.assertTrue((scratch() / "unread" / "summary.json").exists())


class TestControlC(BadDayTest):
    def test_while_yade_starts_it_is_a_sentence_too(self):
        process = subprocess.Popen(
            [SCRIPTS / "run.sh", "deploy", *ENDLESS, "--out", scratch() / "not_begun"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        while b"bin/yade\0-n\0" not in Path(f"/proc/{process.pid}/cmdline").read_bytes():
            self.assertIsNone(process.poll())
        process.send_signal(signal.SIGINT)
        self.ends(process, STOPPED, "^deploy: stopped by Ctrl-C")
        self.assertFalse((scratch() / "not_begun").exists())

    def test_case_goes_on_later(self):
        folder = scratch() / "stopped_case"
        process = start("case.py", *ENDLESS, "--out", folder)
        while "deploying" not in process.stderr.readline():
            self.assertIsNone(process.poll())
        process.send_signal(signal.SIGINT)
        self.ends(process, STOPPED, "stopped by Ctrl-C; run it again to continue")
        self.assertEqual([path.name for path in folder.iterdir()], ["unfinished"])


if __name__ == "__main__":
    unittest.main()

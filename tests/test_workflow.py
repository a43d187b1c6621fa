# SPDX-License-Identifier: GPL-2.0-or-later
"""The Snakemake workflow: cases, command lines, and a sweep on a Slurm of the test's own."""

import importlib
import json
import os
import re
import subprocess
import sys
import time
import unittest

from processes import Halt, kill
from slurm import Slurm
from support import ROOT, CommandTest, long, scratch, yade_environment

sys.path.append(str(ROOT / "scripts"))

from sweeping import config  # noqa: E402  (found only now)

FOLDER = ROOT / "scripts" / "workflow"
PROFILE = FOLDER / "slurm"
# Tiny cases of three fold lines; the values of one option are given as Snakemake takes them.
TINY = """\
grid:
  beta: [3, 30]
  alpha_crease: [100, 1000]
options:
  duration: 0.004
  fold_lines: 3
  outer_width: 0.279
  spin_up_tolerance: 0.01
  force_time_step: false
out: results
threads: 1
memory: 1000
minutes: 10
"""
CASES = {f"beta_{b}-alpha_crease_{a}" for b in (3, 30) for a in (100, 1000)}


def command(*options):
    """Command line of snakemake with the workflow and further options."""
    return ["snakemake", "--snakefile", str(FOLDER / "Snakefile"), *options]


def snakemake(folder, *options):
    """Run the workflow in `folder`; returns the CompletedProcess, all output as text in stdout."""
    return subprocess.run(
        command(*options),
        cwd=folder,
        env=yade_environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def new_folder(name):
    """An empty folder with tiny.yaml."""
    folder = scratch() / name
    folder.mkdir()
    (folder / "tiny.yaml").write_text(TINY)
    return folder


class TestPlan(unittest.TestCase):
    def test_without_a_grid_of_ones_own_the_cases_are_those_of_table_2(self):
        paper = importlib.import_module("verification.paper")
        done = snakemake(new_folder("table_2"), "--dry-run", "--printshellcmds", "--jobs", "1")
        self.assertEqual(done.returncode, 0, done.stdout)
        found = re.findall(r"--alpha-crease=(\S+) --beta=(\S+)", done.stdout)
        wanted = {(a, b) for a in paper.ALPHA_CREASE for b in paper.BETA}
        self.assertEqual({tuple(map(float, pair)) for pair in found}, wanted)
        self.assertEqual(len(found), len(wanted))

    def test_a_grid_of_ones_own_replaces_it_and_options_go_to_every_case(self):
        options = ["--configfile", "tiny.yaml", "--dry-run", "--printshellcmds", "--jobs", "1"]
        done = snakemake(new_folder("plan"), *options)
        self.assertEqual(done.returncode, 0, done.stdout)
        lines = [line for line in done.stdout.splitlines() if line.startswith("yade ")]
        self.assertEqual(len(lines), 4)
        for line in lines:
            for option in ("--duration=0.004", "--fold-lines=3", "--no-force-time-step"):
                self.assertIn(f" {option} ", line)
        folders = {re.search(r"--out results/cases/(\S+) ", line)[1] for line in lines}
        self.assertEqual(folders, CASES)
        # Snakemake cuts what it hands to the job of a case at commas.
        self.assertNotIn(",", "".join(folders))


# What a file of configuration holds, and parts of what must be said of it.
BAD = {
    "": "is empty",
    "[1]": "must hold names with values",
    "grid: [": "line 1, column 8: is no YAML",
    "when: 2020-13-45": "is no YAML",
    "grid: [1]": "grid: must be parameters with lists of values",
    "grid: {}": "grid: must be parameters with lists of values",
    "grid: {beta: 3}": "grid: beta must be a list of values, not 3",
    "grid: {beta: []}": "grid: beta must be a list of values",
    "grid: {beta: [3, 3.0]}": "grid: beta: a value is given twice",
    "grid: {beta: [-3]}": "grid: beta = -3.0 must be >= 0",
    "grid: {beta: [.nan]}": "grid: beta = nan must be >= 0",
    "grid: {beta: [[3]]}": "grid: beta = a list of 1 must be a number",
    "grid: {bta: [3]}": "grid: bta is no parameter",
    "grid: {omega: [15], omega: [20]}": "omega: is given twice",
    "out: a\nout: b": "out: is given twice",
    '{"grid": {"beta": [3]}, "grid": {"beta": [4]}}': "grid: is given twice",
    "gird: {beta: [3]}": "gird is nothing to configure",
    "options: 3": "options: must be names with values, not 3",
    "options: {bta: 3}": "options: bta is no parameter",
    "options: {fold_lines: 3.5}": "options: fold_lines = 3.5 must be a whole number",
    "options: {zeta: yes}": "options: zeta = True must be a number",
    "options: {crease_law: mine}": "options: crease_law = 'mine' must be one of paper, ",
    "options: {force_time_step: 1}": "options: force_time_step = 1 must be true or false",
    "options: {checkpoint_every: -1}": "options: checkpoint_every = -1 s must be >= 0",
    "threads: many": "threads = 'many' must be a whole number >= 1",
    "memory: 0": "memory = 0 must be a whole number >= 1",
    "threads: 1e400": "threads = '1e400' must be a whole number >= 1",
    '{"out": "\\udcff"}': "must be UTF-8",
    "minutes: 1.5": "minutes = 1.5 must be a whole number >= 1",
    "out: 3": "out = 3 must be the name of a folder",
    "out: '{case}'": "out = '{case}' must be the name of a folder",
}


def workflow(*options):
    """Command line of `scripts/workflow.py` on one core, with further options."""
    return ["/usr/bin/python3", str(ROOT / "scripts" / "workflow.py"), "--cores", "1", *options]


class TestBadConfiguration(CommandTest):
    """Each is refused before any job."""

    def start(self, folder, *options):
        """`scripts/workflow.py` in a folder; it may run, not only plan."""
        return subprocess.run(
            workflow(*options),
            cwd=folder,
            env=yade_environment(),
            capture_output=True,
            text=True,
        )

    def test_bad_file_is_one_sentence(self):
        folder = new_folder("bad_file")
        for content, reason in BAD.items():
            with self.subTest(content):
                (folder / "bad.yaml").write_text(content)
                done = self.start(folder, "--configfile", "tiny.yaml", "bad.yaml", "--dry-run")
                self.ends_with_one_sentence(done, "workflow", "workflow: bad.yaml: ", reason)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertEqual(sorted(os.listdir(folder)), ["bad.yaml", "tiny.yaml"])

    def test_missing_file_is_one_sentence(self):
        done = self.start(new_folder("no_file"), "--configfile=nowhere.yaml")
        self.ends_with_one_sentence(done, "workflow", "nowhere.yaml")

    def test_no_core_at_all_is_one_sentence(self):
        folder = new_folder("no_core")
        for option in ("-j0", "--jobs=-1", "--cores=00"):
            done = self.start(folder, option)
            self.ends_with_one_sentence(done, "workflow", "cores or jobs: must be at least 1")

    def test_what_the_command_line_configures_is_checked_too(self):
        folder = new_folder("command_line")
        bad = {
            "grid=3": "config: grid: must be parameters",
            "threads=many": "config: threads = 'many' must be",
            "options={zeta: x}": "config: options: zeta = 'x' must be a number",
            "options={beta: 3}": "config: options: beta is in the grid, too",
            "options={parameters: nowhere.json}": "nowhere.json",
            "out=tiny.yaml": "config: out = 'tiny.yaml': tiny.yaml is no folder to write to",
        }
        for option, reason in bad.items():
            with self.subTest(option):
                done = self.start(folder, "--config", option)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn(reason, done.stderr)
                self.assertIn("WorkflowError", done.stderr)
                self.assertNotIn("Traceback", done.stderr)
                self.assertFalse((folder / "out").exists())

    def test_name_given_twice_on_the_command_line_is_one_sentence(self):
        folder = new_folder("twice")
        for words in (["threads=1", "threads=2"], ["options={beta: 3, beta: 4}"]):
            done = self.start(folder, "--config", *words)
            name = "threads" if len(words) > 1 else "beta"
            self.ends_with_one_sentence(done, "workflow", f"--config: {name} is given twice")

    def test_values_taken_over_in_yaml_are_not_given_twice(self):
        text = "a: &a {beta: 3, zeta: 1}\nb: {c: &c {<<: *a, beta: 4}}\nd: {<<: *c, beta: 5}\n"
        (scratch() / "merged.yaml").write_text(text)
        found = config.read_config(scratch() / "merged.yaml")
        self.assertEqual(found["b"]["c"], {"beta": 4, "zeta": 1})
        self.assertEqual(found["d"], {"beta": 5, "zeta": 1})

    def test_folder_may_look_like_an_option_or_stand_below_home(self):
        folder = new_folder("odd_out")
        for out, meant in (("-dash", folder / "-dash"), ("~/grid", scratch() / "grid")):
            with self.subTest(out):
                options = ["--config", f"out={out}", "options={parameters: ~/p.json}"]
                (scratch() / "p.json").write_text("{}")
                done = subprocess.run(
                    workflow("-np", *options),
                    cwd=folder,
                    env={**yade_environment(), "HOME": str(scratch())},
                    capture_output=True,
                    text=True,
                )
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIn(f" --out {meant}/cases/", done.stdout)
                self.assertIn(f"sweep.py report {meant}\n", done.stdout)
                self.assertIn(f" --parameters={scratch()}/p.json ", done.stdout)

    def test_results_of_a_single_run_are_not_written_over(self):
        folder = new_folder("single_run")
        (folder / "results").mkdir()
        for name in ("summary.json", "report.html"):
            (folder / "results" / name).write_text("of the run\n")
        done = self.start(folder, "--configfile", "tiny.yaml")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("results/summary.json is a single run's", done.stderr)
        self.assertEqual((folder / "results" / "report.html").read_text(), "of the run\n")

    def test_numbers_as_yaml_takes_them_for_texts_are_values(self):
        folder = new_folder("texts")
        content = "grid: {beta: [1e1]}\noptions: {duration: 1e-2, no_pictures: true}\nmemory: 1e3\n"
        content += "threads: 1.0\n"
        (folder / "mine.yaml").write_text(content)
        for plan in (["--dry-run", "--printshellcmds"], ["-np"], ["-pn"]):
            done = self.start(folder, "--configfile", "mine.yaml", *plan)
            self.assertEqual(done.returncode, 0, done.stderr)
            lines = [line for line in done.stdout.splitlines() if line.startswith("yade ")]
            self.assertEqual(len(lines), 1, done.stdout)
            self.assertIn("--duration=1e-2 --no-pictures --beta=1e1 ", lines[0])
            self.assertFalse((folder / ".snakemake" / "workflow.lock").exists())


class TestKilled(unittest.TestCase):
    ONE_CASE = re.sub("  (beta|alpha_crease): .*", r"  \1: [100]", TINY)

    def start(self, folder, halt=None):
        return subprocess.Popen(
            workflow("--configfile", "tiny.yaml"),
            cwd=folder,
            env=halt.environment() if halt else yade_environment(),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def finish(self, folder):
        process = self.start(folder)
        said, _ = process.communicate()
        self.assertEqual(process.returncode, 0, said)
        case = folder / "results" / "cases" / "beta_100-alpha_crease_100"
        files = (path for path in case.rglob("*") if path.is_file() and not path.name[0] == ".")
        return {
            path.relative_to(case): path.read_bytes()
            for path in files
            if path.name != "wall_time.json"
        }

    def test_killed_workflow_goes_on_and_leaves_the_same_files(self):
        quiet, killed = (new_folder(name) for name in ("quiet_workflow", "killed_workflow"))
        for folder in (quiet, killed):
            (folder / "tiny.yaml").write_text(self.ONE_CASE)
        expected = self.finish(quiet)
        self.assertGreater(len(expected), 5)

        halt = Halt(r"\.part/history\.csv")
        process = self.start(killed, halt)
        halt.wait(process)
        other = self.start(killed)
        said, _ = other.communicate()
        self.assertEqual(other.returncode, 1)
        self.assertEqual(said, f"workflow: another workflow is running in {killed}\n")
        kill(process)
        self.assertEqual(self.finish(killed), expected)


# Snakemake's function took one profile up to 7.19, and takes several since 7.32.
READ = """
import inspect, json, snakemake, sys
several = "profiles" in inspect.signature(snakemake.get_argument_parser).parameters
parser = snakemake.get_argument_parser(sys.argv[1:] if several else sys.argv[1])
print(json.dumps(vars(parser.parse_args([])), default=str))
"""


class TestProfile(unittest.TestCase):
    """The profile as Snakemake's own command-line parser reads it."""

    def setUp(self):
        done = subprocess.run(
            ["/usr/bin/python3", "-c", READ, str(PROFILE)], capture_output=True, text=True
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.values = json.loads(done.stdout)

    def test_jobs_are_submitted_watched_and_cancelled(self):
        self.assertIn("sbatch --parsable ", self.values["cluster"])
        status = PROFILE / self.values["cluster_status"]
        self.assertTrue(os.access(status, os.X_OK), status)
        self.assertEqual(self.values["cluster_cancel"], "scancel")
        self.assertIs(self.values["keep_going"], True)
        self.assertIs(self.values["rerun_incomplete"], True)

    def test_every_field_of_the_submission_is_known_to_a_case(self):
        fields = set(re.findall(r"\{([^}]*)\}", self.values["cluster"]))
        known = {"rule", "wildcards.case", "threads", "resources.mem_mb", "resources.runtime"}
        self.assertEqual(fields, known)


@long
class TestSlurm(unittest.TestCase):
    """A 2 x 2 sweep on a real Slurm; one job is cancelled while it runs."""

    @classmethod
    def setUpClass(cls):
        cls.folder = new_folder("slurm")
        options = ["--configfile", "tiny.yaml", "--profile", str(PROFILE), "--latency-wait", "10"]
        cls.slurm = Slurm()
        cls.victim = "beta_30-alpha_crease_100"
        with cls.slurm:
            environment = {**yade_environment(), **cls.slurm.environment}
            settings = {"cwd": cls.folder, "env": environment, "text": True}
            pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
            first = subprocess.Popen(command(*options), **settings, **pipes)
            cls.cancelled = cls.cancel(first)
            cls.first_output, _ = first.communicate()
            cls.first_code = first.returncode
            cls.after_first = cls.folders()
            cls.second = subprocess.run(command(*options), **settings, **pipes)
            cls.after_second = cls.folders()
            cls.states = {
                job: cls.status(job)
                for job in re.findall(r"external jobid '(\d+)'", cls.first_output)
            }
            cls.unknown = cls.status("4000000")
        cls.unreachable = cls.status("1")

    @classmethod
    def cancel(cls, workflow):
        """Cancel the victim's job as soon as it runs; its id, or None if it never did."""
        while workflow.poll() is None:
            for job, name, state in cls.slurm.jobs():
                if name == f"case.{cls.victim}" and state == "RUNNING":
                    cls.slurm.run("scancel", job)
                    return job
            time.sleep(0.1)
        return None

    @classmethod
    def status(cls, job):
        """What the profile's status script says of a job."""
        done = subprocess.run(
            [PROFILE / "status.sh", job], env=cls.slurm.environment, capture_output=True, text=True
        )
        return done.stdout.strip()

    @classmethod
    def folders(cls):
        """Times at which the finished cases were completed, by name [ns]."""
        files = (cls.folder / "results" / "cases").glob("*/case.json")
        return {path.parent.name: path.stat().st_mtime_ns for path in files}

    def test_a_cancelled_job_is_noticed_and_the_others_are_completed(self):
        self.assertIsNotNone(self.cancelled, self.first_output)
        self.assertNotEqual(self.first_code, 0)
        self.assertEqual(set(self.after_first), CASES - {self.victim}, self.first_output)

    def test_a_rerun_completes_only_the_case_that_is_missing(self):
        self.assertEqual(self.second.returncode, 0, self.second.stdout)
        self.assertEqual(set(self.after_second), CASES)
        for name, time_completed in self.after_first.items():
            self.assertEqual(self.after_second[name], time_completed, name)
        submitted = re.findall(r"Submitted job \d+ with external jobid", self.second.stdout)
        self.assertEqual(len(submitted), 1, self.second.stdout)

    def test_a_finished_case_that_was_removed_is_planned_again(self):
        case = self.folder / "results" / "cases" / self.victim
        away = case.rename(self.folder / "away")
        try:
            done = snakemake(self.folder, "--configfile", "tiny.yaml", "--dry-run", "--jobs", "1")
        finally:
            away.rename(case)
        self.assertEqual(done.returncode, 0, done.stdout)
        planned = re.findall("wildcards: case=(.*)", done.stdout)
        self.assertEqual(planned, [self.victim], done.stdout)

    def test_the_report_knows_all_cases(self):
        results = self.folder / "results"
        page, table = (results / name for name in ("report.html", "cases.csv"))
        for name in CASES:
            self.assertIn(name, page.read_text())
            self.assertRegex(table.read_text(), f"(?m)^{name},.*,complete,")

    def test_the_status_script_tells_every_state_apart(self):
        self.assertEqual(len(self.states), len(CASES))
        for job, state in self.states.items():
            self.assertEqual(state, "failed" if job == self.cancelled else "success")
        self.assertEqual(self.unknown, "failed")
        self.assertEqual(self.unreachable, "running")  # nobody answers: ask again

    def test_nothing_is_left_running(self):
        self.assertEqual(self.slurm.processes(), [])
        self.assertFalse(self.slurm.folder.exists())


class TestLeavesNothing(unittest.TestCase):
    @long
    def test_a_test_that_fails_leaves_no_daemon_and_no_job(self):
        slurm = Slurm()
        with self.assertRaises(ZeroDivisionError):
            with slurm:
                slurm.run("sbatch", "--mem=100", "--output=/dev/null", "--wrap", "sleep 1000")
                self.assertGreaterEqual(len(slurm.processes()), 3)
                1 / 0
        self.assertEqual(slurm.processes(), [])
        self.assertFalse(slurm.folder.exists())


if __name__ == "__main__":
    unittest.main()

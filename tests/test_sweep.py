# SPDX-License-Identifier: GPL-2.0-or-later
"""Sweeps and cases: whole or not at all, killed at any moment and gone on with, byte for byte."""

import argparse
import csv
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import time
import unittest
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path

import numpy as np
from membrane.cli.options import chosen_sail, from_arguments, parse
from membrane.files import replacing, write_json
from membrane.measures import SQUARE_OUTCOMES
from membrane.parameters import SailParameters
from membrane.results.case_folder import COMPLETE, DAMAGED, DIVERGED, FAILED, KILLED, LAST_GOOD
from membrane.results.case_folder import MISSING, Status, identity, look
from membrane.results.unfinished import UNFINISHED
from membrane.results.history import read_history
from membrane.results.output import HistoryWriter
from membrane.run.sails import SAILS
from membrane.run.sails.sheet import PatternParameters
from membrane.study.sweep import config, grid, jobs, results
from membrane.study.verification import paper
from membrane.view import report
from processes import Halt, family, kill, send, state
from slurm import Slurm
from support import ROOT, CommandTest, long, scratch, yade_environment


CASE, SWEEP = ROOT / "scripts" / "case.py", ROOT / "scripts" / "sweep.py"
COARSE = ["--fold-lines", "3", "--inner-width", "0.15"]
SHORT = [*COARSE, "--duration", "0.02", "--spin-up-tolerance", "1e-3"]
TOO_LONG = [*COARSE, "--duration", "0.2", "--dt", "2.3e-5", "--force-time-step"]
TOO_LONG += ["--spin-up-tolerance", "1e-3"]
OFTEN = ["--checkpoint-every", "0"]
WALL_TIME = "wall_time.json"  # what may differ, as what is below jobs.WORK


def part_of(folder):
    """Where a case runs until it is finished."""
    return folder / UNFINISHED


def has_result(folder):
    """Whether there is any result of a case."""
    return folder.is_dir() and os.listdir(folder) != [UNFINISHED]


def start(command, halt):
    """A process of its own session; `halt` is a Halt or None."""
    return subprocess.Popen(
        list(map(str, command)),
        cwd=scratch(),
        env=halt.environment() if halt else yade_environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def start_case(folder, *options, halt=None):
    return start(["yade", "-n", "-x", "-j1", CASE, "--out", folder, *options], halt)


def start_sweep(folder, *options, halt=None):
    return start(["/usr/bin/python3", SWEEP, *options, "--out", folder], halt)


def tree(folder):
    """Contents of all files that must be the same, by path."""
    files = (path for path in folder.rglob("*") if path.is_file())
    names = {path.relative_to(folder): path for path in files}
    return {
        str(name): path.read_bytes()
        for name, path in names.items()
        if name.name != WALL_TIME and name.parts[0] != jobs.WORK
    }


def rows(folder):
    """How many rows a history.csv has."""
    try:
        return (folder / "history.csv").read_text().count("\n") - 1
    except FileNotFoundError:
        return 0


def cut(path):
    """Cut off the last bytes of a file."""
    os.truncate(path, path.stat().st_size - 100)


def zero(path):
    """Zero the last bytes of a file."""
    content = path.read_bytes()
    path.write_bytes(content[:-100] + bytes(100))


def kill_at(number, run):
    """Kill a command, which `run(halt=...)` starts, at the n-th change of an unfinished case."""
    halt = Halt(f"{UNFINISHED}/", number)
    process = run(halt=halt)
    halt.wait(process)
    kill(process)


class SweepTest(unittest.TestCase):
    def completes(self, process):
        """It ends well; returns what it said."""
        said, _ = process.communicate()
        self.assertEqual(process.returncode, 0, said)
        return said

    def same(self, expected, found):
        """Two folders hold the same files."""
        expected, found = tree(expected), tree(found)
        self.assertGreater(len(expected), 5)
        self.assertEqual(sorted(found), sorted(expected))
        for name, content in expected.items():
            self.assertTrue(found[name] == content, f"{name} differs")


@lru_cache(maxsize=None)
def diverged():
    """Folder of a case that diverged without being disturbed."""
    folder = scratch() / "diverged"
    process = start_case(folder, *TOO_LONG)
    said, _ = process.communicate()
    assert process.returncode == 0, said
    return folder


class TestCase(SweepTest):
    def test_diverged_case_is_a_result_with_time_and_reason(self):
        found = json.loads((diverged() / "case.json").read_text())
        self.assertEqual(found["outcome"], DIVERGED)
        self.assertRegex(found["reason"], "from nowhere")
        history = (diverged() / "history.csv").read_text().splitlines()
        last = float(history[-1].split(",")[0])
        self.assertTrue(last < found["time"] < last + 2e-3, (last, found["time"]))
        self.assertTrue((diverged() / LAST_GOOD).exists())

    def test_killed_case_that_diverges_leaves_the_same_files(self):
        """Also after a power cut that took what was not yet on the disk."""
        folder = scratch() / "killed" / "diverged"
        run = partial(start_case, folder, *TOO_LONG, *OFTEN)
        for number, damage in zip(random.Random(7).sample(range(100, 400), 2), (cut, zero)):
            kill_at(number, run)
            self.assertFalse(has_result(folder))
            saved = (part_of(folder) / "checkpoint").iterdir()
            damage(max(path for path in saved if path.name.isdecimal()) / "scene.yade.gz")
            damage(part_of(folder) / "history.csv")
        self.completes(run())
        self.same(diverged(), folder)
        self.assertFalse(part_of(folder).exists())

    def test_case_killed_while_tethers_lie_on_the_spool_leaves_the_same_files(self):
        options = [*SHORT, "--tip-mass", "5e-3", "--duration", "0.19"]
        quiet, folder = (scratch() / name / "case" for name in ("wound", "killed_wound"))
        self.completes(start_case(quiet, *options, *OFTEN))
        history = read_history(quiet / "history.csv")
        first = int(np.argmax(history["contact_work"] != 0))
        self.assertTrue(0 < first < len(history["time"]) - 10)
        halt = Halt("checkpoint/")
        process = start_case(folder, *options, *OFTEN, halt=halt)
        halt.wait_until(process, lambda: rows(part_of(folder)) >= first + 5)
        kill(process)
        self.assertFalse(has_result(folder))
        self.completes(start_case(folder, *options, *OFTEN))
        self.same(quiet, folder)
        self.assertEqual((folder / "report.html").exists(), report.TEMPLATE.is_file())

    def test_case_on_a_free_hub_killed_twice_leaves_the_same_files(self):
        """In the spin-up, after which the hub must be let go, and in the run."""
        space = ["--hub-inertia", "1e-5", "--gravity", "0", "--air-density", "0"]
        options = [*SHORT, *space, "--duration", "0.03", "--no-pictures", *OFTEN]
        quiet, folder = scratch() / "quiet_hub", scratch() / "killed_hub" / "case"
        self.completes(start_case(quiet, *options))
        spin = read_history(quiet / "history.csv")["hub_spin"]
        self.assertGreater(np.ptp(spin), 1e-3 * spin[0])
        halt = Halt("checkpoint/", 8)
        for reached in (lambda: rows(part_of(folder)) == 0, lambda: rows(part_of(folder)) > 5):
            process = start_case(folder, *options, halt=halt)
            halt.wait_until(process, reached)
            kill(process)
            self.assertFalse(has_result(folder))
        self.completes(start_case(folder, *options))
        self.same(quiet, folder)

    def test_case_killed_just_when_it_has_its_name_is_finished(self):
        folder = scratch() / "killed_late"
        halt = Halt(r"begun\.json$", 2)  # first it is made, then removed
        process = start_case(folder, *SHORT, "--no-pictures", halt=halt)
        halt.wait(process)
        kill(process)
        before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
        self.completes(start_case(folder, *SHORT, "--no-pictures"))
        after = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
        gone = {path.name for path in before.keys() - after.keys()}
        self.assertEqual(gone, {UNFINISHED, "begun.json", "lock"})
        self.assertLessEqual(after.items(), before.items())
        self.assertFalse(part_of(folder).exists())

    def test_finished_case_is_left_alone_and_another_is_refused(self):
        before = {path: path.stat().st_mtime_ns for path in diverged().rglob("*")}
        self.completes(start_case(diverged(), *TOO_LONG))
        process = start_case(diverged(), *TOO_LONG, "--beta", "3")
        said, _ = process.communicate()
        self.assertNotEqual(process.returncode, 0)
        self.assertRegex(said, "case: .* holds another case: beta = 30.0, not 3.0")
        self.assertNotIn("Traceback", said)
        after = {path: path.stat().st_mtime_ns for path in diverged().rglob("*")}
        self.assertEqual(after, before)

    def test_another_case_does_not_take_the_place_of_one_that_is_not_finished(self):
        folder = scratch() / "begun" / grid.CASES / "mine"
        run = partial(start_case, folder, *SHORT, "--no-pictures", *OFTEN)
        kill_at(60, run)
        before = tree(part_of(folder))
        said, _ = run("--beta", "3").communicate()
        self.assertIn(f"{part_of(folder)} holds another case: beta = 30.0, not 3.0; to lose", said)
        self.assertEqual(tree(part_of(folder)), before)
        with self.assertRaisesRegex(ValueError, f"{part_of(folder)} holds another case"):
            grid.plan(folder.parents[1], {folder.name: SailParameters()})

    def test_folder_of_something_else_is_refused_and_nobody_is_told_to_remove_it(self):
        folder = scratch() / "letters"
        folder.mkdir()
        (folder / "letter.txt").write_text("Dear")
        process = start_case(folder, *SHORT)
        said, _ = process.communicate()
        self.assertEqual(process.returncode, 1)
        self.assertIn(f"case: {folder}/case.json: is missing; choose another folder", said)
        self.assertNotIn("remove", said)
        self.assertEqual([path.name for path in folder.iterdir()], ["letter.txt"])

    def test_failed_case_keeps_its_reason_and_leaves_no_result(self):
        folder = scratch() / "refused_case"
        process = start_case(folder, *COARSE, "--dt", "1e-4")
        said, _ = process.communicate()
        self.assertNotEqual(process.returncode, 0)
        self.assertFalse(has_result(folder))
        status = look(folder)
        self.assertEqual(status.state, FAILED)
        self.assertRegex(status.reason, "dt = 0.0001 s must be <= .*critical")
        self.assertIn(status.reason, said)


class TestSweep(SweepTest):
    OPTIONS = [*SHORT, "--no-pictures", *OFTEN, "--alpha-crease", "10", "100", "--beta", "3"]

    @classmethod
    def setUpClass(cls):
        cls.folder = scratch() / "sweep"
        process = start_sweep(cls.folder, *cls.OPTIONS)
        cls.said, _ = process.communicate()
        cls.status = process.returncode

    def test_sweep_reports_every_case(self):
        self.assertEqual(self.status, 0, self.said)
        self.assertIn("2 of 2 cases are complete, 0 diverged.", self.said)
        self.assertRegex(self.said, r"\d of 2 cases done, \d running")
        with open(self.folder / "cases.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["alpha_crease"] for row in rows], ["10", "100"])
        for row in rows:
            summary = json.loads((self.folder / "cases" / row["case"] / "summary.json").read_text())
            self.assertEqual(row["outcome"], "complete")
            self.assertEqual(str(summary["parameters"]["alpha_crease"]), row["alpha_crease"] + ".0")
            self.assertEqual(summary["parameters"]["beta"], 3)
            for outcome in SQUARE_OUTCOMES:
                value = summary["measures"][outcome.name]
                unit, factor = outcome.shown or (outcome.unit, 1)
                told = row[outcome.name if unit == "-" else f"{outcome.name}_{unit}"]
                self.assertEqual(told, "" if value is None else str(factor * value))
            self.assertEqual(row["period_s"], "")  # too short a run to see it
        page = (self.folder / "report.html").read_text()
        for name in ("deployment_rate.png", "phase_difference.png", "cases.csv"):
            self.assertIn(f'"{name}"', page)
            self.assertGreater((self.folder / name).stat().st_size, 200)

    def test_sweep_killed_at_random_moments_leaves_the_same_files(self):
        folder = scratch() / "killed_sweep"
        run = partial(start_sweep, folder, *self.OPTIONS)
        for number in random.Random(3).sample(range(80), 2):
            kill_at(number, run)
        said = self.completes(run())
        self.assertRegex(said, "killed before: it was stopped from outside")
        self.same(self.folder, folder)

    def test_snakemake_killed_alone_leaves_the_same_files(self):
        folder = scratch() / "killed_snakemake"
        halt = Halt("checkpoint/")
        process = start_sweep(folder, *self.OPTIONS, halt=halt)
        halt.wait(process)
        halt.lift()
        snakemake, *left = family(process.pid)[1:]
        os.kill(snakemake, signal.SIGKILL)  # its jobs go on
        said = ""
        while "it is still running" not in said:
            line = process.stdout.readline()
            self.assertNotEqual(line, "", f"it came to its end: {said}")
            said += line
        self.assertTrue(said.endswith("; it runs again\n"), said)
        for job in left:
            send(job, signal.SIGCONT)
        self.completes(process)
        self.same(self.folder, folder)

    def test_what_a_killed_sweep_leaves_running_is_ended(self):
        folder = scratch() / "left_over"
        halt = Halt("checkpoint/", 5)
        process = start_sweep(folder, *self.OPTIONS, halt=halt)
        job = halt.wait(process)
        left = family(process.pid)[1:]
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        halt.lift()
        try:
            said = self.completes(start_sweep(folder, *self.OPTIONS))
            told = re.search("sweep: ended (.*), processes that a killed sweep had left here", said)
            self.assertLessEqual({left[0], job}, set(map(int, told[1].split(", "))))
            self.assertEqual([pid for pid in left if Path(f"/proc/{pid}").exists()], [])
        finally:
            for pid in left:
                send(pid, signal.SIGKILL)
        self.same(self.folder, folder)

    def test_lost_case_runs_alone_and_again_if_it_is_killed(self):
        folder = scratch() / "lost"
        shutil.copytree(self.folder, folder, symlinks=True)
        lost, kept = sorted((folder / "cases").iterdir())
        shutil.rmtree(lost)
        before = {path: path.stat().st_mtime_ns for path in kept.rglob("*")}
        halt = Halt("checkpoint/", 20)
        process = start_sweep(folder, *self.OPTIONS, halt=halt)
        case = halt.wait(process)
        halt.lift()
        os.kill(case, signal.SIGKILL)
        said = self.completes(process)
        self.assertIn("1 of 2 cases are there already", said)
        self.assertRegex(said, f"{lost.name}: it was stopped from outside.*; it runs again")
        self.same(self.folder, folder)
        self.assertEqual({path: path.stat().st_mtime_ns for path in kept.rglob("*")}, before)

    def test_damaged_case_is_told_and_left_as_it_is(self):
        folder = scratch() / "damaged_sweep"
        shutil.copytree(self.folder, folder, symlinks=True)
        lost, hurt = sorted((folder / "cases").iterdir())
        shutil.rmtree(lost)
        os.truncate(hurt / "history.csv", 1000)
        before = tree(hurt)
        process = start_sweep(folder, *self.OPTIONS)
        said, _ = process.communicate()
        self.assertEqual(process.returncode, 1, said)
        self.assertRegex(
            said, f"sweep: {hurt}/history.csv: .* cut off; the case is damaged: remove {hurt}, "
        )
        self.assertIn(f"{hurt.name} is damaged: ", said)
        self.assertIn("1 of 2 cases are complete, 0 diverged.", said)
        self.assertEqual(tree(hurt), before)
        process = start_case(hurt, *SHORT, "--alpha-crease", "100", "--beta", "3")
        said, _ = process.communicate()
        self.assertNotEqual(process.returncode, 0)
        self.assertRegex(said, "case: .*history.csv: .* is cut off; the case is damaged: remove ")
        shutil.rmtree(hurt)
        self.completes(start_sweep(folder, *self.OPTIONS))
        self.same(self.folder, folder)

    def test_other_options_in_the_same_folder_are_refused(self):
        process = start_sweep(self.folder, *self.OPTIONS, "--zeta", "0.5")
        said, _ = process.communicate()
        self.assertNotEqual(process.returncode, 0)
        self.assertRegex(said, "sweep: .* holds another case: zeta = 0.02, not 0.5")
        self.assertNotIn("Traceback", said)


def changed(path, change):
    """Rewrite a JSON file of an object: `change` is called with it."""
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def without(name):
    """What changes a JSON file of a case so that it lacks a name."""
    return lambda folder: changed(folder / "case.json", lambda content: content.pop(name))


def given(name, value):
    """What changes a JSON file of a case so that it gives a name another value."""
    return lambda folder: changed(folder / "case.json", lambda c: c.update({name: value}))


def filled(name, text):
    """What gives a file of a case another text."""
    return lambda folder: (folder / name).write_text(text)


def header(folder):
    """Take all rows from the history of a case."""
    path = folder / "history.csv"
    path.write_text(path.read_text().partition("\n")[0] + "\n")


def second_value(text):
    """What replaces the time in the second row of a history."""

    def damage(folder):
        lines = (folder / "history.csv").read_text().splitlines(keepends=True)
        lines[2] = text + lines[2][lines[2].index(",") :]
        (folder / "history.csv").write_text("".join(lines))

    return damage


def unnamed(folder):
    """Rename a column of the history of a case."""
    path = folder / "history.csv"
    path.write_text(path.read_text().replace("deployment_rate", "rate", 1))


# How a finished case is damaged, and parts of what must be said of it.
DAMAGES = {
    "history empty": (filled("history.csv", ""), "history.csv: is empty"),
    "history missing": (lambda f: (f / "history.csv").unlink(), "history.csv: is missing"),
    "history without rows": (header, "history.csv: has no row"),
    "history with nan": (second_value("nan"), "history.csv: line 3, time: is 'nan'"),
    "history with inf": (second_value("inf"), "history.csv: line 3, time: is 'inf'"),
    "history goes back": (second_value("-1"), "history.csv: line 3, time"),
    "history cut": (lambda f: os.truncate(f / "history.csv", 3000), "history.csv: line"),
    "history without a column": (unnamed, "history.csv: line 1: names no column deployment_rate"),
    "result missing": (lambda f: (f / "case.json").unlink(), "case.json: is missing"),
    "result a folder": (
        lambda f: ((f / "case.json").unlink(), (f / "case.json").mkdir()),
        "case.json",
    ),
    "result cut": (lambda f: os.truncate(f / "case.json", 40), "case.json: line "),
    "result {}": (filled("case.json", "{}"), "case.json: outcome"),
    "result []": (filled("case.json", "[]"), "case.json: must hold an object"),
    "result of one name": (filled("case.json", '{"outcome": "complete"}'), "case.json: parameters"),
    "no versions": (without("versions"), "case.json: versions"),
    "another outcome": (given("outcome", "splendid"), "case.json: outcome: is 'splendid'"),
    "parameters a list": (given("parameters", [1]), "case.json: parameters: must be an object"),
    "a parameter a list": (given("parameters", {"beta": [3]}), "case.json: parameters.beta"),
    "a parameter out of range": (given("parameters", {"beta": -3}), "beta = -3 must be >= 0"),
    "another sail": (given("sail", "kite"), "case.json: sail: is 'kite'; must be one of "),
    "units missing": (lambda f: (f / "history.units.json").unlink(), "history.units.json"),
    "summary missing": (lambda f: (f / "summary.json").unlink(), "summary.json"),
    "summary {}": (filled("summary.json", "{}"), "summary.json: measures: must be an object"),
    "a measure a word": (
        filled("summary.json", '{"measures": {"period": "long"}}'),
        "summary.json: measures.period: is 'long'; must be a number or null",
    ),
    "diverged without a reason": (given("outcome", "diverged"), "case.json: reason"),
    "diverged at no time": (
        lambda f: changed(
            f / "case.json", lambda c: c.update(outcome="diverged", reason="", time="soon")
        ),
        "case.json: time: is 'soon'",
    ),
}


def write_case(folder, p, rows=101):
    """A complete case with curves of a swing, without running it."""
    folder.mkdir(parents=True)
    about = {"outcome": COMPLETE, **identity(p), "versions": {"yade": "2023.02a"}}
    write_json(folder / "case.json", about)
    units = {"time": "s", "deployment_rate": "-", "phase_difference": "rad"}
    time = np.linspace(0, p.duration, rows)
    swing = -np.sin(50 * time) * p.alpha_crease / 100
    columns = dict(zip(units, (time, 10 * time, swing)))
    with HistoryWriter(folder / "history.csv", units) as history:
        for row in zip(*columns.values()):
            history.write(dict(zip(units, row)))
    found = {outcome.name: outcome.of(columns) for outcome in SQUARE_OUTCOMES}
    write_json(folder / "summary.json", {"measures": found})


@lru_cache(maxsize=None)
def two_cases():
    """Folder of a planned sweep of two cases with curves of a swing, without running them."""
    folder, base = scratch() / "two_cases", {"beta": 3.0, "duration": 0.1}
    cases = grid.grid(SailParameters, {"alpha_crease": [10.0, 100.0]}, base)
    grid.plan(folder, cases)
    for name, p in cases.items():
        write_case(folder / grid.CASES / name, p)
    return folder


class TestReport(SweepTest):
    """What is there and what is missing, without YADE."""

    def report(self, folder, **options):
        """Exit status and output of `sweep.py report`, where no yade can be imported."""
        blocked = scratch() / "no_yade"
        (blocked / "yade").mkdir(parents=True, exist_ok=True)
        (blocked / "yade" / "__init__.py").write_text("raise ImportError('YADE was imported')\n")
        done = subprocess.run(
            ["/usr/bin/python3", str(SWEEP), "report", str(folder)],
            env={"PATH": os.environ["PATH"], "PYTHONPATH": str(blocked)},
            capture_output=True,
            text=True,
            **options,
        )
        return done.returncode, done.stdout + done.stderr

    def copy(self, name):
        """A new copy of two_cases() and the folder of its first case."""
        folder = scratch() / name
        shutil.copytree(two_cases(), folder)
        return folder, folder / grid.CASES / "alpha_crease_10"

    def refused(self, folder, *parts):
        """`sweep.py report` and `sweep.py run` end by one sentence and change nothing."""
        before = tree(folder)
        status, said = self.report(folder)
        self.assertEqual(status, 1)
        self.assertEqual(len(said.splitlines()), 1, said)
        for part in ("sweep: ", *parts):
            self.assertIn(part, said)
        self.assertEqual(tree(folder), before)

    def test_damaged_case_is_reported_and_the_other_as_usual(self):
        whole, _ = self.copy("undamaged")
        status, said = self.report(whole)
        self.assertEqual(
            (status, said.splitlines()[0]), (0, "2 of 2 cases are complete, 0 diverged.")
        )
        usual = (whole / "cases.csv").read_text().splitlines()[2]
        self.assertNotIn("in 3D", (whole / "report.html").read_text())
        for number, (what, (damage, reason)) in enumerate(DAMAGES.items()):
            with self.subTest(what):
                folder, case = self.copy(f"damaged_{number}")
                damage(case)
                self.assertEqual(look(case).state, DAMAGED)
                status, said = self.report(folder)
                self.assertEqual(status, 1, said)
                first, told, last = said.splitlines()
                self.assertEqual(first, "1 of 2 cases are complete, 0 diverged.")
                self.assertTrue(told.startswith(f"  {case.name} is damaged: "), told)
                self.assertIn(f"{case}/", told)
                self.assertIn(reason, told)
                rows = (folder / "cases.csv").read_text().splitlines()
                self.assertEqual(rows[2], usual)
                with open(folder / "cases.csv", newline="") as file:
                    row = next(csv.DictReader(file))
                self.assertEqual((row["case"], row["outcome"]), (case.name, DAMAGED))
                self.assertIn(reason, row["reason"])
                self.assertEqual(row["final_deployment_rate"], "")
                page = (folder / "report.html").read_text()
                self.assertIn("1 damaged", page)
                self.assertIn('"deployment_rate.png"', page)

    def test_case_of_other_parameters_than_planned_is_not_complete(self):
        folder, case = self.copy("of_another")
        changed(
            folder / "sweep.json",
            lambda plan: plan["cases"][case.name]["parameters"].update(duration=0.2),
        )
        status, said = self.report(folder)
        self.assertEqual(status, 1)
        self.assertIn("1 of 2 cases are complete", said)
        self.assertIn(f"{case.name} is damaged: {case} holds another case: duration = 0.1", said)

    def test_damaged_files_of_an_unfinished_case_do_not_end_the_report(self):
        for number, text in enumerate(("", "[1]", "{}", '{"reason": 3}', '{"parameters": [1]}')):
            with self.subTest(text):
                folder, case = self.copy(f"unfinished_{number}")
                shutil.rmtree(case)
                part = part_of(case)
                part.mkdir(parents=True)
                (part / "begun.json").write_text(text)
                (part / "failure.json").write_text(text)
                status, said = self.report(folder)
                self.assertEqual(status, 1)
                self.assertRegex(said, f"{case.name} is missing")
                self.assertNotIn("Traceback", said)

    def test_damaged_plan_is_a_sentence(self):
        plans = {
            "": "is empty",
            '{"cases"': "is no JSON",
            "[1]": "must hold an object",
            "{}": "cases: must be an object",
            '{"cases": [1]}': "cases: must be an object, not a list of 1",
            '{"cases": {"a": [1]}}': "cases.a: must be an object",
            '{"cases": {"../a": {}}}': "cases.../a: is no name of a folder",
            '{"cases": {"a": {"parameters": {}, "sail": []}}}': "cases.a.sail: is a list of 0;",
            '{"cases": {"a": {"parameters": {"beta": "x"}, "sail": "square"}}}': (
                "cases.a.parameters: beta = 'x' must be a number"
            ),
        }
        for number, (text, reason) in enumerate(plans.items()):
            with self.subTest(text):
                folder, _ = self.copy(f"plan_{number}")
                (folder / "sweep.json").write_text(text)
                self.refused(folder, f"{folder}/sweep.json: ", reason)

    def test_results_of_a_single_run_are_not_written_over(self):
        folder = scratch() / "single"
        shutil.copytree(two_cases() / grid.CASES, folder / "long")  # cases within it, too
        for name in ("summary.json", "report.html", "history.csv"):
            (folder / name).write_text("of the run\n")
        self.refused(folder, f"{folder}/summary.json ")
        before = tree(folder)
        process = start_sweep(folder, *SHORT)
        said, _ = process.communicate()
        self.assertEqual(process.returncode, 1)
        self.assertRegex(said, f"^sweep: {folder}/summary.json .*\n$")
        self.assertEqual(tree(folder), before)

    def test_table_of_another_is_not_written_over(self):
        folder = scratch() / "own_table"
        shutil.copytree(two_cases() / grid.CASES, folder / "mine")
        (folder / "cases.csv").write_text("my own\n")
        self.refused(folder, f"{folder}/cases.csv was not made by this version")

    def test_full_disk_keeps_the_earlier_report(self):
        folder, _ = self.copy("full")
        self.report(folder)
        before = tree(folder)
        self.assertGreater(len(before["deployment_rate.png"]), 10_000)

        def no_space():
            resource.setrlimit(resource.RLIMIT_FSIZE, (6000, 6000))

        status, said = self.report(folder, preexec_fn=no_space)
        self.assertEqual(status, 1)
        self.assertRegex(said, f"(?m)^sweep: .*{folder}/deployment_rate.png")
        self.assertNotIn("Traceback", said)
        self.assertEqual(tree(folder), before)

    def test_file_is_replaced_whole_or_not_at_all(self):
        path = scratch() / "replaced.txt"
        path.write_text("old")
        with self.assertRaises(ZeroDivisionError):
            with replacing(path) as part:
                part.write_text("half of the n")
                1 / 0
        self.assertEqual(path.read_text(), "old")
        self.assertFalse(part.exists())
        with replacing(path) as part:
            part.write_text("new")
        self.assertEqual(path.read_text(), "new")
        self.assertFalse(part.exists())

    def test_holes_are_told_with_their_reasons(self):
        folder = scratch() / "holes"
        parameters = json.loads((diverged() / "case.json").read_text())["parameters"]
        axes = {"alpha_crease": [10.0, 1000.0], "beta": [3.0, 30.0]}
        cases = grid.grid(SailParameters, axes, parameters)
        grid.plan(folder, cases)
        here = folder / grid.CASES
        shutil.copytree(diverged(), here / "alpha_crease_1000-beta_30")
        failed = part_of(here / "alpha_crease_10-beta_3")
        failed.mkdir(parents=True)
        (failed / "failure.json").write_text('{"reason": "a <b>reason</b>"}')
        (part_of(here / "alpha_crease_10-beta_30") / "checkpoint").mkdir(parents=True)
        status, said = self.report(folder)
        self.assertEqual(status, 1, said)
        self.assertIn("0 of 4 cases are complete, 1 diverged.", said)
        self.assertRegex(said, r"1000-beta_30 diverged at 0\.\d+ s, because: .*from nowhere")
        self.assertIn("alpha_crease_10-beta_3 is missing (failed): a <b>reason</b>", said)
        with open(folder / "cases.csv", newline="") as file:
            rows = {row["case"]: row for row in csv.DictReader(file)}
        states = {name: row["outcome"] for name, row in rows.items()}
        self.assertEqual(
            states,
            {
                "alpha_crease_10-beta_3": FAILED,
                "alpha_crease_10-beta_30": KILLED,
                "alpha_crease_1000-beta_3": MISSING,
                "alpha_crease_1000-beta_30": DIVERGED,
            },
        )
        self.assertIn("last checkpoint", rows["alpha_crease_10-beta_30"]["reason"])
        page = (folder / "report.html").read_text()
        self.assertIn("a &lt;b&gt;reason", page)
        self.assertIn("from nowhere", page)

    def test_folders_of_cases_alone_can_be_reported(self):
        folder = scratch() / "loose"
        shutil.copytree(diverged(), folder / "mine")
        status, said = self.report(folder)
        self.assertEqual(status, 0, said)
        self.assertIn("mine diverged", said)

    def test_large_grid_is_drawn_in_panels(self):
        folder = scratch() / "large"
        axes = {"alpha_crease": [1.0, 10.0, 100.0, 1e3, 1e4], "beta": [0.0, 3.0, 30.0]}
        for name, p in grid.grid(SailParameters, axes).items():
            write_case(folder / name, p)
        status, said = self.report(folder)
        self.assertEqual(status, 0, said)
        self.assertIn("15 of 15 cases are complete", said)
        page = (folder / "report.html").read_text()
        self.assertIn("Sweep over alpha_crease and beta", page)
        for name in ("deployment_rate.png", "phase_difference.png", "maps.png"):
            self.assertIn(f'"{name}"', page)
            self.assertEqual((folder / name).read_bytes()[:8], b"\x89PNG\r\n\x1a\n")

    def test_grid_of_other_numbers_and_of_words_is_drawn_as_far_as_it_can_be(self):
        for maps, axes in (
            (True, {"omega": [10.0, 20.0], "fold_lines": [3, 7]}),
            (False, {"crease_law": ["paper", "conservative"], "omega": [10.0, 20.0]}),
            (False, {"omega": [10.0, 20.0], "beta": [3.0, 30.0], "zeta": [0.0, 0.1]}),
        ):
            with self.subTest(axes=list(axes)):
                folder = scratch() / f"grid_of_{'_'.join(axes)}"
                for name, p in grid.grid(SailParameters, axes).items():
                    write_case(folder / name, p)
                status, said = self.report(folder)
                self.assertEqual(status, 0, said)
                with open(folder / "cases.csv", newline="") as file:
                    rows = list(csv.DictReader(file))
                found = {name: {row[name] for row in rows} for name in axes}
                self.assertEqual(found, {n: set(map(grid.text, v)) for n, v in axes.items()})
                page = (folder / "report.html").read_text()
                for name, drawn in (("phase_difference.png", True), ("maps.png", maps)):
                    self.assertEqual(f'"{name}"' in page, drawn)

    def test_case_that_has_a_page_is_linked_to_it(self):
        folder, case = self.copy("with_a_page")
        (case / "shapes.png").touch()
        (case / "report.html").touch()
        status, said = self.report(folder)
        self.assertEqual(status, 0, said)
        page = (folder / "report.html").read_text()
        self.assertEqual(page.count(f'<a href="cases/{case.name}/report.html">'), 2)

    def test_folder_without_cases_is_a_sentence(self):
        folder = scratch() / "empty"
        folder.mkdir()
        status, said = self.report(folder)
        self.assertEqual(status, 1)
        self.assertEqual(said.strip(), f"sweep: {folder} holds no case")


class TestGrid(unittest.TestCase):
    def test_default_grid_is_that_of_table_2(self):
        cases = grid.grid(SailParameters, {})
        found = {(p.alpha_crease, p.beta) for p in cases.values()}
        self.assertEqual(found, {(a, b) for a in paper.ALPHA_CREASE for b in paper.BETA})
        self.assertEqual(len(cases), len(found))
        for p in cases.values():
            self.assertGreaterEqual(p.duration, 1.2)  # to see the lead that follows the lag
            usual = replace(p, alpha_crease=1000.0, beta=30.0, duration=1.0)
            self.assertEqual(usual, SailParameters())

    def test_several_values_are_an_axis_and_single_ones_are_shared(self):
        given = {"omega": [15.0, 20.0], "beta": [3.0], "crease_law": ["paper", "conservative"]}
        cases = grid.grid(SailParameters, given, {"zeta": 0.1, "beta": 30.0})
        self.assertEqual(len(cases), 4)
        for name, p in cases.items():
            self.assertEqual(name, f"omega_{p.omega:g}-crease_law_{p.crease_law}")
            self.assertEqual((p.beta, p.zeta, p.duration), (3.0, 0.1, 1.0))

    def test_names_tell_close_values_apart(self):
        close = {"alpha_crease": [1e-9, 1.0, 1 + 1e-15]}
        self.assertEqual(len(grid.grid(SailParameters, close)), 3)
        files = {"file": ["a/b.fold", "a_b.fold"]}
        with self.assertRaisesRegex(ValueError, "two cases would have one name"):
            grid.grid(PatternParameters, files)

    def test_value_given_twice_or_out_of_range_is_refused(self):
        for given, sentence in (
            ({"alpha_crease": [10.0], "beta": [3.0, 3.0]}, "beta: 3 3: a value is given twice"),
            ({"beta": [-1.0, 3.0]}, "beta = -1"),
            ({"zeta": [-1.0]}, "zeta = -1"),
        ):
            with self.assertRaisesRegex(ValueError, sentence):
                grid.grid(SailParameters, given)
        with self.assertRaisesRegex(ValueError, "give several values of a parameter"):
            grid.grid(PatternParameters, {"omega": [10.0]})

    def test_words_of_a_case_ask_for_its_parameters(self):
        for p in (
            SailParameters(),
            SailParameters(dt=1e-5 / 3, path="law2", force_time_step=True, gravity=0.0, beta=1 / 3),
            PatternParameters(file="a b.fold", flat=True, poisson=-1e-7),
            SAILS["ikaros"].parameters(spin=2.7, sun=30.0),
            SAILS["miura"].parameters(file="other.fold", omega=0.1 + 0.2),
        ):
            kind, words = chosen_sail(grid.case_words(p))
            parser = argparse.ArgumentParser()
            self.assertEqual(from_arguments(parse(parser, kind, words), kind=kind), p)


class TestMeasures(unittest.TestCase):
    def measure(self, until):
        """Outcomes of tips that lag by 30 degrees and then lead, with a period of 2 s."""
        time = np.linspace(0, until, 1001)
        columns = {
            "time": time,
            "phase_difference": -np.radians(30) * np.sin(np.pi * time),
            "deployment_rate": time / until,
        }
        case = Status(Path(), COMPLETE, measures={o.name: o.of(columns) for o in SQUARE_OUTCOMES})
        return {o.name: results.measured(case, o) for o in SQUARE_OUTCOMES}

    def test_swing_of_a_known_curve(self):
        found = self.measure(2.0)
        self.assertAlmostEqual(found["amplitude"], 30, places=6)
        self.assertAlmostEqual(found["time_of_largest_lag"], 0.5)
        self.assertAlmostEqual(found["period"], 2)
        self.assertAlmostEqual(found["time_of_rate_0.9"], 1.8, delta=0.003)

    def test_run_too_short_has_no_period_and_no_amplitude(self):
        found = self.measure(1.4)
        self.assertAlmostEqual(found["amplitude"], 30, delta=1e-3)
        self.assertIsNone(found["period"])
        found = self.measure(0.4)
        self.assertIsNone(found["amplitude"])
        self.assertIsNone(found["period"])


# What a file of configuration holds, and parts of what must be said of it.
BAD = {
    "": "is empty",
    "[1]": "must hold names with values",
    "grid: [": "line 1, column 8: is no YAML",
    "when: 2020-13-45": "is no YAML",
    "grid: [1]": "grid: must be names with values, not a list of 1",
    "grid: {beta: []}": "--beta: expected at least one argument",
    "grid: {beta: [3, 3.0]}": "beta: 3 3: a value is given twice",
    "grid: {beta: [-3]}": "beta = -3.0 must be >= 0",
    "grid: {beta: [.nan]}": "beta = nan must be >= 0",
    "grid: {beta: [[3]]}": "--beta: must be a number, not '[3]'",
    "grid: {bta: [3]}": "unrecognized arguments: --bta 3",
    "grid: {omega: [15], omega: [20]}": "omega: is given twice",
    "grid: {omega: [15]}\noptions: {omega: 20}": "omega: is given twice",
    "out: a\nout: b": "out: is given twice",
    '{"grid": {"beta": [3]}, "grid": {"beta": [4]}}': "grid: is given twice",
    "gird: {beta: [3]}": "gird: is nothing to configure",
    "options: 3": "options: must be names with values, not 3",
    "options: {fold_lines: 3.5}": "--fold-lines: must be a whole number, not '3.5'",
    "options: {zeta: yes}": "--zeta: expected at least one argument",
    "options: {crease_law: mine}": "--crease-law: invalid choice: 'mine'",
    "options: {force_time_step: 1}": "--force-time-step: must be true or false, not '1'",
    "options: {checkpoint_every: soon}": "--checkpoint-every: must be a number, not 'soon'",
    "sail: 3": "sail: must be a word, not 3",
    "sail: miura\ngrid: {fold_lines: [3, 7]}": "unrecognized arguments: --fold-lines 3 7",
    "threads: many": "--threads: must be a number, not 'many'",
    "memory: 0": "--memory: 0: must be at least 1",
    "threads: 1e400": "--threads: '1e400' is too large a number",
    '{"out": "\\udcff"}': "must be UTF-8",
    "minutes: 1.5": "--minutes: must be a whole number, not '1.5'",
}


class TestCommandLine(CommandTest):
    """What is asked for, by words and by files; nothing runs."""

    def setUp(self):
        self.folder = scratch() / self.id().rpartition(".")[2]
        self.folder.mkdir()

    def dry(self, *options, home=None):
        """`sweep.py --dry-run` in the folder, which leaves nothing."""
        before = sorted(self.folder.rglob("*"))
        done = subprocess.run(
            ["/usr/bin/python3", SWEEP, *options, "--dry-run"],
            cwd=self.folder,
            env={**yade_environment(), **({"HOME": str(home)} if home else {})},
            capture_output=True,
            text=True,
        )
        self.assertEqual(sorted(self.folder.rglob("*")), before)
        return done

    def cases(self, *options, **more):
        """States of the cases by name."""
        done = self.dry(*options, **more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return dict(line.split(": ") for line in done.stdout.splitlines())

    def write(self, text):
        (self.folder / "mine.yaml").write_text(text)
        return "--config", "mine.yaml"

    def test_bad_file_is_one_sentence(self):
        for text, reason in BAD.items():
            with self.subTest(text):
                done = self.dry(*self.write(text))
                self.ends_with_one_sentence(done, "sweep", "sweep: mine.yaml: ", reason)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_missing_file_no_core_and_no_folder_are_one_sentence(self):
        self.ends_with_one_sentence(self.dry("--config=nowhere.yaml"), "sweep", "nowhere.yaml")
        for option in ("-j0", "--jobs=-1", "--threads=00"):
            done = self.dry(option)
            self.assertRegex(done.stderr, "sweep: error: argument .*: must be at least 1\n$")
        done = self.dry("--checkpoint-every=-1")
        self.assertRegex(done.stderr, "sweep: error: argument .*: -1: must be >= 0 and finite\n$")
        self.ends_with_one_sentence(self.dry("miura"), "sweep", "give several values")
        (self.folder / "file").write_text("")
        (self.folder / "summary.json").write_text("")
        done = self.dry("--out", ".")
        self.ends_with_one_sentence(done, "sweep", "summary.json is a single run's")

    def test_file_and_command_line_ask_for_the_same(self):
        text = "sail: miura\ngrid: {omega: [15, 20.0]}\noptions: {size: 1e-1, flat: true}\n"
        found = self.cases(*self.write(f"{text}out: there\nmemory: 1e3\nthreads: 1.0\n"))
        self.assertEqual(found, {"omega_15": MISSING, "omega_20": MISSING})
        words = ["miura", "--omega", "15", "20", "--size=.1", "--flat", "--out", "there"]
        self.assertEqual(self.cases(*words), found)

    def test_command_line_wins_over_the_file(self):
        given = self.write("grid: {omega: [15, 20]}\noptions: {beta: 3}\n")
        self.assertEqual(set(self.cases(*given)), {"omega_15", "omega_20"})
        self.assertEqual(set(self.cases(*given, "--omega", "7", "8")), {"omega_7", "omega_8"})
        both = {f"beta_{b}-omega_{a}" for a in (15, 20) for b in (1, 2)}
        self.assertEqual(set(self.cases(*given, "--beta", "1", "2")), both)
        self.assertEqual(set(self.cases("miura", *given)), {"omega_15", "omega_20"})

    def test_values_taken_over_in_yaml_are_not_given_twice(self):
        text = "a: &a {beta: 3, zeta: 1}\nb: {c: &c {<<: *a, beta: 4}}\nd: {<<: *c, beta: 5}\n"
        self.write(text)
        found = config.read_config(self.folder / "mine.yaml")
        self.assertEqual(found["b"]["c"], {"beta": 4, "zeta": 1})
        self.assertEqual(found["d"], {"beta": 5, "zeta": 1})

    def test_folder_may_look_like_an_option_or_stand_below_home(self):
        table_2 = self.cases()
        self.assertEqual(len(table_2), 6)
        for out, meant in (("-dash", self.folder / "-dash"), ("~/grid", scratch() / "grid")):
            with self.subTest(out):
                place = meant / grid.CASES / "alpha_crease_100-beta_0"
                write_case(place, SailParameters(alpha_crease=100.0, beta=0.0, duration=1.2))
                found = self.cases(*self.write(f"out: {out}\n"), home=scratch())
                self.assertEqual(found, {**table_2, place.name: COMPLETE})


class TestAnySail(SweepTest):
    """A sheet from a file, of a mesh that is as coarse as can be."""

    OPTIONS = ["--size", "0.05", "--duration", "0.01", "--no-pictures", *OFTEN]

    def sheet(self, name):
        """A FOLD file of its own."""
        path = scratch() / f"{name}.fold"
        shutil.copy(ROOT / "scripts" / "patterns" / "miura.fold", path)
        return path

    def test_sweep_over_a_sheet_reports_its_own_measures(self):
        folder, sheet = scratch() / "sheets", self.sheet("swept")
        words = [SWEEP, sheet, "--omega", "40", "60", *self.OPTIONS, "--out", folder]
        said = self.completes(start(["/usr/bin/python3", *words], None))
        self.assertIn("2 of 2 cases are complete, 0 diverged.", said)
        with open(folder / "cases.csv", newline="") as file:
            found = {row["omega"]: row for row in csv.DictReader(file)}
        for omega, row in found.items():
            summary = json.loads((folder / "cases" / row["case"] / "summary.json").read_text())
            self.assertEqual(
                (summary["sail"], summary["parameters"]["file"]), ("sheet", str(sheet))
            )
            angle = np.degrees(summary["measures"]["final_mean_crease_angle"])
            self.assertAlmostEqual(float(row["final_mean_crease_angle_deg"]), angle)
        areas = {omega: float(row["largest_projected_area"]) for omega, row in found.items()}
        self.assertGreater(areas["60"], areas["40"])  # the faster it spins the sooner it opens
        for name in ("radius.png", "crease_angle.png", "spin.png"):
            self.assertEqual((folder / name).read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        sheet.write_text(sheet.read_text() + "\n")
        said, _ = start(["/usr/bin/python3", *words], None).communicate()
        self.assertRegex(said, "^sweep: .*omega_40 holds another case: sum_of_file = ")

    def test_killed_case_of_a_sheet_goes_on_unless_its_file_is_another(self):
        quiet, folder, sheet = scratch() / "quiet_sheet", scratch() / "cut_sheet", self.sheet("cut")

        def run(place, halt=None):
            words = [CASE, sheet, "--out", place, *self.OPTIONS]
            return start(["yade", "-n", "-x", "-j1", *words], halt)

        self.completes(run(quiet))
        kill_at(60, partial(run, folder))
        self.assertFalse(has_result(folder))
        text = sheet.read_text()
        sheet.write_text(text + "\n")
        said, _ = run(folder).communicate()
        self.assertRegex(said, f"case: {part_of(folder)} holds another case: sum_of_file = .*lose")
        sheet.write_text(text)
        self.completes(run(folder))
        self.same(quiet, folder)


class TestStopped(SweepTest):
    def test_control_c_ends_all_in_one_sentence_and_nobody_else_sweeps_there(self):
        folder = scratch() / "stopped"
        options = [*COARSE, "--duration", "20", "--omega", "15", "20", "--no-pictures"]
        process = start_sweep(folder, *options)
        while "2 running" not in process.stdout.readline():
            self.assertIsNone(process.poll())
        said, _ = start_sweep(folder, *options).communicate()
        self.assertEqual(said, f"sweep: another sweep is running in {folder}\n")
        started = family(process.pid)[1:]
        self.assertGreater(len(started), 2)
        process.send_signal(signal.SIGINT)
        said, _ = process.communicate()
        self.assertEqual(process.returncode, 130)
        self.assertEqual(
            said.splitlines()[-1], "sweep: stopped; the same command goes on from here"
        )
        self.assertNotIn("Traceback", said)
        self.assertEqual([pid for pid in started if state(pid) not in "XZ"], [])

    def test_what_snakemake_says_where_it_fails_itself_is_quoted(self):
        folder = scratch() / "no_cache"
        environment = {**yade_environment(), "XDG_CACHE_HOME": "/dev/null"}
        done = subprocess.run(
            ["/usr/bin/python3", SWEEP, *SHORT, "--omega", "15", "20", "--out", folder],
            env={**environment, "MPLCONFIGDIR": str(scratch())},
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.returncode, 1)
        self.assertRegex(
            done.stderr.splitlines()[-1],
            f"^sweep: Snakemake ended by 1: .*Not a directory: '/dev/null/.*{folder}/.*log$",
        )


@long
class TestSlurm(SweepTest):
    """A 2 x 2 sweep on a real Slurm; one job is cancelled while it runs, and one sweep killed."""

    OPTIONS = [*COARSE, "--duration", "0.05", "--spin-up-tolerance", "1e-2", "--no-pictures"]
    OPTIONS += ["--beta", "3", "30", "--alpha-crease", "100", "1000", "--slurm", "--memory", "1000"]

    def start(self, slurm, folder):
        return subprocess.Popen(
            ["/usr/bin/python3", SWEEP, *self.OPTIONS, *OFTEN, "--out", folder],
            env={**yade_environment(), **slurm.environment},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def running(self, slurm, sweep, ready=lambda job, case: True):
        """Id and case of a job on Slurm as soon as one runs that is `ready`."""
        while sweep.poll() is None:
            for job, case, now in slurm.jobs():
                if now == "RUNNING" and ready(job, case):
                    return job, case
            time.sleep(0.1)
        self.fail(sweep.communicate()[0])

    def test_a_cancelled_job_runs_again_and_a_killed_sweep_goes_on(self):
        folder = scratch() / "slurm"
        with Slurm() as slurm:
            daemons = len(slurm.processes())
            sweep = self.start(slurm, folder)
            self.running(slurm, sweep)
            before = {job for job, *_ in slurm.jobs()}
            kill(sweep)
            sweep = self.start(slurm, folder)
            saved = folder / grid.CASES / "{}" / UNFINISHED / "checkpoint"
            job, victim = self.running(
                slurm,
                sweep,
                lambda job, case: job not in before and Path(str(saved).format(case)).exists(),
            )
            slurm.run("scancel", job)
            said = self.completes(sweep)
            self.assertEqual(slurm.jobs(), [])
            again = self.completes(self.start(slurm, folder))
            for _ in range(300):  # a daemon's helpers take a moment to end
                if len(left := slurm.processes()) <= daemons:
                    break
                time.sleep(0.1)
        self.assertRegex(said, f"{victim}: it was stopped from outside.*; it runs again")
        self.assertIn("4 of 4 cases are complete, 0 diverged.", said)
        self.assertIn("4 of 4 cases are there already", again)
        self.assertLessEqual(len(left), daemons)
        with open(folder / "cases.csv", newline="") as file:
            outcomes = {row["case"]: row["outcome"] for row in csv.DictReader(file)}
        names = {f"alpha_crease_{a}-beta_{b}" for a in (100, 1000) for b in (3, 30)}
        self.assertEqual(outcomes, dict.fromkeys(names, COMPLETE))

    def test_control_c_cancels_its_jobs(self):
        with Slurm() as slurm:
            sweep = self.start(slurm, scratch() / "slurm_stopped")
            self.running(slurm, sweep)
            sweep.send_signal(signal.SIGINT)
            said, _ = sweep.communicate()
            self.assertEqual(sweep.returncode, 130, said)
            while slurm.jobs():  # those that end
                self.assertNotIn("PENDING", {state for *_, state in slurm.jobs()})
                time.sleep(0.1)

    def test_a_test_that_fails_leaves_no_daemon_and_no_job(self):
        slurm = Slurm()
        with self.assertRaises(ZeroDivisionError):
            with slurm:
                slurm.run("sbatch", "--mem=100", "--output=/dev/null", "--wrap", "sleep 1000")
                self.assertGreaterEqual(len(slurm.processes()), 3)
                1 / 0
        self.assertEqual(slurm.processes(), [])
        self.assertFalse(slurm.folder.exists())


@long
class TestReferencePath(SweepTest):
    def test_law2_case_killed_leaves_the_same_files(self):
        quiet, folder = scratch() / "law2", scratch() / "killed_law2" / "case"
        options = [*SHORT, "--path", "law2", "--no-pictures", *OFTEN]
        self.completes(start_case(quiet, *options))
        run = partial(start_case, folder, *options)
        for number in random.Random(11).sample(range(60), 2):
            kill_at(number, run)
        self.completes(run())
        self.same(quiet, folder)


if __name__ == "__main__":
    unittest.main()

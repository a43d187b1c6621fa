# SPDX-License-Identifier: GPL-2.0-or-later
"""Output folders: earlier results stay whole until a run has all of its own."""

import contextlib
import json
import os
import shutil
import subprocess
import unittest

from membrane.results.own import CASE, LIST, RUN, add_to_list, listed
from membrane.results.unfinished import FAILURE, RESULT, SAVED, UNFINISHED, name_of, new_results
from support import scratch, yade_environment

HOLD = """
import sys
from membrane.results.unfinished import new_results
with new_results(sys.argv[1]):
    print("held", flush=True)
    sys.stdin.read()
"""


def stopped(count, work):
    """Do some work that Ctrl-C stops after so many renames."""
    renames = iter([os.rename] * count)

    def rename(*paths):
        for really in renames:
            return really(*paths)
        os.rename = unchanged
        raise KeyboardInterrupt

    unchanged, os.rename = os.rename, rename
    try:
        with contextlib.suppress(KeyboardInterrupt):
            work()
    finally:
        os.rename = unchanged


def killed(count, work):
    """Do some work in a process of its own, which is killed after so many renames."""
    child = os.fork()
    if not child:
        renames = iter([os.rename] * count)
        os.rename = lambda *paths: next(renames, lambda *_: os._exit(9))(*paths)
        work()
        os._exit(0)
    os.waitpid(child, 0)


class TestNewResults(unittest.TestCase):
    def setUp(self):
        self.folder = scratch() / self.id().rpartition(".")[2]

    def write(self, folder, **files):
        """Text files, `name` for `name.csv`; shapes go into their folder."""
        (folder / "shapes").mkdir(parents=True)
        for name, text in files.items():
            (folder / f"{name}.csv").write_text(text)
            (folder / "shapes" / f"film_{text}.vtu").write_text(text)

    def earlier(self, **files):
        """Results of an earlier run."""
        with new_results(self.folder) as part:
            self.write(part, **files)

    def found(self):
        """Text of all files by path below the folder, but for the list of them."""
        files = (path for path in self.folder.rglob("*") if path.is_file() and path.name != LIST)
        return {str(path.relative_to(self.folder)): path.read_text() for path in files}

    def test_results_take_the_place_of_earlier_ones_and_leave_other_files(self):
        self.earlier(history="old")
        (self.folder / "mine.csv").write_text("of the user")
        add_to_list(self.folder, ["sail.gif"])
        (self.folder / "sail.gif").write_text("made of the earlier shapes")
        with new_results(self.folder) as part:
            self.write(part, history="new")
            self.assertEqual((self.folder / "history.csv").read_text(), "old")
        self.assertEqual(
            self.found(),
            {"history.csv": "new", "shapes/film_new.vtu": "new", "mine.csv": "of the user"},
        )
        self.assertFalse((self.folder / UNFINISHED).exists())

    def test_failure_leaves_earlier_results_and_what_there_is_of_the_new(self):
        self.earlier(history="old")
        before = self.found()
        for error in (RuntimeError, KeyboardInterrupt):
            with self.assertRaises(error), new_results(self.folder) as part:
                self.assertEqual([path.name for path in part.iterdir()], ["lock"])
                self.write(part, history="half")
                raise error
            left = self.found()
            self.assertEqual({name: left[name] for name in before}, before)
            self.assertEqual(left[f"{UNFINISHED}/history.csv"], "half")

    def test_exchange_that_is_cut_off_leaves_the_results_of_one_run(self):
        old = {"history.csv": "old", "other.csv": "old", "shapes/film_old.vtu": "old"}
        new = {name.replace("old", "new"): "new" for name in old}
        outcomes = []
        for count in range(12):
            for cut_off in (stopped, killed):
                with self.subTest(renames=count, by=cut_off.__name__):
                    shutil.rmtree(self.folder, ignore_errors=True)
                    self.earlier(history="old", other="old")
                    cut_off(count, self.exchange)
                    with contextlib.suppress(ZeroDivisionError), new_results(self.folder):
                        1 / 0  # a next run, which fails
                    outcomes.append(self.found())
                    self.assertIn(outcomes[-1], (old, new))
                    self.assertEqual(
                        listed(self.folder, RUN), {"history.csv", "other.csv", "shapes"}
                    )
        self.assertIn(old, outcomes)
        self.assertIn(new, outcomes)

    def exchange(self):
        with new_results(self.folder) as part:
            self.write(part, history="new", other="new")

    ABOUT = {"sail": "square", "parameters": {"beta": 3.0}, "versions": {}}

    def case(self, about=None):
        """New results of a case that can go on."""
        return new_results(self.folder, CASE, about or self.ABOUT)

    def test_run_that_can_go_on_finds_what_it_had_and_leaves_its_reason(self):
        with self.assertRaises(RuntimeError), self.case() as part:
            self.write(part, history="half")
            raise RuntimeError("no room")
        self.assertEqual(json.loads((part / FAILURE).read_text()), {"reason": "no room"})
        with self.assertRaises(KeyboardInterrupt), self.case() as part:
            self.assertFalse((part / FAILURE).exists())
            self.assertEqual((part / "history.csv").read_text(), "half")
            raise KeyboardInterrupt
        with self.case({**self.ABOUT, "versions": {"yade": "another"}}) as part:
            self.assertFalse((part / "history.csv").exists())
            self.write(part, history="whole")
            (part / SAVED).mkdir()
        self.assertEqual(self.found(), {"history.csv": "whole", "shapes/film_whole.vtu": "whole"})
        self.assertFalse((self.folder / UNFINISHED).exists())

    def test_who_sees_the_result_of_a_case_sees_all_whenever_it_is_cut_off(self):
        whole = {name: "all" for name in ("history.csv", "shapes/film_all.vtu", RESULT)}
        outcomes = []
        for count in range(9):
            for cut_off in (stopped, killed):
                with self.subTest(renames=count, by=cut_off.__name__):
                    shutil.rmtree(self.folder, ignore_errors=True)
                    cut_off(count, self.finish)
                    found = self.found()
                    outcomes.append(RESULT in found)
                    if outcomes[-1]:
                        self.assertLessEqual(whole.items(), found.items())
                    self.finish()
                    self.assertEqual(self.found(), whole)
        self.assertEqual(set(outcomes), {True, False})

    def finish(self):
        """Finish a case, or the exchange of its results, as `run_case` does."""
        with self.case() as part:
            if not any((folder / RESULT).exists() for folder in (self.folder, part)):
                shutil.rmtree(part / "shapes", ignore_errors=True)
                self.write(part, history="all")
                (part / RESULT).write_text("all")

    def test_failure_before_the_first_file_leaves_no_trace(self):
        with self.assertRaises(ValueError), new_results(self.folder / "a" / "b"):
            raise ValueError
        self.assertFalse(self.folder.exists())
        self.folder.mkdir()
        with self.assertRaises(ValueError), new_results(self.folder):
            raise ValueError
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_two_runs_at_once_into_one_folder_are_refused(self):
        script = scratch() / "hold.py"
        script.write_text(HOLD)
        holder = subprocess.Popen(
            ["yade", "-n", "-x", script, self.folder],
            env=yade_environment(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        while "held" not in holder.stdout.readline():
            self.assertIsNone(holder.poll())
        with self.assertRaisesRegex(ValueError, "another run is writing"), new_results(self.folder):
            self.fail("not refused")
        holder.communicate()
        self.assertEqual(holder.returncode, 0)
        with new_results(self.folder):
            pass

    def test_name_is_that_of_the_output_folder(self):
        with new_results(self.folder) as part:
            self.assertEqual(name_of(part), self.folder.name)
        self.assertEqual(name_of(self.folder), self.folder.name)


if __name__ == "__main__":
    unittest.main()

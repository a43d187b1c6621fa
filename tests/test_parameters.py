# SPDX-License-Identifier: GPL-2.0-or-later
"""Parameters of the scene: tables of the paper, command line, batch tables."""

import argparse
import contextlib
import io
import json
import re
import subprocess
import unittest
from dataclasses import fields
from math import inf, pi

import numpy as np
from membrane.cli.options import add_arguments, count, from_arguments, parse
from membrane.parameters import SailParameters, describe
from membrane.results.history import read_history
from membrane.run import driver
from support import O, ROOT, long, quiet, scratch, yade_environment

QUICK = True

# Tables 1 and 2 of the paper, and the defaults chosen among Table 2's.
PAPER = {
    "outer_width": 0.455,
    "inner_width": 0.103,
    "fold_lines": 7,
    "thickness": 7.5e-6,
    "young": 3.2e9,
    "poisson": 0.34,
    "density": 1420.0,
    "spool_radius": 0.025,
    "tip_mass": 0.36e-3,
    "omega": 6 * pi,
    "theta0": 0.0,
    "alpha": 100.0,
    "gamma": 100.0,
    "zeta": 0.02,
}


class TestParameters(unittest.TestCase):
    def parse(self, *words):
        parser = argparse.ArgumentParser()
        add_arguments(parser)
        return parser.parse_args(words)

    def test_defaults_are_those_of_the_paper(self):
        values = SailParameters().as_dict()
        self.assertLessEqual(PAPER.items(), values.items())
        self.assertIn(values["alpha_crease"], (100.0, 1000.0))
        self.assertIn(values["beta"], (0.0, 3.0, 30.0))

    def test_no_options_give_the_defaults(self):
        self.assertEqual(from_arguments(self.parse()), SailParameters())

    def test_every_parameter_can_be_set_on_the_command_line(self):
        for item in fields(SailParameters):
            flag = "--" + item.name.replace("_", "-")
            if item.type is bool:
                words, expected = [flag], not item.default
            elif item.metadata["choices"]:
                expected = next(c for c in item.metadata["choices"] if c != item.default)
                words = [flag, expected]
            elif item.type is int:
                words, expected = [flag, str(item.default + 1)], item.default + 1
            else:
                expected = 0.9 * item.default if item.default else 0.01
                words = [flag, repr(expected)]
            found = from_arguments(self.parse(*words)).as_dict()
            self.assertEqual(found, {**SailParameters().as_dict(), item.name: expected})

    def test_command_line_wins_over_a_file_and_that_over_defaults(self):
        file = scratch() / "some.json"
        file.write_text('{"parameters": {"beta": 1.0, "zeta": 0.1, "duration": 3.0}}')
        words = ["--parameters", str(file), "--zeta", "0.2"]
        found = parse(argparse.ArgumentParser(), words=words)
        self.assertEqual((found.beta, found.zeta), (1.0, 0.2))
        self.assertEqual((found.duration, found.gamma), (3.0, 100.0))

    def test_where_several_values_may_be_given_only_those_given_are_there(self):
        parser = argparse.ArgumentParser()
        add_arguments(parser, several=True)
        self.assertEqual(vars(parser.parse_args([])), {})
        words = "--beta 3 30 --force-time-step --crease-law paper --fold-lines 3e0".split()
        expected = {"beta": [3.0, 30.0], "force_time_step": [], "crease_law": ["paper"]}
        self.assertEqual(vars(parser.parse_args(words)), {**expected, "fold_lines": [3]})
        found = parser.parse_args(["--force-time-step", "true", "false"])
        self.assertEqual(found.force_time_step, [True, False])

    def test_table_overrides_the_command_line(self):
        found = from_arguments(self.parse("--beta", "3"), {"beta": 0.0, "zeta": 0.1})
        self.assertEqual((found.beta, found.zeta), (0.0, 0.1))

    def test_whole_numbers_may_have_a_point_or_an_exponent(self):
        for word, value in (("36", 36), ("36.0", 36), ("1e3", 1000), ("+4", 4), ("3.6e1", 36)):
            found = from_arguments(self.parse("--spool-facets", word)).spool_facets
            self.assertEqual((type(found), found), (int, value))
            table = from_arguments(self.parse(), {"spool_facets": float(word)}).spool_facets
            self.assertEqual((type(table), table), (int, value))
        self.assertEqual(count("2.0"), 2)

    def test_other_words_for_whole_numbers_are_a_sentence(self):
        for word, reason in (
            ("36.5", "must be a whole number, not '36.5'"),
            ("many", "must be a number, not 'many'"),
            ("nan", "must be a whole number"),
            ("1e400", "'1e400' is too large a number"),
            ("9" * 5000, "9…' is too large|9… is too large"),
            ("3e9", "'3e9' is too large a number"),
        ):
            with self.subTest(word=word[:9]), self.assertRaises(SystemExit):
                said = io.StringIO()
                with contextlib.redirect_stderr(said):
                    try:
                        self.parse("--spool-facets", word)
                    finally:
                        last = said.getvalue().splitlines()[-1]
                        self.assertRegex(last, f"error: argument --spool-facets: .*({reason})")

    def test_values_of_other_kinds_are_refused_and_the_right_ones_get_their_type(self):
        for name, value, reason in (
            ("exchange_period", 10**10, "exchange_period = 10000000000 is too large a number"),
            ("exchange_period", 1e300, "is too large a number"),
            ("zeta", True, "zeta = True must be a number"),
            ("fold_lines", True, "fold_lines = True must be a number"),
            ("force_time_step", 2, "force_time_step = 2 must be true or false"),
            ("force_time_step", "no", "force_time_step = 'no' must be true or false"),
            ("duration", inf, "duration = inf s must be >= 0 and finite"),
        ):
            with self.assertRaisesRegex(ValueError, reason):
                SailParameters(**{name: value})
        found = SailParameters(beta=3, fold_lines=7.0, force_time_step=1)
        self.assertEqual(
            repr((found.beta, found.fold_lines, found.force_time_step)), "(3.0, 7, True)"
        )

    def test_more_steps_than_can_be_counted_are_refused(self):
        for changes in ({"duration": 1e308}, {"dt": 1e-320}, {"dt": 1e-18}):
            with self.assertRaisesRegex(
                ValueError, r"duration = .* s must be at most \d+ steps of dt"
            ):
                SailParameters(**changes)
        SailParameters(duration=0.0, dt=1e-320)

    def test_intervals_longer_than_the_run_leave_its_ends_and_do_not_lengthen_it(self):
        folder, coarse = scratch() / "long_intervals", {"fold_lines": 3, "inner_width": 0.15}
        long = {"history_interval": 1e308, "shapes_interval": 1e300, "spin_up_tolerance": 1e-2}
        O.reset()
        with quiet():
            driver.deploy(
                SailParameters(duration=2e-3, **long, **coarse), folder, False, page=False
            )
        np.testing.assert_allclose(read_history(folder / "history.csv")["time"], [0, 2e-3])
        self.assertEqual(len(list((folder / "shapes").glob("film_*.vtu"))), 2)

    def test_shapes_more_often_than_rows_come_with_every_row(self):
        folder, coarse = scratch() / "short_intervals", {"fold_lines": 3, "inner_width": 0.15}
        often = {"history_interval": 1e-3, "shapes_interval": 1e-4, "spin_up_tolerance": 1e-2}
        O.reset()
        with quiet():
            driver.deploy(
                SailParameters(duration=3e-3, **often, **coarse), folder, False, page=False
            )
        self.assertEqual(len(list((folder / "shapes").glob("film_*.vtu"))), 4)

    def test_unknown_name_in_a_table_is_refused(self):
        with self.assertRaisesRegex(ValueError, "betta is not a parameter of the sail; it has"):
            from_arguments(self.parse(), {"betta": 3.0})

    def test_every_description_has_unit_range_and_default(self):
        for item in fields(SailParameters):
            text = describe(item)
            number = re.search(r"default (.+)\)$", text)[1]
            if item.type in (float, int):
                self.assertAlmostEqual(float(number), item.default, delta=1e-5 * item.default)
                self.assertIn(">", text)
            else:
                self.assertEqual(number, str(item.default))
            if item.type is float and item.metadata["unit"] != "-":
                self.assertIn(f"[{item.metadata['unit']}]", text)

    def test_help_tells_sources_and_defaults(self):
        for several in (False, True):
            parser = argparse.ArgumentParser()
            add_arguments(parser, several=several)
            text = " ".join(parser.format_help().split())
            for source in ("Table 1", "Table 2", "assumed", "run"):
                self.assertIn(f"parameters, {source}:", text)
            self.assertIn("time to run after the release [s] (>= 0; default 1)", text)
            self.assertIn("crease stiffness; 0: no creases (>= 0; default 30)", text)


class TestBatch(unittest.TestCase):
    def run_table(self, name, text):
        """Summaries of a batch of yade-batch by the rows' names."""
        folder = scratch() / name
        folder.mkdir()
        (folder / "table.txt").write_text(text)
        done = subprocess.run(
            ["yade-batch", "-j1", "--job-threads=1", "table.txt", ROOT / "scripts" / "deploy.py"],
            cwd=folder,
            env=yade_environment(),
            capture_output=True,
            text=True,
            timeout=300,
        )
        self.assertNotIn("FAILED", done.stdout + done.stderr)
        found = (folder / "out").glob("*/summary.json")
        return {path.parent.name: json.loads(path.read_text()) for path in found}

    @long
    def test_each_row_of_a_batch_table_leaves_its_results(self):
        short, names = "0.002 0.001 0.1", "description duration shapes_interval spin_up_tolerance"
        rows = f"{names} beta\nsoft {short} 3\nstiff {short} 30\n"
        found = self.run_table("batch", rows)
        betas = {name: summary["parameters"]["beta"] for name, summary in found.items()}
        self.assertEqual(betas, {"soft": 3.0, "stiff": 30.0})
        for summary in found.values():
            self.assertEqual(
                (summary["sail"], summary["parameters"]["duration"]), ("square", 0.002)
            )

    @long
    def test_a_column_names_the_sail(self):
        rows = "description sail duration omega\none 'miura' 0.002 40\ntwo 'heliogyro' 0.002 9\n"
        found = self.run_table("batch_of_sails", rows)
        sails = {name: (s["sail"], s["parameters"]["omega"]) for name, s in found.items()}
        self.assertEqual(sails, {"one": ("miura", 40.0), "two": ("heliogyro", 9.0)})


if __name__ == "__main__":
    unittest.main()

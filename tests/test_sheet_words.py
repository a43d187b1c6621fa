# SPDX-License-Identifier: GPL-2.0-or-later
"""What is told of a sheet: what was read, what is doubtful, which sides set the time step."""

import contextlib
import io
import json
import unittest
from dataclasses import replace

import numpy as np
from membrane.mesh.sheet_words import described, doubts, slow_sides
from membrane.mesh.placing import place
from membrane.results.output import read_history
from membrane.run import driver
from membrane.run.sails.sheet import PatternParameters, read_sheet, sail_of
from support import O, SceneTest, gmsh_sheet, scratch

QUICK = True

# A sheet of two squares and the crease between them.
PAIR = {
    "frame_unit": "m",
    "vertices_coords": [[0, 0], [1, 0], [2, 0], [2, 1], [1, 1], [0, 1]],
    "edges_vertices": [[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [5, 0], [1, 4]],
    "edges_assignment": [*"BBBBBBV"],
}


def sheet_of(content, **parameters):
    """SheetMesh of a FOLD file's content, and its PatternParameters."""
    path = scratch() / "words.fold"
    path.write_text(json.dumps(content))
    p = PatternParameters(file=str(path), **parameters)
    return read_sheet(p), p


def with_gap(gap):
    """The sheet with a crease that ends `gap` above the edge, near the vertex that is there."""
    coords, edges = PAIR["vertices_coords"], PAIR["edges_vertices"]
    new = {"vertices_coords": [*coords, [1, gap]], "edges_vertices": [*edges[:6], [6, 4]]}
    return {**PAIR, **new}


def flown(sheet, p, name):
    """Summary of a flight into a folder of scratch(), and what it said on standard error."""
    O.reset()
    with contextlib.redirect_stderr(io.StringIO()) as said:
        summary = driver.deploy(
            p, scratch() / name, pictures=False, page=False, sail=sail_of(sheet, p)
        )
    return summary, said.getvalue()


class TestWords(unittest.TestCase):
    def test_one_line_tells_what_was_read(self):
        p = PatternParameters(file=str(gmsh_sheet()))
        sheet = read_sheet(p)
        words = described(sheet, place(sheet, p))
        valleys = replace(sheet, crease_signs=-sheet.crease_signs, others=())
        self.assertEqual(
            words,
            f"0.4 x 0.4 m, {len(sheet.triangles)} triangles, creases of 4 sides (4 mountain, 0 "
            "valley), tips at 4 nodes, a hub of 1 node",
        )
        words = described(valleys, place(valleys, PatternParameters(tips="none")))
        self.assertIn("(0 mountain, 4 valley), tips at 0 nodes, a hub of 1 node", words)
        farthest = place(sheet, PatternParameters(tips="farthest"))
        self.assertIn("not used: tips", described(sheet, farthest))

    def test_a_sheet_as_it_should_be_raises_no_doubts(self):
        self.assertEqual(doubts(read_sheet(PatternParameters(file=str(gmsh_sheet())))), [])

    def test_missing_creases_and_sizes_of_a_forgotten_unit_are_doubted(self):
        plain, _ = sheet_of({**PAIR, "edges_assignment": [*"BBBBBBF"]})
        (said,) = doubts(plain)
        self.assertIn("no creases", said)
        sheet, _ = sheet_of(PAIR)
        for unit, wide in ((1e3, "2000 m wide"), (1e-4, "0.0002 m wide")):
            (said,) = doubts(replace(sheet, nodes=unit * sheet.nodes))
            self.assertIn(wide, said)
            self.assertIn("--unit", said)


class TestSlowSides(SceneTest):
    def found(self, content, **parameters):
        """Critical step [s], and what slow_sides gives, of a sheet."""
        O.reset()
        sheet, p = sheet_of(content, **parameters)
        _, made = driver.build(p, sail_of(sheet, p))
        springs = (made.membrane.sides, made.membrane.stiffnesses, made.membrane.masses)
        rows, longer = slow_sides(sheet.nodes, *map(np.array, springs), p.zeta)
        ends = sheet.nodes[np.array(made.membrane.sides)[rows]]
        return made.forces.criticalTimeStep(), ends, longer

    def test_the_side_that_sets_the_step_is_found_and_what_it_costs(self):
        for zeta in (0.0, 0.02):
            good, none, _ = self.found(PAIR, zeta=zeta)
            self.assertEqual(len(none), 0)
            for gap in (1e-3, 1e-4):
                bad, ends, longer = self.found(with_gap(gap), zeta=zeta)
                np.testing.assert_allclose(np.sort(ends[0], axis=0), [(1, 0, 0), (1, gap, 0)])
                self.assertEqual(len(ends), 1)
                # Told is what is sure to be gained; the whole gain is not much more.
                self.assertLess(longer, good / bad)
                self.assertGreater(longer, 0.5 * good / bad)

    def test_it_is_told_before_the_run(self):
        sheet, p = sheet_of(with_gap(1e-3), duration=1e-6)
        _, said = flown(sheet, p, "slow")
        self.assertRegex(said, r"Warning: the side from \(1, 0(\.001)?\) to \(1, 0(\.001)?\) m")
        self.assertRegex(
            said, r"0.001 m long, sets the time step: without it it could be \d+ times"
        )


class TestFlight(SceneTest):
    def test_the_last_row_is_that_of_the_duration(self):
        """Whatever the intervals: no step begins later."""
        sheet, _ = sheet_of(PAIR, size=0.3)
        for changes in (
            {"duration": 0.0107},
            {"duration": 0.0107, "dt": 2.3e-5},
            {"duration": 3e-4},
            {"duration": 1.3e-5, "dt": 1.1e-5},
            {"duration": 0.005, "history_interval": 0.003},
        ):
            p = PatternParameters(**{"shapes_interval": 0.0, **changes})
            with self.subTest(changes):
                summary, _ = flown(sheet, p, "timed")
                times = read_history(scratch() / "timed" / "history.csv")["time"]
                self.assertAlmostEqual(times[-1] / p.duration, 1, places=9)
                self.assertLessEqual(summary["dt"], p.dt or 0.51 * summary["critical_time_step"])
                self.assertLessEqual(np.diff(times).max(), p.history_interval * (1 + 1e-9))

    def test_a_huge_sail_makes_no_step_beyond_the_duration(self):
        """Its critical step is longer than the run, and than a turn."""
        sheet, _ = sheet_of(PAIR, unit=1000.0, size=300.0)
        p = PatternParameters(duration=0.05, tip_mass=0.0)
        summary, said = flown(sheet, p, "huge")
        self.assertIn("Warning: the sail is 2000 m wide", said)
        self.assertGreater(0.5 * summary["critical_time_step"], p.duration)
        self.assertLessEqual(summary["dt"] * p.omega, 0.05 + 1e-12)
        times = read_history(scratch() / "huge" / "history.csv")["time"]
        self.assertAlmostEqual(times[-1] / p.duration, 1, places=9)

    def test_steps_longer_than_the_duration_and_no_duration_are_refused(self):
        sheet, _ = sheet_of(PAIR, size=0.3)
        for changes, words in (
            ({"duration": 1e-6, "dt": 2e-6}, "duration = 1e-06 s: must be > 0 and >= dt = 2e-06 s"),
            ({"duration": 0.0}, "duration = 0.0 s: must be > 0"),
            ({"duration": 1e300}, "duration = 1e.300 s must be at most"),
        ):
            with self.assertRaisesRegex(ValueError, words):
                flown(sheet, PatternParameters(**changes), "refused")

    def test_layers_that_cross_at_the_end_are_counted(self):
        """Of a strip of three squares bent by 130 degrees twice the third cuts the first."""
        strip = {
            "frame_unit": "m",
            "vertices_coords": [[0, 0], [1, 0], [2, 0], [3, 0], [3, 1], [2, 1], [1, 1], [0, 1]],
            "edges_vertices": [[i, (i + 1) % 8] for i in range(8)] + [[1, 6], [2, 5]],
            "edges_assignment": [*"BBBBBBBBVV"],
        }
        for angle, crossed in ((130, True), (100, False)):
            angles = [0] * 8 + [angle, angle]
            sheet, p = sheet_of({**strip, "edges_foldAngle": angles}, size=0.3, duration=1e-5)
            summary, said = flown(sheet, p, "crossed")
            count = summary["measures"]["final_crossings"]
            self.assertEqual(count > 0, crossed)
            told = f"Warning: layers cross at the end: {count} times a side passes through a tri"
            self.assertEqual(told in said, crossed)


if __name__ == "__main__":
    unittest.main()

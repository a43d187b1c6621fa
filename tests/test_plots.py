# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures: scale bars as long as they say, words that can be read, curves clear of the frame."""

import csv
import itertools
import unittest
from types import SimpleNamespace
from unittest import mock

import numpy as np
from matplotlib.figure import Figure
from membrane.measures import Measure, in_plots
from membrane.view import plots
from mpl_toolkits.mplot3d import proj3d

from membrane.study.verification.chart_picture import draw, words_box
from support import ROOT, scratch

QUICK = True


UNITS = {"mm": 1e-3, "m": 1.0}


class TestScaleBar(unittest.TestCase):
    def drawn(self, radius):
        """Ends (2, 3) of the bar [m], the length it tells [m], and both ends on the page."""
        figure = Figure(figsize=(4, 3))
        axes = figure.add_axes((0, 0, 1, 1), projection="3d")
        plots._set_view(axes, radius)
        plots.draw_scale_bar(axes, radius)
        (line,), (label,) = axes.lines, axes.texts
        number, unit = label.get_text().split()
        figure.draw_without_rendering()
        ends = np.array(line.get_data_3d()).T[1:3]
        page = axes.transData.transform(
            np.array(proj3d.proj_transform(*ends.T, axes.get_proj()))[:2].T
        )
        return ends, float(number) * UNITS[unit], page / figure.bbox.size

    def test_it_is_as_long_as_it_says_and_a_good_part_of_the_sail(self):
        for radius in (3e-3, 0.32, 1.7, 10.0, 45.0):
            ends, told, _ = self.drawn(radius)
            self.assertAlmostEqual(np.linalg.norm(ends[1] - ends[0]) / told, 1, places=9)
            self.assertTrue(0.25 < told / radius <= 0.7, (told, radius))

    def test_it_lies_level_and_within_the_picture(self):
        _, _, (left, right) = self.drawn(0.32)
        self.assertLess(abs(left[1] - right[1]), 1e-6)
        for x, y in (left, right):
            self.assertTrue(0 < x < 1 and 0 < y < 0.5, (x, y))
        self.assertGreater(right[0] - left[0], 0.1)


class TestChart(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(ROOT / "reference" / "chart.csv", newline="") as file:
            table = csv.DictReader(line for line in file if not line.startswith("#"))
            cls.points = [
                SimpleNamespace(
                    **{key: row[key] for key in ("question", "path", "part")},
                    mesh=int(row["mesh"]),
                    dt=float(row["dt_s"]),
                    cost=float(row["cost_s"]),
                    error=float(row["error"]),
                    pareto=row["pareto"] == "1",
                )
                for row in table
            ]
        cls.figure = draw(cls.points, scratch() / "chart.png")

    def test_words_cover_neither_one_another_nor_points_and_stay_in_their_panel(self):
        (legend,) = self.figure.legends
        for axes in self.figure.axes:
            boxes = [words_box(label) for label in axes.texts]
            self.assertGreater(len(boxes), 2)
            for one, other in itertools.combinations([*boxes, legend.get_window_extent()], 2):
                self.assertFalse(one.overlaps(other))
            for line in axes.lines:
                if line.get_linestyle() == "None":
                    (place,) = axes.transData.transform(np.transpose(line.get_data()))
                    self.assertFalse(any(box.contains(*place) for box in boxes))
            for box in boxes:
                self.assertTrue(axes.bbox.fully_contains(*box.min), box)
                self.assertTrue(axes.bbox.fully_contains(*box.max), box)

    def test_every_part_left_out_and_every_step_of_the_front_is_named(self):
        told = [label.get_text() for axes in self.figure.axes for label in axes.texts]
        parts = [p.part for p in self.points if p.part]
        self.assertEqual(len(parts), sum(any(p in words for p in set(parts)) for words in told))
        front = [f"{p.dt:.2g} s" for p in self.points if p.pareto]
        self.assertEqual(len(front), sum(words.endswith(" s") for words in told))
        self.assertEqual(set(front), {words.split(", ")[-1] for words in told if " s" in words})

    def test_axes_keep_clear_of_their_neighbours(self):
        boxes = [axes.get_tightbbox() for axes in self.figure.axes]
        for left, right in itertools.pairwise(boxes):
            self.assertLess(left.x1, right.x0)


class TestHistory(unittest.TestCase):
    def test_a_curve_that_stays_where_it_is_stands_clear_of_the_frame(self):
        columns = {"time": [0.0, 0.1, 0.2], "area": [0.999, 1.0, 0.999], "none": [0.0] * 3}
        history = {name: np.array(values) for name, values in columns.items()}
        with mock.patch.object(Figure, "savefig", autospec=True) as save:
            lines = [Measure(name, "-", name, None, name) for name in ("area", "none")]
            plots.plot_history(history, in_plots(lines, history), scratch() / "no.png")
        figure = save.call_args[0][0]
        for axes, top in zip(figure.axes, (1.0, 0.0)):
            low, high = axes.get_ylim()
            self.assertEqual(low, 0)
            self.assertGreater(high - top, 0.03 * (high - low))


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures: the scale bar is as long as it says, and curves stand clear of the frame."""

import unittest
from unittest import mock

import numpy as np
from matplotlib.figure import Figure
from membrane import plots
from mpl_toolkits.mplot3d import proj3d

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


class TestHistory(unittest.TestCase):
    def test_a_curve_that_stays_where_it_is_stands_clear_of_the_frame(self):
        history = {"time": [0.0, 0.1, 0.2], "area": [0.999, 1.0, 0.999], "none": [0.0, 0.0, 0.0]}
        with mock.patch.object(Figure, "savefig", autospec=True) as save:
            plots.plot_history(history, {"area": "area [-]", "none": "none [-]"}, "no.png")
        figure = save.call_args[0][0]
        for axes, top in zip(figure.axes, (1.0, 0.0)):
            low, high = axes.get_ylim()
            self.assertEqual(low, 0)
            self.assertGreater(high - top, 0.03 * (high - low))


if __name__ == "__main__":
    unittest.main()

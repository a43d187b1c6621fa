# SPDX-License-Identifier: GPL-2.0-or-later
"""What a run and a report keep in memory does not grow with all that they have written."""

import gc
import tracemalloc
import unittest
from unittest import mock

import numpy as np
from membrane.files import BadFile
from membrane.measures import SQUARE
from membrane.parameters import SailParameters
from membrane.results.history import read_history
from membrane.run import driver
from membrane.run.record import Recorder
from membrane.study.sweep import pictures
from support import SceneTest, scratch


GRIDS = ((400, 1), (1, 400), (20, 20), (3, 2))  # values of alpha_c and of beta


class TestRecorder(SceneTest):
    def test_shapes_and_rows_are_not_kept_but_can_be_read_back(self):
        sail, built = driver.build(SailParameters())
        recorder = Recorder(scratch() / "memory", sail, built, SQUARE, 1.0)
        start, kept = built.positions(), []
        moving = mock.patch.object(
            built, "last_positions", lambda: start * (1 + 1e-3 * len(recorder.frame_times))
        )
        with moving:

            def record(count):
                for _ in range(count):
                    time = 0.1 * len(recorder.frame_times)
                    kept.append(built.last_positions()[7].tolist())
                    recorder.history(time)
                    recorder.shape(time)
                gc.collect()
                return tracemalloc.get_traced_memory()[0]

            tracemalloc.start()
            try:
                before, after = record(20), record(100)
            finally:
                tracemalloc.stop()
        recorder.close()
        self.assertLess((after - before) / 100, 0.15 * start.nbytes)
        self.assertEqual(len(recorder.frames), 120)
        np.testing.assert_array_equal([x[7] for x in recorder.frames], kept)
        np.testing.assert_array_equal(recorder.columns()["time"], recorder.frame_times)


class TestPictures(unittest.TestCase):
    """Of 400 cases: as large and about as slow as those of some."""

    def draw(self, draw, *arguments):
        """The Figure that `draw` would write."""
        with mock.patch.object(pictures, "save", autospec=True) as save:
            draw(*arguments, "no.png")
        return save.call_args[0][0]

    def test_curves_of_all_cases_are_in_a_few_panels(self):
        for alphas, betas in GRIDS:
            with self.subTest(alphas=alphas, betas=betas):
                curves = {
                    (float(a), float(b)): (np.arange(3.0), np.array([a, b, a * b], dtype=float))
                    for a in range(alphas)
                    for b in range(betas)
                }
                figure = self.draw(pictures.plot_curves, curves, [(0.0, 0.0)], "value")
                self.assertLessEqual(len(figure.axes), pictures.MANY)
                lines = [line.get_ydata() for axes in figure.axes for line in axes.lines]
                drawn = {tuple(values) for values in lines if len(values) == 3}
                self.assertEqual(drawn, {tuple(values) for _, values in curves.values()})
                self.assertEqual(sum(len(values) == 3 for values in lines), alphas * betas)
                (legend,) = filter(None, (axes.get_legend() for axes in figure.axes))
                self.assertLessEqual(len(legend.get_texts()), pictures.MANY + 1)
                self.assertLess(max(figure.get_size_inches()), 16)

    def test_heat_maps_have_numbers_where_these_can_be_read(self):
        for alphas, betas in GRIDS:
            with self.subTest(alphas=alphas, betas=betas):
                values = {(float(a), float(b)): a + b for a in range(alphas) for b in range(betas)}
                words = dict.fromkeys(values, "")
                figure = self.draw(pictures.plot_maps, {"one": values, "two": values}, words)
                self.assertLess(max(figure.get_size_inches()), 40)
                panel = figure.axes[0]
                many = max(alphas, betas) > pictures.MANY
                self.assertEqual(len(panel.texts), 0 if many else alphas * betas)
                self.assertEqual(panel.images[0].get_array().shape, (betas, alphas))
                for axis, count in ((panel.xaxis, alphas), (panel.yaxis, betas)):
                    ticks = axis.get_ticklocs().tolist()
                    self.assertLessEqual(len(ticks), pictures.MANY)
                    labels = [label.get_text() for label in axis.get_ticklabels()]
                    self.assertEqual(labels, [f"{tick:g}" for tick in ticks])
                    self.assertLess(max(ticks), count)


class TestHistory(unittest.TestCase):
    def read(self, *lines):
        path = scratch() / "history.csv"
        path.write_text("".join(line + "\n" for line in lines))
        return {name: values.tolist() for name, values in read_history(path).items()}

    def test_a_table_is_the_same_in_whatever_way_its_numbers_are_written(self):
        expected = {"a": [1 / 3, -1e-300, 5.0], "b": [2.0, 3.0, 1e300]}
        plain = [f"{a!r},{b!r}" for a, b in zip(*expected.values())]
        self.assertEqual(self.read("a,b", *plain), expected)
        quoted = [f'"{a!r}", {b!r} ' for a, b in zip(*expected.values())]
        self.assertEqual(self.read('"a",b', *quoted), expected)
        self.assertEqual(self.read("a,b"), {"a": [], "b": []})

    def test_what_is_no_number_and_rows_of_another_length_are_named(self):
        for line, reason in (
            ("1,nan", "line 3, b: is 'nan'"),
            ("1_0,2", "line 3, a: is '1_0'"),
            ("1", "line 3: has 1 values for 2"),
            ("1,2,3", "line 3: has 3 values for 2"),
            ("", "line 3: has 0 values for 2"),
            ("1,1e400", "line 3, b: is '1e400'"),
            ("x,2", "line 3, a: is 'x'"),
        ):
            with self.assertRaisesRegex(BadFile, reason):
                self.read("a,b", "1,2", line, "3,4")
        with self.assertRaisesRegex(BadFile, "line 2: has 3 values for 2"):
            self.read("a,b", "1,2,3", "4")  # as many values as two rows have


if __name__ == "__main__":
    unittest.main()

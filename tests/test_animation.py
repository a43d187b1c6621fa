# SPDX-License-Identifier: GPL-2.0-or-later
"""The animation: pictures rendered off-screen, and the films made of them."""

import contextlib
import json
import os
import shutil
import signal
import subprocess
from time import sleep
import unittest
from dataclasses import replace
from unittest import mock

import numpy as np
from membrane import animation
from membrane.files import TEMPORARY
from membrane.finished_run import read_run
from membrane.mesh import sail_mesh
from membrane.output import VtkSeries, list_series, read_frame
from support import ROOT, CommandTest, pattern_run, scratch, short_run, yade_environment

MISSING = [program for program in ("Xvfb", "ffmpeg") if not shutil.which(program)]


def probe(path):
    """What ffprobe says of a film's pictures."""
    done = subprocess.run(
        ["ffprobe", "-v", "error", "-count_frames", "-of", "json", "-show_streams", str(path)],
        capture_output=True,
        check=True,
    )
    (stream,) = json.loads(done.stdout)["streams"]
    return stream


def film(image):
    """Share of a picture (height, width, 3) that shows the film's upper side."""
    red, green, blue = np.moveaxis(image.astype(int), -1, 0)
    return np.mean((red > blue + 40) & (green > blue))


def along(ends, share):
    """Points (C, 3) at a share of the length of lines between `ends` (C, 2, 3)."""
    return ends[:, 0] + share * (ends[:, 1] - ends[:, 0])


def on_picture(stage, point):
    """Row and column where a stage's picture shows a point (3,) [m]."""
    stage.renderer.SetWorldPoint(*point, 1)
    stage.renderer.WorldToDisplay()
    x, y, _ = stage.renderer.GetDisplayPoint()
    return animation.SIZE[1] - 1 - int(y), int(x)


@unittest.skipIf(MISSING, f"needs {' and '.join(MISSING)}")
class TestPictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        run = read_run(short_run())
        cls.addClassCleanup(mock.patch.stopall)
        mock.patch.object(animation, "SIZE", (640, 360)).start()
        with animation.virtual_display():
            with contextlib.closing(animation.Stage(run)) as stage:
                cls.first, cls.again, cls.last = (stage.picture(i) for i in (0, 0, 20))
                cls.places = [cls.marked_places(stage, i) for i in (0, 20)]
                camera = stage.renderer.GetActiveCamera()
                cls.pixels_per_metre = 360 / (2 * camera.GetParallelScale())

    @staticmethod
    def marked_places(stage, i):
        """Where shape `i` has its tip masses, the spool's mark, and the spool opposite of it."""
        tips = read_frame(stage.shapes[i][1])[0][stage.run.tips]
        (radius, height), angle = stage.run.spool, stage.run.parameters.omega * stage.shapes[i][0]
        mark = 0.5 * radius * np.array([np.cos(angle), np.sin(angle), 0])
        above = np.array([0, 0, 0.51 * height])
        points = [*tips, above + mark, above - mark]
        return [on_picture(stage, point) for point in points]

    def test_tip_masses_and_the_turning_spool_are_where_they_are(self):
        for image, places in zip((self.first, self.last), self.places):
            *tips, mark, spool = [image[place].astype(int) for place in places]
            self.assertEqual(len(tips), 4)
            for colour in tips:
                self.assertLess(colour.max(), 90)
            self.assertGreater(mark.min(), 200)
            self.assertTrue(90 < spool.min() <= spool.max() < 160, spool)

    def test_sail_opens_and_is_shaded(self):
        self.assertEqual(self.first.shape, (360, 640, 3))
        self.assertGreater(film(self.first), 0.005)
        self.assertGreater(film(self.last), 3 * film(self.first))
        self.assertGreater(len(np.unique(self.last.reshape(-1, 3), axis=0)), 100)

    def test_view_holds_a_sail_that_hangs_low_or_flies_high(self):
        shapes = list_series(short_run() / "shapes" / "film.pvd")
        positions, _ = read_frame(shapes[-1][1])
        series = VtkSeries(scratch() / "far", "film", sail_mesh().triangles)
        for time, lift in enumerate((-0.3, 0.3)):
            series.write(time, positions + [0, 0, lift])
        with animation.virtual_display():
            far = list_series(scratch() / "far" / "film.pvd")
            run = replace(read_run(short_run()), shapes=far)
            with contextlib.closing(animation.Stage(run)) as stage:
                pictures = [stage.picture(i) for i in range(2)]
        for image in pictures:
            self.assertGreater(film(image), 0.01)
            for edge in (image[:2], image[-2:], image[:, :2], image[:, -2:]):
                self.assertEqual(film(edge), 0)
        low, high = pictures
        self.assertEqual([film(low[:180]), film(high[180:])], [0, 0])

    def test_sail_from_a_pattern_is_shown_without_a_spool(self):
        with animation.virtual_display():
            with contextlib.closing(animation.Stage(read_run(pattern_run()))) as stage:
                picture = stage.picture(0)
        self.assertGreater(film(picture), 0.01)
        metal = np.all(np.abs(picture.astype(int) - [105, 112, 130]) < 12, axis=-1)
        self.assertLess(np.mean(metal), 1e-3)

    def test_fold_lines_are_seen_along_their_whole_length_on_all_petals(self):
        mesh = sail_mesh()
        series = VtkSeries(scratch() / "flat", "film", mesh.triangles)
        series.write(0.0, mesh.nodes)
        flat = list_series(scratch() / "flat" / "film.pvd")
        run = replace(read_run(short_run()), shapes=flat, spool=(1e-6, 1e-6))  # it hides nothing
        with animation.virtual_display():
            with contextlib.closing(animation.Stage(run)) as stage:
                bright = stage.picture(0).astype(int).sum(axis=2)
                ends = mesh.nodes[mesh.creases]
                places = [on_picture(stage, x) for t in (0.2, 0.5, 0.8) for x in along(ends, t)]
                offside = [on_picture(stage, x) for x in mesh.nodes[mesh.triangles].mean(axis=1)]
        film = np.median([bright[row, column] for row, column in offside])
        dark = [bright[r - 1 : r + 2, c - 1 : c + 2].min() < 0.7 * film for r, c in places]
        self.assertGreater(len(dark), 1000)
        self.assertGreater(np.mean(dark), 0.99)

    def test_same_shape_gives_the_same_picture(self):
        np.testing.assert_array_equal(self.first, self.again)

    def test_scale_bar_is_as_long_as_it_says(self):
        corner = self.first[320:345, :200].max(axis=2) < 90
        bar = np.flatnonzero(corner.sum(axis=1) == corner.sum(axis=1).max())
        length = corner[bar[0]].sum() / self.pixels_per_metre
        self.assertAlmostEqual(length, 0.1, delta=2.5 / self.pixels_per_metre)

    def test_time_is_written_and_changes(self):
        clocks = [image[:50, :200].max(axis=2) < 120 for image in (self.first, self.last)]
        self.assertGreater(clocks[0].sum(), 50)
        self.assertGreater(np.sum(clocks[0] != clocks[1]), 20)


@unittest.skipIf(MISSING, f"needs {' and '.join(MISSING)}")
class TestFilms(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.before = os.environ.get("DISPLAY")
        cls.made = animation.animate(short_run())

    def test_mp4_plays_everywhere_and_has_a_picture_for_each_shape(self):
        stream = probe(self.made[0])
        self.assertEqual(stream["codec_name"], "h264")
        self.assertEqual(stream["pix_fmt"], "yuv420p")
        self.assertEqual((stream["width"], stream["height"]), animation.SIZE)
        self.assertEqual(stream["nb_read_frames"], "21")
        self.assertEqual(stream["r_frame_rate"], "25/1")
        film = self.made[0].read_bytes()
        self.assertTrue(0 < film.find(b"moov") < film.find(b"mdat"))  # plays while it loads

    def test_gif_is_small_and_takes_as_long(self):
        mp4, gif = (probe(path) for path in self.made)
        self.assertEqual(gif["codec_name"], "gif")
        self.assertLess(self.made[1].stat().st_size, 3e6)
        self.assertAlmostEqual(float(gif["duration"]), float(mp4["duration"]), delta=0.05)

    def test_display_is_given_back(self):
        self.assertEqual(os.environ.get("DISPLAY"), self.before)

    def test_long_films_become_gifs_of_fewer_and_smaller_pictures(self):
        gif = scratch() / "small.gif"
        limits = {"GIF_LARGEST": 30e3, "GIF_PICTURES": 8}
        with mock.patch.multiple(animation, **limits):
            animation._write_gif(self.made[0], gif, 21)
        stream = probe(gif)
        self.assertEqual(stream["nb_read_frames"], "7")
        self.assertLess(stream["width"], animation.GIF_WIDTHS[0])
        self.assertAlmostEqual(float(stream["duration"]), 21 / 25, delta=0.1)


class TestPace(unittest.TestCase):
    def test_film_tells_how_much_slower_it_is_however_steps_fall(self):
        self.assertEqual(animation.pace([0, 0.01, 0.02]), "slowed down 4 times")
        self.assertEqual(animation.pace([0, 0.010003, 0.020048]), "slowed down 4 times")
        self.assertEqual(animation.pace([0, 0.5, 1.0005]), "speeded up 12.5 times")
        for real in ([0, 0.04, 0.08], [0, 0.0401], [1.0]):
            self.assertEqual(animation.pace(real), "")


class TestWithoutTools(unittest.TestCase):
    def test_missing_program_is_named_with_its_package(self):
        with mock.patch.object(animation.shutil, "which", return_value=None):
            with self.assertRaisesRegex(RuntimeError, "Xvfb .apt-get install xvfb"):
                animation.animate(scratch())


class TestCommand(CommandTest):
    def test_folder_without_a_run_ends_with_one_sentence(self):
        self.ends_without_a_run("animate")

    @unittest.skipIf(MISSING, f"needs {' and '.join(MISSING)}")
    def test_control_c_leaves_earlier_films_and_nothing_that_runs(self):
        folder = scratch() / "stopped_animation"
        shutil.copytree(short_run(), folder)
        for name in animation.FILES:
            (folder / name).write_text("made before")
        before = sorted(path.name for path in folder.iterdir())
        process = subprocess.Popen(
            ["yade", "-n", "-x", ROOT / "scripts" / "animate.py", folder],
            env=yade_environment(),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        while process.poll() is None and not list(folder.glob(f"{TEMPORARY}*")):
            sleep(0.01)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        said, _ = process.communicate()  # until no process holds its output
        self.assertEqual(process.returncode, 130, said)
        self.assertRegex(said.strip().splitlines()[-1], "^animate: stopped by Ctrl-C")
        self.assertEqual(sorted(path.name for path in folder.iterdir()), before)
        for name in animation.FILES:
            self.assertEqual((folder / name).read_text(), "made before")


if __name__ == "__main__":
    unittest.main()

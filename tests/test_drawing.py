# SPDX-License-Identifier: GPL-2.0-or-later
"""What YADE's own window shows of a membrane: pictures from a virtual screen, pixel by pixel."""

import json
import os
import shutil
import signal
import subprocess
import unittest
from functools import lru_cache

import membrane
import numpy as np
from matplotlib.image import imread
from membrane.view import window
from support import ROOT, SceneTest, of_the_view, run_yade, scratch, yade_environment

BACKGROUND = 0.2  # grey, of YADE's window
WATCHDOG = 600  # s, after which a window that hangs is killed
DRAWING = ROOT / "tests" / "drawn_scenes.py"


def run_on_screen(*command):
    """Run YADE on a virtual screen of its own; returns status, output."""
    if not shutil.which("xvfb-run"):
        raise RuntimeError("xvfb-run is missing: apt-get install xvfb xauth")
    screen = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", "yade", "-x", "-j1"]
    process = subprocess.Popen(
        [*screen, *map(str, command)],
        cwd=scratch(),
        env={**yade_environment(), "LIBGL_ALWAYS_SOFTWARE": "1"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,  # so that the screen goes with it
    )
    try:
        said, _ = process.communicate(timeout=WATCHDOG)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        raise
    return process.returncode, said


@lru_cache(maxsize=None)
def drawn():
    """Folder of pictures, facts about them, and what YADE said."""
    folder = scratch() / "drawn"
    folder.mkdir()
    status, said = run_on_screen(DRAWING, folder)
    if status:
        raise RuntimeError(f"YADE ended with {status}: {said}")
    return folder, json.loads((folder / "facts.json").read_text()), said


def picture(name):
    """Pixels (H, W, 3) of a picture, 0 to 1, the first row on top."""
    return imread(drawn()[0] / f"{name}.png")[:, :, :3].astype(float)


def painted(pixels):
    """Which pixels (H, W) are not background."""
    return np.abs(pixels - BACKGROUND).max(axis=2) > 0.01


def extent(pixels, scale="half"):
    """Left, right, lower, upper edge [m] of what is painted, as the pictures' scale has it."""
    half = drawn()[1][scale]
    mask = painted(pixels)
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    scale = 2 * half / len(mask)
    left, right = scale * columns[0] - half, scale * (columns[-1] + 1) - half
    lower, upper = half - scale * (rows[-1] + 1), half - scale * rows[0]
    return np.array([left, right, lower, upper])


def pixel(pixels, x, y):
    """Colour (3,) at a place [m] of a picture seen from the top."""
    half = drawn()[1]["half"]
    size = len(pixels)
    return pixels[int((half - y) / (2 * half) * size), int((half + x) / (2 * half) * size)]


def film_colour(name):
    """Colour (3,) in the middle of a cell of the sheet, a little off the diagonal."""
    (x, y, _), size = drawn()[1]["corner"], drawn()[1]["size"]
    return pixel(picture(name), x + 0.47 * size, y + 0.39 * size)


def vividness(colour):
    """Largest less smallest of red, green and blue."""
    return np.ptp(colour)


def brightness(colour):
    """Luminance of a colour."""
    return np.dot(colour, (0.2126, 0.7152, 0.0722))


@of_the_view
class TestPictures(unittest.TestCase):
    two_pixels = 2 / 600  # m

    @classmethod
    def setUpClass(cls):
        drawn()

    def test_the_film_is_where_it_is_and_fills_its_outline(self):
        (x, y, _), size = drawn()[1]["corner"], drawn()[1]["size"]
        pixels = picture("strain_0")
        np.testing.assert_allclose(
            extent(pixels), [x, x + size, y, y + size], rtol=0, atol=self.two_pixels
        )
        self.assertAlmostEqual(painted(pixels).mean(), size**2, delta=4 * size * self.two_pixels)

    def test_film_at_one_strain_has_one_colour(self):
        pixels = picture("strain_2")
        self.assertLess(np.ptp(pixels[painted(pixels)], axis=0).max(), 0.01)

    def test_colour_follows_the_strain_from_dark_to_bright(self):
        colours = [film_colour(f"strain_{i}") for i in range(5)]
        steps = np.diff([brightness(c) for c in colours])
        self.assertGreater(steps.min(), 0.05)
        for i, one in enumerate(colours):
            for other in colours[:i]:
                self.assertGreater(np.abs(one - other).max(), 0.15)

    def test_legend_shows_the_films_colour_where_its_strain_is(self):
        pixels = picture("legend")
        corner = np.index_exp[-120:, -240:]  # below the sheet
        here = np.abs(pixels[corner] - film_colour("legend")).max(axis=2) < 0.02
        rows = np.flatnonzero(here.any(axis=1))
        self.assertGreater(len(rows), 5, "the legend has no such colour")
        row = pixels[corner][rows[len(rows) // 2]]
        bar = np.flatnonzero(np.ptp(row, axis=1) > 0.2)
        place = np.flatnonzero(here[rows[len(rows) // 2]]).mean()
        self.assertAlmostEqual((place - bar[0]) / np.ptp(bar), 0.5, delta=0.05)
        beyond = painted(pixels) & ~painted(picture("strain_2"))
        self.assertFalse(beyond[:-120].any() or beyond[:, :-240].any())

    def test_automatic_range_is_the_next_round_number(self):
        self.assertAlmostEqual(drawn()[1]["automatic_range"], 5e-4, delta=1e-12)
        np.testing.assert_allclose(
            film_colour("automatic"), film_colour("strain_2"), rtol=0, atol=0.01
        )

    def test_buckled_film_is_dull(self):
        taut, wrinkled = film_colour("strain_2"), film_colour("wrinkled")
        self.assertLess(vividness(wrinkled), 0.5 * vividness(taut))
        self.assertEqual(np.argmax(wrinkled), np.argmax(taut))
        self.assertLess(vividness(film_colour("slack")), 0.5 * vividness(film_colour("strain_0")))

    def test_film_of_plane_stress_is_dull_unless_taut(self):
        taut = film_colour("film_taut")
        np.testing.assert_allclose(taut, film_colour("strain_2"), rtol=0, atol=0.02)
        self.assertLess(vividness(film_colour("film_wrinkled")), 0.5 * vividness(taut))
        self.assertLess(
            vividness(film_colour("film_slack")), 0.5 * vividness(film_colour("strain_0"))
        )

    def test_outlines_leave_the_inside_of_triangles_free(self):
        filled, outlined = picture("strain_2"), picture("outlines")
        share = painted(outlined).sum() / painted(filled).sum()
        self.assertLess(share, 0.3)
        self.assertGreater(share, 0.02)
        np.testing.assert_allclose(extent(outlined), extent(filled), rtol=0, atol=self.two_pixels)

    def test_creases_turn_from_white_to_red_as_they_close(self):
        (x, y, _), size = drawn()[1]["corner"], drawn()[1]["size"]
        whiteness = []
        for i, angle in enumerate(drawn()[1]["angles"]):
            pixels = picture(f"crease_{i}")
            colour = pixel(pixels, x + 0.5 * size, y + 0.4 * size)
            self.assertGreater(colour[0], 0.8)
            self.assertGreaterEqual(colour[1], colour[2])
            whiteness.append(0.5 * (colour[1] + colour[2]))
            right = x + 0.5 * size * (1 + max(0, -np.cos(angle)))
            self.assertAlmostEqual(extent(pixels)[1], right, delta=2 * self.two_pixels)
        self.assertGreater(whiteness[0], 0.98)
        self.assertLess(whiteness[-1], 0.15)
        self.assertLess(np.diff(whiteness).max(), -0.1)

    def test_spheres_of_the_nodes_are_hidden_unless_asked_for(self):
        size = drawn()[1]["size"]
        np.testing.assert_array_equal(picture("spheres_hidden"), picture("strain_0"))
        shown = painted(picture("spheres_shown"))
        self.assertGreater(shown.mean(), size**2 + 3 * size * 0.03)

    def test_picture_in_the_middle_of_a_run_is_up_to_date(self):
        for path in ("law2", "fused"):
            with self.subTest(path):
                run = drawn()[1][path]
                within = self.two_pixels * drawn()[1]["wide"] / drawn()[1]["half"]
                left = extent(picture(f"flight_{path}"), "wide")[0]
                earliest, latest = (
                    run["start"] + run["speed"] * run[t] for t in ("before", "after")
                )
                self.assertGreater(earliest - run["start"], 0.04)
                self.assertGreater(left, earliest - within)
                self.assertLess(left, latest + within)
                self.assertGreater(run["end"], latest)
                landed = extent(picture(f"landed_{path}"), "wide")[0]
                self.assertAlmostEqual(landed, run["end"], delta=within)
        self.assertEqual(drawn()[1]["fused"]["bodies"], 0, "the bodies were current without it")

    def test_drawing_changes_no_bit_of_the_motion(self):
        for path in ("law2", "fused"):
            run = drawn()[1][path]
            self.assertEqual(run["steps"][0], run["steps"][1], path)
            self.assertTrue(run["same"], path)

    def test_folded_sail_is_a_cross_with_closed_creases_and_flat_a_square_with_open_ones(self):
        folded, flat = picture("sail_folded"), picture("sail_flat")
        width = 2 * 0.35 / len(flat)  # m a pixel
        area = 0.455**2 - 0.103**2  # of the film [m2], Table 1
        self.assertAlmostEqual(painted(flat).sum() * width**2, area, delta=0.04 * area)
        self.assertLess(painted(folded).sum(), 0.25 * painted(flat).sum())

        def reddish(pixels):
            return (pixels[:, :, 0] > 0.7) & (pixels[:, :, 2] < 0.3) & (pixels[:, :, 1] < 0.5)

        def whitish(pixels):
            return pixels.min(axis=2) > 0.9

        self.assertGreater(reddish(folded).sum(), 300)
        self.assertLess(reddish(flat).sum(), 30)
        self.assertGreater(whitish(flat).sum(), 3000)

    def test_a_membrane_that_cannot_be_drawn_ends_its_drawer_and_not_yade(self):
        _, facts, said = drawn()
        self.assertTrue(facts["dead"])
        self.assertIn("no longer drawn", said)
        self.assertIn("is not in the scene", said)

    def test_watched_deployment_is_drawn_as_it_goes_until_the_user_closes_the_window(self):
        facts = drawn()[1]
        self.assertGreater(facts["frames"][-1], facts["frames"][0])
        film = picture("watched")[:-120]  # without the legend
        self.assertGreater(painted(film).sum(), 2000)
        reddish = (film[:, :, 0] > 0.7) & (film[:, :, 2] < 0.3) & (film[:, :, 1] < 0.5)
        self.assertGreater(reddish.sum(), 300)
        self.assertTrue(facts["closed"])


class TestWithoutDisplay(SceneTest):
    @of_the_view
    def test_drawer_exists_and_refuses_a_bad_range(self):
        self.assertEqual(membrane.GlExtra_Membrane(strainRange=1e-5).strainRange, 1e-5)
        for bad in (-1e-9, float("nan"), float("inf")):
            with self.assertRaisesRegex(ValueError, r"strainRange = .* must be finite and >= 0"):
                membrane.GlExtra_Membrane(strainRange=bad)

    def test_window_says_that_there_is_no_display(self):
        for make in (window.show, window.Watch):
            with self.assertRaisesRegex(RuntimeError, "without a display"):
                make()

    def test_watch_says_so_before_anything_is_built(self):
        done = run_yade(ROOT / "scripts" / "deploy.py", "--watch", "--out", "unseen")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("deploy: window: YADE runs without a display", done.stderr)
        self.assertFalse((scratch() / "unseen").exists())


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""report.html: what it holds of a run, and how it behaves in a browser without a screen."""

import base64
import html
import io
import json
import re
import shutil
import time
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.image import imread
from membrane.geometry import crease_angles
from membrane.mesh import sail_mesh
from membrane.parameters import SailParameters
from membrane.results.output import list_series, read_frame, read_history
from membrane.run import driver
from membrane.study.sweep.page import render
from membrane.study.sweep.report import report as sweeping_report
from membrane.view import plots, report
from support import CommandTest, free_hub_run, pattern_run, scratch, short_run
from test_sweep import two_cases


try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import Select, WebDriverWait
except ImportError:
    webdriver = None

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
VIRIDIS = colormaps["viridis"](np.arange(256))[:, :3]
PATIENCE = 60  # with a browser that draws in software, on a machine that does other things [s]
SWITCHES = (
    "--headless=new",
    "--no-sandbox",  # it does not start as root otherwise
    "--disable-dev-shm-usage",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)


def unpacked(text, kind):
    """Array from the page's base64."""
    return np.frombuffer(base64.b64decode(text), dtype=kind)


def hue(colours):
    """Directions (n, 3) of colours (n, 3) in linear light: the same however bright it is."""
    linear = np.where(colours > 0.04045, ((colours + 0.055) / 1.055) ** 2.4, colours / 12.92)
    return linear / np.linalg.norm(linear, axis=1)[:, None]


class FirstView:
    """The page's first view of the short run, on a canvas of `shape` (height, width, 3)."""

    def __init__(self, shape):
        self.height, self.width, _ = shape
        shapes = list_series(short_run() / "shapes" / "film.pvd")
        reach = max(np.linalg.norm(read_frame(path)[0], axis=1).max() for _, path in shapes)
        elevation, azimuth, half = np.radians([32, -65, 14])
        across = np.cos(elevation) * np.array([np.cos(azimuth), np.sin(azimuth)])
        towards = np.array([*across, np.sin(elevation)])
        right = np.cross([0, 0, 1], towards)
        right /= np.linalg.norm(right)
        self.axes = np.array([right, np.cross(towards, right), towards])
        self.distance = 1.04 * reach / np.tan(half)  # of the eye [m]
        self.scale = 0.5 * self.height / np.tan(half)  # pixels of 1 m in 1 m distance

    def colour(self, image, point):
        """Colour (3,) of an image where it shows a point (3,) [m]."""
        x, y, z = self.axes @ point
        pixels = self.scale / (self.distance - z) * np.array([x, y])
        return image[round(0.5 * self.height - pixels[1]), round(0.5 * self.width + pixels[0])]


class TestReportData(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.data = report.run_data(short_run())
        cls.shapes = list_series(short_run() / "shapes" / "film.pvd")
        cls.mesh = sail_mesh()

    def levels(self, packed):
        values = unpacked(packed["data"], "u1").reshape(len(self.shapes), -1)
        return packed["low"] + (packed["high"] - packed["low"]) * values / 255

    def test_positions_are_those_of_the_shapes_within_ten_micrometres(self):
        self.assertEqual(self.data["times"], [time for time, _ in self.shapes])
        packed = self.data["positions"]
        held = packed["unit"] * unpacked(packed["data"], "<i2").reshape(21, -1, 3)
        true = np.array([read_frame(path)[0] for _, path in self.shapes])
        self.assertGreater(np.ptp(true), 0.3)
        self.assertLess(np.abs(held - true).max(), 1e-5)

    def test_fields_are_those_of_the_shapes_within_half_a_level(self):
        factors = {"side_strain": 1e6, "tension": 1e3, "buckled": 100, "crease_angle": 180 / np.pi}
        self.assertEqual([field["name"] for field in self.data["fields"]], list(factors))
        for field in self.data["fields"]:
            name, low, high = field["name"], field["low"], field["high"]
            true = np.array([read_frame(path)[1][name] for _, path in self.shapes])
            true = np.clip(factors[name] * true.astype(float), low, high)
            held = self.levels(field)
            self.assertGreater(np.ptp(held), 0.5 * (high - low), name)
            self.assertLess(np.abs(held - true).max(), 0.501 * (high - low) / 255, name)

    def test_fold_lines_come_with_their_signs_and_angles(self):
        mesh = self.mesh
        pairs = unpacked(self.data["creases"], "<u4").reshape(-1, 2).tolist()
        place = {tuple(sorted(pair)): i for i, pair in enumerate(pairs)}
        order = [place[tuple(sorted(pair))] for pair in mesh.creases.tolist()]
        self.assertEqual(sorted(order), list(range(len(pairs))))
        signs = np.array(self.data["creaseSigns"])[order]
        self.assertEqual(signs.tolist(), mesh.crease_signs.tolist())
        last, _ = read_frame(self.shapes[-1][1])
        true = np.degrees(crease_angles(last, mesh.triangles, mesh.creases, mesh.crease_signs))
        held = self.levels(self.data["creaseAngles"])[-1][order]
        self.assertGreater(np.ptp(held), 90)
        self.assertLess(np.abs(held - np.clip(true, 0, 180)).max(), 0.4)

    def test_curves_are_the_history(self):
        history = read_history(short_run() / "history.csv")
        rate, phase, *_ = self.data["curves"]
        np.testing.assert_allclose(self.data["historyTimes"], history["time"], rtol=1e-5)
        held = rate["lines"][0]["values"]
        np.testing.assert_allclose(held, history["deployment_rate"], rtol=1e-5)
        held = np.radians(phase["lines"][0]["values"])
        self.assertGreater(np.ptp(held), 0.1)
        np.testing.assert_allclose(held, history["phase_difference"], rtol=1e-5)

    def test_table_of_parameters_names_all_and_marks_what_is_not_the_default(self):
        _, parameters = self.data["tables"]
        rows = {row[0]: row for row in parameters["rows"]}
        self.assertEqual(list(rows), list(SailParameters().as_dict()))
        self.assertEqual(rows["duration"][1:3], ["0.1 (default 1)", "s"])
        self.assertEqual(rows["omega"][1:3], ["18.8496", "rad/s"])

    def test_large_runs_keep_evenly_spaced_shapes_up_to_the_last(self):
        self.assertEqual(report.thinned(list(range(21)), 100, largest=2100), list(range(21)))
        self.assertEqual(report.thinned(list(range(21)), 100, largest=2000), list(range(0, 21, 2)))
        self.assertEqual(
            report.thinned(list(range(20)), 100, largest=700), [1, 4, 7, 10, 13, 16, 19]
        )
        self.assertEqual(report.thinned(list(range(21)), 100, largest=1), [9, 20])


class TestOtherRuns(unittest.TestCase):
    def labels(self, data):
        """Of the curves, and of the measures."""
        return [curve["label"] for curve in data["curves"]], [
            row[0] for row in data["tables"][0]["rows"]
        ]

    def test_sail_from_a_pattern_has_its_own_curves_and_no_spool(self):
        data = report.run_data(pattern_run())
        curves, measures = self.labels(data)
        self.assertEqual(
            curves,
            ["radius", "area over flat area", "crease angle", "spin", "energy", "film strain"],
        )
        self.assertIn("spin at the end", measures)
        energy = [line["label"] for line in data["curves"][-2]["lines"]]
        self.assertEqual(energy, ["kinetic", "elastic", "creases", "damping work"])
        self.assertIsNone(data["spool"])
        self.assertEqual(len(data["tips"]), 4)
        self.assertEqual(len(data["times"]), 5)
        # It begins at 60 rad/s and slows down as it opens.
        turned = np.array(data["turned"])
        self.assertEqual(turned[0], 0)
        self.assertTrue((np.diff(turned) > 0).all())
        self.assertTrue(0.5 * 60 * 0.02 < turned[-1] < 60 * 0.02, turned)

    def test_free_hub_turns_as_it_did(self):
        data = report.run_data(free_hub_run())
        self.assertIn("hub", self.labels(data)[0])
        history = read_history(free_hub_run() / "history.csv")
        spins = (history["hub_spin"][1:] + history["hub_spin"][:-1]) / 2
        turned = np.append(0, np.cumsum(spins * np.diff(history["time"])))
        expected = np.interp(data["times"], history["time"], turned)
        np.testing.assert_allclose(data["turned"], expected, atol=1e-3)
        steady = SailParameters().omega * np.array(data["times"])
        self.assertGreater(np.abs(expected - steady).max(), 0.05)

    def test_damaged_results_are_refused_with_the_name_of_the_file(self):
        summary = json.loads((short_run() / "summary.json").read_text())
        other = {**summary, "mesh": {**summary["mesh"], "nodes": 7}}
        history = (short_run() / "history.csv").read_text()
        film = (short_run() / "shapes" / "film.pvd").read_text()
        shape = (short_run() / "shapes" / "film_000003.vtu").read_bytes()
        line = next(line for line in film.splitlines() if "film_000001" in line)
        for name, content in (
            ("summary.json", "{}"),
            ("summary.json", "[]"),
            ("summary.json", '{"parameters": null}'),
            ("summary.json", '{"parameters": {"unit": 1}}'),
            ("summary.json", json.dumps(summary)[:200]),
            ("summary.json", json.dumps(other)),
            ("history.csv", history[:-10]),
            ("history.csv", history.splitlines()[0] + "\n"),
            ("history.csv", history.replace("time", "tame", 1)),
            ("shapes/film.pvd", film[:200]),
            ("shapes/film.pvd", film.replace(line, "", 1).replace("DataSet", "Other")),
            ("shapes/film.pvd", film.replace('timestep="0.0"', 'timestep="nan"', 1)),
            ("shapes/film.pvd", film.replace("film_000001", "../film_000001", 1)),
            ("shapes/film.pvd", film.replace("film_000001", "sides_000001", 1)),
            ("shapes/film_000003.vtu", shape[: len(shape) // 2]),
            ("shapes/sides_000000.vtu", shape),
        ):
            folder = scratch() / "damaged"
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(short_run(), folder)
            data = content if isinstance(content, bytes) else content.encode()
            self.assertNotEqual(data, (folder / name).read_bytes())
            (folder / name).write_bytes(data)
            with self.subTest(name=name, content=content[:60]):
                with self.assertRaises((ValueError, OSError)) as caught:
                    report.run_data(folder)
                said = str(caught.exception)
                wanted = "sides_000001" if "sides_000001" in str(content) else Path(name).name
                self.assertIn(wanted, said)
                self.assertEqual(len(said.splitlines()), 1)


class TestReportWithoutViewer(unittest.TestCase):
    def test_deployment_goes_on_says_why_and_leaves_no_older_page(self):
        folder = scratch() / "no_viewer"
        folder.mkdir()
        (folder / "report.html").write_text("of an earlier run")
        said = io.StringIO()
        with mock.patch.object(report, "TEMPLATE", folder / "absent.html"):
            with mock.patch("sys.stderr", said):
                driver.write_page(folder)
        self.assertRegex(said.getvalue(), "no report.html: .*scripts/run.sh viewer")
        self.assertFalse((folder / "report.html").exists())


@unittest.skipUnless(webdriver and BROWSER and DRIVER, "needs chromium, chromium-driver, selenium")
@unittest.skipUnless(report.TEMPLATE.is_file(), "the viewer is not built: scripts/run.sh viewer")
class TestReportInBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.page = report.write_report(short_run())
        options = webdriver.ChromeOptions()
        options.binary_location = BROWSER
        for switch in SWITCHES:
            options.add_argument(switch)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        cls.driver = webdriver.Chrome(options=options, service=Service(DRIVER))
        cls.addClassCleanup(cls.driver.quit)

    def setUp(self):
        self.resize(1280, 800)
        self.driver.get(self.page.as_uri())
        self.await_(lambda: self.clock() == 0.0)

    def resize(self, width, height):
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)

    def find(self, id_):
        return self.driver.find_element(By.ID, id_)

    def await_(self, happens):
        WebDriverWait(self.driver, PATIENCE, poll_frequency=0.1).until(lambda _: happens())

    def clock(self):
        """The time shown [s]."""
        shown = re.fullmatch(r"t = (\d+\.\d+) s", self.find("clock").text)
        return float(shown[1]) if shown else None

    def canvas(self):
        """The sail as drawn, with what lies over it: (height, width, 3), 0 to 1."""
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done));"
        )
        return imread(io.BytesIO(self.find("scene").screenshot_as_png), format="png")[..., :3]

    def picture(self):
        """The sail as drawn, without what lies over its edges: (height, width, 3), 0 to 1."""
        return self.canvas()[60:-60]

    def golden(self, image):
        """Share of the picture that shows the film."""
        red, _, blue = np.moveaxis(image, -1, 0)
        return np.mean(red > blue + 0.2)

    def changed(self, before, after):
        """Share of the pixels that differ."""
        self.assertEqual(before.shape, after.shape)
        return np.mean(np.abs(before - after).max(axis=2) > 0.05)

    def cursors(self):
        """Where the plots' cursors stand [pixels]."""
        lines = self.driver.find_elements(By.CSS_SELECTOR, ".plot .cursor")
        return [float(line.get_attribute("x1")) for line in lines]

    def test_it_loads_without_an_error_and_without_the_network(self):
        self.driver.get_log("browser"), self.driver.get_log("performance")
        self.driver.get(self.page.as_uri())
        self.await_(lambda: self.clock() == 0.0)
        self.assertGreater(self.golden(self.picture()), 0)
        bad = [entry for entry in self.driver.get_log("browser") if entry["level"] != "INFO"]
        self.assertEqual(bad, [])
        messages = [json.loads(entry["message"]) for entry in self.driver.get_log("performance")]
        asked = [
            message["message"]["params"]["request"]["url"]
            for message in messages
            if message["message"]["method"] == "Network.requestWillBeSent"
        ]
        self.assertEqual(asked, [self.page.as_uri()])

    def test_links_of_a_sweep_lead_to_the_case_whatever_it_is_called(self):
        folder = scratch() / "odd_names"
        case = two_cases() / "cases" / "alpha_crease_10"
        names = ("javascript:document.title='run'", "a#b?c%20d", "<b>&\"'", "-ä x")
        for name in names:
            shutil.copytree(case, folder / name)
            (folder / name / "report.html").write_text(f"<meta charset=utf-8>{html.escape(name)}")
            plots.save(Figure(figsize=(1, 1)), folder / name / "shapes.png")
        sweeping_report(folder)
        page = folder / "report.html"
        self.driver.get(page.as_uri())
        count = len(self.driver.find_elements(By.CSS_SELECTOR, "td a"))
        self.assertEqual(count, len(names))
        for image in self.driver.find_elements(By.TAG_NAME, "img"):
            self.driver.execute_script("arguments[0].loading = 'eager';", image)
            self.await_(lambda: int(image.get_attribute("naturalWidth")) > 0)
        for number in range(count):
            self.driver.get(page.as_uri())
            link = self.driver.find_elements(By.CSS_SELECTOR, "td a")[number]
            name = link.text
            link.click()
            self.await_(lambda: self.driver.current_url != page.as_uri())
            self.assertEqual(self.driver.find_element(By.TAG_NAME, "body").text, name)

    def test_nothing_in_the_page_of_a_sweep_can_run(self):
        folder = scratch() / "page_with_scripts"
        shutil.copytree(two_cases(), folder)
        sweeping_report(folder)
        page = folder / "report.html"
        script = "<script>document.title = 'run'</script><a id=x href=\"javascript:document.title="
        page.write_text(page.read_text().replace("<h1>", script + "'run'\">x</a><h1>", 1))
        self.driver.get(page.as_uri())
        self.find("x").click()
        self.assertRegex(self.driver.title, "^Sweep over")

    def test_error_in_a_page_would_be_seen(self):
        self.driver.get_log("browser")
        self.driver.execute_script("setTimeout(() => { throw new Error('on purpose'); });")
        self.await_(lambda: any(e["level"] == "SEVERE" for e in self.driver.get_log("browser")))

    def test_canvas_shows_the_shaded_sail(self):
        image = self.picture()
        self.assertGreater(self.golden(image), 0.01)
        self.assertLess(self.golden(image), 0.5)
        shades = np.unique((image[image[..., 0] > image[..., 2] + 0.2] * 255).astype(int), axis=0)
        self.assertGreater(len(shades), 10)

    def test_tip_masses_spool_and_scale_are_where_they_are(self):
        (_, first), *_, (end, last) = list_series(short_run() / "shapes" / "film.pvd")
        mesh, p = sail_mesh(), SailParameters()
        for key, now, path in ((Keys.HOME, 0.0, first), (Keys.END, end, last)):
            self.find("slider").send_keys(key)
            image = self.canvas()
            view = FirstView(image.shape)
            tips = [view.colour(image, tip) for tip in read_frame(path)[0][mesh.tips]]
            self.assertGreaterEqual(sum(colour.max() < 0.35 for colour in tips), 3)  # before film
            along = 0.5 * p.spool_radius * np.array([np.cos(p.omega * now), np.sin(p.omega * now)])
            mark, opposite = ([*place, 0.51 * p.spool_height] for place in (along, -along))
            self.assertGreater(view.colour(image, mark).min(), 0.75)
            grey = view.colour(image, opposite)
            self.assertTrue(0.25 < grey.min() <= grey.max() < 0.6, grey)
        length, unit = self.find("scale-bar").text.split()
        self.assertEqual(unit, "mm")
        wide = view.scale / view.distance * float(length) / 1000
        self.assertAlmostEqual(self.find("scale-bar").rect["width"], wide, delta=1)

    def test_dragging_turns_the_sail_and_reset_turns_it_back(self):
        before = self.picture()
        self.assertEqual(self.changed(before, self.picture()), 0)
        drag = ActionChains(self.driver, duration=50).move_to_element(self.find("scene"))
        drag.click_and_hold().move_by_offset(80, 30).move_by_offset(80, 30).release().perform()
        turned = self.picture()
        self.assertGreater(self.changed(before, turned), 0.02)
        self.assertGreater(self.golden(turned), 0.01)
        self.find("reset").click()
        self.assertLess(self.changed(before, self.picture()), 0.001)

    def test_slider_changes_time_and_shape(self):
        folded, start = self.picture(), self.cursors()
        slider = self.find("slider")
        slider.send_keys(Keys.ARROW_RIGHT)
        self.assertEqual(self.clock(), 0.005)
        slider.send_keys(Keys.END)
        self.assertEqual(self.clock(), 0.1)
        opened = self.picture()
        self.assertGreater(self.golden(opened), 2 * self.golden(folded))
        self.assertGreater(self.cursors()[0], start[0] + 100)

    def test_moving_along_each_curve_moves_the_sail(self):
        shapes = [self.picture()]
        svgs = self.driver.find_elements(By.CSS_SELECTOR, ".plot svg")
        self.assertEqual(len(svgs), 4)
        for svg in svgs:
            times = []
            for share in (-0.2, 0.2, 0.47):  # of the width, from the middle
                aside = round(share * svg.rect["width"])
                ActionChains(self.driver, duration=20).move_to_element_with_offset(
                    svg, aside, 0
                ).perform()
                times.append(self.clock())
                pointed = svg.rect["width"] / 2 + aside
                # Within half a shape's interval of the pointer, which is 10 pixels here.
                np.testing.assert_allclose(self.cursors(), pointed, atol=12)
            self.assertTrue(0 < times[0] < times[1] < times[2] == 0.1, times)
            shapes.append(self.picture())
            ActionChains(self.driver, duration=20).move_to_element_with_offset(
                svg, -round(0.3 * svg.rect["width"]), 0
            ).perform()
        self.assertGreater(self.changed(shapes[0], shapes[1]), 0.05)
        self.assertEqual(self.changed(shapes[1], shapes[2]), 0)

    def test_readings_beside_the_curves_are_those_of_the_history(self):
        history = read_history(short_run() / "history.csv")
        self.find("slider").send_keys(Keys.END)
        first = self.driver.find_element(By.CSS_SELECTOR, ".plot figcaption i")
        self.assertAlmostEqual(float(first.text), history["deployment_rate"][-1], delta=6e-4)

    def test_play_button_plays_to_the_end_and_then_again(self):
        Select(self.find("speed")).select_by_visible_text("1/4")
        before = self.picture()
        for _ in range(2):
            start = self.driver.execute_script(
                "document.getElementById('play').click();"
                "return document.getElementById('clock').textContent;"
            )
            self.assertEqual(start, "t = 0.000 s")
            self.await_(lambda: self.clock() == 0.1)
            self.await_(lambda: self.find("play").get_attribute("aria-label") == "Play")
        self.assertGreater(self.changed(before, self.picture()), 0.05)

    def test_it_stops_where_it_is_paused(self):
        Select(self.find("speed")).select_by_visible_text("1/32")
        self.find("play").click()
        self.assertEqual(self.find("play").get_attribute("aria-label"), "Pause")
        self.await_(lambda: self.clock() > 0)
        self.find("play").click()
        paused = self.clock()
        self.assertLess(paused, 0.1)
        time.sleep(0.4)  # 2.5 shapes
        self.assertEqual(self.clock(), paused)

    def test_keys_play_and_step(self):
        body = self.driver.find_element(By.TAG_NAME, "body")
        body.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
        self.assertEqual(self.clock(), 0.01)
        body.send_keys(Keys.ARROW_LEFT)
        self.assertEqual(self.clock(), 0.005)
        body.send_keys(Keys.END)
        self.assertEqual(self.clock(), 0.1)
        body.send_keys(Keys.HOME)
        self.assertEqual(self.clock(), 0.0)
        body.send_keys(Keys.SPACE)
        self.await_(lambda: self.clock() > 0)

    def test_keys_step_after_the_button_was_pressed_and_leave_choices_alone(self):
        self.find("reset").click()
        pressed = self.driver.switch_to.active_element
        self.assertEqual(pressed.get_attribute("id"), "reset")
        pressed.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
        self.assertEqual(self.clock(), 0.01)
        self.find("field").send_keys(Keys.ARROW_LEFT)
        self.assertEqual(self.clock(), 0.01)

    def test_keys_turn_and_zoom_without_a_change_of_time(self):
        body = self.driver.find_element(By.TAG_NAME, "body")
        before = self.picture()
        body.send_keys(Keys.SHIFT, Keys.ARROW_LEFT * 4)
        turned = self.picture()
        self.assertGreater(self.changed(before, turned), 0.01)
        body.send_keys(Keys.SHIFT, Keys.ARROW_RIGHT * 4)
        self.assertLess(self.changed(before, self.picture()), 0.001)
        body.send_keys(Keys.SHIFT, Keys.ARROW_UP * 40)  # to the top, and no farther
        above = self.picture()
        self.assertGreater(self.changed(before, above), 0.01)
        body.send_keys(Keys.SHIFT, Keys.ARROW_UP)
        self.assertLess(self.changed(above, self.picture()), 0.001)
        width = self.find("scale-bar").rect["width"]
        body.send_keys("+")
        larger = self.picture()
        self.assertGreater(self.golden(larger), 1.1 * self.golden(above))
        self.assertNotEqual(self.find("scale-bar").rect["width"], width)
        body.send_keys("-")
        self.assertLess(self.changed(above, self.picture()), 0.001)
        self.assertEqual(self.clock(), 0.0)

    def test_page_tells_its_keys(self):
        hint = self.driver.find_element(By.CLASS_NAME, "hint").text
        for key in ("space", "\u2190", "\u2192", "shift", "+", "\u2212"):
            self.assertIn(key, hint)

    def test_colouring_by_each_field_shows_its_scale_and_meaning(self):
        self.find("slider").send_keys(Keys.END)
        seen = [self.picture()]
        meanings = {label: meaning for _, label, _, _, meaning in report.FIELDS}
        for label in ("side strain", "tension", "buckled sides", "crease angle"):
            Select(self.find("field")).select_by_visible_text(label)
            self.assertIn(label, self.find("legend").text)
            self.assertIn(meanings[label], self.find("legend").text)
            seen.append(self.picture())
            for other in seen[:-1]:
                self.assertGreater(self.changed(other, seen[-1]), 0.05, label)
        Select(self.find("field")).select_by_index(0)
        self.assertFalse(self.find("legend").is_displayed())
        self.assertEqual(self.changed(seen[0], self.picture()), 0)

    def test_triangles_have_the_colours_of_their_values_at_the_time(self):
        self.find("folds").click()
        Select(self.find("field")).select_by_visible_text("crease angle")
        self.find("slider").send_keys(Keys.END)
        image = self.canvas()
        view = FirstView(image.shape)
        places, fields = read_frame(list_series(short_run() / "shapes" / "film.pvd")[-1][1])
        middles = places[sail_mesh().triangles].mean(axis=1)
        shown = hue(np.array([view.colour(image, middle) for middle in middles]))
        levels = np.rint(255 * np.clip(fields["crease_angle"] / np.pi, 0, 1)).astype(int)
        self.assertGreater(np.ptp(levels), 100)
        apart = np.linalg.norm(shown - hue(VIRIDIS)[levels], axis=1)
        self.assertGreater(np.mean(apart < 0.05), 0.75)  # others lie behind

    def test_film_has_the_colours_of_its_scale_lit_more_or_less(self):
        self.find("folds").click()
        Select(self.find("field")).select_by_visible_text("tension")
        self.find("slider").send_keys(Keys.END)
        image = self.picture()
        faces = np.abs(image[:-1, :-1] - image[1:, 1:]).max(axis=2) == 0  # of one colour
        faces &= np.abs(image[:-1, :-1] - image[0, 0]).max(axis=2) > 0.1
        pixels = np.round(255 * image[:-1, :-1][faces])
        shown, counts = np.unique(pixels, axis=0, return_counts=True)
        self.assertGreater(len(shown), 100)
        apart = np.linalg.norm(hue(shown / 255)[:, None] - hue(VIRIDIS), axis=2).min(axis=1)
        self.assertLess(np.average(apart > 0.03, weights=counts), 0.08)  # spool and tips

    def test_key_tells_sides_and_folds_where_they_are_seen(self):
        def told():
            return [e.text for e in self.driver.find_elements(By.CSS_SELECTOR, ".key span span")]

        sides, folds = ["top", "bottom"], ["mountain", "valley"]
        for field, expected in ((0, sides + folds), (1, folds), (4, [])):
            Select(self.find("field")).select_by_index(field)
            self.assertEqual([text for text in told() if text], expected)
        Select(self.find("field")).select_by_index(0)
        self.find("folds").click()
        self.assertEqual([text for text in told() if text], sides)
        self.resize(390, 844)
        places = (".scale-bar", ".key")
        bar, key = (self.driver.find_element(By.CSS_SELECTOR, place).rect for place in places)
        self.assertLess(bar["x"] + bar["width"], key["x"])

    def test_turning_with_the_spool_is_another_view_once_it_has_turned(self):
        start = self.picture()
        self.find("corotate").click()
        self.assertEqual(self.changed(start, self.picture()), 0)
        self.find("slider").send_keys(Keys.END)
        along = self.picture()
        self.find("corotate").click()
        self.assertGreater(self.changed(along, self.picture()), 0.02)

    def test_nothing_sticks_out_at_any_width(self):
        for width, height in ((1280, 800), (800, 600), (390, 844)):
            self.resize(width, height)
            self.await_(lambda: self.find("scene").rect["width"] <= width)
            wide = self.driver.execute_script("return document.documentElement.scrollWidth")
            self.assertLessEqual(wide, width)
            self.assertGreater(self.golden(self.picture()), 0.005, width)

    def test_page_of_a_sweep_is_no_wider_than_a_phone(self):
        case = {"state": "complete", "values": ["1000", "30", "0.865", "92.0"] * 2}
        names = [f"alpha_crease_1000-beta_{beta}" for beta in (3, 30)]
        page = scratch() / "sweep.html"
        content = render(
            states={"complete": 2},
            pictures={"swing.png": "The swing over alpha_c and beta."},
            columns=[("time_of_amplitude", "s", "when the largest lag is reached")] * 8,
            cases=[
                {**case, "name": n, "place": n, "page": "", "shapes": f"{n}/shapes.png"}
                for n in names
            ],
            others=[],
            common=[("spin_up_tolerance", "1e-06", "-", "residual energy", "run")],
            versions={"numpy": "1.24.2"},
            table="cases.csv",
            axes=["alpha_crease", "beta"],
        )
        page.write_text(content)
        self.resize(390, 844)
        self.driver.get(page.as_uri())
        self.assertIn("Sweep over alpha_crease", self.driver.title)
        wide = self.driver.execute_script("return document.documentElement.scrollWidth")
        self.assertLessEqual(wide, 390)


class TestCommand(CommandTest):
    def test_folder_without_a_run_ends_with_one_sentence(self):
        self.ends_without_a_run("report")


if __name__ == "__main__":
    unittest.main()

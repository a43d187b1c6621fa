# SPDX-License-Identifier: GPL-2.0-or-later
"""Calibration: known parameters are found again, and lie within the uncertainty that is told."""

import json
import os
import subprocess
import unittest
import unittest.mock

import numpy as np
from membrane.files import BadFile
from membrane.study.calibration import kept_runs, runs, search, surface, target
from processes import Halt, kill
from support import ROOT, long, run_yade, scratch, yade_environment

TIMES = np.linspace(0.0, 0.1, 101)  # [s]
LOW, HIGH = np.log([10.0, 1.0]), np.log([1000.0, 100.0])
NOISE = {"phase_difference": np.radians(0.1), "deployment_rate": 0.005}


class Sail:
    """Curves in closed form, with the valley and the saturation of the sail's, and scatter.

    Parameters
    ----------
    scatter : float
        Standard deviation by which whole runs are off; it grows with time and is not white.
    rng : numpy.random.Generator
    """

    def __init__(self, scatter, rng):
        self.scatter, self.rng = scatter, rng
        self.points, self.curves = np.empty((0, 2)), np.empty((0, 2, len(TIMES)))

    def exact(self, point):
        """Curves (2, S) at a point (2,), logarithms, without scatter."""
        alpha, beta = np.exp(point)
        s = TIMES / TIMES[-1]
        late, stiff = 1 / (1 + 100 / alpha), beta / 40
        phase = -0.5 * s**2.5 * (1 - 0.3 * s * np.log1p(stiff) - 0.06 * late * np.sin(2.5 * s))
        rate = 0.08 + 0.8 * s**3 * (1 - 0.15 * late * s - 0.2 * s * np.log1p(stiff))
        return np.array([phase, rate])

    def run(self, point):
        """Curves (2, S) with the scatter of a run."""
        s = TIMES / TIMES[-1]
        off = self.rng.standard_normal((2, 2)) @ [s**4, s**4 * np.cos(6 * s)]
        return self.exact(point) + self.scatter * off

    def __call__(self, points):
        found = [self.run(point) for point in points]
        self.points = np.concatenate([self.points, points])
        self.curves = np.concatenate([self.curves, found])
        return found

    def target(self, point, noise):
        """Target from a run at a point, with white noise of standard deviation `noise`."""
        values = self.run(point)
        values = values + noise * self.rng.standard_normal(values.shape)
        names = ("phase_difference", "deployment_rate")
        return target.Target(TIMES, names, values, target.noise_of(values))


class TestTarget(unittest.TestCase):
    def write(self, text):
        path = scratch() / "target.csv"
        path.write_text(text)
        return path

    def rows(self, count=20, **changes):
        lines = [f"{1e-3 * i},{changes.get(f'row_{i}', i / 20)},0" for i in range(count)]
        return "\n".join(["time,deployment_rate,other", *lines]) + "\n"

    def test_noise_of_a_smooth_curve_is_that_which_was_added(self):
        rng = np.random.default_rng(0)
        smooth = np.array([np.sin(20 * TIMES), 0.3 * TIMES])
        self.assertLess(target.noise_of(smooth).max(), 1e-5)
        noise = np.array([0.01, 0.002])
        many = [target.noise_of(smooth + noise[:, None] * rng.normal(size=smooth.shape))]
        self.assertLess(np.abs(many[0] / noise - 1).max(), 0.25)

    def test_curves_of_the_table_are_taken_until_the_time_given(self):
        text = self.rows().replace(",0\n", ",?\n")  # in a column that is not asked for
        found = target.read_target(self.write(text), until=0.0155)
        self.assertEqual(found.columns, ("deployment_rate",))
        self.assertEqual(found.values.tolist(), [[i / 20 for i in range(16)]])

    def test_tables_of_other_programs_are_read(self):
        text = self.rows().replace("0\n", "zero\n")
        plain = target.read_target(self.write(text), until=1.0)
        comma = text.replace(".", ",")
        self.assertEqual(len(plain.times), 20)
        for other in (
            text.replace(",", ", "),
            text.replace(",", " ,\t"),
            text + "\n\n \n",
            text.replace("\n", "\n\n"),
            text[:-1],
            text[: -len(",zero\n")] + ",",
            "# " + text,
            "\ufeff" + text,
            text.replace("\n", "\r\n"),
            text.replace("\n", "\r"),
            text.replace(",", ";"),
            text.replace("\n", ",\n").replace(",", ";"),
            text.replace(",", "\t"),
            text.replace(",", "  "),
            text.replace(",", '","').replace("\n", '"\n"')[:-1].join(('"', "")),
            self.rows().replace(",", ";").replace(".", ","),
            self.rows().replace(",", "\t").replace(".", ","),
            self.rows().replace(",", "; ").replace(".", ",").replace("\n", ";\n"),
        ):
            with self.subTest(other[:90]):
                found = target.read_target(self.write(other), until=1.0)
                np.testing.assert_array_equal(found.times, plain.times)
                np.testing.assert_array_equal(found.values, plain.values)
        for other, said in (
            (comma, "line 2: has 5 values for 3 columns; where commas are decimal, semicolons"),
            (text.replace(",", ";").replace("0.05", "0,05"), "'0,05'; must be a finite number"),
            (text.replace("0.05,", "0.05,0.05,"), "line 3: has 4 values for 3 columns"),
            (text.replace("0.05", '"0.05'), "is no table"),
            ("\n \n,,\n", "is empty"),
        ):
            with self.subTest(other[:90]), self.assertRaisesRegex(BadFile, said):
                target.read_target(self.write(other), until=1.0)

    def test_degrees_and_percent_are_seen(self):
        for name, factor, said in (
            ("phase_difference", -3.4, "reaches -3.23 rad, .* are these degrees"),
            ("deployment_rate", 2, "reaches 1.9, .* are these percent"),
        ):
            rows = [f"{i / 1000},{factor * i / 20}" for i in range(20)]
            text = "\n".join([f"time,{name}", *rows])
            with self.subTest(name), self.assertRaisesRegex(BadFile, said):
                target.read_target(self.write(text), until=1.0)
            found = target.read_target(self.write(text), until=0.0145)
            self.assertEqual(len(found.times), 15)

    def test_any_measure_of_a_kind_of_sail_may_be_the_curve(self):
        names = ("time", "tip_radius", "spin_rate", "kinetic_energy", "mean_crease_angle")
        rows = [(1e-3 * i, 0.1 + 1e-3 * i, 60 - i, 1e-3 * i, 0.1 * i) for i in range(20)]
        path = self.write("\n".join([",".join(names), *(",".join(map(str, r)) for r in rows)]))
        found = target.read_target(path, sail="sheet")
        self.assertEqual(set(found.columns), {"tip_radius", "spin_rate", "mean_crease_angle"})
        found = target.read_target(path, ["kinetic_energy", "spin_rate"], sail="sheet")
        np.testing.assert_array_equal(found.values, np.array(rows)[:, [3, 2]].T)
        with self.assertRaisesRegex(BadFile, "no column deployment_rate or phase_difference"):
            target.read_target(path)
        for name, most, said in (
            ("mean_crease_angle", 180, "reaches 180 rad, .* are these degrees"),
            ("projected_area", 95, "reaches 95, .* are these percent"),
        ):
            lines = [f"{i / 1000},{most * i / 19}" for i in range(20)]
            path = self.write("\n".join([f"time,{name}", *lines]))
            with self.subTest(name), self.assertRaisesRegex(BadFile, said):
                target.read_target(path, sail="sheet")

    def test_tables_that_are_no_curve_are_refused(self):
        cases = {
            "no column phase_difference": (self.rows(), ["phase_difference"], 1.0),
            "no column time": (self.rows().replace("time", "tme"), [], 1.0),
            "has 6 times .* times are in s": (self.rows(), [], 0.005),
            "line 5, deployment_rate: is .\\?.; must be a finite": (self.rows(row_3="?"), [], 1.0),
            "grow": (self.rows().replace("0.004,", "0.003,"), [], 1.0),
            "no column deployment_rate or phase_difference": ("time,a\n0,1\n", [], 1.0),
        }
        for said, (text, columns, until) in cases.items():
            with self.assertRaisesRegex(ValueError, said):
                target.read_target(self.write(text), columns, until)


class TestSurface(unittest.TestCase):
    def test_region_has_its_width_also_at_the_bounds(self):
        for point in (LOW, HIGH, 0.5 * (LOW + HIGH), np.array([LOW[0], HIGH[1]])):
            region = surface.Region.about(point, LOW, HIGH)
            self.assertTrue(region.holds(np.array([point]))[0])
            self.assertLess(np.abs(region.high - region.low - 2 * surface.HALF).max(), 1e-12)
            self.assertTrue((region.low >= LOW).all() and (region.high <= HIGH).all())

    def test_quadratic_curves_and_their_slopes_are_met(self):
        rng = np.random.default_rng(1)
        region = surface.Region.about(np.array([4.0, 3.0]), LOW, HIGH)
        points = rng.uniform(region.low, region.high, size=(9, 2))
        c = rng.normal(size=(6, 1, 5))

        def curves(p):
            a, b = p
            return c[0] + c[1] * a + c[2] * b + c[3] * a * a + c[4] * a * b + c[5] * b * b

        made = surface.Surface(region, points, np.array([curves(p) for p in points]))
        at = np.array([3.9, 3.2])
        slopes = [
            c[1] + 2 * c[3] * at[0] + c[4] * at[1],
            c[2] + c[4] * at[0] + 2 * c[5] * at[1],
        ]
        self.assertLess(np.abs(made(at) - curves(at)).max(), 1e-9)
        self.assertLess(np.abs(made.slopes(at) - slopes).max(), 1e-9)
        self.assertLess(made.scatter.max(), 1e-9)
        self.assertEqual(made.freedom, 3)

    def test_too_few_runs_are_refused(self):
        region = surface.Region.about(np.array([4.0, 3.0]), LOW, HIGH)
        with self.assertRaisesRegex(RuntimeError, "too few"):
            surface.Surface(region, np.zeros((5, 2)), np.zeros((5, 1, 4)))


class TestEstimate(unittest.TestCase):
    """On curves in closed form, whose parameters and scatter are known."""

    def errors(self, noise, scatter, trials=80):
        """Errors over the standard deviations told, (trials, 2), and these deviations."""
        truth, off, sigma = np.log([80.0, 30.0]), [], []
        for seed in range(trials):
            sail = Sail(scatter, np.random.default_rng(seed))
            wanted = sail.target(truth, noise)
            _, found = surface.refine(sail, wanted, truth + 0.1, LOW, HIGH, seed)
            off.append((found.point - truth) / found.sigma)
            sigma.append(found.sigma)
        return np.array(off), np.array(sigma)

    def check(self, noise, scatter):
        off, sigma = self.errors(noise, scatter)
        self.assertTrue((np.median(sigma, axis=0) < 0.35).all(), np.median(sigma, axis=0))
        self.assertTrue((np.std(off, axis=0) > 0.7).all(), np.std(off, axis=0))
        self.assertTrue((np.std(off, axis=0) < 1.3).all(), np.std(off, axis=0))
        self.assertTrue((np.abs(np.mean(off, axis=0)) < 0.4).all(), np.mean(off, axis=0))

    def test_uncertainty_is_right_where_noise_rules(self):
        self.check(noise=0.005, scatter=1e-4)

    def test_uncertainty_is_right_where_scatter_rules(self):
        self.check(noise=1e-4, scatter=0.003)

    def test_a_model_that_cannot_follow_is_told_and_widens_the_uncertainty(self):
        truth = np.log([80.0, 30.0])
        found = []
        for bump in (0.0, 0.05):
            sail = Sail(0.001, np.random.default_rng(0))
            wanted = sail.target(truth, 0.002)
            values = wanted.values + bump * np.sin(60 * TIMES)
            wanted = target.Target(TIMES, wanted.columns, values, wanted.noise)
            found.append(surface.refine(sail, wanted, truth, LOW, HIGH)[1])
        self.assertLess(found[0].lack_of_fit, 2)
        self.assertGreater(found[1].lack_of_fit, 4)
        self.assertTrue((found[1].sigma > 2 * found[0].sigma).all())

    def test_a_parameter_without_effect_is_not_said_to_be_known(self):
        truth = np.log([50000.0, 30.0])  # far in the saturation
        low, high = np.log([1000.0, 1.0]), np.log([1e6, 100.0])
        known = 0
        for seed in range(30):
            sail = Sail(0.002, np.random.default_rng(seed))
            _, found = surface.refine(sail, sail.target(truth, 0.005), truth, low, high, seed)
            known += found.sigma[0] < surface.HALF
        self.assertLessEqual(known, 2)  # by chance a slope of scatter looks like one


class TestOneParameter(unittest.TestCase):
    """A sheet that spins faster opens faster, in closed form: omega alone is found."""

    def test_it_is_found_where_it_was(self):
        class Sheet(Sail):
            def exact(self, point):
                turned = np.exp(point[0]) * TIMES
                return np.array([60 / (1 + turned**2), 0.1 + 0.01 * turned**1.5])

        low, high, truth = np.log([[5.0], [50.0], [17.0]])
        sheet = Sheet(1e-3, np.random.default_rng(3))
        sheet.points = np.empty((0, 1))
        values = sheet.run(truth)
        wanted = target.Target(TIMES, ("spin_rate", "tip_radius"), values, np.full(2, 1e-4))
        point = search.search(sheet, wanted, low, high)
        _, found = surface.refine(sheet, wanted, point, low, high)
        self.assertLess(found.sigma[0], 0.1)
        self.assertLess(abs(found.point - truth)[0], 3 * found.sigma[0])


class TestSearch(unittest.TestCase):
    def test_the_parameters_are_found_in_a_wide_field_with_few_runs(self):
        for seed, truth in enumerate(np.log([[80.0, 30.0], [20.0, 60.0], [300.0, 20.0]])):
            sail = Sail(0.002, np.random.default_rng(seed))
            point = search.search(sail, sail.target(truth, 0.003), LOW, HIGH, seed)
            self.assertLess(np.abs(point - truth).max(), surface.HALF, np.exp([point, truth]))
            self.assertLessEqual(len(sail.points), search.FIRST + search.MOST)


def command(*arguments):
    """Command line of scripts/calibrate.py."""
    return ["/usr/bin/python3", str(ROOT / "scripts" / "calibrate.py"), *map(str, arguments)]


def calibrate(*arguments):
    """Run scripts/calibrate.py; returns the CompletedProcess."""
    return subprocess.run(
        command(*arguments), cwd=scratch(), env=yade_environment(), capture_output=True, text=True
    )


def noisy_run(alpha_crease, beta, seed, *scene):
    """File with the noisy early curves of a run; `scene` are further options."""
    folder = scratch() / f"true_{alpha_crease:g}_{beta:g}_{len(scene)}"
    options = {"alpha-crease": alpha_crease, "beta": beta, "duration": 0.1, "shapes-interval": 0}
    flags = [f"--{name}={value}" for name, value in options.items()]
    done = run_yade(
        ROOT / "scripts" / "deploy.py", "--out", folder, "--no-pictures", *flags, *scene
    )
    if done.returncode:
        raise RuntimeError(done.stderr)
    table = np.genfromtxt(folder / "history.csv", delimiter=",", names=True)
    rng = np.random.default_rng(seed)
    columns = [table[n] + s * rng.standard_normal(len(table)) for n, s in NOISE.items()]
    path = folder / "target.csv"
    rows = np.column_stack([table["time"], *columns])
    np.savetxt(path, rows, delimiter=",", header=",".join(["time", *NOISE]), comments="")
    return path


class TestDeployments(unittest.TestCase):
    def test_a_run_that_diverges_has_no_curves_and_ends_nothing(self):
        names, times = ("phase_difference",), np.linspace(0.0, 0.2, 11)
        wanted = target.Target(times, names, np.zeros((1, 11)), np.zeros(1))
        scene = ["--fold-lines=3", "--inner-width=0.15", "--spin-up-tolerance=1e-3"]
        scene += ["--dt=2.3e-5", "--force-time-step"]
        simulate = runs.Deployments(ROOT / "scripts" / "deploy.py", ["beta"], wanted, scene)
        with unittest.mock.patch.dict(os.environ, yade_environment()):
            (curves,) = simulate([[np.log(30.0)]])
        self.assertIsNone(curves)
        self.assertEqual((len(simulate), len(simulate.points)), (1, 0))

    def test_a_run_of_another_sail_gives_its_own_measures(self):
        times = np.linspace(0.0, 0.004, 5)
        wanted = target.Target(times, ("spin_rate", "tip_radius"), np.zeros((2, 5)), np.zeros(2))
        words = ["miura", "--size=0.05", "--air-density=0"]
        simulate = runs.Deployments(ROOT / "scripts" / "deploy.py", ["omega"], wanted, words)
        with unittest.mock.patch.dict(os.environ, yade_environment()):
            slow, fast = simulate([[np.log(30.0)], [np.log(60.0)]])
        for omega, (spin, radius) in ((30.0, slow), (60.0, fast)):
            self.assertAlmostEqual(spin[0], omega, delta=1e-3 * omega)
            self.assertTrue((np.diff(spin) < 0).all())  # it turns the slower the wider it is
            self.assertTrue((np.diff(radius) > 0).all())
        self.assertGreater(fast[1][-1], slow[1][-1])


class TestKeptRuns(unittest.TestCase):
    ABOUT = {"names": ["beta"], "columns": ["phase_difference"], "times": [0.0, 0.1, 0.2]}
    RUNS = {(1 / 3,): np.array([[0.1, -1e-300, 2 / 7]]), (0.5,): None}

    def setUp(self):
        self.path = scratch() / f"{self.id()}.jsonl"
        kept = kept_runs.KeptRuns(self.path, self.ABOUT)
        self.assertEqual(len(kept), 0)
        self.assertFalse(self.path.exists())
        for point, curves in self.RUNS.items():
            kept.add(point, curves)

    def found(self, **changes):
        kept = kept_runs.KeptRuns(self.path, {**self.ABOUT, **changes})
        return [point for point in self.RUNS if point in kept]

    def test_runs_are_given_back_bit_for_bit(self):
        kept = kept_runs.KeptRuns(self.path, self.ABOUT)
        self.assertEqual(len(kept), 2)
        for point, curves in self.RUNS.items():
            self.assertIn(point, kept)
            np.testing.assert_array_equal(kept[point], curves)

    def test_a_line_that_is_cut_off_is_left_out_and_others_follow_it(self):
        text = self.path.read_text()
        self.path.write_text(text[: text.index("0.5") + 1])
        kept = kept_runs.KeptRuns(self.path, self.ABOUT)
        self.assertEqual(len(kept), 1)
        kept.add((0.5,), None)
        self.assertEqual(self.found(), list(self.RUNS))

    def test_runs_of_another_scene_or_target_are_not_taken(self):
        other = {**self.ABOUT, "times": [0.0, 0.1, 0.3]}
        self.assertEqual(self.found(**other), [])
        self.assertEqual(self.found(), list(self.RUNS))
        kept_runs.KeptRuns(self.path, other).add((0.5,), None)
        self.assertEqual(self.found(), [])
        self.assertEqual(self.found(**other), [(0.5,)])

    def test_a_file_of_something_else_is_not_taken(self):
        first = self.path.read_text().splitlines(keepends=True)[0]
        for text in (
            "",
            "{",
            "[1]\n",
            first + "7\n",
            first + '[[1], "x"]\n',
            first + "[[], null]\n",
        ):
            self.path.write_text(text)
            self.assertEqual(self.found(), [], text)

    def test_a_file_of_another_is_not_written_over(self):
        kept_runs.refuse_another(self.path)
        link = self.path.with_suffix(".link")
        link.symlink_to(self.path)
        other = self.path.with_suffix(".txt")
        for path, text in ((link, None), *((other, text) for text in ("", "mine\n", "[1]\n"))):
            if text is not None:
                path.write_text(text)
            with self.assertRaisesRegex(ValueError, f"{path} was not made by calibrate"):
                kept_runs.refuse_another(path)
        kept_runs.refuse_another(self.path.with_suffix(".missing"))


class TestCommand(unittest.TestCase):
    def refused(self, said, *arguments):
        done = calibrate(*arguments)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(said, done.stderr.splitlines()[-1])
        self.assertNotIn("Traceback", done.stderr)

    def test_what_cannot_be_is_refused_in_one_sentence(self):
        path = scratch() / "flat.csv"
        path.write_text("time,deployment_rate\n" + "".join(f"{i / 200},0.1\n" for i in range(20)))
        self.refused("No such file", scratch() / "absent.csv")
        self.refused("must be > 0 and grow", path, "--beta", "5", "1")
        self.refused("must be > 0 and grow", path, "--beta", "5", "inf")
        self.refused("--seed -1: must be >= 0", path, "--seed", "-1")
        self.refused("must name a folder", path, "--out", "")
        self.refused("is chosen here", path, "--duration=2")
        self.refused("no column phase_difference", path, "--column", "phase_difference")
        self.refused("does not vary", path)
        for words, said in (
            ("--vary omga 1 2", "--vary omga: must be a parameter of the sail that is a number"),
            ("--vary crease_law 1 2", "--vary crease_law: must be a parameter"),
            ("--vary omega 1 fast", "--omega 1 fast: must be numbers"),
            ("--vary omega 2 1", "--omega 2 1: must be > 0 and grow"),
            ("--vary omega 1 2 --omega=3", "--omega is chosen here, not by the caller"),
            ("--vary omega 2 2", "all parameters are held: nothing to find"),
            ("--vary omega 1 2 --vary beta 1 2 --vary zeta 1 2", "must be one parameter or two"),
            ("--sail kite", "SAIL is 'kite': must be a .fold or .msh file, or one of "),
            ("--sail sheet --column deployment_rate", "invalid choice: 'deployment_rate'"),
            ("--sail miura", "no column tip_radius or projected_area or mean_crease_angle or spin"),
        ):
            self.refused(said, path, *words.split())

    def test_what_the_scene_refuses_ends_the_search_at_once(self):
        path = scratch() / "line.csv"
        rows = "".join(f"{i / 1000},{i / 20}\n" for i in range(20))
        path.write_text("time,deployment_rate\n" + rows)
        self.refused("thickness = -1.0 m", path, "--thickness=-1")
        self.refused("Not a directory", path, "--out", path / "below")
        self.assertFalse((scratch() / "out" / "calibration").exists())


@long
class TestStopped(unittest.TestCase):
    """A coarse sail, whose curves need not be good ones."""

    COARSE = ["--fold-lines", "3", "--inner-width", "0.15", "--spin-up-tolerance", "1e-3"]

    def test_stopped_calibration_goes_on_and_finds_the_same(self):
        path = noisy_run(100.0, 30.0, 5, *self.COARSE)
        quiet, folder = scratch() / "quiet_calibration", scratch() / "stopped_calibration"
        done = calibrate(path, *self.COARSE, "--out", quiet)
        self.assertEqual(done.returncode, 0, done.stderr)
        halt = Halt("unfinished_runs", 12)
        process = subprocess.Popen(
            command(path, *self.COARSE, "--out", folder),
            cwd=scratch(),
            env=halt.environment(),
            stderr=subprocess.PIPE,
            text=True,
        )
        halt.wait(process)
        kill(process)
        done = calibrate(path, *self.COARSE, "--out", folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, r"(?m)^calibrate: .*: \d+ runs are there already")
        for name in ("calibration.json", "runs.csv"):
            self.assertEqual((folder / name).read_text(), (quiet / name).read_text())
        self.assertFalse(list(folder.glob("unfinished*")))


@long
class TestRecovery(unittest.TestCase):
    """The real sail: about 40 runs each."""

    def test_known_parameters_are_found_again(self):
        truth = {"alpha_crease": 45.0, "beta": 35.0}
        folder = scratch() / "recovered"
        done = calibrate(noisy_run(**truth, seed=5), "--out", folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads((folder / "calibration.json").read_text())
        for name, true in truth.items():
            about = found["parameters"][name]
            self.assertLess(about["sigma_of_logarithm"], 0.2, done.stdout)
            off = abs(np.log(about["value"] / true))
            self.assertLess(off, 3 * about["sigma_of_logarithm"], done.stdout)
            self.assertTrue(about["identifiable"])
        self.assertEqual(found["warnings"], [])
        for name, noise in NOISE.items():
            self.assertLess(found["curves"][name]["rms"], 1.5 * noise)
        picture = (folder / "calibration.png").read_bytes()
        self.assertEqual(picture[:8], b"\x89PNG\r\n\x1a\n")
        runs = np.genfromtxt(folder / "runs.csv", delimiter=",", names=True)
        self.assertEqual(len(runs), found["runs"])

    def test_a_parameter_that_the_curve_does_not_tell_is_warned_of(self):
        folder = scratch() / "unknown"
        path = noisy_run(5000.0, 30.0, seed=5)
        bounds = ["--alpha-crease", "1000", "100000", "--beta", "30", "30"]
        done = calibrate(path, "--column", "phase_difference", *bounds, "--out", folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Warning: alpha_crease is not identifiable", done.stdout)
        found = json.loads((folder / "calibration.json").read_text())
        self.assertEqual(list(found["parameters"]), ["alpha_crease"])


if __name__ == "__main__":
    unittest.main()

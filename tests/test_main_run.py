# SPDX-License-Identifier: GPL-2.0-or-later
"""The main run: the paper's sail at the defaults, folded, spun up, released and run for 1 s."""

import csv
import json
import unittest
from dataclasses import asdict

import numpy as np
import yade.config
from membrane import measures
from membrane.fold import fold, fold_report
from membrane.mesh import sail_mesh
from membrane.parameters import SailParameters
from support import main_run, read_grid


class TestMainRun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = main_run()
        cls.history, cls.summary, cls.folder = cls.run_.history, cls.run_.summary, cls.run_.folder

    def test_it_ran_for_one_second_from_the_release(self):
        time = self.history["time"]
        self.assertEqual(time[0], 0)
        self.assertAlmostEqual(time[-1], 1.0, delta=1e-9)
        np.testing.assert_allclose(np.diff(time), 1e-3, rtol=1e-9)

    def test_sail_starts_folded_and_opens_beyond_nine_tenths(self):
        rate = self.history["deployment_rate"]
        self.assertLess(rate[0], 0.1)
        self.assertGreater(rate.max(), 0.9)

    def test_tips_go_together_for_a_tenth_of_a_second(self):
        early = self.history["time"] <= 0.1
        phases = np.degrees(self.run_.phases[early])
        self.assertEqual(len(phases), 101)
        self.assertGreater(np.ptp(phases[:, 0]), 10, "the tips hardly moved")
        self.assertLess(np.ptp(phases, axis=1).max(), 1.0)

    def test_tips_lag_behind_the_spool_and_swing_back(self):
        lag = self.history["phase_difference"]
        self.assertEqual(lag[0], 0)
        lowest = int(np.argmin(lag))
        self.assertLess(lag[lowest], -np.radians(30))
        self.assertGreater(lag[lowest:].max(), lag[lowest] + np.radians(30))

    def test_all_history_is_finite(self):
        for name, values in self.history.items():
            self.assertTrue(np.all(np.isfinite(values)), name)
        for name in ("kinetic_energy", "elastic_energy", "crease_energy", "spool_work"):
            self.assertGreater(np.abs(self.history[name]).max(), 1e-6, name)

    def test_ledger_of_energies_closes_within_one_percent_of_the_spools_work(self):
        work = np.abs(self.history["spool_work"]).max()
        self.assertGreater(work, 1e-3)
        self.assertLess(np.abs(self.history["energy_balance"]).max(), 0.01 * work)
        rest = self.history["energy_balance"] - self.history["kink_error"]
        self.assertLess(np.abs(rest).max(), 1e-6 * work)

    def test_balance_is_energies_less_works(self):
        h = self.history
        stored = h["kinetic_energy"] + h["elastic_energy"] + h["gravity_energy"]
        parts = ("crease_work", "damping_work", "drag_work", "spool_work", "contact_work")
        works = sum(h[part] for part in parts)
        balance = stored - stored[0] - (works - works[0])
        np.testing.assert_allclose(balance, h["energy_balance"], atol=1e-12)

    def test_damping_and_drag_take_energy_at_all_times(self):
        for name in ("damping_work", "drag_work"):
            work = self.history[name]
            self.assertLess(work[-1], -1e-5)
            self.assertLessEqual(np.diff(work).max(), 0, name)

    def test_angular_momentum_is_the_sum_of_its_impulses(self):
        momentum, impulse = self.history["angular_momentum"], self.history["angular_impulse"]
        change = momentum - momentum[0]
        self.assertGreater(np.ptp(momentum), 0.1 * momentum[0])
        np.testing.assert_allclose(change, impulse - impulse[0], atol=1e-9 * momentum.max())

    def test_spin_up_reached_its_tolerance(self):
        self.assertLess(self.summary["spin_up"]["residual"], 1e-6)

    def test_history_is_a_table_with_units(self):
        with open(self.folder / "history.csv", newline="") as file:
            names, *rows = csv.reader(file)
        units = json.loads((self.folder / "history.units.json").read_text())
        self.assertEqual(list(units), names)
        self.assertEqual(len(rows), 1001)
        self.assertEqual(units["energy_balance"], "J")

    def test_summary_holds_parameters_versions_and_measures(self):
        summary = json.loads((self.folder / "summary.json").read_text())
        self.assertEqual(summary["parameters"], asdict(SailParameters()))
        self.assertEqual(summary["parameters"]["alpha_crease"], 1000.0)
        self.assertEqual(summary["versions"]["yade"], yade.config.version.strip())
        wall = json.loads((self.folder / "wall_time.json").read_text())
        for stage in ("build", "spin_up", "run"):
            self.assertGreater(wall[stage], 0)
        found = summary["measures"]
        rate = self.history["deployment_rate"]
        self.assertEqual(found["largest_deployment_rate"], rate.max())
        self.assertEqual(found["final_deployment_rate"], rate[-1])
        first = self.history["time"][np.flatnonzero(rate > 0.9)[0]]
        self.assertEqual(found["time_of_rate_0.9"], first)
        self.assertGreater(summary["critical_time_step"], summary["parameters"]["dt"])

    def test_summary_counts_the_sides_that_the_folding_shortened(self):
        mesh = sail_mesh()
        report = asdict(fold_report(mesh, fold(mesh)))
        self.assertGreater(report["shortened"], 50)
        self.assertEqual(self.summary["fold"]["shortened"], report["shortened"])
        self.assertAlmostEqual(self.summary["fold"]["shortening"], report["shortening"], delta=1e-9)

    def test_shapes_are_readable_and_hold_the_fields(self):
        mesh = sail_mesh()
        shapes = sorted((self.folder / "shapes").glob("film_*.vtu"))
        self.assertEqual(len(shapes), 101)
        points, values, cells = read_grid(shapes[-1])
        self.assertEqual(cells.tolist(), mesh.triangles.tolist())
        rate = measures.deployment_rate(mesh, points)
        self.assertAlmostEqual(rate, self.history["deployment_rate"][-1], delta=1e-5)
        of_film = {"side_strain", "tension", "buckled", "crease_angle"}
        self.assertEqual(set(values), of_film | {"area_strain"})
        self.assertTrue(all(np.ptp(field) > 0 for field in values.values()))
        _, values, cells = read_grid(self.folder / "shapes" / "sides_000100.vtu")
        self.assertEqual(len(cells), 1316)
        self.assertEqual(set(values), of_film | {"fold", "kind"})
        for name, field in values.items():
            self.assertTrue(np.all(np.isfinite(field)), name)
            self.assertGreater(np.ptp(field), 0, name)
        on_fold = values["fold"] != 0
        self.assertEqual(np.count_nonzero(on_fold), 364)
        np.testing.assert_array_equal(values["crease_angle"] != np.float32(np.pi), on_fold)
        np.testing.assert_array_equal(values["kind"] == 2, np.arange(1316) >= 1300)

    def test_series_lists_every_shape_with_its_time(self):
        for name in ("film", "sides"):
            text = (self.folder / "shapes" / f"{name}.pvd").read_text()
            self.assertEqual(text.count("<DataSet"), 101)
            self.assertIn(f'file="{name}_000100.vtu"', text)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""What `scripts/run.sh bench` is made of: turns, ratios, its file, LAMMPS's input, a worker.

Nothing here measures a speed, and LAMMPS need not be installed.
"""

import json
import time
import unittest
from unittest import mock

import numpy as np
from membrane.study import benchmarks
from membrane.study.benchmarks import cases, lammps, quiet, results, sheet, turns, workers
from support import scratch

QUICK = True


def sample(**changes):
    """An Entry, with `changes`."""
    return benchmarks.Entry(**{"name": "n", "value": 1.0, "unit": "-", "nodes": 9, **changes})


class TestTurns(unittest.TestCase):
    def test_everything_takes_its_turn_in_every_round(self):
        seen = []
        takers = {name: lambda n=name: seen.append(n) or len(seen) for name in "abc"}
        found = turns.take_turns(takers, 3, quiet.Quiet())
        self.assertEqual("".join(seen), "abccbaabc")
        self.assertEqual(found, {"a": [1, 6, 7], "b": [2, 5, 8], "c": [3, 4, 9]})

    def test_ratio_is_the_median_of_pairs_not_the_ratio_of_medians(self):
        entry = turns.ratio_entry("r", [1.0, 10.0, 4.0], [1.0, 5.0, 1.0], 9)
        self.assertEqual(entry.value, 2.0)
        self.assertEqual(entry.spread, (1.0, 4.0))
        self.assertEqual(entry.best, 1.0)

    def test_numbers_without_partners_are_refused(self):
        for above, below in (([1.0], [1.0, 2.0]), ([], [])):
            with self.assertRaises(ValueError):
                turns.ratios(above, below)


class TestEntry(unittest.TestCase):
    def test_target_holds_on_its_side_only(self):
        for bound, holds in (("at most", (True, True, False)), ("at least", (False, True, True))):
            for value, wanted in zip((0.9, 1.0, 1.1), holds):
                entry = sample(value=value, target=1.0, bound=bound)
                self.assertIs(entry.holds, wanted, (bound, value))

    def test_without_target_nothing_holds_or_fails(self):
        self.assertIsNone(sample().holds)
        self.assertNotIn("holds", sample().as_dict())

    def test_numbers_that_say_nothing_are_refused(self):
        for changes in ({"value": np.nan}, {"target": 1.0}, {"target": 1.0, "bound": "about"}):
            with self.assertRaises(ValueError):
                sample(**changes)


class TestResults(unittest.TestCase):
    def setUp(self):
        self.path = scratch() / "bench.json"
        self.path.unlink(missing_ok=True)

    def save(self, module, *entries):
        rows = results.as_rows(module, entries, "abc")
        results.save(self.path, module, rows, {"date": "today"}, ["first", "second"])
        return json.loads(self.path.read_text())

    def test_entries_are_replaced_by_module_and_kept_in_order(self):
        self.save("second", sample(value=1 / 3, spread=(0.3, 0.4), best=0.31))
        self.save("first", sample(value=1.0), sample(value=2.0, threads=2))
        content = self.save("first", sample(value=3.0, target=2.0, bound="at most"))
        self.assertEqual(list(content["made_with"]), ["first", "second"])
        first, second = content["entries"]
        wanted = {"module": "first", "name": "n", "value": 3.0, "nodes": 9, "threads": 1}
        self.assertEqual({**first, **wanted}, first)
        self.assertIs(first["holds"], False)
        self.assertEqual(first["commit"], "abc")
        self.assertEqual((second["value"], second["spread"]), (0.3333, [0.3, 0.4]))

    def test_two_entries_of_one_name_are_refused(self):
        with self.assertRaises(RuntimeError):
            self.save("first", sample(), sample())
        self.assertFalse(self.path.exists())

    def test_table_tells_every_entry_and_whether_its_target_is_met(self):
        met = sample(name="met", target=1.0, bound="at most", spread=(0.5, 2.0), best=0.9)
        missed = sample(name="missed", target=2.0, bound="at least", nodes=None)
        lines = results.table("module", [met, missed, sample(name="free")])
        self.assertEqual(len(lines), 5)
        self.assertRegex(lines[2], "at most 1 +holds$")
        self.assertRegex(lines[3], "at least 2 +DOES NOT HOLD$")
        self.assertNotIn("hold", lines[4])

    def test_commit_and_processor_are_named(self):
        self.assertRegex(results.commit(), r"^(unknown|[0-9a-f]{12}\+?)$")
        self.assertIn("cores", results.processor())


class TestQuiet(unittest.TestCase):
    def disturbed(self, patience, cores, tell=None):
        """Numbers that are taken beside other work on so many `cores`, and the one that counts."""
        taken, last = [], cores.pop
        with mock.patch.object(quiet.OtherWork, "cores", lambda self: last(0)):
            with mock.patch.object(quiet, "LOOK", 0.0):
                watch = quiet.Quiet(tell)
                watch.patience = patience
                found = watch.measure(lambda: taken.append(0) or len(taken))
        return found, watch.mark([sample()])[0].other_work

    def test_disturbed_measurements_are_repeated_on_a_quiet_machine(self):
        cores = [0.0, 1.0, 0.9, 0.1, 0.05]  # looked, measured, looked, looked, measured
        self.assertEqual(self.disturbed(60.0, cores), (2, 0.05))

    def test_without_patience_the_first_one_counts(self):
        self.assertEqual(self.disturbed(0.0, [1.0]), (1, 1.0))

    def test_end_of_patience_is_told_once(self):
        told = []
        self.assertEqual(self.disturbed(1e-9, [0.7, 0.8], told.append), (1, 0.8))
        self.assertEqual(len(told), 1)

    def test_own_work_is_not_that_of_others(self):
        watch = quiet.OtherWork()
        before, start = quiet._own(), time.process_time()
        while time.process_time() - start < 0.2:
            pass
        self.assertAlmostEqual(quiet._own() - before, 0.2, delta=0.05)
        self.assertGreaterEqual(watch.cores(), 0.0)


class TestSheet(unittest.TestCase):
    def test_every_fourth_row_of_sides_inside_is_a_fold_line(self):
        plan = sheet.square_sheet(13)
        rows = plan.nodes[plan.creases, 1] / sheet.SPACING
        self.assertEqual(sorted(set(np.round(rows).ravel())), [4.0, 8.0])
        self.assertEqual(len(plan.creases), 2 * 12)
        self.assertEqual(set(plan.crease_signs), {1, -1})

    def test_nodes_are_a_little_out_of_place(self):
        plan = sheet.square_sheet(10)
        away = np.std(plan.places - plan.nodes) / sheet.SPACING
        self.assertAlmostEqual(away / sheet.PERTURBATION, 1.0, delta=0.2)


class TestLammps(unittest.TestCase):
    SIDE = 4

    def sections(self):
        """Lines of the data file by section; those before the first one under ''."""
        path = scratch() / "sheet.data"
        lammps.write_data(sheet.square_sheet(self.SIDE), path)
        found, name = {"": []}, ""
        for line in path.read_text().splitlines()[1:]:
            if line.split(" ")[0] in ("Masses", "Atoms", "Bonds"):
                name = line.split(" ")[0]
                found[name] = []
            elif line:
                found[name].append(line.split())
        return found

    def test_data_are_the_sheet(self):
        data, plan = self.sections(), sheet.square_sheet(self.SIDE)
        nodes, sides = len(plan.nodes), 3 * self.SIDE**2 - 4 * self.SIDE + 1
        self.assertEqual(data[""][:2], [[str(nodes), "atoms"], [str(sides), "bonds"]])
        box = np.array([line[:2] for line in data[""] if line[-1].endswith("hi")], dtype=float)
        atoms = np.array(data["Atoms"], dtype=float)
        self.assertEqual(atoms[:, 0].tolist(), list(range(1, nodes + 1)))
        self.assertLess(np.abs(atoms[:, 3:] - plan.places).max(), 1e-11)
        self.assertTrue((box[:, 0] < atoms[:, 3:]).all() and (atoms[:, 3:] < box[:, 1]).all())
        bonds = np.array(data["Bonds"], dtype=int)
        self.assertEqual(bonds[:, 0].tolist(), list(range(1, sides + 1)))
        self.assertEqual((bonds[:, 2:] - 1).tolist(), plan.sides().tolist())
        diagonal = (bonds[:, 3] - bonds[:, 2]) == self.SIDE + 1
        self.assertEqual((bonds[:, 1] == 2).tolist(), diagonal.tolist())
        self.assertEqual(diagonal.sum(), (self.SIDE - 1) ** 2)

    def test_commands_never_make_new_lists_and_run_twice(self):
        lines = [line.split() for line in lammps.input_text(1000).splitlines()]
        commands = [line[0] for line in lines]
        order = ["units", "atom_style", "bond_style", "read_data", "bond_coeff", "fix", "run"]
        self.assertEqual(sorted(order, key=commands.index), order)
        self.assertIn("neigh_modify delay 1000000 every 1000000 check no".split(), lines)
        self.assertNotIn("pair_style", commands)
        self.assertEqual([line[1] for line in lines if line[0] == "run"], ["100", "1000"])
        lengths = [float(line[3]) for line in lines if line[0] == "bond_coeff"]
        self.assertAlmostEqual(lengths[1] / lengths[0], np.sqrt(2))

    def test_loop_time_is_that_of_the_last_run(self):
        loop = "Loop time of {} on 1 procs for {} steps with 16 atoms\n"
        use = "{}% CPU use with 1 MPI tasks x no OpenMP threads\n"
        said = "".join(
            loop.format(seconds, steps) + use.format(share)
            for seconds, steps, share in (("9", 100, 30.0), ("0.5", 1000, 80.0))
        )
        self.assertAlmostEqual(lammps.loop_time(said, 2), 5e-4)
        self.assertAlmostEqual(lammps.loop_time(said, 1), 4e-4)
        with self.assertRaisesRegex(RuntimeError, "ERROR: no"):
            lammps.loop_time("ERROR: no such style", 1)


class TestWorker(unittest.TestCase):
    def test_worker_measures_each_path_and_says_why_it_cannot(self):
        for path in benchmarks.PATHS:
            plan = cases.plan(6, 1, path, True, 1)
            with workers.workers({"one": plan}) as started:
                for _ in range(2):
                    answer = started["one"].measure(20)
                    self.assertGreater(answer[cases.clock(1)], 0)
                    self.assertEqual(answer["nodes"], 36)
        with self.assertRaisesRegex(RuntimeError, "no_path"):
            workers.Worker("sheet", side=6, path="no_path", everything=False)


if __name__ == "__main__":
    unittest.main()

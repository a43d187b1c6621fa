# SPDX-License-Identifier: GPL-2.0-or-later
"""A run that goes wrong is stopped soon, with the reason, and its last good state comes back."""

import re
import unittest

import membrane
import numpy as np
from membrane import scene
from membrane.parameters import SailParameters
from membrane.results.case_folder import LAST_GOOD
from membrane.run import driver
from support import O, SceneTest, film_of_the_sail, scratch, set_engines


class WatchTest(SceneTest):
    def make(self, share, *, speed=1e-6, tolerance=0.1, **engine):
        """The flat film at `share` of its critical step, with random velocities [m/s]."""
        O.reset()
        mesh, flat = film_of_the_sail()
        self.net = scene.add_membrane(flat, mesh.triangles)
        self.sail = set_engines(
            self.net, force_time_step=True, energy_tolerance=tolerance, **engine
        )
        rng = np.random.default_rng(4)
        for i in self.net.bodyIds:
            O.bodies[i].state.vel = (speed * rng.normal(size=3)).tolist()
        O.dt = share * self.sail.forces.criticalTimeStep()

    def stopped(self, most):
        """Steps to the stop, and what it says."""
        for step in range(1, most + 1):
            try:
                O.step()
            except RuntimeError as error:
                return step, str(error)
        self.fail(f"not stopped in {most} steps")


class TestStop(WatchTest):
    def test_step_too_long_is_stopped_within_a_few_hundred_steps(self):
        for share in (1.02, 1.05, 1.2, 2.0, 5.0):
            for zeta in (0.0, 0.02):
                self.make(share, zeta=zeta)
                steps, message = self.stopped(300)
                with self.subTest(share=share, zeta=zeta, message=message):
                    self.assertIn("from nowhere", message)
                    self.assertRegex(message, r"side \d+-\d+ \(bodies #\d+ and #\d+\)")
                    self.assertRegex(message, r"node \d+ is the fastest")
                    self.assertGreater(steps, 1)

    def test_strong_damping_with_a_step_too_long_is_blamed(self):
        self.make(1.1, zeta=1.0)
        _, message = self.stopped(300)
        self.assertRegex(message, "damping gave .* from nowhere")

    def test_step_below_the_limit_is_never_stopped(self):
        for zeta in (0.0, 0.02):
            self.make(0.95, zeta=zeta)
            scene.advance(3000)

    def test_membrane_at_rest_is_never_stopped(self):
        self.make(0.5, speed=0.0)
        scene.advance(2000)

    def test_membrane_that_only_flies_is_never_stopped(self):
        self.make(0.5, speed=0.0)
        for i in self.net.bodyIds:
            O.bodies[i].state.vel = (3.0, 4.0, 5.0)
        scene.advance(2000)

    def test_push_by_hand_is_energy_from_nowhere(self):
        self.make(0.5)
        scene.advance(10)
        O.bodies[self.net.bodyIds[7]].state.vel = (0, 0, 1.0)
        self.assertLessEqual(self.stopped(10)[0], 2)

    def test_wrong_settings_are_refused(self):
        with self.assertRaisesRegex(ValueError, "tolerance"):
            membrane.MembraneWatch(tolerance=0.0)
        with self.assertRaisesRegex(ValueError, "period"):
            membrane.MembraneWatch(period=0)
        O.engines = [membrane.MembraneWatch()]
        with self.assertRaisesRegex(RuntimeError, "ledger is not set"):
            O.step()

    def test_watch_changes_nothing(self):
        runs = []
        for tolerance in (0.1, 0):
            self.make(0.5, tolerance=tolerance, zeta=0.02)
            scene.advance(500)
            runs.append(self.sail.positions())
        np.testing.assert_array_equal(*runs)


class TestRestore(WatchTest):
    def test_last_good_state_runs_on_with_a_shorter_step(self):
        self.make(0.5, speed=1e-3, zeta=0.02)
        scene.advance(450)
        O.dt *= 2.4
        steps, _ = self.stopped(300)
        self.assertGreater(np.abs([s.vel for s in self.states()]).max(), 2e-3)
        time = self.sail.watch.restore()
        self.assertEqual(O.time, time)
        self.assertLess(np.abs([s.vel for s in self.states()]).max(), 1e-2)
        O.dt = 0.5 * self.sail.forces.criticalTimeStep()
        before = self.sail.ledger.total
        scene.advance(500)
        self.assertLess(self.sail.ledger.total, 1.01 * before)

    def test_saved_watch_stops_at_the_same_step_with_the_same_words_and_state(self):
        for calm in (10, 250):  # steps: with the states that were saved, and with later ones
            self.make(0.5, speed=1e-3, zeta=0.02)
            scene.advance(450)
            saved = O.time
            for form in (".xml", ".yade", ":memory:"):
                O.save(self.place(form), quiet=True)
            expected = self.end(calm)
            self.assertEqual(expected[2] < saved, calm == 10)
            for form in (".xml", ".yade", ":memory:"):
                O.reset()
                O.load(self.place(form), quiet=True)
                found = self.end(calm)
                with self.subTest(calm=calm, form=form):
                    self.assertEqual(found[:-1], expected[:-1])
                    np.testing.assert_array_equal(found[-1], expected[-1])

    def place(self, form):
        return ":memory:watch" if form == ":memory:" else str(scratch() / f"watch{form}")

    def end(self, calm):
        """The stop by a step too long after `calm` steps: when, its words, and what comes back."""
        scene.advance(calm)
        O.dt *= 2.08
        steps, words = self.stopped(300)
        (watch,) = [e for e in O.engines if isinstance(e, membrane.MembraneWatch)]
        time, ledger = watch.restore(), watch.ledger
        book = [ledger.kinetic, ledger.dampingWork, ledger.balance, ledger.forces is not None]
        bodies = [[body.state.pos, body.state.vel] for body in O.bodies]
        return steps, words, time, book, np.array(bodies)

    def states(self):
        return [O.bodies[i].state for i in self.net.bodyIds]

    def test_nothing_kept_is_a_message(self):
        with self.assertRaisesRegex(RuntimeError, "no state was kept"):
            membrane.MembraneWatch().restore()


class TestDeploy(unittest.TestCase):
    def test_run_forced_too_far_leaves_its_last_good_state_and_no_nan(self):
        O.reset()
        folder = scratch() / "too_far"
        p = SailParameters(dt=2.6e-5, force_time_step=True, duration=0.05, shapes_interval=0)
        with self.assertRaisesRegex(RuntimeError, "last good state") as caught:
            driver.deploy(p, folder, pictures=False)
        self.assertRegex(str(caught.exception), "from nowhere|critical")
        text = (folder / "history.csv").read_text()
        self.assertIsNone(re.search("nan|inf", text))
        O.reset()
        O.load(str(folder / LAST_GOOD), quiet=True)
        positions = np.array([body.state.pos for body in O.bodies])
        self.assertTrue(np.isfinite(positions).all())
        O.dt = 5e-6
        scene.advance(200)
        O.reset()


if __name__ == "__main__":
    unittest.main()

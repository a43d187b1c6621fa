# SPDX-License-Identifier: GPL-2.0-or-later
"""While a scene runs in the background Python may ask, save and change without disturbing it."""

import threading
import unittest

import numpy as np
from membrane import scene
from support import O, SceneTest, force_engine, grid, node_states, scratch
from yade import wrapper as yade

STEPS = 1500


def spinning(path, period=7):
    """A creased sheet that spins and crumples, partly held; a MembraneScene."""
    O.reset()
    nodes, triangles = grid(6)
    nodes -= nodes.mean(axis=0)
    creases = [(21 + i, 22 + i) for i in range(6)]
    net = scene.add_membrane(
        nodes, triangles, creases, [-1] * 6, interactions=path == "law2", alpha=1.0
    )
    made = scene.set_engines(
        net, path=path, exchange_period=period, beta=10, theta0=2.0, zeta=0.02, air_density=1e-2
    )
    made.hold([0, 24])
    O.dt = 0.3 * made.forces.criticalTimeStep()
    scene.set_spin(made, 20.0)
    return made


def run_in_background(steps, meanwhile, most=100):
    """Run so many steps in YADE's thread; calls `meanwhile` up to `most` times. Gives how often."""
    O.run(steps, False)
    calls = 0
    while O.running and calls < most:
        meanwhile(calls)
        calls += 1
    O.wait()
    return calls


class TestBackground(SceneTest):
    def ends(self, path, meanwhile=None, most=100):
        """Where a run ends, with what is done meanwhile, and how often it was."""
        made = spinning(path)
        calls = run_in_background(STEPS, lambda n: meanwhile and meanwhile(made, n), most)
        self.assertEqual(O.iter, STEPS)
        return node_states(made.membrane), calls

    def undisturbed(self, path, meanwhile, most=100):
        expected, _ = self.ends(path)
        found, calls = self.ends(path, meanwhile, most)
        self.assertGreaterEqual(calls, 2, "it was hardly asked anything")
        np.testing.assert_array_equal(found, expected)

    def test_questions_change_nothing(self):
        questions = (
            lambda made: made.forces.writeBack(),
            lambda made: made.forces.criticalTimeStep(),
            lambda made: made.forces.creaseEnergy(),
            lambda made: made.forces.creaseAngles([]),
            lambda made: made.forces.lastPositions(),
            lambda made: made.forces.creaseForces(),
            lambda made: made.membrane.elasticEnergy(),
            lambda made: made.membrane.lengths([]),
            lambda made: made.ledger.balance,
            lambda made: made.ledger.crease,
            lambda made: made.field.energy(),
        )
        for path in scene.PATHS:
            with self.subTest(path):
                self.undisturbed(path, lambda made, n: questions[n % len(questions)](made))

    def test_bodies_brought_up_to_date_all_the_time_change_nothing(self):
        ends = []
        for often in (0, 10**6):
            made = spinning("fused", period=50)
            calls = run_in_background(8 * STEPS, lambda n: made.forces.writeBack(), often)
            self.assertGreaterEqual(calls, min(often, 50))
            ends.append(node_states(made.membrane))
        np.testing.assert_array_equal(ends[1], ends[0])

    def test_answers_belong_to_one_step(self):
        """A sheet flies by so fast that nodes of two steps would lie far from one another."""
        for path in scene.PATHS:
            made = spinning(path)
            made.hold([0, 24], False)
            made.forces.airDensity = made.forces.beta = 0.0
            for i in made.membrane.bodyIds:
                O.bodies[i].state.vel = (1e3, 0, 0)
            apart, rest = [], np.array(made.membrane.restLengths)
            run_in_background(
                STEPS,
                lambda n: apart.append(np.abs(np.array(made.membrane.lengths([])) - rest).max()),
            )
            self.assertGreater(len(apart), 2)
            self.assertLess(max(apart), 1e-3 * 1e3 * O.dt)

    def test_forces_are_not_summed_while_threads_add_them(self):
        made = spinning("law2")
        refused = []

        def ask(_):
            try:
                made.forces.nodeForces()
            except RuntimeError as error:
                refused.append(str(error))

        calls = run_in_background(STEPS, ask)
        self.assertLessEqual(calls - 1, len(refused))
        self.assertIn("the scene is running", refused[0])

    def test_a_save_changes_nothing_and_is_of_one_step(self):
        for path in scene.PATHS:
            with self.subTest(path):
                file = scratch() / f"background_{path}.yade.gz"
                self.undisturbed(path, lambda made, n: O.save(str(file), quiet=True), most=5)
                O.reset()
                O.load(str(file), quiet=True)
                saved = node_states(force_engine().membrane)
                near = O.iter
                spinning(path)
                scene.advance(max(0, near - 2))
                for _ in range(6):  # the clock may be some steps behind
                    if np.array_equal(node_states(force_engine().membrane), saved):
                        break
                    scene.advance(1)
                else:
                    self.fail("the saved nodes are those of no step")

    def test_parameters_may_be_set(self):
        for path in scene.PATHS:
            expected, _ = self.ends(path)

            def change(made, n):
                made.forces.beta = 10 + (n % 2)
                made.forces.beta = 10

            found, calls = self.ends(path, change)
            self.assertGreater(calls, 2)
            self.assertTrue(np.all(np.isfinite(found)))
            self.assertLess(np.abs(found - expected)[0].max(), 0.1)

    def test_a_step_may_ask_for_itself(self):
        """From engines before and after, in the thread that runs; also in the very first step."""
        for path in scene.PATHS:
            made = spinning(path)
            yade.asked = asked = []
            yade.asking = made.forces
            command = (
                "from yade import wrapper; wrapper.asked.append(wrapper.asking.creaseEnergy())"
            )
            runner = dict(iterPeriod=100, command=command, initRun=True)
            O.engines = [yade.PyRunner(**runner), *O.engines, yade.PyRunner(**runner)]
            O.run(500, True)
            self.assertEqual(len(asked), 10)
            del yade.asked, yade.asking

    def test_several_threads_ask_at_once(self):
        made = spinning("fused")
        answers, stop = [], threading.Event()

        def ask():
            while not stop.is_set():
                answers.append(made.forces.criticalTimeStep())

        threads = [threading.Thread(target=ask) for _ in range(3)]
        O.run(STEPS, False)
        for thread in threads:
            thread.start()
        O.wait()
        stop.set()
        for thread in threads:
            thread.join(60)
            self.assertFalse(thread.is_alive())
        self.assertGreater(len(answers), 3)
        expected, _ = self.ends("fused")
        self.assertEqual(len(answers), np.isfinite(answers).sum())
        self.assertEqual(expected.shape, (2, 49, 3))

    def test_a_scene_of_other_engines_is_not_waited_for(self):
        """None of our engines ever arrives: a question is answered all the same."""
        made = spinning("fused")
        made.forces.dead = made.ledger.dead = made.watch.dead = True
        O.run(-1, False)
        self.assertGreater(made.forces.criticalTimeStep(), 0)
        O.pause()
        O.wait()


if __name__ == "__main__":
    unittest.main()

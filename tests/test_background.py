# SPDX-License-Identifier: GPL-2.0-or-later
"""While a scene runs in the background Python may ask, save and change without disturbing it."""

import threading
import time
import unittest

import numpy as np
from membrane import scene
from support import O, SceneTest, force_engine, grid, node_states, scratch, set_engines
from yade import wrapper as yade


def spinning(path, period=7):
    """A creased sheet that spins and crumples, partly held; a MembraneScene."""
    O.reset()
    nodes, triangles = grid(6)
    nodes -= nodes.mean(axis=0)
    creases = [(21 + i, 22 + i) for i in range(6)]
    net = scene.add_membrane(
        nodes, triangles, creases, [-1] * 6, interactions=path == "law2", alpha=1.0
    )
    made = set_engines(
        net, path=path, exchange_period=period, beta=10, theta0=2.0, zeta=0.02, air_density=1e-2
    )
    made.hold([0, 24])
    O.dt = 0.3 * made.forces.criticalTimeStep()
    scene.set_spin(made, 20.0)
    return made


def ask(made, calls, meanwhile):
    """Call `meanwhile` so many times with their number while the scene runs; gives its steps."""
    O.run(-1, False)
    while O.iter < 20:
        time.sleep(1e-3)
    for number in range(calls):
        meanwhile(number)
    O.stopAtIter = O.iter + 2000  # O.pause() would not wait for the end of the step
    O.wait()
    return O.iter


class TestBackground(SceneTest):
    def undisturbed(self, path, meanwhile, calls=100, period=7):
        """The nodes go as if nobody had done anything meanwhile; gives the number of steps."""
        made = spinning(path, period)
        steps = ask(made, calls, lambda number: meanwhile(made, number))
        found = node_states(made.membrane)
        made = spinning(path, period)
        scene.advance(steps)
        np.testing.assert_array_equal(found, node_states(made.membrane))
        return steps

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
        self.undisturbed("fused", lambda made, _: made.forces.writeBack(), 3000, period=50)

    def test_answers_belong_to_one_step(self):
        """A sheet flies by so fast that nodes of two steps would lie far from one another."""
        for path in scene.PATHS:
            made = spinning(path)
            made.hold([0, 24], False)
            made.forces.airDensity = made.forces.beta = 0.0
            for i in made.membrane.bodyIds:
                O.bodies[i].state.vel = (1e3, 0, 0)
            apart, rest = [], np.array(made.membrane.restLengths)

            def look(_):
                apart.append(np.abs(np.array(made.membrane.lengths([])) - rest).max())

            ask(made, 50, look)
            self.assertLess(max(apart), 1e-3 * 1e3 * O.dt)

    def test_forces_are_not_summed_while_threads_add_them(self):
        made = spinning("law2")

        def refused(_):
            with self.assertRaisesRegex(RuntimeError, "the scene is running"):
                made.forces.nodeForces()

        ask(made, 5, refused)
        self.assertEqual(len(made.forces.nodeForces()), 49)

    def test_a_save_changes_nothing_and_is_of_one_step(self):
        for path in scene.PATHS:
            with self.subTest(path):
                file = scratch() / f"background_{path}.yade.gz"
                steps = self.undisturbed(path, lambda made, _: O.save(str(file), quiet=True), 5)
                O.reset()
                O.load(str(file), quiet=True)
                saved = node_states(force_engine().membrane)
                made = spinning(path, period=1)
                for _ in range(steps):  # YADE's clock is saved before the nodes, and may be behind
                    scene.advance(1)
                    if np.array_equal(node_states(made.membrane), saved):
                        break
                else:
                    self.fail("the saved nodes are those of no step")

    def test_parameters_may_be_set(self):
        for path in scene.PATHS:
            made = spinning(path)

            def change(number):
                made.forces.beta = 10 + (number % 2)

            ask(made, 50, change)
            self.assertTrue(np.all(np.isfinite(node_states(made.membrane))))

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
        answers, threads = [], []

        def ask_often():
            for _ in range(20):
                answers.append(made.forces.criticalTimeStep())

        def start(_):
            threads.append(threading.Thread(target=ask_often))
            threads[-1].start()

        def join(_):
            for thread in threads:
                thread.join()

        steps = ask(made, 4, lambda number: (start, start, start, join)[number](number))
        self.assertEqual(np.isfinite(answers).sum(), 60)
        found = node_states(made.membrane)
        made = spinning("fused")
        scene.advance(steps)
        np.testing.assert_array_equal(found, node_states(made.membrane))

    def test_a_scene_of_other_engines_is_not_waited_for(self):
        """None of our engines ever arrives: a question is answered all the same."""
        made = spinning("fused")
        made.forces.dead = made.ledger.dead = made.watch.dead = True
        limits = []
        ask(made, 1, lambda _: limits.append(made.forces.criticalTimeStep()))
        self.assertGreater(limits[0], 0)


if __name__ == "__main__":
    unittest.main()

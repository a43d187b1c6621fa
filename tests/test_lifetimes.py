# SPDX-License-Identifier: GPL-2.0-or-later
"""Membranes and engines that outlive their scene, and saved attributes that nobody saved."""

import unittest
from functools import lru_cache

import membrane
import numpy as np
from membrane import scene
from support import O, SceneTest, grid, node_states, scratch, set_engines
from yade import wrapper as yade

# What asks the scene for the nodes; each ends with a sentence where it holds others.
QUESTIONS = {
    "Membrane": (
        lambda made: made.membrane.elasticEnergy(),
        lambda made: made.membrane.lengths([]),
        lambda made: made.membrane.tensions([]),
        lambda made: made.membrane.addInteractions(),
        lambda made: made.membrane.removeInteractions(),
    ),
    "engine": (
        lambda made: made.forces.criticalTimeStep(),
        lambda made: made.forces.creaseEnergy(),
        lambda made: made.forces.creaseAngles([]),
        lambda made: made.forces.nodeForces(),
    ),
    "others": (
        lambda made: made.field.energy(),
        lambda made: made.watch.restore(),
        lambda made: made.hub.totalInertia,
        lambda made: made.hub.kinetic,
    ),
}
# Those that have nothing to ask.
STATEMENTS = (
    lambda made: made.forces.writeBack(),
    lambda made: made.forces.forgetVelocities(),
    lambda made: made.forces.lastPositions(),
    lambda made: made.forces.creaseForces(),
    lambda made: made.ledger.balance,
    lambda made: made.ledger.crease,
    lambda made: made.membrane.hasInteractions,
)


def spinning(path, cells=4, steps=250):
    """A creased sheet on a free hub that spins for a while: a MembraneScene."""
    nodes, triangles = grid(cells)
    nodes -= nodes.mean(axis=0)
    middle = len(nodes) // 2
    net = scene.add_membrane(
        nodes, triangles, [(middle, middle + 1)], [1], interactions=path == "law2"
    )
    made = set_engines(
        net, path=path, beta=3, zeta=0.02, driven=net.bodyIds[:2], hub_inertia=1e-5, omega=20.0
    )
    made.hold([0, 1])
    O.dt = 0.3 * made.forces.criticalTimeStep()
    scene.set_spin(made, 20.0)
    scene.advance(steps)
    return made


@lru_cache(maxsize=None)
def saved(path):
    """File with the scene of `spinning`."""
    O.reset()
    spinning(path)
    file = scratch() / f"lifetimes_{path}.xml"
    O.save(str(file), quiet=True)
    return file


class TestOtherScenes(SceneTest):
    def others(self):
        """Go to scenes without the nodes in turn; gives their names."""
        O.reset()
        yield "reset"
        for _ in range(40):
            O.bodies.append(yade.Body())
        yield "bodies of others"
        O.reset()
        spinning("fused", steps=0)
        yield "another membrane"
        O.reset()
        O.load(str(saved("law2")), quiet=True)
        yield "loaded"
        O.bodies.clear()
        yield "cleared"
        O.reset()
        O.addScene()
        O.switchToScene(1)
        yield "second scene"
        O.reset()

    def test_questions_about_nodes_that_are_not_there_end_with_a_sentence(self):
        saved("law2")
        for path in scene.PATHS:
            O.reset()
            made = spinning(path)
            for name in self.others():
                for group, questions in QUESTIONS.items():
                    for number, ask in enumerate(questions):
                        with self.subTest(path=path, scene=name, group=group, number=number):
                            with self.assertRaisesRegex(
                                RuntimeError, "is not in the scene|has no body in the scene"
                            ):
                                ask(made)
                for say in STATEMENTS:
                    say(made)
                self.assertFalse(made.membrane.hasInteractions)

    def test_engines_do_not_act_on_other_nodes(self):
        for path in scene.PATHS:
            for _ in self.others_of(path):
                O.engines = [yade.ForceResetter(), self.made.forces, yade.NewtonIntegrator()]
                with self.assertRaisesRegex(RuntimeError, "is not in the scene"):
                    O.step()

    def others_of(self, path):
        O.reset()
        self.made = spinning(path)
        yield from self.others()

    def test_an_engine_goes_on_where_its_nodes_are_again(self):
        O.reset()
        made = spinning("fused", steps=100)
        here = node_states(made.membrane)[0]
        O.addScene()
        O.switchToScene(1)
        with self.assertRaisesRegex(RuntimeError, "is not in the scene"):
            made.forces.criticalTimeStep()
        O.switchToScene(0)
        np.testing.assert_array_equal(node_states(made.membrane)[0], here)
        scene.advance(10)

    def test_a_state_is_restored_right_after_loading(self):
        for path in scene.PATHS:
            file = saved(path)
            O.reset()
            O.load(str(file), quiet=True)
            made = scene.loaded()
            kept = made.watch.restore()
            self.assertGreater(kept, 0)
            self.assertEqual(O.time, kept)
            scene.advance(10)
            made = None


class TestSavedAttributes(SceneTest):
    """A file may hold anything."""

    def test_wrong_lengths_are_refused(self):
        for cls, attributes, message in (
            ("MembraneLedger", {"started": True}, "doneWorks has 0 entries"),
            ("MembraneLedger", {"started": True, "doneWorks": [0.0]}, "doneWorks has 1 entries"),
            ("MembraneLedger", {"contactWorks": [1.0]}, "contactPairs, contactWorks and"),
            ("MembraneWatch", {"lowest": [0.0]}, "lowest has 1 entries"),
            ("MembraneWatch", {"lowest": [0.0] * 11}, "lowest has 11 entries"),
            ("MembraneWatch", {"newerBodies": [0.0] * 13}, "newerBodies has 13 entries"),
            ("MembraneWatch", {"olderBodies": [0.0] * 15}, "olderBodies has 15 entries"),
            ("MembraneWatch", {"newerHub": [0.0]}, "newerHub has 1 entries"),
        ):
            with self.subTest(cls), self.assertRaisesRegex(ValueError, f"{cls}: {message}"):
                getattr(membrane, cls)(**attributes)

    def test_they_are_refused_in_a_file_too(self):
        text = saved("fused").read_text()
        for name in ("doneWorks", "lowest", "newerBodies"):
            with self.subTest(name):
                begin = text.index(f"<{name}>")
                end = text.index(f"</{name}>")
                one = (
                    f"<{name}>\n<count>1</count>\n<item_version>0</item_version>\n<item>0</item>\n"
                )
                file = scratch() / f"short_{name}.xml"
                file.write_text(text[:begin] + one + text[end:])
                O.reset()
                with self.assertRaisesRegex(Exception, f"{name} has 1 entries"):
                    O.load(str(file), quiet=True)

    def test_ids_that_no_body_has(self):
        spinning("fused")
        for ids in ([-1], [10**6], [2**31 - 1]):
            O.engines = [membrane.SpoolRotation(ids=ids, touching=ids, reach=1.0)]
            O.step()
        self.assertEqual(O.iter, 253)


class TestLedgerAfterLoading(SceneTest):
    def test_crease_energy_is_that_of_the_save(self):
        for path in scene.PATHS:
            O.reset()
            made = spinning(path)
            crease, balance = made.ledger.crease, made.ledger.balance
            self.assertGreater(crease, 0)
            file = scratch() / f"crease_{path}.xml"
            O.save(str(file), quiet=True)
            O.reset()
            O.load(str(file), quiet=True)
            ledger = scene.loaded().ledger
            self.assertEqual((ledger.crease, ledger.balance), (crease, balance))


class TestMembraneOfAnEngine(SceneTest):
    def test_none_or_another(self):
        for path in scene.PATHS:
            O.reset()
            made = spinning(path)
            small = scene.add_membrane(*grid(1), interactions=path == "law2")
            large = scene.add_membrane(*grid(9), interactions=path == "law2")
            for other in (None, small, large, membrane.Membrane()):
                made.forces.membrane = other
                with self.subTest(path=path, other=other):
                    self.assertTrue(np.isfinite(made.ledger.crease))
                    self.assertEqual(made.forces.lastPositions(), [])
                    self.assertEqual(made.forces.creaseForces(), [])
                    made.forces.writeBack()
                    if other is None:
                        with self.assertRaisesRegex(RuntimeError, "membrane is not set"):
                            made.forces.criticalTimeStep()
                    with self.assertRaises(RuntimeError):
                        scene.advance(3)

    def test_none_in_a_step_that_was_stopped(self):
        """The ledger is then up to date, and the watch has no forces to look at."""
        for path in scene.PATHS:
            O.reset()
            made = spinning(path)
            made.watch.tolerance = 1e-300
            with self.assertRaisesRegex(RuntimeError, "from nowhere"):
                scene.advance(300)
            made.forces.membrane = None
            made.watch()


class TestHub(SceneTest):
    def test_other_nodes_take_other_places(self):
        made = spinning("fused")
        made.hold([0, 1], False)
        made.hold([23, 24])
        made.ledger.dead = made.watch.dead = True
        before = node_states(made.membrane)[0]
        made.hub.nodes = [23, 24]
        scene.advance(1)
        moved = np.linalg.norm(node_states(made.membrane)[0] - before, axis=1)
        self.assertLess(moved.max(), 2 * 20.0 * 0.06 * O.dt)

    def test_nodes_out_of_range_twice_or_free_are_refused(self):
        made = spinning("law2")
        for nodes, message in (
            ([0, 25], "nodes: 25 must be in 0 ... 24"),
            ([-1], "nodes: -1 must be in 0 ... 24"),
            ([0, 0], "nodes: 0 is listed twice"),
            ([0, 7], "node 7 must be held"),
        ):
            made.hub.nodes = nodes
            with self.assertRaisesRegex(RuntimeError, f"FreeHub: {message}"):
                scene.advance(1)


class TestThreads(SceneTest):
    def test_so_many_threads_are_refused(self):
        made = spinning("fused", steps=0)
        made.forces.ompThreads = 10**5
        with self.assertRaisesRegex(RuntimeError, "ompThreads = 100000 must be <= 1024"):
            scene.advance(1)

    def test_more_threads_than_nodes(self):
        made = spinning("fused", steps=0)
        made.forces.ompThreads = 1000
        scene.advance(30)
        many = node_states(made.membrane)[0]
        O.reset()
        made = spinning("fused", steps=30)
        self.assertLess(np.abs(node_states(made.membrane)[0] - many).max(), 1e-12)


if __name__ == "__main__":
    unittest.main()

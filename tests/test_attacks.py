# SPDX-License-Identifier: GPL-2.0-or-later
"""The attacks of tests/attacks: they miss nothing and notice harm; with --full, they do none."""

import re
import subprocess
import sys
import unittest
from unittest import mock

import numpy as np
from membrane import scene
from support import O, ROOT, SceneTest, long
from yade import wrapper as yade

sys.path.insert(0, str(ROOT / "tests" / "attacks"))

import arsenal  # noqa: E402
import attacks  # noqa: E402
import damage  # noqa: E402
import situations  # noqa: E402


class TestTargets(SceneTest):
    def test_every_attribute_is_known_with_its_type(self):
        for name, cls in arsenal.CLASSES.items():
            documented = {
                key: re.search(":yattrtype:`([^`]*)`", member.__doc__ or "")
                for key, member in vars(cls).items()
            }
            for key, kind in documented.items():
                if kind:
                    self.assertEqual(arsenal.OWN[name][key], kind[1], f"{name}.{key}")
        self.assertEqual(arsenal.OWN["MembraneLedger"]["doneWorks"], "vector<Real>")  # hidden
        self.assertEqual(set(arsenal.OWN), set(arsenal.CLASSES))

    def test_each_attribute_method_and_path_is_attacked(self):
        targets = {name.split()[0] for name in attacks.names(1)}
        for target in ("FreeHub.nodes", "MembraneWatch.restore", "SpoolRotation.ids", "O.engines"):
            self.assertIn(target, targets)

    def test_the_scene_has_everything(self):
        there = {}
        for path in scene.PATHS:
            situations.run(path)
            self.assertGreater(sum(type(i.phys) is yade.FrictPhys for i in O.interactions), 0)
            for name, one in situations.objects().items():
                there[name] = there.get(name) or one in O.engines
        engines = {name for name, cls in arsenal.CLASSES.items() if issubclass(cls, yade.Engine)}
        missing = {name for name in engines if not there[name]}
        self.assertEqual(missing, {"MembraneFault", "MembraneForce"})

    def test_only_parts_of_our_own_are_damaged(self):
        for path in scene.PATHS:
            parts = damage.own_parts(damage.saved(path))
            tags = {part.tag for _, part in parts}
            self.assertLessEqual({"beta", "count", "bodyIds", "newerBodies", "node"}, tags)
            self.assertFalse(tags & {"pos", "engines", "interactionLoop", "damping"})


class TestHarm(SceneTest):
    def test_lost_numbers_are_noticed(self):
        O.bodies.append(yade.Body(shape=yade.Sphere(radius=1)))
        world = situations.World(engines=[yade.ForceResetter()])
        attacks.go_on(world)
        O.bodies[0].state.pos = (float("nan"), 0, 0)
        with self.assertRaisesRegex(attacks.Harm, "no longer finite"):
            attacks.go_on(world)

    def test_what_is_no_sentence_is_noticed(self):
        self.assertIsNone(attacks.attempt(lambda: None))
        self.assertIsInstance(attacks.attempt(lambda: int("x")), ValueError)
        with self.assertRaisesRegex(attacks.Harm, "no sentence"):
            attacks.attempt(lambda: np.testing.assert_(False, "vector::_M_range_check"))

    def test_a_run_that_a_refused_or_senseless_value_has_changed_is_noticed(self):
        def shift(world, *_):
            O.bodies[-1].state.pos += (1e-9, 0, 0)
            return answer

        for answer in ((float("nan"), None), (1.0, ValueError("no"))):
            with mock.patch.object(attacks, "SITUATIONS", [situations.running]):
                attacks.carry_out("FreeHub.spin 0", lambda _: None)
                with mock.patch.object(attacks, "attack_attribute", shift):
                    with self.assertRaisesRegex(attacks.Harm, "the run is another one"):
                        attacks.carry_out("FreeHub.spin 0", lambda _: None)


@long
class TestAttacks(unittest.TestCase):
    def test_none_does_harm(self):
        done = subprocess.run(
            [str(ROOT / "scripts" / "run.sh"), "attack"], capture_output=True, text=True
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"attack: \d{4,} attacks, 0 did harm")


if __name__ == "__main__":
    unittest.main()

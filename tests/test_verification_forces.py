# SPDX-License-Identifier: GPL-2.0-or-later
"""The plugin's forces against reference/forces.py and differences of energy, on a few states.

scripts/verify.py does it on all of them.
"""

import functools
import unittest
from unittest import mock

import numpy as np
from membrane.study import verification
from membrane.study.verification import forces
from support import SceneTest


EVEN, UNEVEN = (options for options, _ in forces.FAST.values())
STATES = ((EVEN, "flat"), (EVEN, "folded"), (EVEN, "collapsed"), (UNEVEN, "crumpled"))


def differences(sail, shape):
    """Differences of plugin and reference in one state, by term."""
    return forces.state_differences(sail, forces.random_state(sail, shape))


class TestReference(SceneTest):
    def test_rest_state_is_that_of_the_reference(self):
        for options in (EVEN, UNEVEN):
            for title, pair in forces.rest_pairs(forces.StandingSail(**options)).items():
                with self.subTest(title, **options):
                    most = forces.SHORTENING if title.startswith("L0") else forces.AGREEMENT
                    self.assertLess(forces.difference(*pair), most)

    def test_every_term_is_that_of_the_reference(self):
        for options, shape in STATES:
            for title, error in differences(forces.StandingSail(**options), shape).items():
                with self.subTest(title, shape=shape):
                    self.assertLess(error, forces.AGREEMENT)

    def test_states_reach_every_branch_of_the_laws(self):
        seen = {}
        for options, shape in STATES:
            sail = forces.StandingSail(**options)
            for branch, count in forces.branches(sail, forces.random_state(sail, shape)).items():
                seen[branch] = seen.get(branch, 0) + count
        for branch, count in seen.items():
            self.assertGreater(count, 1, branch)


class TestEnergy(SceneTest):
    def test_conservative_forces_are_gradients_of_their_energies(self):
        for options, shape in STATES:
            sail = forces.StandingSail(**options)
            found = forces.energy_differences(sail, forces.random_state(sail, shape))
            for title, (error, asked) in found.items():
                with self.subTest(title, shape=shape):
                    self.assertLess(error, forces.DIFFERENCE)
                    self.assertGreater(asked, 90)


class TestSensitivity(SceneTest):
    """What the comparison would miss, it would not test."""

    def check_noticed(self, title, shape="crumpled", **wrong):
        with mock.patch.multiple(forces.paper, **wrong):
            found = differences(forces.StandingSail(**UNEVEN), shape)
        self.assertGreater(found[title], 1e-6)

    def test_wrong_buckling_length_is_noticed(self):
        right = forces.paper.critical_length
        self.check_noticed(
            "tensions (3), (6)", critical_length=lambda l0, alpha, h: right(l0, 2 * alpha, h)
        )

    def test_swapped_heights_are_noticed(self):
        right = forces.paper.crease_frame

        def swapped(*arguments):
            frame = right(*arguments)
            heights = frame["height_d"], frame["height_c"]
            frame["height_c"], frame["height_d"] = heights
            return frame

        for law in ("paper", "conservative"):
            self.check_noticed(forces.CREASES.format(law, 0), crease_frame=swapped)

    def test_another_branch_cut_is_noticed(self):
        right = forces.paper.angle_of
        self.check_noticed(
            "crease angles", angle_of=lambda frame, inside: right(frame, inside) % (2 * np.pi)
        )

    def test_damping_of_slack_tethers_is_noticed(self):
        right = forces.paper.damping_forces

        def none_slack(x, v, sides, rest_length, *others):
            _, length = forces.paper.side_geometry(x, sides)
            return right(x, v, sides, np.minimum(rest_length, length), *others)

        for zeta in (forces.ZETA, forces.STRONG):
            self.check_noticed(forces.DAMPING.format(zeta), damping_forces=none_slack)

    def test_tethers_that_push_are_noticed(self):
        right = forces.paper.damping_forces
        self.check_noticed(
            forces.DAMPING.format(forces.STRONG) + forces.AT_PUSHED,
            "flat",
            damping_forces=lambda *rest: right(*rest, may_push=True),
        )

    def test_levers_bounded_elsewhere_or_not_at_all_are_noticed(self):
        for law in ("paper", "conservative"):
            name = f"crease_forces_{law}"
            right = getattr(forces.paper, name)
            for share in (0.0, 0.99 * forces.paper.COLLAPSED):
                with self.subTest(law, collapsed=share):
                    wrong = functools.partial(right, collapsed=share)
                    title = forces.CREASES.format(law, 0) + forces.AT_COLLAPSED
                    self.check_noticed(title, "collapsed", **{name: wrong})


class TestCheck(unittest.TestCase):
    def test_check_holds_within_its_tolerance_only(self):
        for measured, holds in ((1.0, True), (1.1, True), (0.8, False), (np.nan, False)):
            check = verification.Check("name", measured, 1.0, 0.15, "here")
            self.assertIs(check.holds, holds)
            self.assertIs(check.as_dict()["holds"], holds)

    def test_bound_holds_below_it(self):
        for measured, holds in ((-5.0, True), (1.0, True), (1.1, False), (-np.inf, False)):
            self.assertIs(verification.at_most("name", measured, 1.0, "here").holds, holds)

    def test_number_that_is_not_finite_does_not_get_into_json(self):
        self.assertIsNone(verification.recorded("n", np.nan, 1, 1, "here").as_dict()["measured"])


if __name__ == "__main__":
    unittest.main()

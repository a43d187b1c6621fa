# SPDX-License-Identifier: GPL-2.0-or-later
"""Where the method becomes unstable: a few of the limits that scripts/stability.py maps."""

import unittest

import numpy as np
from membrane.study.stability import beyond, creases, drag, negative_stiffness, timestep
from membrane.study.stability.common import bisect, grows
from support import O, SceneTest, Sheet, grid


class TestTimeStep(SceneTest):
    def check_flat_sail(self, **options):
        """The measured limit is above the estimate by no more than 5 %."""
        mesh, model = timestep.sail(**options)
        flat = timestep.placed(mesh, "flat")
        model.balance(flat)
        estimate = model.forces.criticalTimeStep()
        free = np.array([len(state.blockedDOFs) < 6 for state in model.states])
        rng = np.random.default_rng(7)
        velocities = 1e-6 * rng.normal(size=flat.shape) * free[:, None]
        self.assertFalse(grows(model, flat, velocities, estimate))
        self.assertTrue(grows(model, flat, velocities, estimate / 0.95))

    def test_estimate_is_less_than_5_percent_below_the_limit_of_the_flat_sail(self):
        self.check_flat_sail()

    def test_so_it_is_with_many_tether_segments(self):
        self.check_flat_sail(segments=8)

    def test_so_it_is_with_strong_damping_and_heavy_tips(self):
        self.check_flat_sail(zeta=1.0, tip=3.6e-3)


class TestNegativeStiffness(SceneTest):
    def stable(self, kind, angle, poisson):
        nodes, triangles, net = negative_stiffness.membrane(kind, angle, poisson)
        by_eigenvalue = negative_stiffness.lowest_eigenvalue(net, nodes) > -1e-12
        self.assertEqual(by_eigenvalue, min(net.stiffnesses) > 0)
        self.assertEqual(by_eigenvalue, negative_stiffness.runs_stably(nodes, triangles, poisson))
        return by_eigenvalue

    def test_sheet_of_flat_triangles_is_stable_up_to_where_one_triangle_loses_its_stiffness(self):
        limit = negative_stiffness.zero_angle(0.34)
        self.assertAlmostEqual(limit, 124.56, places=2)
        self.assertTrue(self.stable("uniform", limit - 3, 0.34))
        self.assertFalse(self.stable("uniform", limit + 3, 0.34))

    def test_equilateral_neighbours_bear_much_flatter_triangles(self):
        limit = negative_stiffness.zero_angle(0.34, "mixed")
        self.assertGreater(limit, 160)
        self.assertTrue(self.stable("mixed", limit - 3, 0.34))
        self.assertFalse(self.stable("mixed", limit + 3, 0.34))


class TestCreases(SceneTest):
    def test_current_lengths_throw_a_collapsed_triangle_out_and_rest_lengths_do_not(self):
        heights = np.array([1e-5, 1e-4])
        self.assertLess(creases.collapse("rest", 30.0, heights).max(), 1)
        self.assertGreater(creases.collapse("current", 30.0, heights).min(), 50)

    def test_paper_law_jumps_where_the_natural_angle_is_not_0_and_the_other_does_not(self):
        below, above = creases.force_and_energy("paper", 1.0, np.array([-1e-9, 1e-9]))[0]
        self.assertAlmostEqual(below / above, 100, places=3)
        below, above = creases.force_and_energy("conservative", 1.0, np.array([-1e-9, 1e-9]))[0]
        self.assertAlmostEqual(below / above, 1, places=3)

    def test_unequal_heights_gain_spin_from_the_paper_law_only(self):
        self.assertGreater(creases.momentum("paper", 2.0, 0.1, 0.01)[1].max(), 0.1)
        self.assertLess(creases.momentum("paper", 1.0, 0.1, 0.01)[1].max(), 1e-9)
        self.assertLess(creases.momentum("conservative", 2.0, 0.1, 0.01)[1].max(), 1e-9)


class TestDrag(SceneTest):
    def test_plate_turns_back_above_its_limit_and_swells_above_twice_that(self):
        speed, air = 6.0, 1.2
        limit = drag.limit(air, speed)
        model = drag.plate(air, drag.THICKNESS)
        self.assertGreater(drag.speed_after(model, speed, 0.99 * limit, 1), 0)
        self.assertLess(drag.speed_after(model, speed, 1.01 * limit, 1), 0)
        self.assertLess(abs(drag.speed_after(model, speed, 1.99 * limit, 1)), speed)
        self.assertGreater(abs(drag.speed_after(model, speed, 2.01 * limit, 1)), speed)

    def test_at_1_atmosphere_the_papers_step_is_far_below_the_limit(self):
        self.assertLess(drag.PAPER_STEP, 1e-2 * drag.limit(drag.ATMOSPHERE, drag.TIP_SPEED))


class TestBeyond(SceneTest):
    def test_step_above_the_limit_is_refused_and_stopped_soonest_by_the_watch(self):
        row, refused = beyond.blow_up(2.0, 500)
        self.assertIn("the critical time step", refused)
        _, _, grown, stop, _, _, _, watched, _ = row
        self.assertGreater(stop, 0)
        self.assertTrue(0 < watched < grown + stop)


class TestBuckled(SceneTest):
    def test_sheet_shrunk_to_a_point_stays_finite_and_grows_back(self):
        nodes, triangles = grid(4)
        nodes = nodes - nodes.mean(axis=0)
        sheet = Sheet(nodes, triangles, engine={"zeta": 0.02})
        sheet.place(0 * nodes)
        sheet.run_engines()
        O.dt = 0.5 * sheet.engine.criticalTimeStep()
        for _ in range(100):
            O.step()
        self.assertTrue(np.isfinite(sheet.positions()).all())
        self.assertGreater(np.ptp(sheet.positions()[:, 0]), 0)


class TestBisection(unittest.TestCase):
    def test_finds_the_limit_and_says_where_there_is_none(self):
        self.assertAlmostEqual(bisect(lambda x: x > 3.0, 1.0, 2.0, 30), 3.0, places=6)
        self.assertEqual(bisect(lambda x: False, 1.0, 2.0), np.inf)
        self.assertEqual(bisect(lambda x: True, 1.0, 2.0), 0.0)


if __name__ == "__main__":
    unittest.main()

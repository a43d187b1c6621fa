# SPDX-License-Identifier: GPL-2.0-or-later
"""The spool turns as a rigid body, every step while something may touch it, else now and then."""

import unittest

import membrane
import numpy as np
from membrane import scene
from membrane.scene import spool
from support import O, SceneTest
from yade import wrapper as yade

OMEGA, STEP = 6 * np.pi, 1e-4


class TestSpoolRotation(SceneTest):
    def setUp(self):
        super().setUp()
        self.facets = spool.add_spool()
        ball = yade.Body()
        ball.shape, ball.material = yade.Sphere(radius=5e-4), yade.FrictMat()
        ball.state.blockedDOFs = "xyzXYZ"
        self.ball = O.bodies.append(ball)
        self.turning = spool.turning(self.facets, [self.ball], OMEGA)
        O.engines = [yade.ForceResetter(), self.turning]
        O.dt = STEP
        self.start = self.corners()

    def corners(self):
        """Corners of all facets, (F, 3, 3) [m]."""
        states = ((O.bodies[i].state, O.bodies[i].shape) for i in self.facets)
        return np.array([[s.pos + s.ori * v for v in shape.vertices] for s, shape in states])

    def turned(self, angle):
        """Where the corners are after the spool turned by `angle` [rad]."""
        c, s = np.cos(angle), np.sin(angle)
        return self.start @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T

    def put_ball(self, radius):
        """Put the ball at a distance from the axis [m]."""
        O.bodies[self.ball].state.pos = (0.6 * radius, 0.8 * radius, 0.01)

    def run_inside(self, steps):
        """Run `steps` steps of a run that goes on after them."""
        O.stopAtIter = O.iter + steps + 1
        for _ in range(steps):
            O.step()

    def test_facets_are_where_the_contacts_of_a_step_need_them(self):
        self.put_ball(0.026)
        self.run_inside(1500)
        np.testing.assert_allclose(self.corners(), self.turned(OMEGA * 1499 * STEP), atol=1e-13)

    def test_velocities_lead_to_the_next_place(self):
        self.put_ball(0.026)
        self.run_inside(7)
        state = O.bodies[self.facets[3]].state
        place, velocity = np.array(state.pos), np.array(state.vel)
        self.assertEqual(tuple(state.angVel), (0, 0, OMEGA))
        O.step()
        np.testing.assert_allclose(place + STEP * velocity, state.pos, atol=1e-15)

    def test_rests_while_nothing_is_near_but_not_at_the_end_of_a_run(self):
        self.put_ball(0.03)
        self.run_inside(1)
        rested = self.corners()
        self.run_inside(500)
        np.testing.assert_array_equal(self.corners(), rested)
        scene.advance(300)
        np.testing.assert_allclose(self.corners(), self.turned(OMEGA * 801 * STEP), atol=1e-13)

    def test_is_in_place_at_once_when_something_comes_near(self):
        self.put_ball(0.03)
        self.run_inside(400)
        self.put_ball(0.0255)
        self.run_inside(1)
        np.testing.assert_allclose(self.corners(), self.turned(OMEGA * 400 * STEP), atol=1e-13)

    def test_wrong_settings_are_refused(self):
        for name, value in {"sweep": 0.0, "restPeriod": 0}.items():
            with self.assertRaisesRegex(ValueError, name):
                membrane.SpoolRotation(**{name: value})


if __name__ == "__main__":
    unittest.main()

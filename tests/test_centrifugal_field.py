# SPDX-License-Identifier: GPL-2.0-or-later
"""The centrifugal field of the spin-up."""

import unittest

import membrane
import numpy as np
from support import O, SceneTest, Sheet, grid
from yade import wrapper as yade


class TestCentrifugalField(SceneTest):
    def setUp(self):
        super().setUp()
        self.rng = np.random.default_rng(1)
        nodes, triangles = grid(2)
        self.sheet = Sheet(nodes, triangles, pointMasses=self.rng.uniform(0, 1e-4, 9).tolist())
        self.x = self.rng.normal(size=(9, 3))
        self.field = membrane.CentrifugalField(membrane=self.sheet.membrane, omega=7.0)
        O.engines = [yade.ForceResetter(), self.field]

    def forces(self):
        O.step()
        return np.array([O.forces.f(i, True) for i in self.sheet.membrane.bodyIds])

    def test_force_is_mass_times_omega_squared_times_distance_from_the_axis(self):
        self.sheet.place(self.x)
        expected = self.sheet.masses[:, None] * 49.0 * self.x * [1, 1, 0]
        np.testing.assert_allclose(self.forces(), expected, rtol=1e-13)

    def test_force_is_the_slope_of_the_energy(self):
        self.sheet.place(self.x)
        forces, step = self.forces(), 1e-5
        for node, axis in ((0, 0), (3, 1), (8, 2)):
            energies = []
            for side in (1, -1):
                moved = self.x.copy()
                moved[node, axis] += side * step
                self.sheet.place(moved)
                energies.append(self.field.energy())
            slope = (energies[0] - energies[1]) / (2 * step)
            self.assertAlmostEqual(-slope, forces[node, axis], delta=1e-8 * np.abs(forces).max())

    def test_dead_field_has_no_force(self):
        self.sheet.place(self.x)
        self.assertGreater(np.abs(self.forces()).max(), 1e-6)
        self.field.dead = True
        np.testing.assert_array_equal(self.forces(), 0)

    def test_sheet_at_rest_in_the_field_keeps_its_size_when_released_spinning(self):
        O.reset()
        nodes, triangles = grid(2)
        nodes -= nodes.mean(axis=0)
        sheet = Sheet(nodes, triangles, engine={"zeta": 0.3})
        omega = 2000.0
        field = membrane.CentrifugalField(membrane=sheet.membrane, omega=omega)
        newton = yade.NewtonIntegrator(damping=0)
        O.engines = [yade.ForceResetter(), sheet.loop, field, sheet.engine, newton]
        O.dt = 0.2 * sheet.engine.criticalTimeStep()
        for _ in range(3000):
            O.step()
        still = np.linalg.norm(sheet.positions(), axis=1)
        grown = still[0] / np.linalg.norm(nodes[0]) - 1
        self.assertGreater(grown, 1e-5)
        # Damping sees velocities half a step old, which would pull the spinning sheet together.
        sheet.engine.zeta = 0.0
        field.dead, half = True, -0.5 * omega * O.dt
        turn = np.array(
            [[np.cos(half), -np.sin(half), 0], [np.sin(half), np.cos(half), 0], [0] * 3]
        )
        x = sheet.positions()
        sheet.place(x, np.cross([0, 0, omega], x @ turn.T))
        for _ in range(3000):
            O.step()
            radius = np.linalg.norm(sheet.positions(), axis=1)
            self.assertLess(np.abs(radius - still).max(), 2e-3 * grown * still[0])


if __name__ == "__main__":
    unittest.main()

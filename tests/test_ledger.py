# SPDX-License-Identifier: GPL-2.0-or-later
"""The ledger of energies and angular momentum: each entry against a sum of its own."""

import unittest

import numpy as np
from support import O, SceneTest, Sheet, grid

AIR = 0.5


class LedgerTest(SceneTest):
    def make(self, *, gravity=(0, 0, 0), speed=0.3, noise=1e-5, engine=None, share=0.05):
        """A creased 3 x 3 sheet with random places and velocities, and a ledger."""
        O.reset()
        rng = np.random.default_rng(1)
        nodes, triangles = grid(3)
        self.sheet = Sheet(
            nodes,
            triangles,
            creases=[(4, 5), (9, 10)],
            crease_signs=[1, -1],
            engine=engine,
        )
        places = nodes + noise * rng.normal(size=nodes.shape)
        self.sheet.place(places, speed * rng.normal(size=nodes.shape))
        self.gravity = np.array(gravity)
        self.ledger = self.sheet.run_engines(gravity=gravity, ledger=True)
        O.dt = share * self.sheet.engine.criticalTimeStep()

    def step(self, count):
        for _ in range(count):
            O.step()


class TestEntries(LedgerTest):
    def test_values_belong_to_the_places_that_the_forces_saw(self):
        self.make(gravity=(0, 0, -9.81))
        self.step(50)
        x, before, now = self.sheet.positions(), self.sheet.velocities(), O.time
        elastic = self.sheet.membrane.elasticEnergy()
        O.step()
        after, mass = self.sheet.velocities(), self.sheet.masses
        ledger, mean = self.ledger, 0.5 * (before + after)
        self.assertEqual(ledger.time, now)
        self.assertAlmostEqual(ledger.elastic / elastic, 1, delta=1e-12)
        kinetic = 0.5 * np.sum(mass[:, None] * before * after)
        self.assertAlmostEqual(ledger.kinetic / kinetic, 1, delta=1e-12)
        potential = 9.81 * np.sum(mass * x[:, 2])
        self.assertAlmostEqual(ledger.potential / potential, 1, delta=1e-12)
        momentum = np.sum(mass * (x[:, 0] * mean[:, 1] - x[:, 1] * mean[:, 0]))
        self.assertAlmostEqual(ledger.angularMomentum / momentum, 1, delta=1e-10)
        np.testing.assert_allclose(self.sheet.engine.lastPositions(), x, rtol=0, atol=0)

    def test_free_fall_turns_potential_into_kinetic_energy(self):
        self.make(gravity=(1.0, 2.0, -9.81), speed=0.0, noise=0.0)
        self.step(2000)
        fallen = -self.ledger.potential
        self.assertGreater(fallen, 1e-9)
        self.assertLess(abs(self.ledger.balance), 1e-12 * fallen)

    def test_works_of_inner_forces_are_the_loss_of_energy(self):
        self.make(engine={"zeta": 0.05}, speed=1e-3, noise=0.0)
        self.step(2000)
        lost = self.ledger.initial - self.ledger.total
        self.assertGreater(lost, 0.3 * self.ledger.initial)
        self.assertAlmostEqual(self.ledger.dampingWork / -lost, 1, delta=1e-4)
        for name in ("creaseWork", "dragWork", "drivenWork"):
            self.assertEqual(getattr(self.ledger, name), 0, name)
        self.assertLess(abs(self.ledger.contactWork), 1e-12 * lost)

    def test_work_of_creases_is_the_loss_of_their_energy(self):
        self.make(engine={"beta": 300.0, "creaseLaw": "conservative"}, speed=0.0)
        O.step()
        start = self.ledger.crease
        self.step(1000)
        lost = start - self.ledger.crease
        self.assertGreater(lost, 0.05 * start)
        self.assertAlmostEqual(self.ledger.creaseWork / lost, 1, delta=1e-4)
        x = np.array(self.sheet.engine.lastPositions())
        self.sheet.place(x)
        self.assertAlmostEqual(self.sheet.engine.creaseEnergy() / self.ledger.crease, 1, delta=1e-9)

    def test_work_of_drag_is_that_of_a_plate_in_closed_form(self):
        O.reset()
        nodes, triangles = grid(3)
        sheet = Sheet(nodes[:, [0, 1, 2]], triangles, engine={"airDensity": AIR})
        speed, area = 10.0, (3 * 0.02) ** 2
        mass = 1420.0 * 7.5e-6 * area
        sheet.place(nodes, np.broadcast_to([0, 0, speed], nodes.shape))
        ledger = sheet.run_engines(ledger=True)
        O.dt = 1e-6
        self.sheet = sheet
        self.step(3001)
        left = speed / (1 + 0.5 * AIR * area * speed * 3e-3 / mass)
        expected = -0.5 * mass * (speed**2 - left**2)
        self.assertLess(left, 0.8 * speed)
        self.assertAlmostEqual(ledger.dragWork / expected, 1, delta=1e-3)
        self.assertLess(abs(ledger.balance), 1e-9 * abs(expected))

    def test_work_of_a_driven_node_is_that_of_its_holding_force(self):
        omega = 30.0
        sheet = Sheet(
            [[0.025, 0, 0], [0.05, 0.01, 0]],
            cables=[(0, 1)],
            pointMasses=[1e-4, 5e-4],
            engine={"zeta": 0.05},
        )
        driven = O.bodies[sheet.membrane.bodyIds[0]].state
        driven.blockedDOFs = "xyzXYZ"
        ledger = sheet.run_engines(ledger=True)
        from yade.wrapper import RotationEngine

        turn = RotationEngine(
            ids=[sheet.membrane.bodyIds[0]],
            angularVelocity=omega,
            rotationAxis=(0, 0, 1),
            rotateAroundZero=True,
            zeroPoint=(0, 0, 0),
        )
        O.engines = [O.engines[0], turn, *O.engines[1:]]
        O.dt = 0.05 * sheet.engine.criticalTimeStep()
        work, powers = 0.0, []
        for _ in range(8000):
            x = np.array(driven.pos)
            O.step()
            force = np.array(O.forces.f(sheet.membrane.bodyIds[0], True))
            powers.append(-np.dot(force, np.cross([0, 0, omega], x)))
        work = O.dt * (np.sum(powers) - 0.5 * (powers[0] + powers[-1]))
        self.assertGreater(work, 1e-6)
        self.assertAlmostEqual(ledger.drivenWork / work, 1, delta=1e-4)
        self.assertLess(abs(ledger.balance), 1e-3 * work)
        self.assertGreater(ledger.kinetic, 0.3 * work)


class TestBalance(LedgerTest):
    ALL = {"beta": 300.0, "creaseLaw": "conservative", "zeta": 0.02, "airDensity": AIR}

    def imbalance(self, share):
        """Largest |balance| over the energy put in, of a run for the same time."""
        self.make(gravity=(0, 0, -9.81), engine=self.ALL, speed=0.1, share=share)
        largest = 0.0
        for _ in range(round(100 / share)):
            O.step()
            largest = max(largest, abs(self.ledger.balance))
        works = ("creaseWork", "dampingWork", "dragWork")
        for name in works:
            self.assertGreater(abs(getattr(self.ledger, name)), 10 * largest, name)
        return largest / self.ledger.initial

    def test_ledger_of_all_forces_closes_with_the_square_of_the_step(self):
        coarse, fine = self.imbalance(0.04), self.imbalance(0.01)
        self.assertLess(coarse, 5e-3)
        self.assertLess(fine, coarse / 8)

    def test_angular_momentum_is_the_sum_of_its_impulses(self):
        for gravity in ((0, 0, 0), (0, 0, -9.81), (3.0, -2.0, -9.81)):
            self.make(gravity=gravity, engine=self.ALL)
            self.step(1000)
            ledger, size = self.ledger, abs(self.ledger.initialAngularMomentum)
            change = ledger.angularMomentum - ledger.initialAngularMomentum
            self.assertGreater(abs(change), 1e-3 * size)
            self.assertAlmostEqual(change / size, ledger.angularImpulse / size, delta=1e-10)


if __name__ == "__main__":
    unittest.main()

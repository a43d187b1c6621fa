# SPDX-License-Identifier: GPL-2.0-or-later
"""A hub that turns freely: closed forms, angular momentum, energy, both paths, bad use."""

import unittest

import membrane
import numpy as np
from membrane import scene
from membrane.scene import spool
from membrane.study.verification.spinning import fit_frequency2
from support import O, SceneTest, engines_by_class, node_states, release_sail, scratch, set_engines


OMEGA, HUB, ARM, TIP = 10.0, 0.1, 0.3, 2e-3  # spin [rad/s], lengths [m], mass of a tip [kg]
ARMS = 4
PULL = TIP * OMEGA**2 * (HUB + ARM)  # centrifugal force on a tip [N]


def star(path="law2", inertia=1e-3, stiffness=200.0, step=0.05, **options):
    """A hub with ARMS tethers of one segment and a mass at each tip, unstretched, spinning."""
    O.reset()
    angle = np.arange(ARMS) * 2 * np.pi / ARMS
    rim = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(ARMS)])
    nodes = np.concatenate([HUB * rim, (HUB + ARM) * rim])
    tethers = scene.add_membrane(
        nodes,
        [],
        cables=[(i, ARMS + i) for i in range(ARMS)],
        cableStiffness=stiffness,
        cableDensity=1e-5,
        pointMasses=[0.0] * ARMS + [TIP] * ARMS,
    )
    made = set_engines(
        tethers,
        path=path,
        driven=tethers.bodyIds[:ARMS],
        omega=OMEGA,
        hub_inertia=inertia,
        **options,
    )
    made.hold(range(ARMS))
    O.dt = step * made.forces.criticalTimeStep()
    scene.set_spin(made, OMEGA)
    return made


def inertia_about_z(made):
    """Of hub and membrane as they are [kg m2], the hub's own from the FreeHub."""
    r2 = np.sum(made.positions()[:, :2] ** 2, axis=1)
    return made.hub.inertia + np.sum(made.masses() * r2)


class TestClosedForms(SceneTest):
    def test_stretching_arms_slow_the_hub_as_momentum_demands(self):
        """Soft, damped arms: omega (J + m r2) is the same at rest and at the end."""
        for path in scene.PATHS:
            with self.subTest(path):
                stiffness = 0.15  # N: swings and stretching are slow, and damp each other
                made = star(path, stiffness=stiffness, step=0.02, zeta=1.6)
                before = inertia_about_z(made)
                scene.advance(round(75.0 / O.dt))
                after, tip = inertia_about_z(made), made.positions()[ARMS]
                expected = OMEGA * before / after
                self.assertLess(expected, 0.75 * OMEGA)
                self.assertAlmostEqual(made.hub.spin / expected, 1, delta=1e-6)
                # The arm's length at the end is that of the balance m omega2 r = EA (r - r0 - L)/L.
                radius, mass = np.hypot(*tip[:2]), made.masses()[ARMS]
                pull = stiffness * (radius - HUB - ARM) / ARM
                self.assertAlmostEqual(mass * expected**2 * radius / pull, 1, delta=1e-5)
                # What the arms lost went into damping, nothing went elsewhere.
                ledger = made.ledger
                kinetic = 0.5 * before * OMEGA**2 * (before / after)
                lost = (
                    0.5 * before * OMEGA**2 - kinetic - ARMS * 0.5 * pull**2 * ARM / stiffness
                )
                self.assertAlmostEqual(ledger.dampingWork / -lost, 1, delta=1e-3)
                self.assertEqual(ledger.drivenWork, 0)

    def test_arms_swing_faster_on_a_lighter_hub(self):
        """(omega / Omega)2 = (r0 / L) (1 + N m R2 / J), with R = r0 + L."""
        for inertia in (1e-4, 1e-3, 1e6):
            made = star(inertia=inertia, stiffness=2e4, step=0.5)
            tips = [O.bodies[i].state for i in made.membrane.bodyIds[ARMS:]]
            places, stretched = made.positions()[ARMS:], HUB + ARM * (1 + PULL / 2e4)
            for state, place in zip(tips, places * stretched / (HUB + ARM)):
                state.pos = place.tolist()
            scene.set_spin(made, OMEGA)
            for state in tips:  # a kick around the axis
                state.vel = (1.0001 * np.array(state.vel)).tolist()
            made.forces.forgetVelocities()
            stride, swing, times = 20, [], []
            for sample in range(int(3.0 / (stride * O.dt))):
                x = made.positions()
                radial, arm = x[0, :2] / HUB, x[ARMS, :2] - x[0, :2]
                swing.append(radial[0] * arm[1] - radial[1] * arm[0])
                times.append(O.time)
                scene.advance(stride)
            found = fit_frequency2(np.array(times), np.array(swing)) / OMEGA**2
            own = made.hub.totalInertia
            expected = HUB / ARM * (1 + ARMS * TIP * (HUB + ARM) ** 2 / own)
            self.assertGreater(np.ptp(swing), 1e-6)
            self.assertAlmostEqual(found / expected, 1, delta=2e-3, msg=f"J = {inertia}")

    def test_yoyo_stops_the_hub_it_unwinds_from(self):
        """Two masses wound onto the hub take its spin: w = w0 (c R2 - l2) / (c R2 + l2)."""
        made, radius, tips = yoyo()
        own = made.hub.totalInertia
        c = own / (2 * TIP) / radius**2 + 1
        found, expected = [], []
        for _ in range(12):
            scene.advance(round(0.13 / 12 / O.dt))
            unwound2 = np.mean(np.sum(made.positions()[tips, :2] ** 2, axis=1)) - radius**2
            found.append(made.hub.spin / OMEGA)
            expected.append((c * radius**2 - unwound2) / (c * radius**2 + unwound2))
        self.assertGreater(max(expected), 0.8)
        self.assertLess(min(expected), 0.2)
        # 0.02 found, for the hub is a polygon and the tether a chain; 0.04 on twice as coarse ones.
        np.testing.assert_allclose(found, expected, atol=0.03)
        ledger = made.ledger
        kept = ledger.angularMomentum / ledger.initialAngularMomentum
        self.assertAlmostEqual(kept, 1, delta=1e-12)


def yoyo():
    """Two masses on tethers wound around a free hub by a third of a turn, without friction."""
    O.reset()
    radius, piece, count = 0.025 + 5e-4, 2e-3, 28
    arc = np.arange(count + 1)[::-1] * piece / radius  # the tip, at 0, trails the anchor
    chain = radius * np.column_stack([np.cos(arc), np.sin(arc), np.zeros(count + 1)])
    nodes = np.concatenate([chain, chain * [-1, -1, 1]])
    links = np.column_stack([np.arange(count), np.arange(1, count + 1)])
    tips = [count, 2 * count + 1]
    masses = np.zeros(len(nodes))
    masses[tips] = TIP
    tethers = scene.add_membrane(
        nodes,
        [],
        cables=np.concatenate([links, links + count + 1]),
        cableDensity=1e-3 * TIP / piece,
        cableStiffness=5.0,
        pointMasses=masses.tolist(),
    )
    ids = np.array(tethers.bodyIds)
    anchors = [0, count + 1]
    facets = spool.add_spool(facets=72, young=1e5, friction_angle=0)
    made = set_engines(
        tethers,
        path="fused",
        driven=[*facets, *ids[anchors].tolist()],
        touching=np.delete(ids, anchors).tolist(),
        omega=OMEGA,
        hub_inertia=2e-6,
        zeta=0.3,
    )
    made.hold(anchors)
    O.dt = 0.8 * made.forces.criticalTimeStep()
    scene.set_spin(made, OMEGA)
    return made, radius, tips


class TestConservation(SceneTest):
    SPACE = {"gravity": 0.0, "air_density": 0.0, "hub_inertia": 1e-6, "crease_law": "conservative"}

    def test_angular_momentum_of_hub_and_sail_is_kept_to_rounding(self):
        for path in scene.PATHS:
            with self.subTest(path):
                release_sail(path=path, **self.SPACE)
                hub, ledger = engines_by_class()["FreeHub"], engines_by_class()["MembraneLedger"]
                scene.advance(1)
                first = hub.spin
                scene.advance(8000)
                self.assertGreater(abs(hub.spin - first), 0.1 * first)
                change = ledger.angularMomentum - ledger.initialAngularMomentum
                self.assertLess(abs(change), 1e-12 * ledger.initialAngularMomentum)
                self.assertEqual(ledger.drivenWork, 0)

    def test_energy_is_kept_with_the_square_of_the_step(self):
        def imbalance(step):
            made = star(stiffness=200.0, step=step)
            largest = 0.0
            for _ in range(round(60 / step)):
                scene.advance(1)
                largest = max(largest, abs(made.ledger.balance))
            self.assertLess(largest, 1e-5 * made.ledger.kinetic)
            return largest

        coarse, fine = imbalance(0.1), imbalance(0.025)
        self.assertAlmostEqual(np.log2(coarse / fine) / 2, 2, delta=0.1)

    def test_ledger_counts_the_hub(self):
        made = star()
        scene.advance(200)
        x, before = made.positions()[ARMS:], node_states(made.membrane)[1][ARMS:]
        spin = made.hub.spin
        scene.advance(1)
        after, mass = node_states(made.membrane)[1][ARMS:], made.masses()[ARMS:]
        own = 1e-3 + np.sum(made.masses()[:ARMS]) * HUB**2
        kinetic = 0.5 * np.sum(mass[:, None] * before * after) + 0.5 * own * spin * made.hub.spin
        mean = 0.5 * (before + after)
        momentum = np.sum(mass * (x[:, 0] * mean[:, 1] - x[:, 1] * mean[:, 0]))
        momentum += own * 0.5 * (spin + made.hub.spin)
        self.assertAlmostEqual(made.ledger.kinetic / kinetic, 1, delta=1e-12)
        self.assertAlmostEqual(made.ledger.angularMomentum / momentum, 1, delta=1e-12)

    def test_nodes_stay_on_their_circle(self):
        made = star(zeta=0.02)
        scene.advance(50_000)
        self.assertGreater(made.hub.angle, 1.0)
        np.testing.assert_allclose(
            np.hypot(*made.positions()[:ARMS, :2].T), HUB, rtol=4e-16 * 4, atol=0
        )


class TestLimits(SceneTest):
    def test_heavy_hub_is_a_driven_one(self):
        """With 1e12 times the arms' inertia they move as on a RotationEngine."""
        for path in scene.PATHS:
            with self.subTest(path):
                ended = []
                for inertia in (0, 1e9, 1e-3):
                    made = star(path, inertia=inertia, stiffness=3.0)
                    scene.advance(3000)
                    ended.append(made.positions())
                driven, heavy, light = ended
                self.assertGreater(np.abs(light - driven).max(), 1e-3)
                self.assertLess(np.abs(heavy - driven).max(), 1e-10)

    def test_paths_agree(self):
        ended = []
        for path in scene.PATHS:
            made = star(path, stiffness=0.15, step=0.02, zeta=0.05)
            scene.advance(3000)
            ended.append((made.hub.spin, made.hub.angle, made.positions()))
            self.assertLess(made.hub.spin, 0.999 * OMEGA)
        np.testing.assert_allclose(ended[0][:2], ended[1][:2], rtol=1e-11)
        np.testing.assert_allclose(ended[0][2], ended[1][2], rtol=0, atol=1e-12)

    def test_light_hub_lowers_the_critical_time_step(self):
        heavy = star(inertia=1e3).forces.criticalTimeStep()
        light = star(inertia=1e-9).forces.criticalTimeStep()
        self.assertLess(light, 0.5 * heavy)


class TestLoading(SceneTest):
    def test_a_loaded_scene_knows_its_hub(self):
        """Else a run that goes on after the spin-up would never let it go."""
        made = star()
        path = str(scratch() / "star.yade.gz")
        O.save(path, quiet=True)
        driven, spin = sorted(made.driven), made.hub.spin
        O.load(path, quiet=True)
        again = scene.loaded()
        self.assertEqual(again.hub.spin, spin)
        self.assertEqual(sorted(again.driven), driven)


class TestWatch(SceneTest):
    def test_last_good_state_has_the_hub_of_its_time(self):
        made = star(stiffness=3.0)
        scene.advance(350)
        late = made.hub.angle
        steps = round(made.watch.restore() / O.dt)
        self.assertLess(steps, 350)
        again = made.hub.spin, made.hub.angle, made.positions()
        self.assertLess(again[1], late)
        made = star(stiffness=3.0)
        scene.advance(steps)
        self.assertEqual(again[:2], (made.hub.spin, made.hub.angle))
        np.testing.assert_array_equal(again[2], made.positions())


class TestBadUse(SceneTest):
    def refused(self, message):
        with self.assertRaisesRegex(RuntimeError, message):
            scene.advance(1)

    def test_negative_inertia(self):
        with self.assertRaisesRegex(ValueError, "inertia = -1"):
            membrane.FreeHub(inertia=-1.0)

    def test_node_that_is_not_held(self):
        made = star()
        made.hold([2], held=False)
        self.refused("node 2 must be held")

    def test_node_that_the_membrane_lacks(self):
        star().hub.nodes = [0, 8]
        self.refused("8 must be in 0 ... 7")

    def test_engines_in_the_wrong_order(self):
        made = star()
        others = [e for e in O.engines if e is not made.hub and type(e) is not membrane.FreeHub]
        O.engines = [made.hub, *others]
        self.refused("must run in the same step, before it")
        O.engines = [*others, made.hub]
        self.refused("FreeHub must run in the same step")


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""The path "fused", one engine for all forces and the motion, does what interactions do.

Both sum the same forces in another order: what they give differs by rounding, which grows.
"""

import time
import unittest

import __main__
import membrane
import numpy as np
from membrane import scene
from membrane.parameters import SailParameters
from membrane.run import driver
from membrane.scene import spool
from support import (
    O,
    SceneTest,
    contacts,
    engines_by_class,
    force_engine,
    grid,
    interaction_loop,
    node_states,
    quiet,
    released_sail,
    scratch,
    set_engines,
    wind_a_tether,
)
from yade import utils
from yade import wrapper as yade

ENTRIES = ("kinetic", "elastic", "crease", "potential", "creaseWork", "dampingWork", "dragWork")
ENTRIES += ("drivenWork", "contactWork", "kinkError", "initial", "initialCrease", "total")
MOMENTA = ("angularMomentum", "angularImpulse", "initialAngularMomentum")
ALL = {"beta": 300.0, "crease_law": "conservative", "zeta": 0.05, "air_density": 0.5}
GRAVITY = (1.0, -2.0, -9.81)


def entries(ledger):
    """What a ledger holds: energies [J] and angular momenta [N m s]."""
    return (
        np.array([getattr(ledger, name) for name in ENTRIES]),
        np.array([getattr(ledger, name) for name in MOMENTA]),
    )


def sheet(path, *, cells=6, speed=0.3, share=0.2, **options):
    """A creased sheet with random places and velocities; nodes are numbered at random."""
    O.reset()
    rng = np.random.default_rng(2)
    nodes, triangles = grid(cells, jitter=0.1, rng=rng)
    row = cells + 1
    creases = [(row * i + j, row * i + j + 1) for i in (2, 4) for j in range(cells)]
    signs = [1] * cells + [-1] * cells
    number = rng.permutation(len(nodes))
    order = np.argsort(number)
    net = scene.add_membrane(
        nodes[order],
        number[triangles],
        number[np.array(creases)],
        signs,
        positions=nodes[order] + 1e-4 * rng.normal(size=nodes.shape),
        interactions=path == "law2",
    )
    made = set_engines(net, path=path, **options)
    for i in net.bodyIds:
        O.bodies[i].state.vel = (speed * rng.normal(size=3)).tolist()
    O.dt = share * made.forces.criticalTimeStep()
    return made


def wake(made):
    """Let YADE's own loops over bodies run, which a membrane alone does without."""
    made.resetter.dead = made.newton.dead = False


class FusedTest(SceneTest):
    def alike(self, found, expected, tolerance):
        """Two (states, entries) are alike, by `tolerance` of the largest of each kind."""
        (states, book), (states_of_other, book_of_other) = found, expected
        for one, other in (*zip(states, states_of_other), *zip(book, book_of_other)):
            self.assertTrue(np.isfinite(one).all())
            self.assertLess(np.abs(one - other).max(), tolerance * np.abs(other).max())

    def both(self, act, tolerance=1e-10, make=sheet, **options):
        """Do the same on both paths and compare nodes and ledgers."""
        found = {}
        for path in scene.PATHS:
            made = make(path, **options)
            act(made)
            found[path] = node_states(made.membrane), entries(made.ledger)
        self.alike(found["fused"], found["law2"], tolerance)
        return found["fused"]


def sail_as_released(path, **options):
    """The paper's sail on a path, with the places and velocities of the released one."""
    O.reset()
    O.load(str(released_sail("law2")), quiet=True)
    bodies = [(b.state.pos, b.state.vel, b.state.angVel, b.state.ori) for b in O.bodies]
    blocked = [b.state.blockedDOFs for b in O.bodies]
    O.reset()
    parameters = SailParameters(path=path, **options)
    _, made = driver.build(parameters)
    for body, (pos, vel, spin, turned), dofs in zip(O.bodies, bodies, blocked):
        state = body.state
        state.pos, state.vel, state.angVel, state.ori = pos, vel, spin, turned
        state.blockedDOFs = dofs
    made.rotation.dead = made.ledger.dead = False
    O.dt = parameters.dt
    return made


class TestReference(FusedTest):
    def test_released_sail_moves_as_with_interactions(self):
        start = node_states(sail_as_released("law2").membrane)[0]
        states, _ = self.both(lambda made: scene.advance(1000), make=sail_as_released)
        self.assertGreater(np.abs(states[0] - start).max(), 1e-3)

    def test_finer_sail_with_another_law_too(self):
        def start(path):
            O.reset()
            parameters = SailParameters(
                path=path, refine=2, crease_law="conservative", zeta=0.05, air_density=0.1
            )
            sail, made = driver.build(parameters)
            O.dt = 0.3 * made.forces.criticalTimeStep()
            scene.release(made, parameters.omega, sail.held)
            return made

        self.both(lambda made: scene.advance(200), make=start)

    def test_sheet_under_each_force_and_under_all(self):
        for options in ({}, *({name: value} for name, value in ALL.items()), ALL):
            if "crease_law" in options:
                options = {**options, "beta": 300.0}
            with self.subTest(**options):
                self.both(lambda made: scene.advance(300), gravity=GRAVITY, **options)

    def test_ledger_counts_from_the_middle_of_a_run(self):
        def act(made):
            made.ledger.dead = True
            scene.advance(50)
            made.ledger.dead = False
            scene.advance(50)

        self.both(act, gravity=GRAVITY, **ALL)

    def test_forces_of_a_state_and_its_measures(self):
        found = []
        for path in scene.PATHS:
            made = sheet(path, **ALL)
            scene.advance(20)
            places = node_states(made.membrane)
            made.forces.forgetVelocities()
            forces = scene.compute_forces(made)
            np.testing.assert_array_equal(node_states(made.membrane), places)
            np.testing.assert_allclose(made.forces.lastPositions(), places[0], rtol=1e-15)
            parts = [made.forces.creaseForces(), made.forces.dampingForces()]
            parts.append(made.forces.dragForces())
            parts = [np.array(part) for part in parts]
            for part in parts:
                self.assertGreater(np.abs(part).max(), 1e-6 * np.abs(forces).max())
            numbers = [made.forces.criticalTimeStep(), made.forces.creaseEnergy()]
            numbers.append(made.membrane.elasticEnergy())
            found.append((np.array([forces, *parts]), (numbers, made.forces.creaseAngles())))
        for one, other in zip(*(forces for forces, _ in found)):
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-9 * np.abs(other).max())
        for one, other in zip(*(numbers for _, numbers in found)):
            np.testing.assert_allclose(one, other, rtol=1e-9)

    def test_asking_for_forces_in_the_middle_of_a_run_changes_it_not(self):
        runs = []
        for asks in (False, True):
            made = sheet("fused", **ALL)
            scene.advance(20)
            if asks:
                scene.compute_forces(made)
            scene.advance(20)
            runs.append(node_states(made.membrane))
        np.testing.assert_array_equal(*runs)

    def test_spin_up_and_release(self):
        law2 = self.spun_up_and_released("law2")
        nudged = self.spun_up_and_released("law2", nudge=1e-16)
        fused = self.spun_up_and_released("fused")
        seldom = self.spun_up_and_released("fused", period=7)
        # Local damping jumps with the sign of a power, so that rounding grows: the paths may differ
        # by as much as one of them does if its nodes are moved by a bit.
        spread = max(np.abs(one - two).max() for one, two in zip(law2[0], nudged[0]))
        size = max(np.abs(one).max() for one in law2[0])
        self.assertLess(spread, 1e-5 * size)
        for one, two in zip(fused[0], law2[0]):
            self.assertLess(np.abs(one - two).max(), spread)
        self.alike((fused[0], fused[1]), law2, 1e-5)
        np.testing.assert_array_equal(fused[0], seldom[0])

    def spun_up_and_released(self, path, period=1, nudge=0.0):
        """States and ledger 50 steps after the release; nodes moved at first by a share `nudge`."""
        O.reset()
        parameters = SailParameters(path=path, exchange_period=period)
        sail, made = driver.build(parameters)
        rng = np.random.default_rng(1)
        for i in made.membrane.bodyIds:
            state = O.bodies[i].state
            state.pos = (np.array(state.pos) * (1 + nudge * rng.uniform(-1, 1, 3))).tolist()
        O.dt = 0.5 * made.forces.criticalTimeStep()
        with quiet(), self.assertRaisesRegex(RuntimeError, "no equilibrium"):
            scene.spin_up(made, parameters.omega, batch=100, max_time=2.5e-3)
        scene.release(made, parameters.omega, sail.held)
        scene.advance(50)
        return node_states(made.membrane), entries(made.ledger)


class TestExchange(FusedTest):
    PERIODS = (1, 7, 100)

    def test_period_changes_no_bit(self):
        runs = []
        for period in self.PERIODS:
            made = sail_as_released("fused", exchange_period=period)
            scene.advance(250)
            runs.append((node_states(made.membrane), *entries(made.ledger)))
        for other in runs[1:]:
            for one, two in zip(runs[0], other):
                np.testing.assert_array_equal(one, two)

    def test_seldom_ledger_follows_a_changed_step(self):
        runs = []
        for period in self.PERIODS:
            made = sail_as_released("fused", exchange_period=period)
            for step in (O.dt, 0.7 * O.dt, 0.9 * O.dt):
                O.dt = step
                scene.advance(33)
                self.assertAlmostEqual(made.ledger.time, O.time - O.dt, delta=1e-12)
            runs.append(entries(made.ledger))
        for other in runs[1:]:
            for one, two in zip(runs[0], other):
                np.testing.assert_array_equal(one, two)

    def trajectory(self, steps):
        """Positions of all nodes (steps + 1, N, 3) [m] of the sheet after each step."""
        made = sheet("fused", **ALL)
        found = [made.positions()]
        for _ in range(steps):
            O.step()
            found.append(made.positions())
        return np.array(found)

    def test_bodies_are_up_to_date_wherever_a_run_ends(self):
        expected = self.trajectory(80)
        for period in self.PERIODS:
            with self.subTest(period=period):
                made = sheet("fused", exchange_period=period, **ALL)
                O.step()
                np.testing.assert_array_equal(made.positions(), expected[1])
                scene.advance(9)
                np.testing.assert_array_equal(made.positions(), expected[10])
                O.run(11, True)
                np.testing.assert_array_equal(made.positions(), expected[21])
                scene.advance(1)
                np.testing.assert_array_equal(made.positions(), expected[22])
                O.step()
                np.testing.assert_array_equal(made.positions(), expected[23])
                O.stopAtTime = O.time + 10 * O.dt  # sums of O.dt may end a step later
                O.run()
                O.wait()
                self.assertIn(O.iter, (33, 34))
                np.testing.assert_array_equal(made.positions(), expected[O.iter])
                O.stopAtTime = 0

    def test_paused_run_is_up_to_date_after_writing_back(self):
        made = sheet("fused", exchange_period=1000, **ALL)
        O.run(10**9)
        while O.iter < 200:
            pass
        O.pause()
        steps = None
        while steps != O.iter:  # O.pause() does not wait for the step that is under way
            steps = O.iter
            time.sleep(0.2)
        made.forces.writeBack()
        self.assertNotEqual(steps % 1000, 0)
        found = made.positions()
        np.testing.assert_array_equal(found, self.trajectory(steps)[-1])

    def test_bodies_are_no_older_than_the_period_in_the_middle_of_a_run(self):
        expected = self.trajectory(60)
        for period in (1, 7, 25):
            made = sheet("fused", exchange_period=period, **ALL)
            ages = []

            def look():
                (step,) = np.flatnonzero((expected == made.positions()).all(axis=(1, 2)))
                ages.append(O.iter + 1 - step)

            __main__.look = look
            O.engines = [*O.engines, yade.PyRunner(command="look()", iterPeriod=1, initRun=True)]
            scene.advance(60)
            self.assertEqual(len(ages), 60)
            self.assertEqual(max(ages), min(period - 1, 59), period)
            self.assertEqual(ages[-1], 0)

    def test_save_in_the_middle_of_a_run_holds_the_present_state(self):
        made = sheet("fused", exchange_period=1000, **ALL)
        place = str(scratch() / "midway.yade.gz")
        __main__.save_midway = lambda: O.iter == 20 and O.save(place, quiet=True)
        O.engines = [*O.engines, yade.PyRunner(command="save_midway()", iterPeriod=1, initRun=True)]
        scene.advance(50)
        end = node_states(made.membrane)
        O.reset()
        O.load(place, quiet=True)
        scene.advance(29)  # steps 0 to 20 were made when it was saved
        np.testing.assert_array_equal(node_states(force_engine().membrane), end)

    def test_write_back_in_the_middle_of_a_run(self):
        expected = self.trajectory(30)
        made = sheet("fused", exchange_period=1000, **ALL)
        found = {}

        def fetch():
            if O.iter == 13:
                made.forces.writeBack()
                found["now"] = made.positions()

        __main__.fetch = fetch
        O.engines = [*O.engines, yade.PyRunner(command="fetch()", iterPeriod=1, initRun=True)]
        scene.advance(30)
        np.testing.assert_array_equal(found["now"], expected[14])
        np.testing.assert_array_equal(made.positions(), expected[30])

    def test_bodies_are_up_to_date_when_another_engine_ends_the_run(self):
        expected = self.trajectory(20)
        made = sheet("fused", exchange_period=1000, **ALL)

        def fail():
            if O.iter == 12:
                raise RuntimeError("enough")

        __main__.fail = fail
        O.engines = [*O.engines, yade.PyRunner(command="fail()", iterPeriod=1, initRun=True)]
        with self.assertRaises(Exception):
            scene.advance(20)
        np.testing.assert_array_equal(made.positions(), expected[13])


class TestChangesByHand(FusedTest):
    def between(self, change, **options):
        """Run, change something, run on: on both paths, and bodies exchanged at times."""

        def act(made):
            states = [O.bodies[i].state for i in made.membrane.bodyIds]
            scene.advance(30)
            made.ledger.dead = True  # it does not know what is done by hand
            change(made, states)
            scene.advance(30)
            made.ledger.dead = False
            scene.advance(30)

        options = {"gravity": GRAVITY, **ALL, "energy_tolerance": 0, **options}
        untouched = self.both(lambda made: scene.advance(90), **options)
        changed = self.both(act, **options)
        self.assertGreater(np.abs(changed[0] - untouched[0]).max(), 1e-8, "nothing has changed")
        for awake in (False, True):  # who moves the nodes that are held must not matter
            made = sheet("fused", exchange_period=100, **options)
            if awake:
                wake(made)
            act(made)
            self.alike((node_states(made.membrane), entries(made.ledger)), changed, 1e-11)

    def test_velocity(self):
        def change(made, states):
            states[7].vel = (0.5, -0.2, 0.3)

        self.between(change)

    def test_position(self):
        def change(made, states):
            states[20].pos += states[20].pos * 0 + (1e-5, 2e-5, 3e-5)

        self.between(change)

    def test_held_nodes(self):
        def change(made, states):
            made.hold([3, 11, 30])
            for i in (3, 11, 30):
                states[i].vel = (0, 0, 0)

        self.between(change)

    def test_held_nodes_let_go(self):
        def change(made, states):
            made.hold([3, 11, 30])
            for i in (3, 11, 30):
                states[i].vel = (0, 0, 0)
            scene.advance(10)
            made.hold([3, 11])
            made.hold([3, 30], False)

        self.between(change)

    def test_moving_node_held_and_let_go(self):
        def change(made, states):
            made.hold([3])
            scene.advance(5)
            made.hold([3], False)

        self.between(change)

    def test_one_direction_blocked(self):
        def change(made, states):
            states[5].blockedDOFs = "zXYZ"

        self.between(change)

    def test_body_that_may_touch_something(self):
        # It only changes hands: nothing else may change.
        def change(made, states):
            for node in (4, 5, 6):
                O.bodies[made.membrane.bodyIds[node]].bounded = True

        changed = self.both(
            lambda made: (scene.advance(30), change(made, None), scene.advance(30)),
            gravity=GRAVITY,
            **ALL,
        )
        untouched = self.both(lambda made: scene.advance(60), gravity=GRAVITY, **ALL)
        self.alike(changed, untouched, 1e-11)

    def test_body_that_may_touch_nothing_any_more(self):
        def act(made):
            bodies = [O.bodies[made.membrane.bodyIds[node]] for node in (4, 5, 6)]
            for body in bodies:
                body.bounded = True
            scene.advance(30)
            for body in bodies:
                body.bounded = False
            scene.advance(30)

        changed = self.both(act, gravity=GRAVITY, **ALL)
        untouched = self.both(lambda made: scene.advance(60), gravity=GRAVITY, **ALL)
        self.alike(changed, untouched, 1e-11)

    def test_damping_and_creases(self):
        def change(made, states):
            made.forces.zeta = 0.4
            made.forces.beta = 1000.0
            made.forces.airDensity = 2.0

        self.between(change)

    def test_creases_and_drag_left_out(self):
        def change(made, states):
            made.forces.beta = made.forces.airDensity = 0.0

        self.between(change)

    def test_time_step(self):
        def change(made, states):
            O.dt *= 0.6

        self.between(change)

    def test_gravity(self):
        def change(made, states):
            made.newton.gravity = made.ledger.gravity = (0, 0, 50)

        self.between(change)

    def test_local_damping(self):
        def change(made, states):
            made.newton.damping = 0.3
            scene.advance(20)
            made.newton.damping = 0

        self.between(change)

    def test_threads(self):
        def change(made, states):
            made.forces.ompThreads = 3
            states[7].vel = (0.5, -0.2, 0.3)

        self.between(change)

    def test_change_after_loading(self):
        found = []
        for path in scene.PATHS:
            sheet(path, **ALL)
            scene.advance(30)
            O.save(":memory:by_hand", quiet=True)
            O.reset()
            O.load(":memory:by_hand", quiet=True)
            net = force_engine().membrane
            O.bodies[net.bodyIds[7]].state.vel = (5.0, -2.0, 3.0)
            engines_by_class()["MembraneLedger"].dead = True
            scene.advance(5)
            found.append((node_states(net), ()))
        self.alike(found[1], found[0], 1e-11)


class TestForcesOfOthers(FusedTest):
    def test_permanent_force(self):
        def act(made):
            wake(made)
            for node in (3, 17):
                O.forces.setPermF(made.membrane.bodyIds[node], (1e-4, 2e-4, -3e-4))
            scene.advance(200)
            self.assertGreater(abs(made.ledger.contactWork), 1e-9)

        self.both(act, **ALL)

    def test_force_of_a_runner_now_and_then(self):
        def act(made):
            wake(made)
            ids = made.membrane.bodyIds

            def push():
                if O.iter % 3 == 1:
                    O.forces.addF(ids[3], (1e-3 * np.sin(O.iter), 0, 2e-3))
                    O.forces.addF(ids[9], (0, -1e-3, 0))

            __main__.push = push
            first = yade.PyRunner(command="push()", iterPeriod=1, initRun=True)
            O.engines = [O.engines[0], first, *O.engines[1:]]
            scene.advance(200)
            self.assertGreater(abs(made.ledger.contactWork), 1e-9)

        self.both(act, **ALL)
        self.both(act, exchange_period=1, **ALL)

    def test_field_sees_the_nodes_where_they_are(self):
        # In a spinning frame the force grows with the radius: an old place would show.
        runs = []
        for path, period in (("law2", 1), ("fused", 1), ("fused", 50)):
            options = {"exchange_period": period} if path == "fused" else {}
            made = sheet(path, **options)
            wake(made)
            made.field.dead, made.field.omega = False, 300.0
            scene.advance(100)
            runs.append((node_states(made.membrane), entries(made.ledger)))
        self.alike(runs[1], runs[0], 1e-10)
        np.testing.assert_array_equal(runs[1][0], runs[2][0])

    def test_tether_on_the_turning_spool(self):
        found = []
        for path in scene.PATHS:
            made = wind_a_tether(path)
            engines_by_class()["InteractionLoop"].loopOnSortedInteractions = True
            self.assertGreater(contacts(), 2)
            scene.advance(500)
            found.append((node_states(made.membrane), entries(made.ledger)))
        self.assertGreater(abs(made.ledger.contactWork), 0)
        self.alike(found[1], found[0], 1e-8)

    def test_free_sphere_and_node_that_hits_a_facet(self):
        found = []
        for path in scene.PATHS:
            made = self.above_a_facet(path)
            touched = 0
            for _ in range(30):
                scene.advance(50)
                touched += contacts() > 0
            self.assertGreater(touched, 1)
            self.assertEqual(contacts(), 0, "it has not bounced")
            speed = node_states(made.membrane)[1][12, 2]
            self.assertGreater(speed, 0)
            sphere = O.bodies[self.free].state
            steps = O.iter
            self.assertAlmostEqual(sphere.vel[2] / (-9.81 * steps * O.dt), 1, delta=1e-9)
            dropped = 0.5 * 9.81 * steps * (steps + 1) * O.dt**2
            self.assertAlmostEqual((1.0 - sphere.pos[2]) / dropped, 1, delta=1e-6)
            found.append((node_states(made.membrane), entries(made.ledger)))
        self.alike(found[1], found[0], 1e-9)

    def above_a_facet(self, path):
        """A sheet that falls on a facet under its middle node; a sphere falls beside it."""
        O.reset()
        nodes, triangles = grid(4)
        net = scene.add_membrane(
            nodes, triangles, positions=nodes + [0, 0, 6e-4], interactions=path == "law2"
        )
        stone = yade.FrictMat(young=1e6, poisson=0.3, frictionAngle=0.3, density=1000)
        O.materials.append(stone)
        x, y, _ = nodes[12]
        corners = [(x - 0.01, y - 0.01, 0), (x + 0.01, y - 0.01, 0), (x, y + 0.01, 0)]
        O.bodies.append(utils.facet(corners, material=stone, mask=spool.SPOOL_MASK))
        self.free = O.bodies.append(utils.sphere((1, 1, 1), 0.01, material=stone))
        O.bodies[self.free].bounded = False
        made = set_engines(net, path=path, touching=[net.bodyIds[12]], gravity=9.81, zeta=0.02)
        for i in net.bodyIds:
            O.bodies[i].state.vel = (0.1, 0.05, -0.3)
        O.dt = 0.1 * made.forces.criticalTimeStep()
        return made


class TestErrors(FusedTest):
    def refused(self, message, kind=RuntimeError):
        return self.assertRaisesRegex(kind, message)

    def test_path_and_settings(self):
        nodes, triangles = grid(1)
        net = scene.add_membrane(nodes, triangles)
        with self.refused("path = 'fast' must be one of law2, fused", ValueError):
            set_engines(net, path="fast")
        for period in (0, -3):
            with self.refused(f"exchange_period = {period} must be >= 1", ValueError):
                set_engines(net, path="fused", exchange_period=period)
        O.engines = [membrane.MembraneIntegrator()]
        with self.refused("membrane is not set"):
            O.step()

    def test_integrator_that_would_move_the_nodes_once_more(self):
        made = sheet("fused")
        for mask in (0, -1, made.forces.nodeMask, made.forces.nodeMask + 1):
            made.newton.mask = mask
            made.newton.dead = False
            made.forces.beta = 0.0  # lets it look again
            before = made.positions()
            with self.refused(f"move its nodes a second time; give it mask={2**29 - 1}"):
                scene.advance(3)
            np.testing.assert_array_equal(made.positions(), before)
        made.newton.mask = made.forces.nodeMask - 1
        scene.advance(3)

    def test_integrator_before_the_engine(self):
        made = sheet("fused")
        made.hold([5])
        wake(made)
        O.engines = [made.resetter, made.newton, made.forces]
        with self.refused("NewtonIntegrator must come after it"):
            scene.advance(3)

    def test_engine_twice(self):
        made = sheet("fused")
        O.engines = [made.forces, made.forces]
        before = made.positions()
        with self.refused("twice"):
            scene.advance(3)
        np.testing.assert_array_equal(made.positions(), before)

    def test_two_engines_for_one_membrane(self):
        made = sheet("fused")
        for kind in (membrane.MembraneIntegrator, membrane.MembraneForceEngine):
            O.engines = [made.resetter, kind(membrane=made.membrane), made.forces]
            made.forces.beta = 0.0
            with self.refused(f"two engines .* {kind.__name__} .* compute the forces of one membr"):
                scene.advance(3)

    def test_interactions_that_would_pull_once_more(self):
        made = sheet("fused")
        made.membrane.addInteractions()
        scene.advance(3)  # nobody computes them
        wake(made)
        O.engines = [made.resetter, interaction_loop(made.membrane), made.forces, made.newton]
        made.forces.beta = 0.0
        with self.refused("removeInteractions"):
            scene.advance(3)
        made.membrane.removeInteractions()
        scene.advance(3)

    def test_forces_that_nobody_resets(self):
        made = sheet("fused")
        self.assertTrue(made.resetter.dead)
        scene.advance(3)
        O.forces.addF(made.membrane.bodyIds[0], (1e-3, 0, 0))
        before = made.positions()
        with self.refused("put a ForceResetter at the beginning of O.engines"):
            scene.advance(3)
        np.testing.assert_array_equal(made.positions(), before)
        made.resetter.dead = False
        scene.advance(3)

    def test_time_step_too_long(self):
        made = sheet("fused", exchange_period=100)
        scene.advance(10)
        before = made.positions()
        O.dt *= 20
        with self.refused("critical time step"):
            scene.advance(10)
        np.testing.assert_array_equal(made.positions(), before)

    def test_node_without_a_body(self):
        made = sheet("fused")
        O.bodies.erase(made.membrane.bodyIds[4])
        with self.refused("body #4 of node 4 is not in the scene"):
            scene.advance(1)


class TestGoingWrong(FusedTest):
    def test_watch_stops_and_brings_back_the_last_good_state(self):
        for period in (1, 7, 1000):
            made = sheet(
                "fused",
                force_time_step=True,
                zeta=0.02,
                exchange_period=period,
                share=0.5,
                speed=1e-3,
            )
            scene.advance(450)
            O.dt *= 4
            with self.assertRaisesRegex(RuntimeError, r"from nowhere.*side \d+-\d+.*node \d+ is"):
                scene.advance(1000)
            bad = node_states(made.membrane)
            time = made.watch.restore()
            self.assertEqual(O.time, time)
            good = node_states(made.membrane)
            self.assertLess(np.abs(good[1]).max(), np.abs(bad[1]).max())
            O.dt = 0.5 * made.forces.criticalTimeStep()
            before = made.ledger.total
            scene.advance(500)
            self.assertLess(made.ledger.total, 1.01 * before)
            self.assertLess(np.abs(node_states(made.membrane)[1]).max(), 10)

    def test_run_restored_is_the_run_before(self):
        # With nothing that depends on velocities: after restoring, those count as they are.
        found = []
        for path, period in (("law2", 1), ("fused", 1), ("fused", 64)):
            options = {"exchange_period": period} if path == "fused" else {}
            made = sheet(path, beta=300.0, gravity=GRAVITY, **options)
            scene.advance(250)
            time = made.watch.restore()
            scene.advance(100)
            found.append((node_states(made.membrane), (*entries(made.ledger), np.array([time]))))
        self.alike(found[1], found[0], 1e-10)
        self.alike(found[2], found[1], 1e-15)

    def test_numbers_that_are_not_finite_stop_the_run(self):
        for bad in (float("nan"), float("inf")):
            for field in ("pos", "vel"):
                for period in (1, 7):
                    made = sheet("fused", exchange_period=period, **ALL)
                    scene.advance(10)
                    setattr(O.bodies[made.membrane.bodyIds[8]].state, field, (0, bad, 0))
                    with self.assertRaisesRegex(RuntimeError, r"diverged.*node 8 \(body #8\)"):
                        scene.advance(10)
                    lost = ~np.isfinite(node_states(made.membrane)).all(axis=(0, 2))
                    np.testing.assert_array_equal(np.flatnonzero(lost), [8])

    def test_run_that_overflows_leaves_no_more_behind_than_with_interactions(self):
        left = {}
        for path in scene.PATHS:
            made = sheet(path, force_time_step=True, energy_tolerance=0, share=0.5)
            O.dt *= 30
            with self.assertRaisesRegex(RuntimeError, "diverged|are (nan|inf) m apart"):
                scene.advance(5000)
            left[path] = np.isfinite(node_states(made.membrane)).all(axis=(0, 2)).sum()
        self.assertGreaterEqual(left["fused"], left["law2"])


class TestAlone(FusedTest):
    def test_membrane_alone_needs_no_loops_over_bodies(self):
        made = sheet("fused", **ALL)
        self.assertTrue(made.resetter.dead and made.newton.dead)
        scene.advance(20)
        made.hold([2])
        place = made.positions()[2]
        O.bodies[made.membrane.bodyIds[2]].state.vel = (0, 0, 0)
        scene.advance(20)
        np.testing.assert_array_equal(made.positions()[2], place)
        made.hold([2], False)
        scene.advance(20)
        self.assertGreater(np.abs(made.positions()[2] - place).max(), 0)
        self.assertTrue(made.resetter.dead and made.newton.dead)

    def test_engine_alone_needs_no_integrator_at_all(self):
        made = sheet("fused", **ALL)
        scene.advance(20)
        places = made.positions()
        made = sheet("fused", **ALL)
        O.engines = [made.forces]
        scene.advance(20)
        np.testing.assert_allclose(made.positions(), places, rtol=0, atol=1e-13)

    def test_anything_else_in_the_scene_needs_them(self):
        O.reset()
        nodes, triangles = grid(2)
        O.bodies.append(utils.sphere((1, 1, 1), 0.1))
        net = scene.add_membrane(nodes, triangles)
        made = set_engines(net, path="fused")
        self.assertFalse(made.resetter.dead or made.newton.dead)
        self.assertFalse(net.hasInteractions)

    def test_back_to_interactions(self):
        made = sheet("fused", **ALL)
        scene.advance(30)
        again = set_engines(made.membrane, path="law2", **ALL)
        scene.advance(30)
        states = node_states(made.membrane)
        made = sheet("law2", **ALL)
        scene.advance(30)
        again = set_engines(made.membrane, path="law2", **ALL)
        scene.advance(30)
        self.assertTrue(again.membrane.hasInteractions)
        np.testing.assert_allclose(states, node_states(made.membrane), rtol=0, atol=1e-10)

    def test_two_membranes_in_one_scene(self):
        def start(path, forward):
            O.reset()
            made = []
            for number in range(2):
                rng = np.random.default_rng(number)
                nodes, triangles = grid(5)
                net = scene.add_membrane(nodes + [0, 0, number], triangles)
                made.append(set_engines(net, path=path, zeta=0.05))
                for i in net.bodyIds:
                    O.bodies[i].state.vel = (0.1 * rng.normal(size=3)).tolist()
                wake(made[number])
            if path == "law2":
                for one in made:
                    set_engines(one.membrane, path="law2")
            laws = [e for one in made for e in self.loops(path, one)]
            engines = [e for one in made for e in (one.forces,)]
            books = [one.ledger for one in made]
            O.engines = [made[0].resetter, *laws, *engines[::forward], made[0].newton, *books]
            made[0].hold([7])
            made[1].hold([11])
            O.dt = 0.2 * made[0].forces.criticalTimeStep()
            return made

        found = {}
        for path in scene.PATHS:
            for forward in (1, -1):
                made = start(path, forward)
                scene.advance(100)
                for one in made:
                    before = [node_states(other.membrane) for other in made]
                    scene.compute_forces(one)
                    after = [node_states(other.membrane) for other in made]
                    np.testing.assert_array_equal(before, after)
                found[path, forward] = [
                    (node_states(one.membrane), entries(one.ledger)) for one in made
                ]
        for one, other in zip(found["fused", 1], found["law2", 1]):
            self.alike(one, other, 1e-10)
        for one, other in zip(found["fused", 1], found["fused", -1]):
            self.alike(one, other, 1e-15)

    def loops(self, path, made):
        if path == "fused":
            return []
        functor = membrane.Ip2_MembraneMat_MembraneMat_MembranePhys(membrane=made.membrane)
        if made.membrane.bodyIds[0] > 0:
            return []  # one loop goes through all interactions
        return [
            yade.InteractionLoop(
                [membrane.Ig2_MembraneNode_MembraneNode_MembraneGeom()],
                [functor],
                [membrane.Law2_MembraneGeom_MembranePhys_Buckling()],
            )
        ]


class TestThreads(FusedTest):
    def run_on(self, threads):
        made = sheet("fused", cells=20, gravity=GRAVITY, **ALL)
        made.forces.ompThreads = threads
        made.hold([3, 200])
        scene.advance(200)
        return node_states(made.membrane), entries(made.ledger)

    def test_threads_change_the_order_of_sums_only_and_repeat_every_bit(self):
        one, two, again, three = (self.run_on(n) for n in (1, 2, 2, 3))
        self.alike(two, one, 1e-11)
        self.alike(three, one, 1e-11)
        np.testing.assert_array_equal(two[0], again[0])
        for entry, entry_again in zip(two[1], again[1]):
            np.testing.assert_array_equal(entry, entry_again)
        self.assertGreater(np.abs(two[0] - one[0]).max(), 0, "threads seem to be ignored")


if __name__ == "__main__":
    unittest.main()

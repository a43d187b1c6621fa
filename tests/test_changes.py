# SPDX-License-Identifier: GPL-2.0-or-later
"""What is changed behind an engine's back is refused at its next look, by a sentence."""

import unittest

import membrane
import numpy as np
from membrane import scene
from support import O, SceneTest, grid, interaction_loop, node_states, set_engines
from yade import utils
from yade import wrapper as yade

NODE = 7  # of a sheet of 16


def spinning(path, **options):
    """A sheet that spins for a moment already: a MembraneScene."""
    O.reset()
    nodes, triangles = grid(3)
    nodes -= nodes.mean(axis=0)
    net = scene.add_membrane(nodes, triangles, interactions=path == "law2")
    options = {"zeta": 0.02, "air_density": 1e-3, **options}
    made = set_engines(net, path=path, **options)
    O.dt = 0.3 * made.forces.criticalTimeStep()
    scene.set_spin(made, 20.0)
    scene.advance(20)
    return made


def put(engines, new, place=None):
    """`engines` with a new one at a place, or at the end."""
    engines = list(engines)
    engines.insert(len(engines) if place is None else place, new)
    return engines


class ChangeTest(SceneTest):
    def refused(self, message):
        """The next steps are refused, before anything moves on."""
        positions = node_states(self.made.membrane)[0] if self.bodies else None
        with self.assertRaisesRegex(RuntimeError, message):
            scene.advance(3)
        if self.bodies:
            np.testing.assert_array_equal(node_states(self.made.membrane)[0], positions)

    def each_path(self, **options):
        """The sheet on both paths in turn."""
        for path in scene.PATHS:
            self.bodies = True
            self.made = spinning(path, **options)
            with self.subTest(path):
                yield self.made


class TestBodies(ChangeTest):
    def test_erased_node(self):
        for made in self.each_path():
            self.bodies = False
            O.bodies.erase(made.membrane.bodyIds[NODE])
            self.refused(f"body #{NODE} of node {NODE} was erased or replaced")

    def test_all_bodies_cleared(self):
        for made in self.each_path():
            self.bodies = False
            O.bodies.clear()
            self.refused("body #0 of node 0 was erased or replaced")

    def test_another_state_or_body(self):
        for made in self.each_path():
            self.bodies = False
            O.bodies[NODE].state = yade.State()
            self.refused(f"body #{NODE} of node {NODE} was erased or replaced")

    def test_mass_of_any_size(self):
        for mass in (0.0, 100.0, float("nan"), -1.0):
            for made in self.each_path():
                state = O.bodies[NODE].state
                was = state.mass
                state.mass = mass * was if mass == 100 else mass
                self.refused(f"body #{NODE} of node {NODE}: its mass was changed from")
                state.mass = was
                scene.advance(3)

    def test_another_mass_is_taken_when_the_engine_begins_anew(self):
        ends = []
        for made in self.each_path():
            O.bodies[NODE].state.mass *= 2
            made.forces.membrane = made.membrane
            made.forces.beta = 0.0
            self.refused("its mass was changed")
            made.forces.membrane = None
            made.forces.membrane = made.membrane
            made.ledger.dead = True
            scene.advance(200)
            ends.append(node_states(made.membrane)[0])
        self.assertLess(np.abs(ends[0] - ends[1]).max(), 1e-12)

    def test_mass_of_nothing_is_refused_from_the_start(self):
        for made in self.each_path():
            O.bodies[NODE].state.mass = 0.0
            made.forces.membrane = None
            made.forces.membrane = made.membrane
            self.refused(r"the mass 0.* kg of body #7 must be finite and > 0")

    def test_clump_of_nodes(self):
        for made in self.each_path():
            clump = O.bodies.clump(list(made.membrane.bodyIds[:2]))
            self.bodies = False  # the clump moves them
            self.refused(f"body #0 is a member of clump #{clump}")

    def test_body_of_another_membrane_in_its_place(self):
        for made in self.each_path():
            other = scene.add_membrane(*grid(3), interactions=False)
            O.bodies[NODE].shape = O.bodies[other.bodyIds[NODE]].shape
            made.forces.membrane = None
            made.forces.membrane = made.membrane
            self.refused(f"body #{NODE} of node {NODE} is not in the scene")

    def test_node_knows_its_membrane(self):
        for made in self.each_path():
            shape = O.bodies[made.membrane.bodyIds[NODE]].shape
            self.assertEqual((shape.membrane, shape.node), (made.membrane, NODE))

    def test_membrane_changed_under_the_engine(self):
        for made in self.each_path():
            whole = made.membrane.restLengths, made.membrane.triangles
            with self.assertRaises(ValueError):
                made.membrane.updateAttrs({"triangles": [(0, 1, 99)]})
            self.assertEqual((made.membrane.restLengths, made.membrane.triangles), whole)
            scene.advance(3)
            made.membrane.updateAttrs({"triangles": whole[1]})
            made.ledger.dead = True
            scene.advance(3)

    def test_periodic_scene(self):
        for made in self.each_path():
            O.periodic = True
            made.forces.membrane = None
            made.forces.membrane = made.membrane
            self.refused("periodic")


class TestSides(ChangeTest):
    """Sides of the path law2 that nobody computes."""

    def law2(self):
        self.bodies = True
        self.made = spinning("law2")
        return self.made

    def test_no_interactions_at_all(self):
        self.law2()
        O.interactions.clear()
        self.refused(r"side 0-1 \(bodies #0 and #1\) has no interaction with a MembranePhys")

    def test_one_interaction_erased(self):
        made = self.law2()
        a, b = made.membrane.sides[5]
        O.interactions.erase(a, b)
        self.refused(rf"side {a}-{b} \(bodies #{a} and #{b}\) has no interaction")

    def test_interactions_added_again_are_taken(self):
        made = self.law2()
        made.membrane.removeInteractions()
        made.membrane.addInteractions()
        scene.advance(3)
        ends = node_states(made.membrane)[0]
        self.law2()
        scene.advance(3)
        np.testing.assert_array_equal(ends, node_states(self.made.membrane)[0])

    def test_loop_that_is_dead_or_missing(self):
        self.law2()
        (loop,) = [e for e in O.engines if isinstance(e, yade.InteractionLoop)]
        loop.dead = True
        self.refused(r"side 0-1 .* was not computed in this step: put an InteractionLoop")
        loop.dead = False
        scene.advance(1)
        O.engines = [e for e in O.engines if e != loop]
        self.refused(r"side 0-1 .* was not computed in this step")

    def test_geometry_of_another_type(self):
        for name, other in (("geom", yade.ScGeom), ("phys", yade.FrictPhys)):
            self.law2()
            setattr(O.interactions[0, 1], name, other())
            self.refused(
                f"#0 and #1 interact by a .*{other.__name__}|side 0-1 .* has no interaction"
            )

    def test_nodes_that_are_no_side(self):
        made = self.law2()
        utils.createInteraction(made.membrane.bodyIds[0], made.membrane.bodyIds[15])
        self.refused("bodies #0 and #15 interact but are no side of the membrane")

    def test_loop_twice_or_another_one(self):
        self.law2()
        loop = next(e for e in O.engines if isinstance(e, yade.InteractionLoop))
        O.engines = put(O.engines, loop, 1)
        self.refused("InteractionLoop is in O.engines twice")
        self.law2()
        O.engines = put(O.engines, interaction_loop(self.made.membrane), 1)
        self.refused("two engines in O.engines compute interactions")

    def test_engine_before_the_loop(self):
        made = self.law2()
        O.engines = [made.resetter, made.forces, interaction_loop(made.membrane), made.newton]
        self.refused("InteractionLoop must come before it")

    def test_without_an_engine_of_its_membrane(self):
        """The law has nobody to raise a fault for it; then the next step does."""
        made = self.law2()
        made.forces.dead = made.ledger.dead = made.watch.dead = True
        engines = list(O.engines)
        message = "side that moves without a MembraneForceEngine"
        with self.assertRaisesRegex(RuntimeError, message):
            scene.advance(10)
        self.assertEqual(O.engines, engines, "the engines are not those of before")
        before = O.iter
        try:
            O.run(10, True)
        except RuntimeError as error:  # which YADE loses if it comes before YADE waits for it
            self.assertRegex(str(error), message)
        self.assertLess(O.iter, before + 5)
        made.forces.dead = False
        scene.advance(10)

    def test_numbers_that_are_none_without_an_engine(self):
        made = self.law2()
        O.engines = [made.resetter, interaction_loop(made.membrane), made.newton]
        O.bodies[NODE].state.pos = (float("nan"), 0, 0)
        with self.assertRaisesRegex(RuntimeError, f"#{NODE} .*are nan m apart|#{NODE} are nan m"):
            scene.advance(10)

    def test_a_refused_step_leaves_no_forces_to_the_next(self):
        for path in scene.PATHS:
            ends = []
            for refuse in (False, True):
                self.bodies, self.made = True, spinning(path)
                self.made.hold([0])
                short = O.dt
                if refuse:
                    O.dt = 10 * self.made.forces.criticalTimeStep()
                    self.refused("critical time step")
                    O.dt = short
                scene.advance(5)
                ends.append(node_states(self.made.membrane))
            np.testing.assert_array_equal(ends[1], ends[0], path)

    def test_forces_alone_need_no_engine(self):
        made = self.law2()
        O.engines = [made.resetter, interaction_loop(made.membrane)]
        for _ in range(5):
            O.step()
        self.assertGreater(O.forces.f(0).norm(), 0)


class TestEngines(ChangeTest):
    def test_engine_twice(self):
        for made in self.each_path():
            O.engines = put(O.engines, made.forces, list(O.engines).index(made.forces))
            self.refused(f"a {type(made.forces).__name__} is in O.engines twice")

    def test_another_engine_of_the_membrane(self):
        for made in self.each_path():
            for kind in (membrane.MembraneForceEngine, membrane.MembraneIntegrator):
                more = kind(membrane=made.membrane)
                engines = list(O.engines)
                O.engines = put(O.engines, more, list(O.engines).index(made.forces))
                self.refused("two engines in O.engines, .* compute the forces of one membrane")
                more.dead = True
                scene.advance(1)
                O.engines = engines

    def test_ledger_twice_or_another_one(self):
        for made in self.each_path():
            engines = list(O.engines)
            O.engines = put(engines, made.ledger)
            self.refused("a MembraneLedger is in O.engines twice")
            O.engines = put(engines, membrane.MembraneLedger(forces=made.forces))
            self.refused("two engines in O.engines, .* count its energies")

    def test_other_engines_of_ours_twice(self):
        for made in self.each_path(driven=[], hub_inertia=0):
            engines = list(O.engines)
            made.field.dead = made.spool.dead = False
            for engine in (made.watch, made.field, made.spool, made.newton):
                O.engines = put(engines, engine)
                made.newton.dead = False
                self.refused(f"a {type(engine).__name__} is in O.engines twice")

    def test_integrator_of_the_same_nodes(self):
        made = self.made = spinning("law2")
        self.bodies = True
        O.engines = put(O.engines, yade.NewtonIntegrator(damping=0))
        self.refused("two NewtonIntegrators in O.engines would move its nodes twice")
        O.engines[-1].mask = 1 << 10  # of bodies that are no nodes
        scene.advance(3)
        self.assertTrue(made.newton)

    def test_integrator_before_the_engine(self):
        made = self.made = spinning("law2")
        self.bodies = False  # it has moved them already
        O.engines = [made.resetter, made.newton, interaction_loop(made.membrane), made.forces]
        self.refused("NewtonIntegrator must come after it")

    def test_ledger_and_watch_without_their_engine(self):
        for made in self.each_path():
            made.forces.dead = True
            with self.assertRaisesRegex(RuntimeError, "must run in the same step, before it"):
                scene.advance(3)

    def test_two_membranes_stand_side_by_side(self):
        for made in self.each_path():
            other = scene.add_membrane(*grid(3), interactions=not made.fused)
            kind = type(made.forces)
            O.engines = put(O.engines, kind(membrane=other), list(O.engines).index(made.forces))
            scene.advance(10)

    def test_a_fault_does_not_reach_another_scene(self):
        made = self.made = spinning("law2")
        self.bodies = True
        utils.createInteraction(made.membrane.bodyIds[0], made.membrane.bodyIds[15])
        O.engines = [made.resetter, interaction_loop(made.membrane)]
        O.step()  # notes the fault, and nobody raises it
        spinning("law2")
        scene.advance(20)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""Grains, floors and walls beside a membrane: YADE's own contacts, on both paths."""

import contextlib
import io
import unittest

import membrane
import numpy as np
from membrane import scene
from membrane.scene import contacts as ordinary, spool
from support import O, SceneTest, grid, interaction_loop, node_states, set_engines
from yade import utils
from yade import wrapper as yade

CELLS, CELL = 6, 0.025
ORDERS = (1, -1)


def steel(young=1e6, friction=0.0):
    """Material of other bodies."""
    material = yade.FrictMat(young=young, poisson=0.3, frictionAngle=friction, density=1000)
    O.materials.append(material)
    return material


def sheet(path, height=0.0, radius=0.005, **options):
    """A flat sheet of `CELLS` cells at `height` [m]; nothing moves it yet."""
    O.reset()
    nodes, triangles = grid(CELLS, CELL)
    nodes -= nodes.mean(axis=0)
    return scene.add_membrane(
        nodes,
        triangles,
        positions=nodes + [0, 0, height],
        material=scene.film(thickness=25e-6),
        radius=radius,
        interactions=path == "law2",
        **options,
    )


def rim(net):
    """Nodes of the sheet's edge."""
    flat = np.abs(np.array(net.nodes)[:, :2]).max(axis=1)
    return np.flatnonzero(flat > flat.max() - 1e-9).tolist()


def ball(x, y, z, velocity=(0, 0, 0), radius=0.01, **options):
    """Add a grain; gives its body."""
    made = utils.sphere((x, y, z), radius, **options)
    O.bodies.append(made)
    made.state.vel = velocity
    return made


def contacts():
    """Ids of the bodies of all contacts that are no sides."""
    found = [i for i in O.interactions if i.isReal and type(i.phys).__name__ != "MembranePhys"]
    return [(i.id1, i.id2) for i in found]


class TestGrains(SceneTest):
    def strike(self, path, **options):
        """A ball strikes a free sheet and bounces off; gives what is kept, before and after.

        Momentum, angular momentum about the origin, energy; and how often they touched.
        """
        net = sheet(path)
        grain = ball(0.004, 0.003, 0.0085, (0.1, 0.0, -1.0), radius=0.003, material=steel())
        made = set_engines(net, path=path, touching=net.bodyIds, energy_tolerance=0)
        O.dt = 0.1 * made.forces.criticalTimeStep()
        bodies = [O.bodies[i] for i in net.bodyIds] + [grain]

        def kept():
            mass = np.array([b.state.mass for b in bodies])[:, None]
            x, v = (np.array([getattr(b.state, n) for b in bodies]) for n in ("pos", "vel"))
            spin = grain.state.inertia[0] * np.array(grain.state.angVel)
            energy = 0.5 * np.sum(mass * v**2) + net.elasticEnergy()
            return (mass * v).sum(axis=0), np.cross(x, mass * v).sum(axis=0) + spin, energy

        before, touched = kept(), 0
        for _ in range(100):
            scene.advance(50)
            touched += bool(contacts())
        self.assertEqual(contacts(), [], "it has not bounced off")
        return before, kept(), touched

    def test_a_ball_and_a_sheet_keep_momentum_and_energy(self):
        ends = []
        for path in scene.PATHS:
            with self.subTest(path):
                before, after, touched = self.strike(path)
                self.assertGreater(touched, 0)
                scale = np.linalg.norm(before[0])
                np.testing.assert_allclose(after[0], before[0], atol=1e-11 * scale)
                np.testing.assert_allclose(after[1], before[1], atol=1e-11 * scale * CELL)
                self.assertAlmostEqual(after[2] / before[2], 1, delta=1e-3)
                ends.append(np.concatenate(after[:2]))
        np.testing.assert_allclose(ends[1], ends[0], rtol=0, atol=1e-12)

    def test_functors_may_stand_in_any_order(self):
        """A clamped sheet pulled taut bears two balls, however the functors are listed."""
        ends = []
        for order in ORDERS:
            net = sheet("law2")
            places = 1.001 * np.array(net.nodes)
            for i, x in zip(net.bodyIds, places.tolist()):
                O.bodies[i].state.pos = x
                O.bodies[i].bounded = True
            for node in rim(net):
                O.bodies[net.bodyIds[node]].state.blockedDOFs = "xyzXYZ"
            grains = [ball(x, 0.003, 0.0155, material=steel(friction=0.3)) for x in (-0.03, 0.03)]
            loop = interaction_loop(net)
            geometry = [*loop.geomDispatcher.functors, yade.Ig2_Sphere_Sphere_ScGeom()]
            physics = [*loop.physDispatcher.functors, yade.Ip2_FrictMat_FrictMat_FrictPhys()]
            laws = [*loop.lawDispatcher.functors, yade.Law2_ScGeom_FrictPhys_CundallStrack()]
            forces = membrane.MembraneForceEngine(membrane=net, zeta=0.05)
            O.engines = [
                yade.ForceResetter(),
                yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb()]),
                yade.InteractionLoop(geometry[::order], physics[::order], laws[::order]),
                forces,
                yade.NewtonIntegrator(damping=0, gravity=(0, 0, -9.81)),
            ]
            O.dt = 0.3 * forces.criticalTimeStep()
            scene.advance(1)
            corner = O.interactions[net.bodyIds[0], net.bodyIds[1]].phys.normalForce.norm()
            self.assertGreater(corner, 0.5)
            scene.advance(int(0.02 / O.dt))
            touching = [pair for pair in contacts() if set(pair) & {b.id for b in grains}]
            self.assertEqual(len(touching), len(contacts()), "nodes touch one another")
            self.assertGreater(min(b.state.pos[2] for b in grains), 0.0)
            ends.append([np.array(b.state.pos) for b in grains])
        np.testing.assert_allclose(ends[1], ends[0], rtol=0, atol=1e-15)

    def test_grains_touch_one_another_as_ever(self):
        for path in scene.PATHS:
            net = sheet(path)
            first, second = (
                ball(0.0, y, 0.1, (0, -y / 0.02, 0), material=steel()) for y in (-0.0102, 0.0102)
            )
            made = set_engines(net, path=path, touching=net.bodyIds)
            O.dt = 0.3 * made.forces.criticalTimeStep()
            scene.advance(int(0.005 / O.dt))
            self.assertLess(first.state.vel[1], 0.0, path)
            self.assertGreater(second.state.vel[1], 0.0, path)

    def test_a_grain_of_film_touches_like_any_other(self):
        for path in scene.PATHS:
            net = sheet(path)
            grain = ball(0.0, 0.0, 0.0149, material=net.material)
            made = set_engines(net, path=path, touching=net.bodyIds)
            O.dt = 0.01 * made.forces.criticalTimeStep()
            scene.advance(1)
            (pair,) = contacts()
            self.assertIn(grain.id, pair)
            self.assertEqual(type(O.interactions[pair].phys), yade.FrictPhys)


class TestFloors(SceneTest):
    def floor(self, kind):
        """Add a floor 20 mm below the origin."""
        stone = steel(young=1e5)
        if kind == "facet":
            corners = ((-1, -1, -0.02), (2, -1, -0.02), (-1, 2, -0.02))
            O.bodies.append(utils.facet(corners, material=stone))
        elif kind == "wall":
            O.bodies.append(utils.wall(-0.02, axis=2, material=stone))
        elif kind == "box":
            O.bodies.append(utils.box((0, 0, -0.03), (1, 1, 0.01), fixed=True, material=stone))
        else:
            stone.young = 100.0  # as stiff as the others: stiffness grows with the radius
            O.bodies.append(utils.sphere((0, 0, -5.02), 5.0, fixed=True, material=stone))

    def test_a_falling_sheet_stays_above_whatever_bears(self):
        for path in scene.PATHS:
            lowest = {}
            for kind in ("facet", "wall", "box", "sphere"):
                with self.subTest(path=path, kind=kind):
                    net = sheet(path, radius=0.003)
                    self.floor(kind)
                    made = set_engines(
                        net, path=path, touching=net.bodyIds, gravity=9.81, zeta=0.05
                    )
                    O.dt = 0.3 * made.forces.criticalTimeStep()
                    heights = []
                    for _ in range(5):
                        scene.advance(int(0.02 / O.dt))
                        heights.append(made.positions()[:, 2].min())
                    lowest[kind] = min(heights)
                    self.assertLess(min(heights), -0.01, "it has not fallen")
                    self.assertGreater(min(heights), -0.018)
                    self.assertGreater(heights[-1], min(heights) + 1e-3, "it has not bounced")
            self.assertLess(np.ptp(list(lowest.values())), 1.5e-3)

    def test_any_mask_is_touched(self):
        for mask in (1, 2, 1 << 20, spool.SPOOL_MASK, -1):
            net = sheet("fused", height=-0.0171, radius=0.003)
            self.floor("facet")
            O.bodies[-1].mask = mask
            made = set_engines(net, path="fused", touching=net.bodyIds)
            O.dt = 0.01 * made.forces.criticalTimeStep()
            scene.advance(1)
            self.assertEqual(len(contacts()), len(net.nodes), mask)

    def test_grains_of_all_masks_touch_one_another(self):
        net = sheet("fused")
        pair = [ball(0, y, 0.1, material=steel()) for y in (-0.0099, 0.0099)]
        for grain in pair:
            grain.mask = -1
        made = set_engines(net, path="fused", touching=net.bodyIds)
        O.dt = 0.01 * made.forces.criticalTimeStep()
        scene.advance(1)
        self.assertEqual(contacts(), [(pair[0].id, pair[1].id)])

    def test_what_could_not_be_touched_is_refused(self):
        def refused(message, **changes):
            body = ball(0, 0, 0.1, material=steel())
            for name, value in changes.items():
                setattr(body, name, value)
            with self.assertRaisesRegex(ValueError, f"touching: body #{body.id} {message}"):
                set_engines(net, touching=net.bodyIds)
            body.bounded = False
            body.mask = 1
            set_engines(net, touching=net.bodyIds)

        net = sheet("law2")
        refused("is a Tetra, which nodes cannot touch", shape=yade.Tetra())
        refused("has the material ElastMat", mat=yade.ElastMat())
        refused("has the material NoneType", mat=None)
        refused(
            f"has the mask {scene.NODE_MASK}, with which it touches nothing", mask=scene.NODE_MASK
        )

    def test_a_body_that_nothing_would_move_is_refused(self):
        net = sheet("law2")
        body = ball(0, 0, 0.1, material=steel())
        body.mask = spool.SPOOL_MASK
        with self.assertRaisesRegex(ValueError, "NewtonIntegrator would not move it"):
            set_engines(net, touching=net.bodyIds)

    def test_a_body_that_comes_later_is_moved_or_told(self):
        net = sheet("fused")
        made = set_engines(net, path="fused", touching=net.bodyIds)
        O.dt = 0.1 * made.forces.criticalTimeStep()
        scene.advance(2)
        grain = ball(0, 0, 0.1, (0, 0, -1), material=steel())
        with self.assertRaisesRegex(RuntimeError, f"body #{grain.id} is free to move"):
            scene.advance(2)
        made.newton.dead = made.resetter.dead = False
        scene.advance(2)
        self.assertLess(grain.state.pos[2], 0.1)

    def test_a_body_that_is_no_node_cannot_be_named(self):
        net = sheet("law2")
        grain = ball(0, 0, 0.1, material=steel())
        with self.assertRaisesRegex(ValueError, f"body #{grain.id} is not a node of the membrane"):
            set_engines(net, touching=[0, grain.id])

    def test_a_body_that_nothing_touches_is_told(self):
        net = sheet("law2")
        grain = ball(0, 0, 0.1, material=steel())
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            set_engines(net, touching=[0])
            self.assertEqual(said.getvalue(), "")
            set_engines(net)
        self.assertIn(f"nothing of the membrane touches body #{grain.id}", said.getvalue())

    def test_nodes_that_would_touch_like_grains_are_refused(self):
        """As where a loop is made by hand, without the functor of two nodes."""
        net = sheet("fused", radius=0.02)
        forces = membrane.MembraneIntegrator(membrane=net)
        for i in net.bodyIds:
            O.bodies[i].bounded = True
        loop = yade.InteractionLoop(
            ordinary.geometry(),
            [yade.Ip2_FrictMat_FrictMat_FrictPhys()],
            [yade.Law2_ScGeom_FrictPhys_CundallStrack()],
        )
        O.engines = [
            yade.ForceResetter(),
            ordinary.collider(1),
            loop,
            forces,
            yade.NewtonIntegrator(damping=0, mask=1),
        ]
        O.dt = 0.01 * forces.criticalTimeStep()
        with self.assertRaisesRegex(RuntimeError, "nodes of one membrane, touch like grains; put"):
            O.step()
        node_pairs = membrane.Ig2_MembraneNode_MembraneNode_MembraneGeom()
        loop.geomDispatcher.functors = [*loop.geomDispatcher.functors, node_pairs]
        O.interactions.clear()
        for _ in range(3):
            O.step()
        self.assertEqual(contacts(), [])

    def test_every_functor_of_contact_is_listed(self):
        loop = yade.InteractionLoop(ordinary.geometry(), [], [])
        matrix = loop.geomDispatcher.dispMatrix()
        for shape in ordinary.SHAPES:
            self.assertIn((shape, "Sphere"), {*matrix, *(key[::-1] for key in matrix)})


class TestStability(SceneTest):
    def resting(self, young, path="fused", **options):
        """A ball that falls on a clamped sheet, with contacts of so many Pa."""
        net = sheet(path)
        grain = ball(0.001, 0.0, 0.0151, (0, 0, -2.0), material=steel(young))
        made = set_engines(net, path=path, touching=net.bodyIds, gravity=9.81, zeta=0.02, **options)
        made.hold(rim(net))
        made.newton.dead = made.resetter.dead = False
        O.dt = 0.3 * made.forces.criticalTimeStep()
        return made, grain

    def test_a_contact_too_stiff_for_the_step_is_refused(self):
        for path in scene.PATHS:
            made, grain = self.resting(1e9, path)
            free = made.forces.criticalTimeStep()
            with self.assertRaisesRegex(
                RuntimeError, rf"O.dt = .* must be <= .*without contacts, .* and #{grain.id}"
            ):
                scene.advance(1000)
            self.assertLess(made.forces.criticalTimeStep(), 0.2 * free)

    def test_the_critical_step_is_that_of_the_contact(self):
        """One stiff contact of a light node and a heavy ball: the closed form of two masses."""
        for path in scene.PATHS:
            made, grain = self.resting(1e9, path, force_time_step=True)
            made.hold(range(len(made.membrane.nodes)))
            made.hold([24], False)  # the middle one
            grain.state.pos = (0.001, 0.0, 0.01495)
            scene.advance(1)
            (pair,) = contacts()
            phys, mass = O.interactions[pair].phys, made.masses()[24]
            self.assertIn(made.membrane.bodyIds[24], pair)
            rate = phys.kn * (1 / mass + 1 / grain.state.mass)
            step = made.forces.criticalTimeStep()
            self.assertLess(step, 2 / np.sqrt(rate))
            self.assertAlmostEqual(step * np.sqrt(rate) / 2, 1, delta=0.03)

    def test_a_contact_that_blows_up_stops_the_run(self):
        for path in scene.PATHS:
            made, _ = self.resting(1e10, path, force_time_step=True)
            with self.assertRaisesRegex(RuntimeError, "contacts gave .* J from nowhere"):
                scene.advance(3000)

    def test_a_contact_that_is_stable_gives_nothing(self):
        for path in scene.PATHS:
            made, _ = self.resting(1e6, path)
            most = -np.inf
            for _ in range(60):
                scene.advance(100)
                most = max(most, made.ledger.contactGain)
            self.assertGreater(made.ledger.contactTaken, 1e-4)
            self.assertLess(most, 1e-3 * made.ledger.contactTaken)

    def test_friction_only_takes(self):
        net = sheet("fused", height=-0.0172, radius=0.003)
        O.bodies.append(utils.wall(-0.02, axis=2, material=steel(young=1e5, friction=0.5)))
        made = set_engines(net, path="fused", touching=net.bodyIds, gravity=9.81, zeta=0.05)
        O.dt = 0.3 * made.forces.criticalTimeStep()
        for i in net.bodyIds:
            O.bodies[i].state.vel = (0.3, 0, 0)
        given = []
        for _ in range(30):
            scene.advance(int(0.002 / O.dt))
            given.append(made.ledger.contactGain)
        slid = 0.5 * made.masses().sum() * 0.3**2
        self.assertLess(given[-1], -0.2 * slid)
        self.assertLess(np.diff(given).max(), 0.02 * slid)

    def test_bodies_that_overlap_from_the_start_are_no_blow_up(self):
        made, grain = self.resting(1e6)
        grain.state.pos = (0.001, 0.0, 0.0149)
        scene.advance(500)
        self.assertGreater(node_states(made.membrane)[0][:, 2].min(), -0.02)


if __name__ == "__main__":
    unittest.main()

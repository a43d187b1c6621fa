# SPDX-License-Identifier: GPL-2.0-or-later
"""YADE's own analyses may be called on a membrane: they neither crash nor spoil it.

Many of them take every interaction for a sphere contact with normal and shear force, unasked.
"""

import unittest

import numpy as np
from membrane import scene
from support import O, SceneTest, Sheet, film_of_the_sail, interaction_loop, scratch
from yade import export, utils
from yade import wrapper as yade
from yade.minieigenHP import Matrix3, Matrix6


def numbers(value):
    """All numbers in whatever a helper returned, as a flat array."""
    if isinstance(value, (bool, int, float)):
        return np.array([float(value)])
    if isinstance(value, (Matrix3, Matrix6)):
        size = 3 if isinstance(value, Matrix3) else 6
        return np.array([value[i, j] for i in range(size) for j in range(size)])
    parts = [numbers(part) for part in value]
    return np.concatenate(parts) if parts else np.empty(0)


class TestHelpers(SceneTest):
    """The flat sail, stretched by 0.01 %, with a contact law beside its own."""

    def setUp(self):
        super().setUp()
        mesh, flat = film_of_the_sail()
        self.sheet = Sheet(
            flat,
            mesh.triangles,
            creases=mesh.creases,
            crease_signs=mesh.crease_signs,
            engine={"beta": 30.0, "zeta": 0.02},
        )
        self.contact = yade.Law2_ScGeom_FrictPhys_CundallStrack()
        self.sheet.loop = interaction_loop(self.sheet.membrane, self.contact)
        rng = np.random.default_rng(1)
        self.sheet.place(1.0001 * flat + 1e-6 * rng.normal(size=flat.shape))
        self.sheet.run_engines()
        O.dt = 1e-6
        scene.advance(5)
        self.springs = self.all_springs()

    def all_springs(self):
        return {
            (i.id1, i.id2): (i.phys.kn, i.phys.restLength, i.phys.criticalLength)
            for i in O.interactions
        }

    def check(self, value, least=0.0):
        """The result is finite, not all zero, and the membrane is as before and runs on."""
        found = numbers(value)
        self.assertGreater(len(found), 0)
        self.assertTrue(np.all(np.isfinite(found)), found)
        self.assertGreater(np.abs(found).max(), least)
        self.assertEqual(self.all_springs(), self.springs)
        scene.advance(2)

    def test_unbalanced_force(self):
        self.check(utils.unbalancedForce())

    def test_mean_unbalanced_force_is_over_that_of_the_sides(self):
        forces = np.array([O.forces.f(i, True) for i in self.sheet.membrane.bodyIds])
        links = [np.linalg.norm(i.phys.normalForce) for i in O.interactions]
        ratio = np.mean(np.linalg.norm(forces, axis=1)) / np.mean(links)
        self.assertAlmostEqual(utils.unbalancedForce(False) / ratio, 1, delta=1e-9)

    def test_kinetic_energy(self):
        expected = 0.5 * np.sum(self.sheet.masses[:, None] * self.sheet.velocities() ** 2)
        self.assertAlmostEqual(utils.kineticEnergy() / expected, 1, delta=1e-12)

    def test_momentum_and_angular_momentum(self):
        self.check([list(utils.momentum()), list(utils.angularMomentum((1, 2, 3)))], -1)

    def test_stress(self):
        self.check(utils.getStress(1.0))

    def test_stress_of_the_stretched_sail_is_that_of_its_sides(self):
        expected = np.zeros((3, 3))
        net = self.sheet.membrane
        x = self.sheet.positions()
        self.sheet.place(x).side_forces()
        for (a, b), tension, length in zip(net.sides, net.tensions(), net.lengths()):
            along = (x[b] - x[a]) / length
            expected += tension * length * np.outer(along, along)
        found = numbers(utils.getStress(2.0)).reshape(3, 3)
        self.assertGreater(expected[0, 0], 1e-3)
        np.testing.assert_allclose(found, expected / 2.0, atol=1e-3 * expected.max())

    def test_stress_and_tangent(self):
        self.check(utils.getStressAndTangent(1.0))

    def test_stress_of_each_body(self):
        tensors = utils.bodyStressTensors()
        self.assertEqual(len(tensors), len(O.bodies))
        self.check(tensors)

    def test_stress_by_loads_and_profiles(self):
        self.check(utils.getStressProfile(1.0, 2, 0.1, -0.1, [0] * 3, [0] * 3, [0] * 3))

    def test_total_dynamic_stress(self):
        self.check(utils.getTotalDynamicStress(1.0), -1)

    def test_fabric_tensor(self):
        self.check(utils.fabricTensor())

    def test_forces_on_planes(self):
        self.check(utils.forcesOnPlane((0.15, 0, 0), (1, 0, 0)))
        self.check(utils.forcesOnCoordPlane(0.15, 0))

    def test_total_force_in_volume(self):
        self.check(utils.totalForceInVolume())

    def test_counts_of_interactions(self):
        self.check(utils.avgNumInteractions())
        self.check(utils.numIntrsOfEachBody())
        self.assertEqual(len(utils.intrsOfEachBody()), len(O.bodies))

    def test_interaction_angles(self):
        self.check(utils.interactionAnglesHistogram(2))

    def test_largest_overlap(self):
        self.check(utils.maxOverlapRatio())

    def test_porosity_volume_and_mass(self):
        self.check([utils.porosity(1.0), utils.getSpheresVolume(), utils.getSpheresMass()])
        self.assertAlmostEqual(utils.getSpheresMass(), self.sheet.masses.sum(), delta=1e-15)

    def test_sums_of_forces_and_torques(self):
        ids = list(self.sheet.membrane.bodyIds[:9])
        self.check(utils.sumForces(ids, (1, 0, 0)))
        self.check(utils.sumTorques(ids, (0, 0, 1), (0, 0, 0)))

    def test_wave_time_steps(self):
        self.check([utils.PWaveTimeStep(), utils.RayleighWaveTimeStep()])

    def test_setting_the_friction_leaves_the_springs_alone(self):
        utils.setContactFriction(0.5)
        self.check(1.0)

    def test_calming_stops_the_nodes(self):
        self.assertGreater(np.abs(self.sheet.velocities()).max(), 0)
        utils.calm()
        np.testing.assert_array_equal(self.sheet.velocities(), 0)
        self.check(1.0)

    def test_energy_of_a_contact_law_leaves_the_sides_out(self):
        self.assertGreater(self.sheet.membrane.elasticEnergy(), 1e-6)
        self.assertEqual(self.contact.elasticEnergy(), 0)
        O.trackEnergy = True
        scene.advance(2)
        self.assertEqual(self.contact.elasticEnergy(), 0)
        self.check([value for _, value in O.energy.items()])

    def test_global_stiffness_time_stepper(self):
        stepper = yade.GlobalStiffnessTimeStepper(timeStepUpdateInterval=1, defaultDt=1e-7)
        O.engines = [stepper, *O.engines]
        scene.advance(3)
        self.assertTrue(O.dynDt)
        self.check(O.dt)
        exact = self.sheet.engine.criticalTimeStep()
        self.assertLess(O.dt, 2 * exact)
        self.assertGreater(O.dt, 0.1 * exact)

    def record(self, recorder):
        """Two steps with a recorder; none of them moves anything."""
        O.engines = [*O.engines, recorder]
        scene.advance(2)
        self.check(1.0)

    @unittest.skipUnless(hasattr(yade, "VTKRecorder"), "YADE was built without VTK")
    def test_vtk_recorder(self):
        parts = ["spheres", "intr", "stress", "force", "velocity", "bstresses", "id"]
        file = str(scratch() / "vtk_")
        self.record(yade.VTKRecorder(fileName=file, iterPeriod=1, recorders=parts))
        self.assertTrue(list(scratch().glob("vtk_*")))

    def test_recorders(self):
        file = str(scratch() / "forces.txt")
        self.record(yade.ForceRecorder(ids=[1, 2], file=file, iterPeriod=1))
        exporter = export.VTKExporter(str(scratch() / "export"))
        exporter.exportInteractions(what={"kn": "i.phys.kn"})
        self.assertTrue(list(scratch().glob("export*")))

    def test_growing_particles_leaves_the_nodes_alone(self):
        stiffness, body = self.springs[0, 1][0], O.bodies[0]
        mass, radius = body.state.mass, body.shape.radius
        O.bodies.append(utils.sphere((1, 1, 1), 0.1))
        utils.growParticles(1.1)
        grown = self.all_springs()[0, 1]
        self.assertEqual((body.state.mass, body.shape.radius), (mass, radius))
        self.assertAlmostEqual(O.bodies[-1].shape.radius, 0.11, delta=1e-12)
        self.assertTrue(np.all(np.isfinite(grown)))
        self.assertEqual(grown[1:], self.springs[0, 1][1:])
        self.assertGreater(grown[0], 0.5 * stiffness)


if __name__ == "__main__":
    unittest.main()

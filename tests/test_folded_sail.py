# SPDX-License-Identifier: GPL-2.0-or-later
"""The folded sail as the plugin sees it, before the first step."""

import unittest
from dataclasses import asdict

import numpy as np
from membrane import geometry
from membrane.mesh.fold import fold_report
from membrane.parameters import SailParameters
from membrane.run import driver
from support import O, fold_angle


class TestFoldedSail(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        O.reset()
        sail, cls.sail = driver.build(SailParameters())
        cls.mesh = sail.mesh
        cls.folded = cls.sail.positions()
        cls.angles = np.array(cls.sail.forces.creaseAngles())

    def test_all_creases_start_slightly_open(self):
        self.assertEqual(self.angles.shape, (364,))
        self.assertGreater(self.angles.min(), 1e-4)
        self.assertLess(self.angles.max(), 0.05)

    def test_angles_of_the_plugin_are_those_of_the_geometry(self):
        mesh = self.mesh
        expected = geometry.crease_angles(
            self.folded, mesh.triangles, mesh.creases, mesh.crease_signs
        )
        np.testing.assert_allclose(self.angles, expected, rtol=0, atol=1e-12)

    def test_angles_of_the_plugin_are_those_measured_by_turning_the_faces(self):
        corners = geometry.crease_corners(self.mesh.triangles, self.mesh.creases)
        expected = [
            fold_angle(*self.folded[nodes], valley=sign == geometry.VALLEY)
            for nodes, sign in zip(corners, self.mesh.crease_signs)
        ]
        np.testing.assert_allclose(self.angles, expected, rtol=0, atol=1e-12)

    def test_creases_of_the_wrong_sign_would_start_passed_through(self):
        mesh = self.mesh
        flipped = geometry.crease_angles(
            self.folded, mesh.triangles, mesh.creases, -mesh.crease_signs
        )
        self.assertLess(flipped.max(), 0)

    def test_no_side_is_stretched_by_more_than_half_a_percent(self):
        net = self.sail.membrane
        strain = np.array(net.lengths()) / np.array(net.restLengths) - 1
        self.assertEqual(strain.shape, (1316,))
        self.assertLess(strain.max(), 0.005)
        self.assertLess(strain.min(), -0.01, "nothing is bent")

    def test_sides_shortened_by_the_bends_are_counted_in_the_report_and_buckled(self):
        net = self.sail.membrane
        report = asdict(fold_report(self.mesh, self.folded))
        length, rest = np.array(net.lengths()), np.array(net.restLengths)
        film = np.array(net.sideKinds) != 2
        shortened = film & (length / rest - 1 < -1e-3)
        self.assertGreater(shortened.sum(), 50)
        self.assertEqual(report["shortened"], shortened.sum())
        self.assertAlmostEqual(report["shortening"], 1 - (length / rest)[film].min(), delta=1e-12)
        self.assertTrue(np.all(length[shortened] < np.array(net.criticalLengths)[shortened]))

    def test_masses_are_those_of_film_tips_and_tethers(self):
        film = 1420.0 * 7.5e-6 * (0.455**2 - 0.103**2)
        tethers = 4 * 2e-4 * self.mesh.tether_length
        expected = film + tethers + 4 * 0.36e-3
        self.assertAlmostEqual(self.sail.masses().sum() / expected, 1, delta=1e-12)
        self.assertTrue(np.all(self.sail.masses()[self.mesh.tips] > 0.36e-3))

    def test_only_tethers_and_spool_have_bounds(self):
        bounded = {body.id for body in O.bodies if body.bounded}
        ids = np.array(self.sail.membrane.bodyIds)
        facets = {body.id for body in O.bodies if type(body.shape).__name__ == "Facet"}
        free = np.setdiff1d(self.mesh.tether_nodes, self.mesh.anchors)
        self.assertEqual(len(facets), 72)
        self.assertEqual(bounded, facets | set(ids[free].tolist()))

    def test_nodes_do_not_rotate(self):
        for i in self.sail.membrane.bodyIds:
            self.assertTrue(set("XYZ") <= set(O.bodies[i].state.blockedDOFs))


if __name__ == "__main__":
    unittest.main()

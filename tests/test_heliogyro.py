# SPDX-License-Identifier: GPL-2.0-or-later
"""The heliogyro: its pleats keep all lengths, and the spin pulls its blades out."""

import unittest

import numpy as np
from membrane.geometry import crease_angles, side_lengths, unique_sides
from membrane.results.history import read_history
from membrane.run import driver
from membrane.run.sails.heliogyro import KIND, HeliogyroParameters
from support import SceneTest, quiet, scratch


class TestPleats(unittest.TestCase):
    def test_pleats_are_rigid_and_all_bent_alike(self):
        for slope in (0.0, 30.0, 80.0):
            sail = KIND.sail(HeliogyroParameters(blades=3, pleats=5, slope=slope))
            mesh = sail.mesh
            sides = unique_sides(mesh.triangles)[0]
            rest, now = side_lengths(mesh.nodes, sides), side_lengths(sail.start, sides)
            np.testing.assert_allclose(now, rest, rtol=1e-12)
            angles = crease_angles(sail.start, mesh.triangles, mesh.creases, mesh.crease_signs)
            np.testing.assert_allclose(np.degrees(angles), 180 - 2 * slope, atol=1e-6)

    def test_blades_stand_around_the_axis_and_their_roots_turn(self):
        p = HeliogyroParameters(blades=4, root=0.2)
        sail = KIND.sail(p)
        flat = sail.mesh.nodes
        self.assertAlmostEqual(np.abs(flat.mean(axis=0)).max(), 0, places=12)
        radius = np.hypot(*flat[sail.tips, :2].T)
        np.testing.assert_allclose(radius, p.root + p.pleats * p.pleat, rtol=1e-12)
        self.assertEqual(np.hypot(*flat[sail.hub, :2].T).min(), p.root)


class TestFlight(SceneTest):
    def test_blades_come_out_and_hub_and_blades_keep_their_momentum(self):
        p = HeliogyroParameters(pleats=4, hub_inertia=1e-3, duration=0.15)
        folder = scratch() / "heliogyro"
        with quiet():
            summary = driver.deploy(p, folder, pictures=False, page=False)
        history, found = read_history(folder / "history.csv"), summary["measures"]
        self.assertGreater(history["tip_radius"][-1], 2 * history["tip_radius"][0])
        self.assertLess(found["angular_momentum_drift"], 1e-10)
        self.assertLess(history["hub_spin"][-1], history["hub_spin"][0])
        self.assertLess(found["largest_unexplained_energy"], 1e-5 * found["largest_energy"])


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""The folded sail: a cross of four standing strips without stretch and without crossed layers."""

import unittest
from functools import lru_cache
from math import cos, hypot, sqrt

import numpy as np
from membrane import geometry, measures
from membrane.mesh import sail_mesh
from membrane.mesh.fold import fold, fold_report

QUICK = True

STRIP, BAR, ARM, GAP, SPOOL = 0.022, 0.030, 0.040, 1e-4, 0.025
TO_ARM = hypot(BAR - ARM / sqrt(2), ARM / sqrt(2))
REFINES = (1, 2, 3)


@lru_cache
def folded(refine):
    """Mesh and folded positions of the small sail."""
    mesh = sail_mesh(refine=refine)
    return mesh, fold(mesh, BAR, ARM, GAP)


def on_each_fold(test):
    """Run test(self, mesh, positions) at each refinement."""

    def run(self):
        for n in REFINES:
            with self.subTest(refine=n):
                test(self, *folded(n))

    return run


def arc_lengths(mesh):
    """Arc length (N,) [m] of petal 0's nodes, nan elsewhere."""
    arc = np.full(len(mesh.nodes), np.nan)
    for k, ids in enumerate(mesh.rows):
        arc[ids[0]] = mesh.row_arc(k)
    return arc


def strains(mesh, positions, sides):
    """Strains of sides [-]."""
    rest = geometry.side_lengths(mesh.nodes, sides)
    return geometry.side_lengths(positions, sides) / rest - 1


class TestFold(unittest.TestCase):
    @on_each_fold
    def test_no_side_is_stretched(self, mesh, positions):
        lengths = strains(mesh, positions, mesh.sides)
        self.assertLess(lengths.max(), 1e-4)
        self.assertLess(lengths.min(), -0.05)

    @on_each_fold
    def test_sides_keep_their_length_away_from_the_bends(self, mesh, positions):
        ends = arc_lengths(mesh)[mesh.sides] / TO_ARM
        for low, high in ((0.0, 0.5), (1.05, np.inf)):
            inside = np.all((abs(ends) >= low) & (abs(ends) <= high), axis=1)
            inside &= ends[:, 0] * ends[:, 1] >= 0
            self.assertGreater(inside.sum(), 10)
            lengths = strains(mesh, positions, mesh.sides[inside])
            np.testing.assert_allclose(lengths, 0, atol=2e-4)

    @on_each_fold
    def test_every_crease_is_slightly_open(self, mesh, positions):
        angles = geometry.crease_angles(positions, mesh.triangles, mesh.creases, mesh.crease_signs)
        self.assertEqual(len(angles), 364 * mesh.refine)
        self.assertGreater(angles.min(), 0.5 * GAP / STRIP)
        self.assertLess(angles.max(), 0.05)

    @on_each_fold
    def test_no_layers_cross(self, mesh, positions):
        lines, _ = mesh.lines()
        self.assertEqual(len(geometry.crossings(positions, lines, mesh.triangles)), 0)

    def test_a_node_pushed_through_the_stack_is_found_crossing(self):
        mesh, positions = folded(2)
        pushed = positions.copy()
        pushed[mesh.rows[7][0][20]] += [1.5 * GAP, 0, 0]
        self.assertGreater(len(geometry.crossings(pushed, mesh.sides, mesh.triangles)), 0)

    @on_each_fold
    def test_tips_lie_on_the_diagonals_an_arm_length_out(self, mesh, positions):
        x, y, _ = positions[mesh.tips].T
        np.testing.assert_allclose(np.hypot(x, y), ARM + 0.455 / 2 - TO_ARM, atol=3e-4)
        azimuths = np.degrees(np.arctan2(y, x))
        np.testing.assert_allclose(azimuths, [45, 135, -135, -45], atol=1e-10)

    @on_each_fold
    def test_seam_nodes_lie_on_the_diagonals(self, mesh, positions):
        for row in mesh.rows:
            x, y = np.abs(positions[row[:, -1], :2]).T
            np.testing.assert_allclose(x, y, atol=1e-12)

    @on_each_fold
    def test_strips_stand_between_foot_and_head(self, mesh, positions):
        for k, ids in enumerate(mesh.rows):
            from_foot = abs((k / mesh.refine + 1) % 2 - 1) * STRIP
            np.testing.assert_allclose(positions[ids, 2], from_foot - STRIP / 2, atol=1e-6)

    @on_each_fold
    def test_quarter_turn_and_mirror_map_the_fold_onto_itself(self, mesh, positions):
        quarter = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]])
        for row in mesh.rows:
            turned = positions[row] @ quarter
            np.testing.assert_allclose(positions[np.roll(row, -1, axis=0)], turned, atol=1e-12)
            mirrored = positions[row[0]] * [1, -1, 1]
            np.testing.assert_allclose(positions[row[0][::-1]], mirrored, atol=1e-12)

    def test_layers_are_a_gap_apart_at_the_guide_bar_with_the_outer_edge_outermost(self):
        mesh, positions = folded(2)
        middle = np.array([row[0][row.shape[1] // 2] for row in mesh.rows])
        lean = np.arctan2(BAR - ARM / sqrt(2), ARM / sqrt(2))
        expected = BAR + GAP / cos(lean) * (np.arange(17) / 2 + 0.5)
        np.testing.assert_allclose(positions[middle, 0], expected, atol=1e-9)
        np.testing.assert_allclose(positions[middle, 1], 0, atol=1e-12)

    @on_each_fold
    def test_film_clears_the_spool(self, mesh, positions):
        film = positions[: mesh.film_size, :2]
        start, end = film[mesh.sides[:, 0]], film[mesh.sides[:, 1]]
        share = np.linspace(0, 1, 21)[:, None, None]
        radius = np.linalg.norm(start + share * (end - start), axis=2)
        self.assertGreater(radius.min(), SPOOL + 0.004)

    @on_each_fold
    def test_tethers_hang_slack_outside_the_spool(self, mesh, positions):
        lengths = strains(mesh, positions, mesh.cables)
        np.testing.assert_allclose(lengths, 0, atol=1e-12)
        np.testing.assert_allclose(positions[mesh.anchors], mesh.nodes[mesh.anchors], atol=1e-15)
        free = np.setdiff1d(mesh.tether_nodes, mesh.anchors)
        radius = np.hypot(*positions[free, :2].T)
        self.assertGreater(radius.min(), SPOOL + 0.005)
        ends = positions[mesh.inner_corners] - positions[mesh.anchors]
        self.assertLess(np.linalg.norm(ends, axis=1).max(), 0.9 * mesh.tether_length)

    @on_each_fold
    def test_sail_is_almost_closed(self, mesh, positions):
        inner_square = 4 * BAR**2 / 0.455**2
        rate = measures.deployment_rate(mesh, positions)
        self.assertLess(abs(rate - inner_square), 0.006)

    def test_report_holds_the_measured_numbers(self):
        mesh, positions = folded(1)
        report = fold_report(mesh, positions)
        lengths = strains(mesh, positions, mesh.sides)
        self.assertEqual(report.stretch, lengths.max())
        self.assertEqual(report.shortening, -lengths.min())
        self.assertEqual(report.shortened, np.sum(lengths < -1e-3))
        self.assertEqual(report.layers, 8)
        self.assertAlmostEqual(report.height, STRIP, places=6)
        flat = fold_report(mesh, mesh.nodes)
        self.assertEqual((flat.shortened, flat.stretch, flat.height), (0, 0, 0))
        self.assertAlmostEqual(flat.largest_angle, np.pi, places=12)

    def test_other_sails_fold_as_well(self):
        flight = {"outer_width": 14.0, "inner_width": 3.2, "spool_radius": 0.79}
        cases = [({"fold_lines": lines}, {}) for lines in (4, 6, 9, 12)]
        cases += [({"refine": 4}, {}), ({"tether_segments": 1}, {}), ({"tether_segments": 9}, {})]
        cases += [({}, {"arm_radius": radius}) for radius in (0.030, 0.050)]
        cases += [({}, {"bar_radius": 0.027}), ({}, {"layer_gap": 1e-5}), ({}, {"layer_gap": 5e-4})]
        cases += [
            (dict(flight, fold_lines=n), dict(bar_radius=0.9, arm_radius=1.2)) for n in (7, 18)
        ]
        for sail, options in cases:
            with self.subTest(**sail, **options):
                mesh = sail_mesh(**sail)
                report = fold_report(mesh, fold(mesh, **options))
                self.assertLess(report.stretch, 5e-4)
                self.assertLess(report.cable_stretch, 1e-12)
                self.assertGreater(report.least_angle, 0)
                self.assertLess(report.largest_angle, 0.15)

    def test_bad_parameters_raise_and_are_named(self):
        bad = {
            "bar_radius": (0.025, -1.0, float("nan")),
            "arm_radius": (0.0, 0.02, 0.2, float("inf")),
            "layer_gap": (0.0, -1e-4, 0.002),
        }
        mesh = sail_mesh()
        for name, values in bad.items():
            for value in values:
                with self.subTest(**{name: value}), self.assertRaisesRegex(ValueError, name):
                    fold(mesh, **{name: value})
        with self.assertRaisesRegex(ValueError, "arm_radius .* bar_radius / sqrt"):
            fold(mesh, bar_radius=0.05, arm_radius=0.03)


if __name__ == "__main__":
    unittest.main()

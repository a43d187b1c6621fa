# SPDX-License-Identifier: GPL-2.0-or-later
"""The sail's mesh, the geometry helpers and the measures, against counts and closed forms."""

import unittest
from collections import Counter

import numpy as np
from membrane import geometry, measures
from membrane.mesh import LINE_KINDS, sail_mesh, sheet_mesh
from membrane.mesh.fold import fold

QUICK = True

OUTER, INNER, STRIP = 0.455, 0.103, 0.022
REFINES = (1, 2, 3)
OTHERS = (
    {"fold_lines": 6},
    {"fold_lines": 12, "refine": 2},
    {"outer_width": 14.0, "inner_width": 3.2, "fold_lines": 18, "spool_radius": 0.79},
)


def on_each_mesh(test):
    """Run test(self, mesh) on each of the meshes."""

    def run(self):
        for parameters in [{"refine": n} for n in REFINES] + list(OTHERS):
            with self.subTest(**parameters):
                test(self, sail_mesh(**parameters))

    return run


def directed_sides(triangles):
    """All (3 T) sides of triangles as pairs of node ids, in the triangles' sense."""
    return [tuple(pair) for pair in triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)]


def corner_sets(mesh, points):
    """The triangles as a set of sets of rounded corner positions [um]."""
    grid = np.round(1e7 * points[:, :2]).astype(int)
    return {frozenset(map(tuple, grid[triangle])) for triangle in mesh.triangles}


class TestSailMesh(unittest.TestCase):
    def test_small_sail_has_the_expected_counts(self):
        mesh = sail_mesh()
        self.assertEqual(mesh.film_size, 468)
        self.assertEqual(len(mesh.nodes), 468 + 16)
        self.assertEqual(mesh.triangles.shape, (832, 3))
        self.assertEqual(mesh.sides.shape, (1300, 2))
        self.assertEqual(mesh.creases.shape, (364, 2))
        self.assertEqual(mesh.seam_sides.shape, (32, 2))
        self.assertEqual(mesh.cables.shape, (16, 2))
        self.assertAlmostEqual(mesh.strip_width, STRIP, places=12)

    def test_rows_gain_two_cells_from_fold_line_to_fold_line(self):
        for n in REFINES:
            rows = sail_mesh(refine=n).rows
            self.assertEqual(len(rows), 8 * n + 1)
            self.assertEqual(
                [r.shape for r in rows[::n]], [(4, n * (5 + 2 * j) + 1) for j in range(9)]
            )

    @on_each_mesh
    def test_film_is_an_annulus(self, mesh):
        self.assertEqual(mesh.film_size - len(mesh.sides) + len(mesh.triangles), 0)

    @on_each_mesh
    def test_film_has_the_area_of_the_square_less_its_hole(self, mesh):
        area = geometry.triangle_areas(mesh.nodes, mesh.triangles).sum()
        exact = mesh.outer_width**2 - mesh.inner_width**2
        self.assertAlmostEqual(area / exact, 1, places=12)

    @on_each_mesh
    def test_triangles_face_up(self, mesh):
        self.assertGreater(geometry.area_vectors(mesh.nodes, mesh.triangles)[:, 2].min(), 0)

    @on_each_mesh
    def test_no_triangle_is_flat(self, mesh):
        angles = np.degrees(geometry.triangle_angles(mesh.nodes, mesh.triangles))
        self.assertLess(angles.max(), 96)
        self.assertGreater(angles.min(), 40)

    @on_each_mesh
    def test_quarter_turn_maps_the_mesh_onto_itself(self, mesh):
        turned = mesh.nodes @ np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]])
        self.assertEqual(corner_sets(mesh, turned), corner_sets(mesh, mesh.nodes))

    def test_mirror_maps_all_but_the_middle_squares_onto_themselves(self):
        for n in REFINES:
            mesh = sail_mesh(refine=n)
            here = corner_sets(mesh, mesh.nodes)
            missing = here - corner_sets(mesh, mesh.nodes * [1, -1, 1])
            self.assertEqual(len(missing), 0 if n % 2 == 0 else 2 * 4 * 8 * n)

    @on_each_mesh
    def test_film_is_centred_and_as_heavy_along_x_as_along_y(self, mesh):
        area = geometry.triangle_areas(mesh.nodes, mesh.triangles)
        weight = np.zeros(len(mesh.nodes))
        np.add.at(weight, mesh.triangles, area[:, None] / 3)
        scale = mesh.outer_width
        np.testing.assert_allclose(weight @ mesh.nodes / area.sum() / scale, 0, atol=1e-14)
        x2, y2, _ = weight @ mesh.nodes**2
        xy = weight @ (mesh.nodes[:, 0] * mesh.nodes[:, 1])
        self.assertAlmostEqual(x2 / y2, 1, places=12)
        self.assertAlmostEqual(xy / x2, 0, places=12)

    @on_each_mesh
    def test_inner_sides_have_two_opposed_triangles_and_the_rest_form_two_loops(self, mesh):
        directed = Counter(directed_sides(mesh.triangles))
        self.assertEqual(set(directed.values()), {1})
        free = {pair for pair in directed if pair[::-1] not in directed}
        outer = set(zip(mesh.outer_edge, np.roll(mesh.outer_edge, -1)))
        inner_loop = mesh.rows[0][:, :-1].ravel()
        inner = set(zip(np.roll(inner_loop, -1), inner_loop))
        self.assertEqual(free, outer | inner)
        self.assertEqual(len(free), len(outer) + len(inner))

    def test_sides_are_all_sides_once(self):
        mesh = sail_mesh(refine=2)
        expected = {tuple(sorted(pair)) for pair in directed_sides(mesh.triangles)}
        self.assertEqual(set(map(tuple, mesh.sides)), expected)
        self.assertEqual(len(mesh.sides), len(expected))

    def test_corners_lie_on_the_diagonals_in_order(self):
        mesh = sail_mesh()
        signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
        np.testing.assert_allclose(mesh.nodes[mesh.tips, :2], signs * OUTER / 2, atol=1e-15)
        np.testing.assert_allclose(
            mesh.nodes[mesh.inner_corners, :2], signs * INNER / 2, atol=1e-15
        )

    @on_each_mesh
    def test_outer_edge_middles_are_symmetric_and_nearest(self, mesh):
        x, y = np.abs(mesh.nodes[mesh.outer_edge_middles, :2]).min(axis=2).T
        cells = len(mesh.outer_edge) // 4
        half_cell = 0 if cells % 2 == 0 else mesh.outer_width / cells / 2
        np.testing.assert_allclose([x, y], half_cell, atol=1e-12)

    @on_each_mesh
    def test_arc_length_is_the_coordinate_along_the_petal(self, mesh):
        for k, (right, up, left, down) in enumerate(mesh.rows):
            arc = mesh.row_arc(k)
            for ids, column, sign in ((right, 1, 1), (up, 0, -1), (left, 1, -1), (down, 0, 1)):
                along = sign * mesh.nodes[ids, column]
                np.testing.assert_allclose(along, arc, atol=1e-12 * mesh.outer_width)

    def test_creases_lie_on_fold_lines_mountain_and_valley_in_turn_on_all_petals(self):
        for n in REFINES:
            mesh = sail_mesh(refine=n)
            distance = np.abs(mesh.nodes[mesh.creases, :2]).max(axis=2)
            line = (distance - INNER / 2) / STRIP
            np.testing.assert_allclose(line, np.round(line), atol=1e-9)
            np.testing.assert_array_equal(np.round(line[:, 0]), np.round(line[:, 1]))
            np.testing.assert_array_equal(mesh.crease_signs, 2 * (np.round(line[:, 0]) % 2) - 1)
            count = Counter(np.round(line[:, 0]).astype(int))
            self.assertEqual(count, {j: 4 * n * (5 + 2 * j) for j in range(1, 8)})

    def test_triangles_at_a_crease_are_equally_high(self):
        mesh = sail_mesh(refine=2)
        a, b, c, d = mesh.nodes[geometry.crease_corners(mesh.triangles, mesh.creases).T]
        length = np.linalg.norm(b - a, axis=1)
        for apex in (c, d):
            height = np.linalg.norm(np.cross(b - a, apex - a), axis=1) / length
            np.testing.assert_allclose(height, STRIP / 2, rtol=1e-12)

    def test_seam_sides_lie_on_the_diagonals_and_are_no_creases(self):
        mesh = sail_mesh(refine=2)
        x, y = np.abs(np.moveaxis(mesh.nodes[mesh.seam_sides, :2], -1, 0))
        np.testing.assert_allclose(x, y, atol=1e-15)
        self.assertTrue(np.all(x[:, 1] > x[:, 0]))
        seams = set(map(frozenset, mesh.seam_sides))
        self.assertEqual(len(seams), 4 * 16)
        self.assertFalse(seams & set(map(frozenset, mesh.creases)))

    def test_tethers_run_straight_from_spool_to_inner_corner(self):
        mesh = sail_mesh()
        chains = mesh.cables.reshape(4, 4, 2)
        np.testing.assert_array_equal(chains[:, 1:, 0], chains[:, :-1, 1])
        np.testing.assert_array_equal(chains[:, 0, 0], mesh.anchors)
        np.testing.assert_array_equal(chains[:, -1, 1], mesh.inner_corners)
        np.testing.assert_array_equal(mesh.tether_nodes, np.arange(468, 484))
        self.assertAlmostEqual(mesh.tether_length, 0.04783, places=5)
        lengths = geometry.side_lengths(mesh.nodes, mesh.cables)
        np.testing.assert_allclose(lengths, mesh.tether_length / 4, rtol=1e-12)
        ends = mesh.nodes[mesh.anchors] - mesh.nodes[mesh.inner_corners]
        np.testing.assert_allclose(np.linalg.norm(ends, axis=1), mesh.tether_length, rtol=1e-12)
        radius = np.linalg.norm(mesh.nodes[mesh.anchors], axis=1)
        np.testing.assert_allclose(radius, 0.025, rtol=1e-12)

    def test_guide_nodes_are_those_within_half_a_base_cell_of_the_middle(self):
        for n in REFINES:
            mesh = sail_mesh(refine=n)
            expected = []
            for k, ids in enumerate(mesh.rows):
                half_cell = mesh.row_distance(k) / (5 + 2 * k / n)
                expected.append(ids[0][np.abs(mesh.row_arc(k)) <= half_cell * (1 + 1e-9)])
            np.testing.assert_array_equal(mesh.guide_nodes[0], np.concatenate(expected))
            self.assertEqual(mesh.guide_nodes.shape, (4, (8 * n + 1) * (n + 1)))

    def test_lines_are_sides_and_cables_by_kind(self):
        mesh = sail_mesh()
        lines, kinds = mesh.lines()
        count = {name: int(np.sum(kinds == kind)) for name, kind in LINE_KINDS.items()}
        self.assertEqual(count, {"film": 1300 - 364 - 32, "crease": 364, "seam": 32, "tether": 16})
        creases = set(map(frozenset, lines[kinds == LINE_KINDS["crease"]]))
        self.assertEqual(creases, set(map(frozenset, mesh.creases)))

    def test_arrays_are_read_only(self):
        with self.assertRaises(ValueError):
            sail_mesh().nodes[0, 0] = 1.0

    def test_bad_parameters_raise_and_are_named(self):
        bad = {
            "outer_width": (0.1, -1.0, float("inf")),
            "inner_width": (0.5, 0.0, 0.05, float("nan")),
            "fold_lines": (0, 2.5),
            "refine": (0, -1, 1.5),
            "spool_radius": (0.0, 0.08),
            "tether_segments": (0, 4.0),
        }
        for name, values in bad.items():
            for value in values:
                with self.subTest(**{name: value}), self.assertRaisesRegex(ValueError, name):
                    sail_mesh(**{name: value})


class TestSheetMesh(unittest.TestCase):
    def test_nodes_lie_row_by_row_from_the_origin(self):
        nodes, triangles = sheet_mesh(3, 4, 0.5)
        self.assertEqual((nodes.shape, triangles.shape), ((12, 3), (12, 3)))
        for row in range(3):
            for column in range(4):
                expected = [0.5 * column, 0.5 * row, 0]
                np.testing.assert_array_equal(nodes[4 * row + column], expected)

    def test_squares_are_cut_along_one_diagonal(self):
        nodes, triangles = sheet_mesh(4, 6, 0.1)
        sides, _, shares = geometry.unique_sides(triangles)
        self.assertEqual(len(nodes) - len(sides) + len(triangles), 1)
        self.assertEqual(np.sum(shares == 1), 2 * (3 + 5))
        spans = np.unique(np.round((nodes[sides[:, 1]] - nodes[sides[:, 0]]) / 0.1), axis=0)
        np.testing.assert_array_equal(spans, [[0, 1, 0], [1, 0, 0], [1, 1, 0]])

    def test_triangles_face_up_and_cover_the_sheet(self):
        areas = geometry.area_vectors(*sheet_mesh(5, 3, 0.2))
        np.testing.assert_allclose(areas, np.tile([0, 0, 0.02], (16, 1)), rtol=1e-12)

    def test_bad_values_are_refused_by_name(self):
        for changes, text in (
            ({"rows": 1}, "rows = 1: .* >= 2"),
            ({"columns": 2.5}, "columns = 2.5: .* whole number"),
            ({"spacing": 0.0}, "spacing = 0.0 m: .* > 0"),
            ({"spacing": np.nan}, "spacing = nan m: .* finite"),
        ):
            with self.assertRaisesRegex(ValueError, text):
                sheet_mesh(**{"rows": 3, "columns": 3, "spacing": 1.0, **changes})


class TestGeometry(unittest.TestCase):
    def fold_of(self, angle, sign, rng):
        """Two equal triangles at a crease, folded to `angle` [rad], in a random position."""
        half, up = angle / 2, -sign
        apex = 0.3 * np.array([[-np.sin(half), 0, up * np.cos(half)]])
        nodes = np.concatenate([[[0, -0.5, 0], [0, 0.5, 0]], apex, apex * [-1, 1, 1]])
        rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        rotation *= np.sign(np.linalg.det(rotation))
        return nodes @ rotation.T + rng.normal(size=3)

    def test_crease_angle_is_the_angle_between_the_faces_inside_the_fold(self):
        rng = np.random.default_rng(1)
        triangles = np.array([[0, 1, 2], [1, 0, 3]])
        for sign in (geometry.MOUNTAIN, geometry.VALLEY):
            for angle in (-1.5, -1e-3, 0.0, 1e-3, 1.0, np.pi - 1e-3, np.pi, np.pi + 1e-3, 4.7):
                nodes = self.fold_of(angle, sign, rng)
                for crease in ([0, 1], [1, 0]):
                    found = geometry.crease_angles(nodes, triangles, [crease], [sign])
                    self.assertAlmostEqual(found[0], angle, places=12)

    def test_rows_of_sides_are_found_in_any_order_and_direction(self):
        rng = np.random.default_rng(5)
        sides = rng.permutation(geometry.unique_sides(sheet_mesh(3, 4, 1.0)[1])[0])
        rows = rng.permutation(len(sides))[:7]
        for pairs in (sides[rows], sides[rows][:, ::-1]):
            np.testing.assert_array_equal(geometry.side_rows(sides, pairs), rows)
        self.assertEqual(geometry.side_rows(sides, np.empty((0, 2), dtype=int)).tolist(), [])
        for stranger in ((0, 11), (3, 400)):
            with self.assertRaisesRegex(ValueError, f"nodes .{stranger[0]}, {stranger[1]}. are"):
                geometry.side_rows(sides, np.array([sides[2], stranger]))

    def test_mountain_crease_sticks_out_on_the_top_side(self):
        mesh = sail_mesh()
        for sign in (geometry.MOUNTAIN, geometry.VALLEY):
            raised = mesh.nodes.copy()
            raised[mesh.creases[mesh.crease_signs == sign], 2] = sign * 1e-3
            angles = geometry.crease_angles(raised, mesh.triangles, mesh.creases, mesh.crease_signs)
            self.assertLess(angles[mesh.crease_signs == sign].max(), np.pi - 0.05)

    def test_flat_creases_are_at_pi(self):
        mesh = sail_mesh(refine=2)
        angles = geometry.crease_angles(mesh.nodes, mesh.triangles, mesh.creases, mesh.crease_signs)
        np.testing.assert_allclose(angles, np.pi, atol=1e-12)

    def test_crease_without_two_triangles_raises(self):
        with self.assertRaisesRegex(ValueError, "creases"):
            geometry.crease_corners(np.array([[0, 1, 2]]), np.array([[0, 1]]))
        with self.assertRaisesRegex(ValueError, "signs"):
            geometry.crease_angles(np.eye(4, 3), np.array([[0, 1, 2], [1, 0, 3]]), [[0, 1]], [0])

    def test_equilateral_triangle_at_any_scale(self):
        for scale in (1e-8, 1.0, 1e8):
            nodes = scale * np.array([[0, 0, 0], [1, 0, 0], [0.5, np.sqrt(0.75), 0]])
            triangles = np.array([[0, 1, 2]])
            area = geometry.triangle_areas(nodes, triangles)[0]
            self.assertAlmostEqual(area / scale**2, np.sqrt(3) / 4, places=14)
            angles = geometry.triangle_angles(nodes, triangles)[0]
            np.testing.assert_allclose(angles, np.pi / 3, rtol=1e-14)

    def test_two_triangles_share_one_of_five_sides(self):
        sides, triangle_sides, shares = geometry.unique_sides([[0, 1, 2], [1, 0, 3]])
        np.testing.assert_array_equal(sides, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3]])
        np.testing.assert_array_equal(shares, [2, 1, 1, 1, 1])
        np.testing.assert_array_equal(triangle_sides, [[0, 3, 1], [0, 2, 4]])

    def test_no_triangles_have_no_sides(self):
        sides, triangle_sides, shares = geometry.unique_sides([])
        self.assertEqual([a.shape for a in (sides, triangle_sides, shares)], [(0, 2), (0, 3), (0,)])

    def test_crossings_are_found_at_any_scale(self):
        triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=float)
        through, beside = [[0.2, 0.2, -0.1], [0.3, 0.3, 0.1]], [[0.8, 0.8, -0.1], [0.8, 0.8, 0.1]]
        within, short = [[-1, 0.2, 0], [2, 0.2, 0]], [[0.2, 0.2, 0.1], [0.2, 0.2, 0.2]]
        nodes = np.concatenate([triangle, through, beside, within, short])
        sides = np.array([[3, 4], [5, 6], [7, 8], [9, 10], [0, 4]])
        for scale in (1e-6, 1.0, 1e6):
            found = geometry.crossings(scale * nodes, sides, np.array([[0, 1, 2]]))
            np.testing.assert_array_equal(found, [[0, 0]])

    def test_crossings_are_those_of_every_pair_looked_at(self):
        """In layers, in a crumpled sheet and with sides of very different lengths."""
        rng = np.random.default_rng(8)
        mesh = sail_mesh(fold_lines=3, inner_width=0.15)
        film, triangles = mesh.nodes[: mesh.film_size], mesh.triangles
        sides = geometry.unique_sides(triangles)[0]
        folded = fold(mesh)[: mesh.film_size]
        for x in (
            folded + 2e-4 * rng.normal(size=film.shape),
            film + 0.03 * rng.normal(size=film.shape),
            (film + 0.03 * rng.normal(size=film.shape)) * [100, 1, 1e-3],
            np.exp(1.5 * rng.normal(size=film.shape)),
        ):
            found = geometry.crossings(x, sides, triangles)
            self.assertGreater(len(found), 50)
            np.testing.assert_array_equal(found, _all_crossings(x, sides, triangles))
        self.assertEqual(len(geometry.crossings(folded, sides, triangles)), 0)
        self.assertEqual(geometry.crossings(film, sides[:0], triangles).shape, (0, 2))

    def test_quadrangles_are_cut_along_the_better_diagonal(self):
        nodes = np.array(
            [(0, 0, 0), (3, 0, 0), (3, 1, 0), (0, 1, 0)]  # either way the same
            + [(0, 0, 0), (1, 0, 0), (1.5, 0.8, 0), (0.5, 0.8, 0)]  # a rhomb, nearly
            + [(0, 0, 0), (2, -1, 0), (0.5, 0, 0), (2, 1, 0)]  # with a corner that points inwards
            + [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]  # no quadrangle: its sides cross
        )
        quads = np.arange(16).reshape(4, 4)
        for scale in (1e-6, 1e6):
            for first in range(4):
                for quad, cut in (
                    (quads[1], {frozenset((5, 6, 7)), frozenset((4, 5, 7))}),
                    (quads[2], {frozenset((8, 9, 10)), frozenset((8, 10, 11))}),
                ):
                    turned = np.roll(quad, first)[None]
                    found = geometry.cut_quadrangles(scale * nodes, turned)
                    self.assertEqual(set(map(frozenset, found.tolist())), cut)
                    self.assertGreater(geometry.area_vectors(nodes, found)[:, 2].min(), 0)
                    below = geometry.cut_quadrangles(scale * nodes, turned[:, ::-1])
                    self.assertEqual(set(map(frozenset, below.tolist())), cut)
                    self.assertLess(geometry.area_vectors(nodes, below)[:, 2].max(), 0)
        found = geometry.cut_quadrangles(nodes + 1e-9 * np.sin(7 * nodes), quads[:1])
        np.testing.assert_array_equal(found, [[0, 1, 2], [0, 2, 3]])
        with self.assertRaisesRegex(ValueError, r"round \[0.5, 0.5, 0.0\] m cross"):
            geometry.cut_quadrangles(nodes, quads)


def _all_crossings(nodes, sides, triangles):
    """What `geometry.crossings` gives, from a linear system for each pair."""
    found = []
    for i, (a, b) in enumerate(sides):
        others = np.flatnonzero(~np.isin(triangles, (a, b)).any(axis=1))
        p, q, r = nodes[triangles[others].T]
        along = np.broadcast_to(nodes[a] - nodes[b], p.shape)
        columns = np.stack([along, q - p, r - p], axis=-1)
        s, u, v = np.linalg.solve(columns, (nodes[a] - p)[..., None])[..., 0].T
        within = (0 < s) & (s < 1) & (u > 0) & (v > 0) & (u + v < 1)
        found += [(i, k) for k in others[within]]
    return found


class TestMeasures(unittest.TestCase):
    def test_flat_sail_is_fully_deployed(self):
        for n in REFINES:
            mesh = sail_mesh(refine=n)
            self.assertAlmostEqual(measures.deployment_rate(mesh, mesh.nodes), 1, places=12)
            self.assertAlmostEqual(measures.mean_tip_radius(mesh, mesh.nodes), 0.3217336, places=7)
            self.assertAlmostEqual(
                measures.mean_edge_middle_radius(mesh, mesh.nodes), 0.2275, places=12
            )
            np.testing.assert_allclose(measures.area_strain(mesh, mesh.nodes), 0, atol=1e-14)

    def test_measures_follow_a_shrunk_tilted_sail(self):
        mesh = sail_mesh()
        shrunk = mesh.nodes * [0.5, 0.25, 1.0] + [0, 0, 0.3]
        self.assertAlmostEqual(measures.deployment_rate(mesh, shrunk), 0.125, places=12)
        np.testing.assert_allclose(measures.area_strain(mesh, shrunk), 0.125 - 1, rtol=1e-12)
        self.assertAlmostEqual(
            measures.mean_edge_middle_radius(mesh, shrunk), 0.2275 * 0.375, places=12
        )

    def test_flat_tips_are_at_odd_eighths_of_a_turn(self):
        mesh = sail_mesh()
        azimuths = np.degrees(measures.tip_azimuths(mesh, mesh.nodes))
        np.testing.assert_allclose(azimuths, [45, 135, -135, -45], atol=1e-12)

    def test_phase_difference_is_continuous_over_many_turns(self):
        time = np.linspace(0, 2, 400)
        spool = 6 * np.pi * time
        lag = np.outer(time**2, [-1.0, -1.1, 0.4, -3.0])
        azimuths = np.radians([45, 135, -135, -45]) + spool[:, None] + lag
        wrapped = np.arctan2(np.sin(azimuths), np.cos(azimuths))
        self.assertGreater(np.abs(np.diff(wrapped, axis=0)).max(), 3)
        np.testing.assert_allclose(measures.phase_difference(wrapped, spool), lag, atol=1e-11)

    def test_nearest_turn_is_within_half_a_turn(self):
        turns = measures.nearest_turn(np.array([0.1, 3.0, -3.0]), np.array([12.5, -3.0, 3.0]))
        expected = [0.1 + 4 * np.pi, 3.0 - 2 * np.pi, 2 * np.pi - 3.0]
        np.testing.assert_allclose(turns, expected, atol=1e-13)


if __name__ == "__main__":
    unittest.main()

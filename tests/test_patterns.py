# SPDX-License-Identifier: GPL-2.0-or-later
"""Crease patterns become meshes: faces, holes, cuts, creases, folded starts; or one sentence."""

import os
import signal
import unittest
from dataclasses import replace
from unittest.mock import patch

import numpy as np
from membrane import geometry
from membrane.mesh import pattern_mesh
from membrane.mesh.fold_format import FoldFile, FoldFrame
from membrane.mesh.miura import miura
from membrane.mesh.pattern_mesh import mean_value_coordinates, mesh_pattern
from membrane.mesh.patterns import crease_pattern, find_faces, fold_by_angles, nearest_pose
from support import rotation

QUICK = True


def frame(coords, edges, letters, **more):
    """A FoldFrame in metres from plain lists."""
    coords = np.array([(*point, 0.0)[:3] for point in coords], dtype=float)
    return FoldFrame(
        coords=coords, edges=np.array(edges), letters=np.array(list(letters)), unit="m", **more
    )


def pattern_of(*frames, **options):
    return crease_pattern(FoldFile(frames), **options)


def ring(first, count):
    """Edges of a closed loop of vertices."""
    ids = first + np.arange(count)
    return np.column_stack([ids, np.roll(ids, -1)]).tolist()


def crash(*_):
    """As gmsh 4.8 did on a spike; later ones mesh it."""
    os.kill(os.getpid(), signal.SIGSEGV)


SQUARE = [(0, 0), (3, 0), (3, 3), (0, 3)]
HOLE = [(1, 1), (2, 1), (2, 2), (1, 2)]
# The square, its lower edge halved, and a cut from the middle of that edge.
CUT = [*SQUARE, (1.5, 0), (1.5, 1.2)]
CUT_EDGES = [(0, 4), (4, 1), (1, 2), (2, 3), (3, 0), (4, 5)]


class TestFaces(unittest.TestCase):
    def test_a_hole_of_border_edges_is_no_film(self):
        pattern = pattern_of(frame([*SQUARE, *HOLE], [*ring(0, 4), *ring(4, 4)], "B" * 8))
        self.assertAlmostEqual(pattern.area, 9 - 1)
        self.assertEqual((len(pattern.faces), len(pattern.holes[0])), (1, 1))

    def test_a_loop_of_creases_is_film_on_both_sides(self):
        pattern = pattern_of(frame([*SQUARE, *HOLE], [*ring(0, 4), *ring(4, 4)], "BBBBMMMM"))
        self.assertAlmostEqual(pattern.area, 9)
        self.assertEqual(len(pattern.faces), 2)

    def test_film_within_a_hole_is_another_piece_and_refused(self):
        island = [(1.2, 1.2), (1.8, 1.2), (1.8, 1.8), (1.2, 1.8)]
        edges = [*ring(0, 4), *ring(4, 4), *ring(8, 4)]
        with self.assertRaisesRegex(ValueError, "several pieces"):
            pattern_of(frame([*SQUARE, *HOLE, *island], edges, "B" * 12))

    def test_faces_of_a_random_triangulation_are_found_again(self):
        from matplotlib.tri import Triangulation

        rng = np.random.default_rng(3)
        points = rng.uniform(size=(60, 2))
        mesh = Triangulation(*points.T)
        sides, _, shares = geometry.unique_sides(mesh.triangles)
        letters = np.where(shares == 1, "B", "V")
        vertices = np.column_stack([points, np.zeros(60)])
        faces, _ = find_faces(vertices, sides, letters)
        self.assertEqual(
            {frozenset(face.tolist()) for face in faces},
            {frozenset(corners) for corners in mesh.triangles.tolist()},
        )

    def test_what_makes_no_sheet_is_said(self):
        square = ring(0, 4)
        for points, edges, letters, words in (
            (SQUARE, [*square, (0, 2), (1, 3)], "BBBBMM", "edges 4 and 5 cross"),
            ([*SQUARE, (1.5, 0)], [*square, (4, 2)], "BBBBM", "vertex 4 lies on the edge"),
            (SQUARE, square[:3], "BBB", "border .B. with the same face"),
            (SQUARE, square, "FFFF", "enclose no film"),
            (SQUARE, [*square, (2, 0), (0, 2)], "BBBBMV", "edges 4 and 5 join .* as M, .* as V"),
            ([*SQUARE, (3, 0)], [*square, (1, 4)], "BBBBM", "no length"),
            (CUT, CUT_EDGES, "BBBBBB", "a cut is C"),
            (SQUARE, [*square, (0, 2)], "MBBBM", "round its faces do not close"),
        ):
            with self.subTest(words=words), self.assertRaisesRegex(ValueError, words):
                pattern_of(frame(points, edges, letters))

    def test_faces_that_contradict_the_edges_are_refused(self):
        edges, letters = [*ring(0, 4), (0, 2)], "BBBBM"
        for faces, words in (
            ([[0, 1, 2], [2, 3, 1]], "no edge does"),
            ([[0, 1, 2], [0, 2, 3], [0, 1, 2]], "lie on the same side of edge .: they overlap"),
            ([[0, 1, 2]], "crease .M. but has no face on one side"),
        ):
            loops = tuple(np.array(face) for face in faces)
            with self.subTest(words=words), self.assertRaisesRegex(ValueError, words):
                pattern_of(frame(SQUARE, edges, letters, faces=loops))

    def test_a_face_that_touches_itself_is_refused(self):
        points = [*SQUARE, (2, 0)]  # the loop runs back over its first side
        loop = np.array([0, 1, 2, 3, 4])
        with self.assertRaisesRegex(ValueError, "vertex 4 lies on the edge from vertex 0 to"):
            pattern_of(frame(points, ring(0, 5), "BBBBB", faces=(loop,)))

    def test_a_folded_form_without_area_is_refused(self):
        edges, faces = [*ring(0, 4), (0, 2)], (np.array([0, 1, 2]), np.array([0, 2, 3]))
        for points, words in (
            ([(0, 0, 0), (1, 0, 1), (2, 0, 2), (3, 0, 3)], "no area"),
            ([(0, 0, 0), (0, 0, 0), (2, 0, 2), (3, 3, 0)], "edge 0 has no length"),
        ):
            one = frame(points, edges, "BBBBV", faces=faces, classes=("foldedForm",))
            with self.subTest(points), self.assertRaisesRegex(ValueError, words):
                pattern_of(one)

    def test_a_unit_without_length_must_be_told(self):
        one = replace(frame(SQUARE, ring(0, 4), "BBBB"), unit="unit")
        with self.assertRaisesRegex(ValueError, "'unit'"):
            pattern_of(one)
        self.assertAlmostEqual(pattern_of(one, unit=0.1).area, 0.09)


class TestManyWays(unittest.TestCase):
    """What programs write otherwise than others do, and what is meant by it."""

    # An L of three squares, so that no mirror maps it onto itself; two creases.
    POINTS = [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 1)]
    EDGES = [*ring(0, 8), (1, 4), (4, 7)]
    FACES = ([0, 1, 4, 7], [1, 2, 3, 4], [4, 5, 6, 7])
    ANGLES = np.array([0.0] * 8 + [70, -35])

    def sheet(self, points=None, faces=None, **more):
        loops = self.FACES if faces is None else faces
        given = {"faces": tuple(map(np.array, loops)), "angles": self.ANGLES, **more}
        return frame(self.POINTS if points is None else points, self.EDGES, "B" * 8 + "VM", **given)

    def test_faces_that_run_clockwise_show_the_lower_side(self):
        """As of Oriedita, whose y axis points downwards: mountain and valley are seen from there.

        The sheet is turned over, not mirrored.
        """
        clockwise = pattern_of(self.sheet(faces=[face[::-1] for face in self.FACES]))
        below = [(x, -y) for x, y in self.POINTS]
        expected = pattern_of(self.sheet(below, [face[::-1] for face in self.FACES]))
        np.testing.assert_array_equal(clockwise.vertices, expected.vertices)
        np.testing.assert_array_equal(clockwise.folded, expected.folded)
        self.assertEqual(clockwise.notes, ())
        self.assertAlmostEqual(clockwise.area, 3)
        upright = pattern_of(self.sheet())
        back = nearest_pose(clockwise.vertices, upright.vertices)
        np.testing.assert_allclose(back, upright.vertices, atol=1e-12)
        # Folded as the letters say, but seen from below: no rotation makes the two alike.
        other = nearest_pose(clockwise.folded, upright.folded)
        self.assertGreater(np.abs(other - upright.folded).max(), 0.1)
        mesh = mesh_pattern(clockwise, 0.3)
        angles = geometry.crease_angles(mesh.start, mesh.triangles, mesh.creases, mesh.crease_signs)
        bent = {geometry.VALLEY: 180 - 70, geometry.MOUNTAIN: 180 - 35}
        np.testing.assert_allclose(np.degrees(angles), [bent[s] for s in mesh.crease_signs])

    def test_faces_that_disagree_are_made_to_agree_and_told(self):
        right = pattern_of(self.sheet())
        for turned in ([0], [1], [2]):
            faces = [f[::-1] if i in turned else f for i, f in enumerate(self.FACES)]
            found = pattern_of(self.sheet(faces=faces))
            np.testing.assert_array_equal(found.folded, right.folded)
            self.assertIn("1 of 3 faces run the other way round", found.notes[0])
        below = pattern_of(self.sheet(faces=[self.FACES[0], *(f[::-1] for f in self.FACES[1:])]))
        all_below = pattern_of(self.sheet(faces=[face[::-1] for face in self.FACES]))
        np.testing.assert_array_equal(below.folded, all_below.folded)

    def test_a_surface_with_one_side_is_refused(self):
        """A Moebius strip of twelve quadrangles."""
        turns = 2 * np.pi * np.arange(12) / 12
        out = np.column_stack([np.cos(turns), np.sin(turns), 0 * turns])
        across = np.cos(turns / 2)[:, None] * out + np.sin(turns / 2)[:, None] * [0, 0, 1]
        points = np.concatenate([3 * out - 0.4 * across, 3 * out + 0.4 * across])
        faces = [(i, i + 1, i + 13, i + 12) for i in range(11)] + [(11, 12, 0, 23)]
        sides = {frozenset(side) for f in faces for side in zip(f, (*f[1:], f[0]))}
        letters = ["V" if abs(a - b) == 12 else "B" for a, b in sides]
        loops = tuple(map(np.array, faces))
        strip = frame(points, [*map(list, sides)], letters, faces=loops, classes=("foldedForm",))
        with self.assertRaisesRegex(ValueError, "one side only, as a Moebius strip"):
            pattern_of(strip)

    def test_a_pattern_in_any_plane_is_a_flat_pattern(self):
        flat, turn = pattern_of(self.sheet()), rotation(np.random.default_rng(6))
        for matrix in (turn, -turn @ np.diag([1, 1, -1]), np.eye(3)[[0, 2, 1]], np.eye(3)):
            points = flat.vertices @ matrix.T + [1, 2, 3]
            found = pattern_of(self.sheet(points))
            self.assertEqual(np.ptp(found.vertices[:, 2]), 0)
            for one, two in ((found.vertices, flat.vertices), (found.folded, flat.folded)):
                np.testing.assert_allclose(nearest_pose(one, two), two, atol=1e-12)
            alone = pattern_of(replace(self.sheet(points), faces=None, angles=None))
            self.assertAlmostEqual(alone.area, 3)

    def test_vertices_on_one_another_are_one_and_named(self):
        """Where faces say what hangs together, they stay two: a slit is meant."""
        points, edges = [*self.POINTS, (1 + 2e-7, 1)], [*ring(0, 8), (1, 8), (4, 7)]
        bent = replace(frame(points, edges, "B" * 8 + "VM"), angles=self.ANGLES)
        found = pattern_of(bent)
        self.assertEqual(
            found.notes, ("vertices 4 and 8 lie 2e-07 m apart: they are taken as one",)
        )
        np.testing.assert_array_equal(found.folded[:8], pattern_of(self.sheet(faces=[])).folded)
        near = frame([*self.POINTS, (1 - 5e-6, 1 - 5e-6)], edges, "B" * 8 + "VM")
        self.assertEqual(pattern_of(near).notes, ())
        # A side between the two goes with them.
        kink = [*ring(0, 5), (5, 6), (6, 7), (7, 0), (1, 4), (4, 7)]
        kink[4] = (4, 8)
        kink.insert(5, (8, 5))
        tiny = pattern_of(frame(points, kink, "B" * 9 + "VM"))
        self.assertEqual((tiny.area, len(tiny.edges)), (3, 10))
        slit = [*self.POINTS, (1, 1)]
        faces = [[0, 1, 4, 7], [1, 2, 3, 4], [8, 5, 6, 7]]
        edges = [(0, 1), (1, 2), (2, 3), (3, 4), (8, 5), (5, 6), (6, 7), (7, 0)]
        edges += [(1, 4), (4, 7), (8, 7)]
        open_slit = frame(slit, edges, "BBBBBBBBVBB", faces=tuple(map(np.array, faces)))
        with self.assertRaisesRegex(ValueError, "pieces: .* vertices 4 and 8 lie 0 m apart"):
            pattern_of(open_slit)

    def test_an_edge_given_twice_counts_once(self):
        again = [*self.EDGES, (4, 1)]
        twice = frame(self.POINTS, again, "B" * 8 + "VMV", angles=np.array([*self.ANGLES, 70]))
        once = pattern_of(self.sheet(faces=[]))
        np.testing.assert_array_equal(pattern_of(twice).edges, once.edges)
        np.testing.assert_array_equal(pattern_of(twice).folded, once.folded)
        for letters, angle, words in (
            ("VMV", 60, "edges 8 and 10 join the same vertices, bent by 70 and by 60 degrees"),
            ("VMF", 70, "edges 8 and 10 join the same vertices, one as V, the other as F"),
        ):
            other = replace(twice, letters=np.array([*"B" * 8, *letters]))
            with self.assertRaisesRegex(ValueError, words):
                pattern_of(replace(other, angles=np.array([*self.ANGLES, angle])))

    def test_the_border_cannot_fold_whatever_its_letter(self):
        every = replace(self.sheet(), letters=np.array([*"MMMMVVVV", *"VM"]))
        found = pattern_of(every)
        self.assertEqual("".join(found.letters), "B" * 8 + "VM")
        self.assertIn("edge 0 (M) and 7 more cannot fold", found.notes[0])

    def test_a_crease_that_ends_inside_a_face_cannot_be_bent(self):
        points, edges = [*self.POINTS, (0.3, 0.3), (0.6, 0.6)], [*self.EDGES, (8, 9)]
        angles = np.array([*self.ANGLES, 20])
        dangling = frame(points, edges, "B" * 8 + "VMV", angles=angles)
        with self.assertRaisesRegex(
            ValueError, r"edge 10 \(V\) ends inside face \d, .* 20 degrees"
        ):
            pattern_of(dangling)


class TestMesh(unittest.TestCase):
    def test_area_and_orientation_of_non_convex_faces_with_holes(self):
        corner = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]
        hole = [(0.3, 0.3), (0.7, 0.3), (0.5, 0.7)]
        pattern = pattern_of(frame([*corner, *hole], [*ring(0, 6), *ring(6, 3)], "B" * 9))
        mesh = mesh_pattern(pattern, 0.2)
        upward = geometry.area_vectors(mesh.nodes, mesh.triangles)[:, 2]
        self.assertGreater(upward.min(), 0)
        self.assertAlmostEqual(upward.sum(), 5 - 0.08, places=12)

    def test_creases_run_along_their_edges_at_every_size(self):
        pattern = pattern_of(frame(SQUARE, [*ring(0, 4), (0, 2)], "BBBBV"))
        for size in (5.0, 1.0, 0.2):
            mesh = mesh_pattern(pattern, size)
            lengths = geometry.side_lengths(mesh.nodes, mesh.creases)
            self.assertAlmostEqual(lengths.sum(), 3 * np.sqrt(2), places=12)
            np.testing.assert_allclose(mesh.nodes[mesh.creases, 0], mesh.nodes[mesh.creases, 1])
            self.assertEqual(set(mesh.crease_signs), {geometry.VALLEY})
            geometry.crease_corners(mesh.triangles, mesh.creases)

    def test_flat_joined_and_unassigned_edges_are_sides_without_crease(self):
        for letter in "FJU":
            mesh = mesh_pattern(pattern_of(frame(SQUARE, [*ring(0, 4), (0, 2)], "BBBB" + letter)))
            self.assertEqual(len(mesh.creases), 0)
            on = np.abs(mesh.nodes[:, 0] - mesh.nodes[:, 1]) < 1e-12
            self.assertGreater(on.sum(), 5)

    def test_an_unassigned_edge_folds_as_its_angle_says(self):
        for angle, sign in ((-30.0, geometry.MOUNTAIN), (30.0, geometry.VALLEY)):
            angles = np.array([0.0, 0, 0, 0, angle])
            one = frame(SQUARE, [*ring(0, 4), (0, 2)], "BBBBU", angles=angles)
            self.assertEqual(set(mesh_pattern(pattern_of(one)).crease_signs), {sign})

    def test_a_cut_opens_at_the_rim_and_ends_in_one_node(self):
        mesh = mesh_pattern(pattern_of(frame(CUT, CUT_EDGES, "BBBBBC")), 0.3)
        on = (np.abs(mesh.nodes[:, 0] - 1.5) < 1e-9) & (mesh.nodes[:, 1] < 1.2 + 1e-9)
        heights, counts = np.unique(mesh.nodes[on, 1].round(9), return_counts=True)
        self.assertEqual(counts.tolist(), [2] * (len(heights) - 1) + [1])
        self.assertEqual(len(heights), 5)
        sides, _, shares = geometry.unique_sides(mesh.triangles)
        rim = geometry.side_lengths(mesh.nodes, sides[shares == 1]).sum()
        self.assertAlmostEqual(rim, 12 + 2 * 1.2, places=12)
        # Euler's number of a disk: still one piece without a hole.
        self.assertEqual(len(mesh.nodes) - len(sides) + len(mesh.triangles), 1)

    def test_a_cut_within_the_film_is_a_hole_without_area(self):
        points = [*SQUARE, (1, 1.5), (2, 1.5)]
        mesh = mesh_pattern(pattern_of(frame(points, [*ring(0, 4), (4, 5)], "BBBBC")), 0.25)
        sides = geometry.unique_sides(mesh.triangles)[0]
        self.assertEqual(len(mesh.nodes) - len(sides) + len(mesh.triangles), 0)
        self.assertAlmostEqual(mesh.area, 9)

    def test_a_slit_by_doubled_border_edges_stays_open(self):
        points = [(0, 0), (1, 0), (1, 1), (0, 1), (1, 0), (2, 0), (2, 1)]
        edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 2), (2, 4)]
        faces = (np.array([0, 1, 2, 3]), np.array([4, 5, 6, 2]))
        with self.assertRaisesRegex(ValueError, "pieces"):  # they meet in one vertex only
            pattern_of(frame(points, edges, "B" * 8, faces=faces))
        tied = [*points, (1, 2), (0, 2), (2, 2)]
        edges += [(3, 8), (8, 7), (7, 9), (9, 6), (2, 7)]
        edges[2], edges[6] = (2, 3), (6, 2)
        faces = (*faces, np.array([3, 2, 7, 8]), np.array([2, 6, 9, 7]))
        letters = [*"BBVBBBVBBBBBV"]
        mesh = mesh_pattern(pattern_of(frame(tied, edges, letters, faces=faces)), 0.3)
        sides, _, shares = geometry.unique_sides(mesh.triangles)
        rim = geometry.side_lengths(mesh.nodes, sides[shares == 1]).sum()
        self.assertAlmostEqual(rim, 8 + 2, places=12)

    def test_narrow_corners_and_strips_get_no_flat_triangles(self):
        """Equation (5) would give them a negative stiffness, and the sail would be refused."""
        right, top = ((3, y) for y in (0.6, 1.2, 2)), ((x, 3) for x in (2.4, 1.8, 1.2, 0.6))
        points = [*SQUARE, *right, *top]
        rim = [(0, 1), (1, 4), (4, 5), (5, 6), (6, 2), (2, 7), (7, 8), (8, 9), (9, 10), (10, 3)]
        edges = [*rim, (3, 0), *((0, i) for i in (4, 5, 6, 7, 8, 9, 10))]
        pattern = pattern_of(frame(points, edges, "B" * 11 + "MVMVMVM"))
        for size in (0.35, 0.6):
            mesh = mesh_pattern(pattern, size)
            plain = pattern_mesh._with_gmsh(pattern, size)
            angles = [geometry.triangle_angles(m.nodes, m.triangles).max() for m in (plain, mesh)]
            self.assertGreater(np.degrees(angles[0]), 117)
            self.assertLess(np.degrees(angles[1]), 115.1)
            self.assertAlmostEqual(mesh.area, 9)
            creased = geometry.side_lengths(mesh.nodes, mesh.creases).sum()
            expected = geometry.side_lengths(pattern.vertices, pattern.edges[11:]).sum()
            self.assertAlmostEqual(creased, expected)
            geometry.crease_corners(mesh.triangles, mesh.creases)

    def test_nodes_of_a_split_triangle_start_on_the_folded_faces(self):
        points = [(0, 0), (3, 0), (3, 0.4), (0, 0.4), (3, 3), (0, 3)]
        edges = [(0, 1), (1, 2), (3, 0), (2, 4), (4, 5), (5, 3), (3, 2)]
        angles = np.array([0.0] * 6 + [70.0])
        pattern = pattern_of(frame(points, edges, "B" * 6 + "V", angles=angles))
        mesh = mesh_pattern(pattern, 0.7)
        plain = pattern_mesh._with_gmsh(pattern, 0.7)
        self.assertGreater(len(mesh.nodes), len(plain.nodes))  # else nothing has been split
        sides = geometry.unique_sides(mesh.triangles)[0]
        np.testing.assert_allclose(
            geometry.side_lengths(mesh.start, sides), geometry.side_lengths(mesh.nodes, sides)
        )

    def test_what_gmsh_cannot_take_is_refused(self):
        thin = [(0, 0), (1e8, 0), (1e8, 1), (0, 1)]  # gmsh would ask whether to go on, and wait
        with self.assertRaisesRegex(ValueError, "more than 200000 sides"):
            mesh_pattern(pattern_of(frame(thin, ring(0, 4), "BBBB")))

    def test_where_gmsh_crashes_is_told(self):
        with patch.object(pattern_mesh, "_by_gmsh", crash):
            with self.assertRaisesRegex(ValueError, "gmsh cannot mesh the pattern: it crashes"):
                mesh_pattern(pattern_of(frame(SQUARE, ring(0, 4), "BBBB")))

    def test_a_size_out_of_range_is_refused(self):
        pattern = pattern_of(frame(SQUARE, ring(0, 4), "BBBB"))
        for size in (0.0, -1.0, float("nan"), 1e-4):
            with self.assertRaisesRegex(ValueError, "size = "):
                mesh_pattern(pattern, size)


class TestFoldedStart(unittest.TestCase):
    STRIP = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (2, 1), (1, 1), (0, 1)]
    EDGES = [*ring(0, 8), (1, 6), (2, 5)]

    def strip(self, *angles):
        letters = "B" * 8 + "".join("M" if a < 0 else "V" for a in angles)
        return frame(self.STRIP, self.EDGES, letters, angles=np.array([0.0] * 8 + [*angles]))

    def test_a_valley_of_90_degrees_stands_a_face_upright(self):
        pattern = pattern_of(self.strip(90, 0))
        ground = nearest_pose(pattern.folded[[0, 1, 6, 7]], pattern.vertices[[0, 1, 6, 7]])
        self.assertLess(np.ptp(ground[:, 2]), 1e-12)
        folded = fold_by_angles(pattern)
        # The first face found may be any; seen from the one on the ground the rest stands upright.
        x, y, up = (folded[1] - folded[0], folded[7] - folded[0], folded[2] - folded[1])
        np.testing.assert_allclose(np.cross(x, y), up, atol=1e-12)

    def test_two_mountains_of_120_degrees_close_a_triangle_below(self):
        folded = fold_by_angles(pattern_of(self.strip(-120, -120)))
        np.testing.assert_allclose(folded[3], folded[0], atol=1e-12)
        self.assertLess(folded[2, 2], -0.8)

    def test_the_mesh_starts_with_the_angles_of_the_file(self):
        angles = (70.0, -35.0)
        mesh = mesh_pattern(pattern_of(self.strip(*angles)), 0.2)
        found = geometry.crease_angles(mesh.start, mesh.triangles, mesh.creases, mesh.crease_signs)
        first = mesh.nodes[mesh.creases[:, 0], 0] < 1.5
        np.testing.assert_allclose(np.degrees(found[first]), 180 - 70, atol=1e-9)
        np.testing.assert_allclose(np.degrees(found[~first]), 180 - 35, atol=1e-9)
        sides = mesh.lines()[0]
        rest, now = (geometry.side_lengths(x, sides) for x in (mesh.nodes, mesh.start))
        np.testing.assert_allclose(now, rest, rtol=1e-12)

    def test_without_letters_the_faces_tell_the_border(self):
        told = self.strip(70, -35)
        faces = tuple(np.array(face) for face in ([0, 1, 6, 7], [1, 2, 5, 6], [2, 3, 4, 5]))
        given, found = (
            mesh_pattern(pattern_of(replace(told, letters=letters, faces=faces)), 0.2)
            for letters in (told.letters, None)
        )
        np.testing.assert_array_equal(found.start, given.start)
        np.testing.assert_array_equal(found.creases, given.creases)
        np.testing.assert_array_equal(found.crease_signs, given.crease_signs)
        self.assertEqual(set(found.crease_signs), {geometry.MOUNTAIN, geometry.VALLEY})
        without = pattern_of(replace(told, edges=None, letters=None, angles=None, faces=faces))
        self.assertEqual(sorted(without.letters), sorted("B" * 8 + "U" * 2))
        with self.assertRaisesRegex(ValueError, "neither edges_assignment nor faces"):
            pattern_of(replace(told, letters=None))

    def test_angles_that_do_not_go_together_are_refused(self):
        points = [(0, 0), (1, 0), (0, 1), (-1, 0), (0, -1)]
        edges = [(1, 2), (2, 3), (3, 4), (4, 1), (0, 1), (0, 2), (0, 3), (0, 4)]
        for bent, words in (((60, 0, 20, 0), "edge . would"), ((60, 50, 20, 30), "vertex . would")):
            angles = np.array([0.0, 0, 0, 0, *bent])
            with self.assertRaisesRegex(ValueError, "do not go together: " + words) as refused:
                pattern_of(frame(points, edges, "BBBBVVVV", angles=angles))
            self.assertNotIn("-0 ", str(refused.exception))

    def test_a_folded_form_alone_unrolls_to_its_pattern(self):
        pattern = pattern_of(self.strip(50, -110))
        turned = pattern.folded @ rotation(np.random.default_rng(1)).T + 2.0
        faces = ([0, 1, 6, 7], [1, 2, 5, 6], [2, 3, 4, 5])
        form = FoldFrame(
            coords=turned,
            edges=pattern.edges,
            letters=pattern.letters,
            faces=tuple(np.array(face) for face in faces),
            classes=("foldedForm",),
            unit="m",
        )
        found = pattern_of(form)
        a, b = np.triu_indices(8, 1)
        one, two = (np.linalg.norm(x[a] - x[b], axis=1) for x in (found.vertices, pattern.vertices))
        np.testing.assert_allclose(one, two, atol=1e-12)
        np.testing.assert_array_equal(found.folded, turned)
        self.assertGreater(found.area, 0)

    def test_a_folded_form_within_one_percent_unrolls(self):
        """A sheet of 10 x 10 faces, its vertices shaken; errors do not add up along its faces."""
        flat, form = miura(columns=10, rows=10).frames
        rng, exact = np.random.default_rng(3), pattern_of(form)
        sides = exact.vertices[exact.edges]
        lengths = geometry.side_lengths(exact.vertices, exact.edges)
        np.testing.assert_allclose(lengths, geometry.side_lengths(flat.coords, flat.edges))
        noise = rng.normal(size=form.coords.shape)
        noise /= np.abs(
            np.einsum(
                "ei,ei->e", np.diff(noise[exact.edges], axis=1)[:, 0], np.diff(sides, axis=1)[:, 0]
            )
            / lengths**2
        ).max()
        shaken = replace(form, coords=form.coords + 0.008 * noise)
        found = pattern_of(shaken)
        np.testing.assert_array_equal(found.folded, shaken.coords)
        now = geometry.side_lengths(found.vertices, found.edges)
        rest = geometry.side_lengths(shaken.coords, found.edges)
        self.assertLess(np.abs(now / rest - 1).max(), 0.0101)
        off = nearest_pose(found.vertices, flat.coords) - flat.coords
        self.assertLess(np.abs(off).max(), 0.03 * exact.size)
        with self.assertRaisesRegex(ValueError, "does not unroll into the plane: edge .* longer"):
            pattern_of(replace(form, coords=form.coords + 0.05 * noise))

    def test_what_has_no_flat_form_is_refused(self):
        """A pyramid of four triangles, whose angles at the apex do not make a full turn."""
        points = [(0, 0, 0.5), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)]
        edges = [*ring(1, 4), *((0, i) for i in range(1, 5))]
        faces = tuple(np.array([0, i, i % 4 + 1]) for i in range(1, 5))
        peak = frame(points, edges, "BBBBMMMM", faces=faces, classes=("foldedForm",))
        with self.assertRaisesRegex(ValueError, "does not unroll"):
            pattern_of(peak)

    def test_a_stretched_folded_form_is_refused(self):
        pattern = pattern_of(self.strip(50, 0))
        form = replace(self.strip(50, 0), coords=1.02 * pattern.folded, classes=("foldedForm",))
        with self.assertRaisesRegex(ValueError, "changes the length of edge"):
            pattern_of(replace(self.strip(50, 0), angles=None), form)

    def test_what_is_folded_flat_starts_unfolded(self):
        """It has no height to open from: spun, it would stay closed for ever."""
        self.assertIsNone(pattern_of(self.strip(180, -180)).folded)
        self.assertIsNotNone(pattern_of(self.strip(179, -180)).folded)
        flat = replace(self.strip(180, -180), angles=None)
        shut = fold_by_angles(replace(pattern_of(flat), angles=self.strip(180, -180).angles))
        for upright in (shut, shut[:, [1, 2, 0]]):
            form = replace(flat, coords=upright, classes=("foldedForm",))
            self.assertIsNone(pattern_of(flat, form).folded)
            with self.assertRaisesRegex(ValueError, "frame 1 is folded flat"):
                pattern_of(flat, form, start=1)
        moved = replace(flat, coords=flat.coords[:, [1, 2, 0]])  # not folded at all
        self.assertIsNotNone(pattern_of(flat, moved, start=1).folded)

    def test_angles_in_radians_are_doubted(self):
        (said,) = pattern_of(self.strip(1.5, -np.pi)).notes
        self.assertIn("are they in radians? FOLD has degrees", said)
        for few in ((3.2, -1), (0, 0)):
            self.assertEqual(pattern_of(self.strip(*few)).notes, ())
        points, edges = [*SQUARE, (1.5, 1.5)], [*ring(0, 4), *((4, i) for i in range(4))]
        angles = np.array([0.0, 0, 0, 0, 1, 1.5, 1, 1.5])
        with self.assertRaisesRegex(ValueError, "do not go together: .*; .* in radians"):
            pattern_of(frame(points, edges, "BBBBVVVV", angles=angles))
        form = replace(self.strip(1.5, -1), coords=pattern_of(self.strip(1.5, -1)).folded)
        nearly_flat = pattern_of(self.strip(1.5, -1), replace(form, classes=("foldedForm",)))
        self.assertEqual(nearly_flat.notes, ())

    def test_a_folded_form_of_another_sheet_is_passed_over(self):
        flat = replace(self.strip(50, 0), angles=None)
        other = replace(flat, coords=np.vstack([flat.coords, [0, 0, 1]]), classes=("foldedForm",))
        form = replace(flat, coords=pattern_of(self.strip(50, 0)).folded, classes=("foldedForm",))
        np.testing.assert_array_equal(pattern_of(flat, other, form).folded, form.coords)

    def test_a_sheet_that_starts_flat_needs_no_folded_form(self):
        points, edges = [*SQUARE, (1.5, 1.5)], [*ring(0, 4), *((4, i) for i in range(4))]
        sheet = frame(points, edges, "BBBBVVVV", angles=np.array([0.0, 0, 0, 0, 40, 40, 40, 40]))
        with self.assertRaisesRegex(ValueError, "do not go together"):
            pattern_of(sheet)
        self.assertIsNone(pattern_of(sheet, unfolded=True).folded)

    def test_letters_meant_from_below_are_turned_over(self):
        flat, pattern = replace(self.strip(60, 60), angles=None), pattern_of(self.strip(60, 60))
        for letters, expected in (("VV", {-1}), ("MM", {-1}), ("MV", {1, -1})):
            named = np.array(list("B" * 8 + letters))
            form = replace(flat, letters=named, coords=pattern.folded, classes=("foldedForm",))
            one = pattern_of(replace(flat, letters=named), form)
            self.assertEqual(set(mesh_pattern(one, 0.5).crease_signs), expected)


class TestTools(unittest.TestCase):
    def test_mean_value_coordinates_give_linear_functions_back(self):
        """Also in a face that is not convex and has a hole and a slit."""
        corner = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]
        extra = [(0.3, 0.3), (0.7, 0.3), (0.5, 0.7), (1.5, 0.5), (2.5, 0.5)]
        vertices = np.array([(*p, 0.0) for p in [*corner, *extra]])
        sides = np.array([*ring(0, 6), (7, 6), (8, 7), (6, 8), (9, 10), (10, 9)])
        rng = np.random.default_rng(2)
        points = np.column_stack([rng.uniform(0.05, 2.9, 40), rng.uniform(0.05, 0.25, 40)])
        points = np.column_stack([points, np.zeros(40)])
        weights = mean_value_coordinates(points, vertices, sides)
        np.testing.assert_allclose(weights @ vertices, points, atol=1e-12)

    def test_nearest_pose_takes_back_any_motion(self):
        rng = np.random.default_rng(4)
        places, turn = rng.normal(size=(20, 3)), rotation(rng)
        np.testing.assert_allclose(nearest_pose(places @ turn.T + 3.0, places), places, atol=1e-12)


if __name__ == "__main__":
    unittest.main()

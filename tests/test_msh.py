# SPDX-License-Identifier: GPL-2.0-or-later
"""Meshes of gmsh become sheets, in every version, text or binary; or one sentence."""

import unittest

import meshio
import numpy as np
from membrane import geometry
from membrane.files import BadFile
from membrane.mesh.msh import read_msh
from support import gmsh_sheet, scratch

QUICK = True

# Two triangles and a fold line between them, as gmsh writes it.
SMALL = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
1 7 "V"
$EndPhysicalNames
$Nodes
4
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
3
1 1 2 7 1 1 3
2 2 2 0 1 1 2 3
3 2 2 0 1 1 3 4
$EndElements
"""


def written(text, name="small.msh"):
    path = scratch() / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def surface(points, triangles, name="surface.msh"):
    """A .msh file of some triangles without groups."""
    path = scratch() / name
    meshio.Mesh(np.asarray(points, float), [("triangle", triangles)]).write(path, "gmsh22")
    return path


def tube(turns, cells=12):
    """Points and triangles of a band that is closed round the z axis, turned over so many times."""
    around = 2 * np.pi * np.arange(cells) / cells
    out = np.column_stack([np.cos(around), np.sin(around), 0 * around])
    lean = np.column_stack([np.cos(turns * around / 2), np.sin(turns * around / 2)])
    across = lean[:, :1] * [0, 0, 1] + lean[:, 1:] * out
    points = np.concatenate([3 * out - 0.4 * across, 3 * out + 0.4 * across])
    low, high = np.arange(cells), np.arange(cells, 2 * cells)
    after = np.roll(low, -1), np.roll(high, -1)
    if turns % 2:
        after[0][-1], after[1][-1] = cells, 0
    triangles = [np.column_stack([low, after[0], after[1]]), np.column_stack([low, after[1], high])]
    return points, np.concatenate(triangles)


class TestMsh(unittest.TestCase):
    def test_every_version_gives_the_same_sheet(self):
        files = [(2.2, False), (2.2, True), (4.0, False), (4.1, False), (4.1, True)]
        sheets = [read_msh(gmsh_sheet(*file)) for file in files]
        sheets += [read_msh(gmsh_sheet(*file, SaveParametric=1)) for file in files]
        sheets += [read_msh(gmsh_sheet(*file, SaveAll=1)) for file in files[2:]]
        sheets += [read_msh(gmsh_sheet(*file, parts=3)) for file in files]
        remark = b"$Comments\nby hand\n$EndComments\n" + gmsh_sheet().read_bytes()
        sheets.append(read_msh(written(remark)))
        for number in ("2", "2.0", "2.1", "2.20"):
            old = gmsh_sheet(2.2).read_text().replace("\n2.2 0", f"\n{number} 0", 1)
            sheets.append(read_msh(written(old.replace("\n", "\r\n").encode())))
        for sheet in sheets:
            self.assertEqual((sheet.others, sheet.notes), (("tips", "hub"), ()))
            self.assertAlmostEqual(sheet.area, 0.16, places=12)
            self.assertEqual(len(sheet.nodes), len(sheets[0].nodes))
            np.testing.assert_array_equal(sheet.nodes[sheet.creases][..., 0], 0)
            self.assertAlmostEqual(
                geometry.side_lengths(sheet.nodes, sheet.creases).sum(), 0.4, places=12
            )
            self.assertEqual(set(sheet.crease_signs), {geometry.MOUNTAIN})
            corners = np.abs(sheet.nodes[sheet.groups["tips"]])
            np.testing.assert_allclose(corners, [[0.2, 0.2, 0]] * 4)
            np.testing.assert_array_equal(sheet.nodes[sheet.groups["hub"]], [[0, 0, 0]])

    def test_meshes_that_meshio_writes_are_read(self):
        mesh = meshio.read(gmsh_sheet())
        for kind in ("gmsh", "gmsh22"):
            path = scratch() / f"{kind}.msh"
            mesh.write(path, file_format=kind)
            self.assertAlmostEqual(read_msh(path, unit=2.0).area, 4 * 0.16, places=12)

    def test_quadrangles_are_cut_and_triangles_turned_upwards(self):
        one = SMALL.replace("2 2 2 0 1 1 2 3\n3 2 2 0 1 1 3 4", "2 3 2 0 1 3 2 1 4")
        sheet = read_msh(written(one.replace("$Elements\n3", "$Elements\n2")))
        self.assertEqual(len(sheet.triangles), 2)
        self.assertTrue(np.all(geometry.area_vectors(sheet.nodes, sheet.triangles)[:, 2] > 0))

    def test_elements_of_second_order_give_their_corners(self):
        plain = read_msh(gmsh_sheet())
        for version in (2.2, 4.1):
            for more in ({}, {"RecombineAll": 1}, {"RecombineAll": 1, "ElementOrder": 3}):
                sheet = read_msh(gmsh_sheet(version, **{"ElementOrder": 2, **more}))
                order = more.get("ElementOrder", 2)
                note = f"the elements are of order {order}: their corners are taken"
                self.assertEqual(sheet.notes, (note,))
                self.assertAlmostEqual(sheet.area, 0.16, places=12)
                self.assertEqual(len(sheet.creases), len(plain.creases))
                if not more:
                    self.assertEqual(len(sheet.triangles), len(plain.triangles))

    def test_groups_that_lost_their_elements_are_told(self):
        sheet = read_msh(gmsh_sheet(2.2, SaveAll=1))
        self.assertEqual(len(sheet.creases), 0)
        (note,) = sheet.notes
        self.assertIn("no elements are in the groups tips, hub, mountain, film; version 2", note)

    def test_groups_without_names_are_told(self):
        text = SMALL[: SMALL.index("$Phys")] + SMALL[SMALL.index("$Nodes") :]
        self.assertIn("groups have no names", read_msh(written(text)).notes[0])

    def test_in_version_2_every_element_has_its_own_group(self):
        """Also where all lines belong to one curve, as other programs number them."""
        halves = SMALL.replace('1\n1 7 "V"', '2\n1 7 "V"\n1 8 "M"').replace("4\n1 0", "5\n1 0")
        halves = halves.replace("4 0 1 0\n", "4 0 1 0\n5 0.5 0.5 0\n")
        old = halves[halves.index("$Elements") :]
        lines = ["1 1 2 7 1 1 5", "2 1 2 8 1 5 3"]
        faces = ["3 2 2 0 1 1 2 5", "4 2 2 0 1 2 3 5", "5 2 2 0 1 3 4 5", "6 2 2 0 1 4 1 5"]
        new = "\n".join(["$Elements", "6", *lines, *faces, "$EndElements", ""])
        sheet = read_msh(written(halves.replace(old, new)))
        self.assertEqual(sheet.crease_signs.tolist(), [geometry.VALLEY, geometry.MOUNTAIN])
        twice = new.replace("2 1 2 8 1 5 3", "2 1 2 7 1 5 1")
        with self.assertRaisesRegex(BadFile, "0.25, 0.25, 0. m is there twice"):
            read_msh(written(halves.replace(old, twice)))
        again = new.replace("\n6\n", "\n8\n").replace(
            "$EndElements", "7 2 2 9 1 1 2 5\n8 1 2 9 1 1 5\n$EndElements"
        )  # as gmsh writes what is in two groups
        found = read_msh(written(halves.replace(old, again)))
        self.assertEqual((len(found.triangles), len(found.creases)), (4, 2))
        both = new.replace("2 1 2 8 1 5 3", "2 1 2 8 1 5 1")
        with self.assertRaisesRegex(BadFile, "both mountain and valley"):
            read_msh(written(halves.replace(old, both)))

    def test_what_a_sheet_cannot_be_is_said(self):
        corners = np.eye(4)[:, :3]
        closed = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
        apart = np.concatenate([corners[:3], corners[:3] + [0, 0, 2]])
        for points, triangles, words in (
            (corners, closed, "is a closed surface; a sheet has an edge"),
            (*tube(1), "one side only, as a Moebius strip"),
            (apart, [[0, 1, 2], [3, 4, 5]], "is of 2 pieces"),
            (
                np.eye(5)[:, :3],
                [[0, 1, 2], [1, 0, 3], [0, 1, 4]],
                "two triangles share the side at .0.5, 0.5, 0. m",
            ),
        ):
            with self.subTest(words=words), self.assertRaisesRegex(BadFile, words):
                read_msh(surface(points, np.array(triangles)))
        with self.assertRaisesRegex(BadFile, "no triangles; .* in no physical group"):
            read_msh(
                written(
                    SMALL.replace(
                        "3\n1 1 2 7 1 1 3\n2 2 2 0 1 1 2 3\n3 2 2 0 1 1 3 4", "1\n1 1 2 7 1 1 3"
                    )
                )
            )

    def test_triangles_that_disagree_are_made_to_agree(self):
        points, triangles = tube(2)
        triangles[[3, 17]] = triangles[[3, 17], ::-1]
        sheet = read_msh(surface(points, triangles))
        self.assertEqual(sheet.notes, ("2 of 24 triangles ran the other way round",))
        ends = np.stack([sheet.triangles, np.roll(sheet.triangles, -1, axis=1)], axis=-1)
        self.assertEqual(len(np.unique(ends.reshape(-1, 2), axis=0)), 3 * 24)

    def test_a_flat_sheet_is_turned_across_the_axis(self):
        flat = read_msh(gmsh_sheet())
        upright = flat.nodes[:, [0, 2, 1]] + [0, 1, 0]
        sheet = read_msh(surface(upright, flat.triangles))
        self.assertEqual(np.ptp(sheet.nodes[:, 2]), 0)
        self.assertAlmostEqual(sheet.area, 0.16, places=12)
        self.assertIn("turned into the plane", sheet.notes[0])

    def test_nodes_on_one_another_are_told(self):
        """Of two squares that gmsh has meshed one by one; and of a slit, which may be meant."""
        left = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        right = [(x + 1, y, z) for x, y, z in left]
        squares = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]
        words = "of 2 pieces; 2 pairs of nodes lie on one another, as at .1, 0, 0. m: .* open"
        with self.assertRaisesRegex(BadFile, words):
            read_msh(surface([*left, *right], np.array(squares)))
        slit = np.array(squares)
        slit[slit == 7] = 2
        (note,) = read_msh(surface([*left, *right], slit)).notes
        self.assertIn("1 pairs of nodes lie on one another, as at (1, 0, 0) m", note)
        slit[slit == 4] = 1
        self.assertEqual(read_msh(surface([*left, *right], slit)).notes, ())

    def test_group_names_give_creases_their_sign(self):
        for name, sign in (("V", -1), ("valley", -1), ("M", 1), ("Mountain", 1), ("rim", 0)):
            sheet = read_msh(written(SMALL.replace('"V"', f'"{name}"')))
            self.assertEqual(sheet.crease_signs.tolist(), [sign] if sign else [])
            self.assertEqual(len(sheet.groups[name]), 2)

    def test_what_is_wrong_is_named_with_its_place(self):
        for old, new, *parts in (
            ("$MeshFormat\n2.2", "$MeshFormat\n3.0", "$MeshFormat", "'3.0'", "2.2, 4.0 and 4.1"),
            ("$MeshFormat\n2.2", "$MeshFormat\n4.2", "$MeshFormat", "'4.2'"),
            ("2.2 0 8", "2.2 0 4", "$MeshFormat", "of size 8"),
            ("$MeshFormat", "$Mesh", "no mesh of gmsh"),
            ("$Nodes\n4", "$Nodes\n4000000000", "$Nodes", "as its count says"),
            ("$Nodes\n4", "$Nodes\n3", "$Nodes", "as its count says"),
            ("$Elements\n3", "$Elements\n99999999999", "$Elements", "as its count says"),
            ("$Elements\n3", "$Elements\n2", "$Elements", "as its count says"),
            ("$PhysicalNames\n1", "$PhysicalNames\n2", "$PhysicalNames", "names that its count"),
            ("4 0 1 0", "4 0 nan 0", "$Nodes", "node 4 lies at [0.0, nan, 0.0]"),
            ("4 0 1 0", "4 0 x 0", "$Nodes", "gmsh cannot read it"),
            ("4 0 1 0", "3 0 1 0", "node 4"),
            ("1 3 4\n", "1 3 9\n", "$Elements", "node 9"),
            ("1 3 4\n", "1 3 x\n", "$Elements", "gmsh cannot read it"),
            ("1 3 4\n", "1 3 3\n", "$Elements", "has a node twice"),
            ("1 1 2 7 1 1 3", "1 1 2 7 1 2 4", "the line at (0.5, 0.5, 0) m", "no side"),
            ("3 2 2", "3 77 2", "$Elements", "element 77"),
            ("$EndElements", "", "$Elements", "cut off"),
            ("$EndElements\n", "$EndElements\n$Elements\n0\n$EndElements", "$Elements", "twice"),
            ("2 2 2 0 1 1 2 3\n3 2 2 0 1 1 3 4", "2 1 2 7 1 1 2\n3 1 2 7 1 2 3", "no triangles"),
            ("4 0 1 0", "4 0 -1 0", "$Elements", "at (0.5, 0.5, 0) m overlap"),
            ("4 0 1 0", "4 2 2 0", "$Elements", "triangle at (1, 1, 0) m has no area"),
            ("2 2 2 0 1 1 2 3", "2 2 2 0 1 1 3 4", "at (0.3333, 0.6667, 0) m is there twice"),
        ):
            with self.subTest(new=new):
                self.assertIn(old, SMALL)
                path = written(SMALL.replace(old, new, 1))
                with self.assertRaises(BadFile) as caught:
                    read_msh(path)
                for part in (f"{path}: ", *parts):
                    self.assertIn(part, str(caught.exception))

    def test_a_volume_mesh_is_refused(self):
        cube = meshio.Mesh(np.eye(4)[:, :3], [("tetra", [[0, 1, 2, 3]])])
        path = scratch() / "volume.msh"
        cube.write(path, file_format="gmsh22")
        with self.assertRaisesRegex(BadFile, r"kind 4 \(Tetrahedron 4\)"):
            read_msh(path)


if __name__ == "__main__":
    unittest.main()

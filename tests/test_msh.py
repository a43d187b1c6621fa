# SPDX-License-Identifier: GPL-2.0-or-later
"""Meshes of gmsh become sheets, in every version, text or binary; or one sentence."""

import unittest

import meshio
import numpy as np
from membrane import geometry
from membrane.files import BadFile
from membrane.msh import read_msh
from support import gmsh_sheet, scratch

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
    path.write_text(text)
    return path


class TestMsh(unittest.TestCase):
    def test_every_version_gives_the_same_sheet(self):
        sheets = [read_msh(gmsh_sheet(v, b)) for v in (2.2, 4.1) for b in (False, True)]
        for sheet in sheets:
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

    def test_group_names_give_creases_their_sign(self):
        for name, sign in (("V", -1), ("valley", -1), ("M", 1), ("Mountain", 1), ("rim", 0)):
            sheet = read_msh(written(SMALL.replace('"V"', f'"{name}"')))
            self.assertEqual(sheet.crease_signs.tolist(), [sign] if sign else [])
            self.assertEqual(len(sheet.groups[name]), 2)

    def test_what_is_wrong_is_named_with_its_place(self):
        for old, new, *parts in (
            ("$MeshFormat\n2.2", "$MeshFormat\n3.0", "$MeshFormat", "2.2 and 4.1"),
            ("$MeshFormat", "$Mesh", "no mesh of gmsh"),
            ("$Nodes\n4", "$Nodes\n4000000000", "$Nodes", "ends before"),
            ("$Nodes\n4", "$Nodes\n3", "$Nodes", "more than its counts"),
            ("$Elements\n3", "$Elements\n99999999999", "$Elements", "ends before"),
            ("4 0 1 0", "4 0 nan 0", "$Nodes", "node 3"),
            ("4 0 1 0", "4 0 x 0", "$Nodes", "'x'"),
            ("4 0 1 0", "3 0 1 0", "$Nodes", "tag twice"),
            ("4 0 1 0", "2000000000 0 1 0", "$Nodes", "tags from 1 to 2000000000"),
            ("1 3 4\n", "1 3 9\n", "$Elements", "node 9"),
            ("1 3 4\n", "1 3 3\n", "$Elements", "node twice"),
            ("1 1 2 7 1 1 3", "1 1 2 7 1 2 4", "creases[0]"),
            ("3 2 2", "3 9 2", "$Elements", "kind 9"),
            ("$EndElements", "", "$Elements", "cut off"),
            ("2 2 2 0 1 1 2 3\n3 2 2 0 1 1 3 4", "2 1 2 7 1 1 2\n3 1 2 7 1 2 3", "no triangles"),
            ("4 0 1 0", "4 0 -1 0", "$Elements", "face opposite ways"),
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
        with self.assertRaisesRegex(BadFile, "kind 4"):
            read_msh(path)


if __name__ == "__main__":
    unittest.main()

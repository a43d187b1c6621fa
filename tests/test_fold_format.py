# SPDX-License-Identifier: GPL-2.0-or-later
"""FOLD files: what is written is read again, frames inherit, and what is wrong is said."""

import json
import unittest

import numpy as np
from membrane import geometry
from membrane.files import BadFile
from membrane.mesh.fold_format import UNITS, FoldFile, FoldFrame, crease_angles, fold_angles
from membrane.mesh.fold_format import read_fold, write_fold
from membrane.mesh.miura import miura
from support import fold_angle, scratch

QUICK = True

PATCH = {
    "file_spec": 1.2,
    "file_creator": "by hand",
    "frame_unit": "cm",
    "frame_classes": ["creasePattern"],
    "vertices_coords": [[0, 0], [1, 0], [1, 1], [0, 1]],
    "edges_vertices": [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]],
    "edges_assignment": ["B", "B", "B", "B", "M"],
    "edges_foldAngle": [0, 0, 0, 0, -90],
    "faces_vertices": [[0, 1, 2], [0, 2, 3]],
    "faceOrders": [[0, 1, 1]],
    "edges_ours:strength": [1, 2, 3, 4, None],
}


def written(content, name="patch.fold"):
    path = scratch() / name
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


class TestReading(unittest.TestCase):
    def test_every_property_arrives(self):
        (frame,) = read_fold(written(PATCH)).frames
        np.testing.assert_array_equal(frame.coords, [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
        np.testing.assert_array_equal(frame.edges, PATCH["edges_vertices"])
        self.assertEqual("".join(frame.letters), "BBBBM")
        self.assertEqual(frame.angles[4], -90)
        self.assertEqual([face.tolist() for face in frame.faces], [[0, 1, 2], [0, 2, 3]])
        self.assertEqual((frame.unit, frame.metre), ("cm", 0.01))
        self.assertEqual(frame.classes, ("creasePattern",))
        self.assertEqual(frame.custom, {"edges_ours:strength": [1, 2, 3, 4, None]})

    def test_every_letter_of_the_specification_is_known(self):
        for letter in "BMVFUCJ":
            changed = {**PATCH, "edges_assignment": [*"BBBB", letter], "edges_foldAngle": [0] * 5}
            self.assertEqual(read_fold(written(changed)).frames[0].letters[4], letter)

    def test_an_edge_that_does_not_fold_may_have_null_for_its_angle(self):
        """So Origami Simulator writes its borders."""
        changed = {**PATCH, "edges_foldAngle": [None, None, 0, None, -90]}
        self.assertEqual(read_fold(written(changed)).frames[0].angles.tolist(), [0, 0, 0, 0, -90])

    def test_empty_lists_about_edges_that_there_are_not_say_nothing(self):
        edges = {"edges_assignment": [], "edges_foldAngle": []}
        content = {name: v for name, v in PATCH.items() if not name.startswith("edges_")} | edges
        (frame,) = read_fold(written(content)).frames
        self.assertEqual((frame.edges, frame.letters, frame.angles), (None, None, None))
        self.assertEqual(len(frame.faces), 2)

    def test_specification_may_be_a_text_and_angles_may_be_rounded(self):
        for spec in (1, 1.1, "1.1", "1", "1.2"):
            changed = {**PATCH, "file_spec": spec, "edges_assignment": [*"BBBBU"]}
            for angle, taken in ((180.00000000000003, 180), (-180.0000001, -180), (12.5, 12.5)):
                changed["edges_foldAngle"] = [0, 0, 0, 0, angle]
                self.assertEqual(read_fold(written(changed)).frames[0].angles[4], taken)

    def test_units_are_those_of_the_specification(self):
        self.assertAlmostEqual(UNITS["in"], 25.4 * UNITS["mm"])
        self.assertAlmostEqual(UNITS["pt"] * 72, UNITS["in"])
        self.assertEqual(set(UNITS), {"in", "pt", "m", "cm", "mm", "um", "nm"})
        self.assertIsNone(FoldFrame(unit="unit").metre)

    def test_frames_inherit_what_they_do_not_have_from_any_frame(self):
        frames = [
            {"frame_parent": 2, "frame_inherit": True, "frame_title": "grandchild"},
            {"frame_parent": 0, "frame_inherit": True, "edges_assignment": [*"BBBBV"],
             "edges_foldAngle": [0, 0, 0, 0, 30]},
            {"frame_parent": 0, "frame_title": "no heir"},
        ]  # fmt: skip
        found = read_fold(written({**PATCH, "file_frames": frames})).frames
        self.assertEqual("".join(found[1].letters), "BBBBV")
        self.assertEqual(found[1].title, "grandchild")
        self.assertIs(found[1].coords, found[0].coords)
        self.assertIs(found[1].letters, found[2].letters)
        self.assertIsNone(found[3].coords)

    def test_a_circle_of_parents_is_refused(self):
        frames = [{"frame_parent": p, "frame_inherit": True} for p in (2, 3, 1)]
        self.refused({"file_frames": frames}, "frame_parent", "circle", "1 -> 2 -> 3 -> 1")

    def refused(self, changes, *parts):
        path = written({**PATCH, **changes})
        with self.assertRaises(BadFile) as caught:
            read_fold(path)
        text = str(caught.exception)
        for part in (f"{path}: ", *parts):
            self.assertIn(part, text)
        self.assertNotIn("\n", text)

    def test_what_is_wrong_is_named_with_its_place(self):
        nan = float("nan")
        for changes, parts in (
            ({"edges_assignment": [*"BBBBX"]}, ("edges_assignment[4]", "'X'", "B, M, V")),
            ({"edges_assignment": [*"BBB"]}, ("edges_assignment", "3 letters for 5 edges")),
            ({"edges_foldAngle": [0, 0, 0, 0]}, ("edges_foldAngle", "4 angles for 5 edges")),
            ({"edges_foldAngle": [0, 0, 0, 0, 200]}, ("edges_foldAngle[4]", "-180 to 180")),
            ({"edges_foldAngle": [0, 0, 0, 0, 90]}, ("edges_foldAngle[4]", "mountains")),
            ({"edges_foldAngle": [0, 0, 0, 0, None]}, ("edges_foldAngle[4]", "no angle")),
            ({"edges_vertices": [[0, 9]]}, ("edges_vertices[0]", "9", "the last is 3")),
            ({"edges_vertices": [[2, 2]]}, ("edges_vertices[0]", "vertex 2 to itself")),
            ({"edges_vertices": [[0, 1, 2]]}, ("edges_vertices[0]", "an edge has 2")),
            ({"faces_vertices": [[0, 1]]}, ("faces_vertices[0]", "3 or more")),
            ({"vertices_coords": [[0, 0], [1]]}, ("vertices_coords[1]", "2 or 3")),
            ({"vertices_coords": [[0, "1"]]}, ("vertices_coords[0]", "'1'")),
            ({"vertices_coords": [[0, 1e300]]}, ("vertices_coords[0]", "1e+300")),
            ({"vertices_coords": [[0, nan]]}, ("NaN",)),
            ({"vertices_coords": 7}, ("vertices_coords", "must be a list")),
            ({"file_spec": 3}, ("file_spec", "specifications 1 to 1.2")),
            ({"file_spec": "2.0"}, ("file_spec", "'2.0'", "specifications 1 to 1.2")),
            ({"file_spec": "new"}, ("file_spec", "'new'", "specifications 1 to 1.2")),
            ({"file_spec": "nan"}, ("file_spec", "'nan'", "specifications 1 to 1.2")),
            ({"edges_foldAngle": [0, 0, 0, 0, -180.001]}, ("edges_foldAngle[4]", "-180.001")),
            ({"file_frames": [{"frame_parent": 5}]}, ("file_frames[0].frame_parent", "5")),
            ({"file_frames": [{"frame_inherit": True}]}, ("frame_parent", "missing")),
            ({"file_frames": [3]}, ("file_frames[0]", "objects")),
            ({"frame_unit": 3}, ("frame_unit", "text")),
        ):
            with self.subTest(changes=changes):
                self.refused(changes, *parts)

    def test_texts_that_are_no_files_of_json(self):
        for text, part in (
            ("", "is empty"),
            ("[1, 2]", "must hold an object"),
            ('{"a": 1', "is no JSON"),
            ('{"a": 1, "a": 2}', "twice"),
            ('{"a": 1e999}', "too large a number"),
            ('{"a": ' + "9" * 5000 + "}", "too many digits"),
            ('{"a": ' + "[" * 100_000 + "]" * 100_000 + "}", "nested too deeply"),
        ):
            with self.assertRaisesRegex(BadFile, part):
                read_fold(written(text))

    def test_frames_that_inherit_more_than_memory_holds_are_refused(self):
        many = [{"frame_parent": 0, "frame_inherit": True}] * 5000
        coords = [[0, i] for i in range(5000)]
        path = written({"vertices_coords": coords, "file_frames": many})
        self.assertLess(path.stat().st_size, 400_000)
        with self.assertRaisesRegex(BadFile, "numbers with what frames inherit"):
            read_fold(path)


class TestWriting(unittest.TestCase):
    def test_what_is_written_is_read_again_to_the_last_digit(self):
        rng = np.random.default_rng(5)
        pattern, folded = miura(4, 3).frames
        shaken = FoldFrame(
            **{**vars(folded), "coords": folded.coords + 1e-3 * rng.normal(size=(20, 3))}
        )
        own = FoldFrame(**{**vars(pattern), "custom": {"membrane:material": {"young": 3.2e9}}})
        content = FoldFile((own, folded, shaken), {"file_title": "three"}, ("singleModel",))
        path = scratch() / "again.fold"
        write_fold(path, content)
        found = read_fold(path)
        self.assertEqual((found.texts, found.classes), (content.texts, content.classes))
        for one, two in zip(content.frames, found.frames, strict=True):
            for name in ("coords", "edges", "letters", "angles"):
                np.testing.assert_array_equal(getattr(one, name), getattr(two, name), name)
            for name in ("unit", "classes", "attributes", "title"):
                self.assertEqual(getattr(one, name), getattr(two, name))
            np.testing.assert_array_equal(np.array(one.faces), np.array(two.faces))
        self.assertEqual(found.frames[0].custom["membrane:material"]["young"], 3.2e9)

    def test_own_data_without_a_namespace_are_refused(self):
        with self.assertRaisesRegex(ValueError, "colon"):
            write_fold(scratch() / "no.fold", FoldFile((FoldFrame(custom={"mass": 1}),)))
        self.assertFalse((scratch() / "no.fold").exists())


class TestAngles(unittest.TestCase):
    """Two triangles on the x axis: ABC on the left of A -> B stays, ABD on its right is turned."""

    A, B, C = np.zeros(3), np.array([1.0, 0, 0]), np.array([0.4, 1.0, 0])

    def bent(self, lift):
        """D lifted by `lift` [rad] towards the top side."""
        return np.array([0.6, -np.cos(lift), np.sin(lift)])

    def test_lifting_a_face_to_the_top_is_a_valley_and_positive(self):
        for degrees in (-179.0, -90.0, -1.0, 1.0, 60.0, 179.0):
            nodes = np.array([self.A, self.B, self.C, self.bent(np.radians(degrees))])
            angle, sign = crease_angles([degrees])
            found = geometry.crease_angles(nodes, [(0, 1, 2), (1, 0, 3)], [(0, 1)], sign)
            self.assertAlmostEqual(float(found[0]), float(angle[0]), places=12)
            self.assertEqual(sign[0], geometry.VALLEY if degrees > 0 else geometry.MOUNTAIN)
            # The tests' own definition, which knows nothing of FOLD.
            self.assertAlmostEqual(fold_angle(*nodes, valley=degrees > 0), float(angle[0]))
            self.assertAlmostEqual(float(fold_angles(found, sign)[0]), degrees)

    def test_flat_is_pi_and_face_to_face_is_zero(self):
        angle, _ = crease_angles([0.0, 180.0, -180.0])
        np.testing.assert_allclose(angle, [np.pi, 0, 0])

    def test_faces_that_passed_through_each_other_stay_in_range(self):
        np.testing.assert_allclose(
            fold_angles([-0.1, -0.1], [1, -1]) / np.degrees(np.pi - 0.1), [1, -1]
        )


if __name__ == "__main__":
    unittest.main()

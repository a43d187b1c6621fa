# SPDX-License-Identifier: GPL-2.0-or-later
"""The Miura-ori: its folded form keeps all lengths, and the file that is kept is this sheet."""

import unittest

import numpy as np
from membrane.mesh.fold_format import FoldFile, read_fold
from membrane.mesh.miura import miura, vertices
from membrane.mesh.patterns import crease_pattern, fold_by_angles, nearest_pose
from support import ROOT

QUICK = True

SHAPE = {"columns": 4, "rows": 5, "along": 0.05, "across": 0.06, "angle": 65.0}


class TestMiura(unittest.TestCase):
    def test_faces_stay_rigid_at_every_fold(self):
        """All six distances between the corners of every face are kept."""
        faces = np.array(miura(**SHAPE).frames[0].faces)
        flat = vertices(**SHAPE, fold=0.0)
        a, b = np.triu_indices(4, 1)
        for fold in (1.0, 30.0, 60.0, 89.0):
            folded = vertices(**SHAPE, fold=fold)
            rest, now = (
                np.linalg.norm(x[faces[:, a]] - x[faces[:, b]], axis=2) for x in (flat, folded)
            )
            np.testing.assert_allclose(now, rest, rtol=1e-12)
        self.assertLess(np.ptp(folded[:, 0]), 0.1 * np.ptp(flat[:, 0]))

    def test_every_inner_vertex_folds_flat(self):
        """Maekawa's theorem, |M - V| = 2, and Kawasaki's, opposite angles sum to pi."""
        pattern = crease_pattern(miura(**SHAPE))
        letters = dict(zip(map(tuple, pattern.edges.tolist()), pattern.letters))
        inner = 0
        for v in range(len(pattern.vertices)):
            ways = {sum(e) - v: letter for e, letter in letters.items() if v in e}
            if "B" in ways.values():
                continue
            inner += 1
            difference = sum({"M": 1, "V": -1}[letter] for letter in ways.values())
            self.assertEqual(abs(difference), 2)
            away = pattern.vertices[list(ways)] - pattern.vertices[v]
            turns = np.sort(np.arctan2(away[:, 1], away[:, 0]))
            gaps = np.diff([*turns, turns[0] + 2 * np.pi])
            self.assertAlmostEqual(gaps[::2].sum(), np.pi, places=12)
        self.assertEqual(inner, 3 * 4)

    def test_its_angles_fold_the_flat_sheet_into_its_folded_form(self):
        flat, form = miura(**SHAPE, fold=70.0).frames
        pattern = crease_pattern(FoldFile((flat, form)))
        angled = crease_pattern(FoldFile((type(flat)(**{**vars(flat), "angles": form.angles}),)))
        found = nearest_pose(fold_by_angles(angled), pattern.folded)
        np.testing.assert_allclose(found, pattern.folded, atol=1e-12)

    def test_the_kept_file_is_the_sheet_at_the_defaults(self):
        kept, made = read_fold(ROOT / "scripts" / "patterns" / "miura.fold"), miura()
        for one, two in zip(kept.frames, made.frames, strict=True):
            np.testing.assert_allclose(one.coords, two.coords, atol=1e-15)
            np.testing.assert_array_equal(one.edges, two.edges)
            np.testing.assert_array_equal(one.letters, two.letters)
        np.testing.assert_allclose(kept.frames[1].angles, made.frames[1].angles, atol=1e-9)

    def test_bad_values_are_named(self):
        for name, value in (
            ("columns", 3),
            ("rows", 1),
            ("along", 0.0),
            ("angle", 90),
            ("fold", 0),
        ):
            with self.assertRaisesRegex(ValueError, f"^{name} = {value}"):
                miura(**{name: value})


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""Any sheet as a spinning sail: where it is put, what it keeps, what it leaves behind."""

import json
import unittest
from dataclasses import replace
from functools import lru_cache

import numpy as np
from membrane import Membrane, geometry, scene
from membrane.mesh.fold_format import FoldFile, FoldFrame, read_fold, write_fold
from membrane.mesh.pattern_mesh import default_size
from membrane.results.output import read_history
from membrane.mesh.placing import outline_corners, place
from membrane.run import driver
from membrane.run.sails.sheet import REMESH, PatternParameters, read_sheet, sail_of
from support import O, ROOT, CommandTest, SceneTest, gmsh_sheet, quiet, run_yade, scratch

SCRIPT = ROOT / "scripts" / "sail.py"
MIURA = ROOT / "scripts" / "patterns" / "miura.fold"
SHORT = {"size": 0.0375, "omega": 60.0, "duration": 0.02, "shapes_interval": 0.01}


@lru_cache(maxsize=None)
def unfolding():
    """Parameters, folder and summary of the beginning of the Miura sheet's unfolding."""
    O.reset()
    p = PatternParameters(file=str(MIURA), **SHORT)
    folder = scratch() / "unfolding"
    with quiet():
        summary = driver.deploy(p, folder)
    O.reset()
    return p, folder, summary


class TestPlace(unittest.TestCase):
    def test_the_centre_of_mass_lies_on_the_axis_flat_and_folded(self):
        p = PatternParameters(file=str(MIURA), size=0.0375)
        sheet = read_sheet(p)
        sail = place(sheet, p)
        areas = geometry.triangle_areas(sail.nodes, sail.triangles)
        mass = np.zeros(len(sail.nodes))
        np.add.at(mass, sail.triangles, p.density * p.thickness * areas[:, None] / 3)
        mass[sail.tips] += p.tip_mass
        for places in (sail.nodes, sail.start):
            np.testing.assert_allclose(mass @ places, 0, atol=1e-15)
        self.assertLess(np.ptp(sail.start[:, 0]), 0.4 * np.ptp(sail.nodes[:, 0]))
        again = place(sheet, PatternParameters(flat=True))
        np.testing.assert_array_equal(again.start, again.nodes)

    def test_corners_of_the_miura_sheet_are_its_four(self):
        p = PatternParameters(file=str(MIURA))
        sail = place(read_sheet(p), p)
        x, y, _ = sail.nodes[sail.tips].T
        self.assertEqual(len(x), 4)
        np.testing.assert_allclose(np.abs(x), np.ptp(sail.nodes[:, 0]) / 2, rtol=1e-9)

    def test_corners_of_a_polygon_and_of_a_disk(self):
        for count, corners in ((3, 3), (12, 12), (60, 0)):
            turn = 2 * np.pi * np.arange(count) / count
            ring = np.column_stack([np.cos(turn), np.sin(turn)])
            points = np.concatenate([ring, (ring + np.roll(ring, -1, axis=0)) / 2, [[0, 0]]])
            found = outline_corners(points, np.arange(2 * count))
            self.assertEqual(sorted(found), list(range(corners)))

    def test_a_mesh_says_where_its_tips_are(self):
        sheet = read_sheet(PatternParameters(file=str(gmsh_sheet())))
        sail = place(sheet, PatternParameters(hub_radius=1e-3))
        self.assertEqual(sail.tips.tolist(), sheet.groups["tips"].tolist())
        np.testing.assert_allclose(sail.nodes[sail.hub], 0, atol=1e-12)
        alone = place(sheet, PatternParameters())
        self.assertEqual(alone.hub.tolist(), sheet.groups["hub"].tolist())
        p = PatternParameters(file=str(MIURA), tip_mass=0.0)
        flying = place(read_sheet(p), p)
        self.assertEqual(len(flying.hub), 0)
        with self.assertRaisesRegex(ValueError, "no node is that near"):
            place(read_sheet(p), replace(p, hub_radius=1e-9))


class TestFlight(SceneTest):
    def test_a_free_sail_keeps_its_angular_momentum_and_its_energy(self):
        p, folder, summary = unfolding()
        history = read_history(folder / "history.csv")
        self.assertGreater(history["projected_area"][-1], 1.5 * history["projected_area"][0])
        momentum = history["angular_momentum"]
        self.assertLess(np.ptp(momentum), 1e-9 * momentum[0])
        self.assertLess(
            summary["measures"]["largest_unexplained_energy"], 1e-5 * history["kinetic_energy"][0]
        )
        self.assertAlmostEqual(history["spin_rate"][0], p.omega, places=6)

    def test_a_driven_hub_turns_steadily(self):
        about = {"hub_radius": 0.05, "omega": 20.0, "duration": 0.01, "shapes_interval": 0.01}
        p = PatternParameters(file=str(gmsh_sheet()), **about)
        folder = scratch() / "hub"
        with quiet():
            summary = driver.deploy(p, folder, False)
        first, last = (np.array(f.coords) for f in read_fold(folder / "sail.fold").frames[1::1][:2])
        hub = summary["mesh"]["hub"]
        self.assertGreater(len(hub), 0)
        angle = p.omega * read_history(folder / "history.csv")["time"][-1]
        turn = np.array(
            [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
        )
        np.testing.assert_allclose(last[hub], first[hub] @ turn.T, atol=1e-9)

    def test_its_fold_file_holds_the_shapes_and_our_own_data(self):
        p, folder, summary = unfolding()
        content = read_fold(folder / "sail.fold")
        flat, start, *_ = content.frames
        self.assertEqual(len(content.frames), 4)
        later = json.loads((folder / "sail.fold").read_text())["file_frames"]
        self.assertEqual([frame["frame_unit"] for frame in later], ["m"] * 3)  # as not all inherit
        self.assertEqual(flat.custom["membrane:material"]["young"], p.young)
        added = np.array(flat.custom["vertices_membrane:pointMass"])
        self.assertEqual(np.flatnonzero(added).tolist(), sorted(summary["mesh"]["tips"]))
        film = np.sum(flat.custom["vertices_membrane:mass"]) - added.sum()
        self.assertAlmostEqual(film, summary["mesh"]["film_mass"], places=12)
        kinds = np.array(flat.custom["edges_membrane:kind"])
        self.assertEqual(set(flat.letters[kinds == "crease"]), {"M", "V"})
        self.assertEqual(set(flat.letters[kinds == "film"]), {"B", "J"})
        self.assertEqual(start.custom["membrane:time"], 0.0)
        bent = np.abs(start.angles[np.isin(start.letters, ("M", "V"))])
        np.testing.assert_allclose(
            np.unique(bent.round(3)),
            np.unique(np.abs(read_fold(MIURA).frames[1].angles).round(3))[1:],
        )

    def test_what_it_leaves_can_be_flown_again(self):
        """Its own FOLD file is a pattern with a folded form, meshed as it is."""
        _, folder, _ = unfolding()
        sheet = read_sheet(
            PatternParameters(file=str(folder / "sail.fold"), start_frame=3, size=1.0)
        )
        kept = read_fold(folder / "sail.fold")
        self.assertEqual(len(sheet.triangles), len(kept.frames[0].faces))
        self.assertEqual(
            len(sheet.creases), int(np.sum(np.isin(kept.frames[0].letters, ("M", "V"))))
        )


class TestCommand(CommandTest):
    def test_a_pattern_with_a_hole_and_a_cut_flies_from_the_command_line(self):
        points = [
            (0, 0),
            (30, 0),
            (30, 30),
            (0, 30),
            (10, 10),
            (20, 10),
            (20, 20),
            (10, 20),
            (5, 25),
            (8, 22),
        ]
        edges = [
            (0, 1),
            (1, 2),
            (2, 3),
            (3, 0),
            (4, 5),
            (5, 6),
            (6, 7),
            (7, 4),
            (0, 4),
            (2, 6),
            (8, 9),
        ]
        coords = np.array([(*point, 0.0) for point in points])
        content = FoldFrame(
            coords=coords, edges=np.array(edges), letters=np.array(list("B" * 8 + "MVC")), unit="cm"
        )
        path, folder = scratch() / "holed.fold", scratch() / "holed"
        write_fold(path, FoldFile((content,)))
        short = ["--duration", "0.005", "--shapes-interval", "0.001", "--size", "0.03"]
        done = run_yade(SCRIPT, path, "--out", folder, *short)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in done.stdout.split("Look at:")[1].split():
            self.assertGreater((scratch() / name).stat().st_size, 100, name)
        summary = json.loads((folder / "summary.json").read_text())
        self.assertAlmostEqual(summary["mesh"]["film_mass"], 0.08 * 1420 * 7.5e-6, places=12)
        self.assertEqual(len(summary["mesh"]["tips"]), 4)
        again = scratch() / "again"
        done = run_yade(
            SCRIPT, path, "--out", again, "--parameters", folder / "summary.json", "--no-pictures"
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(
            (again / "history.csv").read_bytes(), (folder / "history.csv").read_bytes()
        )

    def test_quadrangles_that_one_diagonal_makes_too_flat_are_flown(self):
        """Four quadrangles round a node off the middle, which the first diagonals would spoil."""
        import meshio

        points = [(x, y, 0.0) for y in (0, 0.1, 0.2) for x in (0, 0.1, 0.2)]
        points[4] = (0.13, 0.13, 0.0)
        quads = [(0, 1, 4, 3), (1, 2, 5, 4), (3, 4, 7, 6), (4, 5, 8, 7)]
        spoilt = 0
        for turn in range(4):
            path = scratch() / "quads.msh"
            corners = np.roll(quads, turn, axis=1)
            meshio.Mesh(points, [("quad", corners)]).write(path, file_format="gmsh22")
            O.reset()
            driver.build(PatternParameters(file=str(path)))
            first = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
            try:
                Membrane(material=scene.film(), nodes=points, triangles=first)
            except ValueError as error:
                spoilt += REMESH in str(error)
        self.assertGreater(spoilt, 0)

    def test_a_pattern_is_meshed_finer_where_that_alone_makes_no_triangle_too_flat(self):
        path = scratch() / "small_face.fold"
        points = [(0, 0), (1, 0), (1, 0.5), (1, 1), (0.505, 1), (0, 1), (0, 0.5)]
        points += [(0.5, 0.5), (0.51, 0.5), (0.505, 0.5015)]
        edges = [(i, (i + 1) % 7) for i in range(7)] + [(6, 7), (8, 2), (9, 4)]
        edges += [(7, 8), (8, 9), (9, 7)]
        content = {"vertices_coords": points, "edges_vertices": edges, "frame_unit": "m"}
        path.write_text(json.dumps({**content, "edges_assignment": [*"BBBBBBBVVVMMM"]}))
        p = PatternParameters(file=str(path))
        O.reset()
        sheet = read_sheet(p)
        (note,) = sheet.notes
        self.assertIn("with sides of 0.0537 m a triangle would be too flat", note)
        self.assertIn("0.0269 m long", note)
        self.assertIn(f"{len(sheet.triangles)} triangles", note)
        driver.build(p, sail_of(sheet, p))
        again = read_sheet(replace(p, size=default_size(1.0) / 2))
        self.assertEqual((again.notes, len(again.nodes)), ((), len(sheet.nodes)))

    def test_narrow_corner_is_refused_with_an_option_that_there_is(self):
        path = scratch() / "narrow.fold"
        corners = [[0, 0], [1, 0], [0.999, 0.003], [0, 0.3]]
        edges = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]]
        content = {"frame_unit": "m", "vertices_coords": corners, "edges_vertices": edges}
        path.write_text(json.dumps({**content, "edges_assignment": [*"BBBBM"]}))
        done = run_yade(SCRIPT, path, "--size", 0.5, "--out", scratch() / "narrow")
        self.ends_with_one_sentence(done, "sail", "the stiffness -", "by another --size")
        self.assertNotIn("allowNegativeStiffness", done.stderr)

    def test_bad_days_end_with_one_sentence(self):
        sheet, mesh = MIURA.read_text(), gmsh_sheet().read_text()
        for name, text, *parts in (
            ("no.fold", None, "no.fold"),
            ("cut.fold", sheet[:3000], "cut.fold", "no JSON"),
            ("letter.fold", sheet.replace('"M"', '"Q"', 1), "edges_assignment", "'Q'"),
            ("nan.fold", sheet.replace("0.0,", "NaN,", 1), "nan.fold", "NaN"),
            ("count.msh", mesh.replace("$Nodes\n", "$Nodes\n9"), "count.msh", "$Nodes"),
            ("sail.txt", "", "sail.txt", ".fold", ".msh"),
        ):
            path = scratch() / name
            if text is not None:
                path.write_text(text)
            with self.subTest(file=name):
                done = run_yade(SCRIPT, path, "--out", scratch() / "bad")
                self.ends_with_one_sentence(done, "sail", *parts)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""The ParaView series: fields on sides and triangles, as VTK's own reader reads them."""

import json
import re
import unittest
from binascii import a2b_base64
from unittest.mock import patch
from xml.etree import ElementTree

import meshio
import numpy as np
from membrane.files import BadFile
from membrane.geometry import crease_angles, triangle_areas
from membrane.mesh import sail_mesh
from membrane.parameters import SailParameters
from membrane.results.history import read_history
from membrane.results.output import VtkSeries, list_series, read_frame
from support import plane_stress_stiffness, read_grid, scratch, short_run

SHAPE = 12  # 0.06 s after the release


class TestShapes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shapes = short_run() / "shapes"
        cls.points, cls.film, cls.triangles = read_grid(shapes / f"film_{SHAPE:06d}.vtu")
        _, cls.lines, cls.sides = read_grid(shapes / f"sides_{SHAPE:06d}.vtu")
        cls.mesh, cls.parameters = sail_mesh(), SailParameters()
        cls.rest = cls.lengths(cls.mesh.nodes)
        cls.now = cls.lengths(cls.points)
        cls.row = {tuple(pair): i for i, pair in enumerate(cls.sides.tolist())}

    @classmethod
    def lengths(cls, nodes):
        return np.linalg.norm(nodes[cls.sides[:, 1]] - nodes[cls.sides[:, 0]], axis=1)

    def stiffness(self):
        """Of the film's sides [N/m], by the definition instead of equation (5)."""
        p, total = self.parameters, np.zeros(len(self.sides))
        for triangle in self.mesh.triangles:
            parts = plane_stress_stiffness(
                self.mesh.nodes[triangle], p.young, p.poisson, p.thickness
            )
            for corner, part in enumerate(parts):
                ends = sorted(np.delete(triangle, corner).tolist())
                total[self.row[tuple(ends)]] += part
        return total

    def of_triangles(self, values):
        """Values (T, 3) of the sides of each triangle."""
        ends = [np.sort(np.delete(self.triangles, k, axis=1), axis=1) for k in range(3)]
        return np.array([[values[self.row[tuple(pair)]] for pair in e.tolist()] for e in ends]).T

    # Python's last security updates decode on beyond padding, where meshio counts on an end.
    @patch("base64.b64decode", lambda data: a2b_base64(re.match("[^=]*=*", data)[0]))
    def test_meshio_reads_the_same(self):
        for name, kind, cells, fields in (
            ("film", "triangle", self.triangles, self.film),
            ("sides", "line", self.sides, self.lines),
        ):
            found = meshio.read(short_run() / "shapes" / f"{name}_{SHAPE:06d}.vtu")
            np.testing.assert_array_equal(found.points, self.points)
            np.testing.assert_array_equal(found.cells_dict[kind], cells)
            self.assertEqual(set(found.cell_data), set(fields))
            for field, (values,) in found.cell_data.items():
                np.testing.assert_array_equal(values, fields[field])

    def test_every_field_is_explained_with_its_unit(self):
        told = json.loads((short_run() / "shapes" / "fields.json").read_text())
        for place, fields in (("side", self.lines), ("triangle", self.film)):
            self.assertEqual({name for name, about in told.items() if place in about}, set(fields))
        self.assertEqual(told["tension"]["unit"], "N")

    def test_side_strain_is_the_relative_growth_of_the_length(self):
        strain = self.now / self.rest - 1
        self.assertLess(strain.min(), -0.01)
        self.assertGreater(strain.max(), 1e-5)
        np.testing.assert_allclose(self.lines["side_strain"], strain, rtol=1e-6, atol=1e-9)

    def test_history_tells_the_largest_strain_of_the_film(self):
        times = [time for time, _ in list_series(short_run() / "shapes" / "sides.pvd")]
        history = read_history(short_run() / "history.csv")
        at = int(np.argmin(np.abs(history["time"] - times[SHAPE])))
        film = self.lines["kind"] < 2
        largest = np.max((self.now / self.rest - 1)[film])
        self.assertAlmostEqual(history["film_strain"][at] / largest, 1, places=9)
        summary = json.loads((short_run() / "summary.json").read_text())
        told = summary["measures"]["largest_film_strain"]
        self.assertEqual(told, history["film_strain"].max())

    def test_buckled_sides_are_shorter_than_the_critical_length(self):
        p = self.parameters
        alpha = np.select(
            [self.lines["kind"] == 1, self.lines["kind"] == 2], [p.alpha_crease, 0], 100
        )
        critical = self.rest - alpha * np.pi**2 * p.thickness**2 / (12 * self.rest)
        shorter = self.now < critical
        self.assertTrue(100 < np.sum(shorter) < 1000)
        np.testing.assert_array_equal(self.lines["buckled"], shorter)

    def test_tension_of_taut_film_is_stiffness_times_elongation(self):
        taut = (self.lines["kind"] < 2) & (self.now > self.rest)
        force = (self.stiffness() * (self.now - self.rest))[taut]
        self.assertGreater(np.sum(taut), 100)
        np.testing.assert_allclose(self.lines["tension"][taut], force, rtol=1e-5, atol=1e-8)
        slack = (self.lines["kind"] == 2) & (self.now < self.rest)
        np.testing.assert_array_equal(self.lines["tension"][slack], 0)

    def test_crease_angle_and_fold_stand_on_the_fold_lines_only(self):
        mesh = self.mesh
        rows = [self.row[tuple(sorted(pair))] for pair in mesh.creases.tolist()]
        angle = np.full(len(self.sides), np.pi)
        angle[rows] = crease_angles(self.points, mesh.triangles, mesh.creases, mesh.crease_signs)
        self.assertGreater(np.ptp(angle[rows]), 1)
        np.testing.assert_allclose(self.lines["crease_angle"], angle, atol=1e-6)
        fold = np.zeros(len(self.sides))
        fold[rows] = mesh.crease_signs
        np.testing.assert_array_equal(self.lines["fold"], fold)

    def test_triangles_carry_the_means_of_their_sides(self):
        for name in ("side_strain", "tension", "buckled"):
            mean = self.of_triangles(self.lines[name].astype(float)).mean(axis=1)
            self.assertGreater(np.ptp(mean), 0, name)
            np.testing.assert_allclose(self.film[name], mean, rtol=1e-4, atol=1e-7, err_msg=name)

    def test_triangles_carry_the_angle_of_their_crease_farthest_from_flat(self):
        angles = self.of_triangles(self.lines["crease_angle"].astype(float))
        bent = np.abs(angles - np.pi)
        self.assertGreater(np.sum(angles > np.pi + 1e-3), 0, "no crease is bent backwards")
        np.testing.assert_allclose(
            np.abs(self.film["crease_angle"] - np.pi), bent.max(axis=1), atol=1e-6
        )
        apart = np.abs(angles - self.film["crease_angle"][:, None].astype(float))
        self.assertLess(apart.min(axis=1).max(), 1e-6)

    def test_area_strain_is_the_relative_growth_of_the_area(self):
        growth = triangle_areas(self.points, self.triangles)
        growth = growth / triangle_areas(self.mesh.nodes, self.triangles) - 1
        self.assertLess(growth.min(), -0.01)
        np.testing.assert_allclose(self.film["area_strain"], growth, rtol=1e-5, atol=1e-7)


class TestSeries(unittest.TestCase):
    def setUp(self):
        self.folder = scratch() / self.id().rsplit(".", 1)[1]

    def write(self, frames):
        series = VtkSeries(self.folder, "film", [[0, 1, 2]])
        points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
        for i in range(frames):
            series.write(0.1 * i, (1 + i) * points, {"level": np.array([float(i)])})
            yield list_series(self.folder / "film.pvd")

    def test_collection_is_whole_after_each_frame(self):
        for count, found in enumerate(self.write(4), start=1):
            text = (self.folder / "film.pvd").read_text()
            ElementTree.fromstring(text)
            self.assertEqual(text.count("</VTKFile>"), 1)
            self.assertEqual([time for time, _ in found], [0.1 * i for i in range(count)])

    def test_frames_are_read_back(self):
        *_, found = self.write(3)
        points, fields = read_frame(found[2][1])
        np.testing.assert_array_equal(points, 3 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]]))
        self.assertEqual(
            {name: values.tolist() for name, values in fields.items()}, {"level": [2.0]}
        )

    def test_shorter_series_leaves_no_frames_of_an_earlier_one(self):
        list(self.write(5))
        list(self.write(2))
        self.assertEqual(len(list(self.folder.glob("*.vtu"))), 2)
        self.assertEqual(len(list_series(self.folder / "film.pvd")), 2)

    def test_missing_and_broken_frames_are_refused(self):
        *_, found = self.write(1)
        path = found[0][1]
        path.write_text("no grid")
        with self.assertRaisesRegex(BadFile, "film_000000.vtu: could not be read"):
            read_frame(path)
        path.unlink()
        with self.assertRaises(FileNotFoundError):
            read_frame(path)


if __name__ == "__main__":
    unittest.main()

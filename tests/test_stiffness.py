# SPDX-License-Identifier: GPL-2.0-or-later
"""Stiffness of the sides, paper equation (5), and masses of the nodes, equation (4)."""

import unittest

import numpy as np
from membrane import Membrane, scene
from membrane.mesh import sail_mesh
from support import grid, plane_stress_stiffness, rotation, unit_film

QUICK = True

FLAT = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.1, 0.0]])
EQUILATERAL = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, np.sqrt(0.75), 0.0]])
RIGHT = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
WIDE = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.5 / np.sqrt(3), 0.0]])  # 120 degrees


def stiffness_opposite(corners, **options):
    """The plugin's stiffnesses (3,) [N/m] of a triangle's sides, opposite its corners; E h = 1."""
    film = options.pop("film", None) or unit_film(**options)
    net = Membrane(
        material=film, nodes=corners.tolist(), triangles=[(0, 1, 2)], allowNegativeStiffness=True
    )
    by_side = dict(zip(net.sides, net.stiffnesses))
    return np.array([by_side[1, 2], by_side[0, 2], by_side[0, 1]])


def random_triangle(rng):
    """Corners (3, 3) of a triangle that is not too flat, anywhere in space."""
    while True:
        corners = rng.normal(size=(3, 3))
        sides = np.roll(corners, 1, axis=0) - corners
        if np.linalg.norm(np.cross(sides[0], sides[1])) > 0.2 * np.max(np.sum(sides**2, axis=1)):
            return corners


class TestStiffness(unittest.TestCase):
    def check(self, corners, expected, poisson=0.34):
        np.testing.assert_allclose(
            stiffness_opposite(corners, poisson=poisson), expected, rtol=0, atol=1e-4
        )

    def test_equilateral_triangle(self):
        self.check(EQUILATERAL, [0.4330, 0.4330, 0.4330])

    def test_right_isosceles_triangle(self):
        self.check(RIGHT, [0.2056, 0.4081, 0.4081])

    def test_flat_triangle_has_a_base_of_negative_stiffness(self):
        self.check(FLAT, [0.7928, 0.7928, -0.3209])

    def test_base_opposite_120_degrees_depends_on_poissons_ratio(self):
        self.assertAlmostEqual(stiffness_opposite(WIDE, poisson=0.0)[2], -0.0210, delta=1e-4)
        self.assertAlmostEqual(stiffness_opposite(WIDE, poisson=0.34)[2], 0.0274, delta=1e-4)

    def test_stiffness_does_not_depend_on_the_size(self):
        for corners in (EQUILATERAL, RIGHT, FLAT, random_triangle(np.random.default_rng(3))):
            expected = stiffness_opposite(corners)
            for scale in (1e-6, 1e-3, 1e3, 1e6):
                found = stiffness_opposite(scale * corners)
                np.testing.assert_allclose(found, expected, rtol=1e-9)

    def test_stiffness_does_not_depend_on_place_and_direction(self):
        rng = np.random.default_rng(4)
        corners = random_triangle(rng)
        moved = corners @ rotation(rng).T + rng.normal(size=3)
        np.testing.assert_allclose(
            stiffness_opposite(moved), stiffness_opposite(corners), rtol=1e-12
        )

    def test_stiffness_is_proportional_to_young_times_thickness(self):
        film = scene.film(young=3.2e9, poisson=0.34, thickness=7.5e-6)
        found = stiffness_opposite(RIGHT, film=film)
        np.testing.assert_allclose(found, 2.4e4 * stiffness_opposite(RIGHT), rtol=1e-13)

    def test_springs_hold_the_energy_of_the_film_in_three_uniaxial_states(self):
        rng = np.random.default_rng(5)
        stress, thickness, young = 0.01, 1.0, 1.0
        for poisson in (-0.5, 0.0, 0.34, 0.5):
            for corners in [EQUILATERAL, RIGHT] + [random_triangle(rng) for _ in range(5)]:
                stiffness = stiffness_opposite(corners, poisson=poisson)
                sides = np.roll(corners, -1, axis=0) - np.roll(corners, -2, axis=0)
                length = np.linalg.norm(sides, axis=1)
                normal = np.cross(sides[0], sides[1])
                area = 0.5 * np.linalg.norm(normal)
                flat = np.eye(3) - np.outer(normal, normal) / np.sum(normal**2)
                for pulled in sides / length[:, None]:
                    along = np.outer(pulled, pulled)
                    strain = stress / young * ((1 + poisson) * along - poisson * flat)
                    stretch = np.einsum("ij,jk,ik->i", sides, strain, sides) / length
                    springs = 0.5 * np.sum(stiffness * stretch**2)
                    film = 0.5 * stress**2 / young * thickness * area
                    self.assertAlmostEqual(springs / film, 1, delta=1e-10)

    def test_shared_side_has_the_sum_of_two_triangles(self):
        nodes = np.array([[0.0, 0, 0], [1.0, 0, 0], [0.3, 0.8, 0], [0.6, -0.5, 0]])
        triangles = [(0, 1, 2), (1, 0, 3)]
        net = Membrane(material=unit_film(), nodes=nodes.tolist(), triangles=triangles)
        found = dict(zip(net.sides, net.stiffnesses))
        upper = plane_stress_stiffness(nodes[[0, 1, 2]])
        lower = plane_stress_stiffness(nodes[[1, 0, 3]])
        expected = {
            (1, 2): upper[0],
            (0, 2): upper[1],
            (0, 1): upper[2] + lower[2],
            (0, 3): lower[0],
            (1, 3): lower[1],
        }
        self.assertEqual(set(found), set(expected))
        for side, value in expected.items():
            self.assertAlmostEqual(found[side] / value, 1, places=12)

    def test_sides_of_the_sail_have_the_sum_of_their_triangles(self):
        mesh = sail_mesh()
        material = scene.film()
        net = Membrane(
            material=material,
            nodes=mesh.nodes.tolist(),
            triangles=mesh.triangles.tolist(),
            cables=mesh.cables.tolist(),
        )
        expected = {}
        for triangle in mesh.triangles:
            values = plane_stress_stiffness(mesh.nodes[triangle], 3.2e9, 0.34, 7.5e-6)
            for i in range(3):
                side = tuple(sorted((int(triangle[i - 2]), int(triangle[i - 1]))))
                expected[side] = expected.get(side, 0.0) + values[i]
        for cable in mesh.cables:
            length = np.linalg.norm(mesh.nodes[cable[1]] - mesh.nodes[cable[0]])
            expected[tuple(sorted(cable.tolist()))] = 200.0 / length
        self.assertEqual(set(net.sides), set(expected))
        np.testing.assert_allclose(
            net.stiffnesses, [expected[side] for side in net.sides], rtol=1e-11
        )


class TestMasses(unittest.TestCase):
    def check_sum(self, nodes, triangles, area):
        net = Membrane(material=scene.film(), nodes=nodes.tolist(), triangles=triangles.tolist())
        expected = 1420.0 * 7.5e-6 * area
        self.assertAlmostEqual(net.area / area, 1, delta=1e-12)
        self.assertAlmostEqual(sum(net.masses) / expected, 1, delta=1e-12)

    def test_masses_of_the_sail_sum_to_density_thickness_area(self):
        for refine in (1, 2, 3):
            mesh = sail_mesh(refine=refine)
            self.check_sum(mesh.nodes[: mesh.film_size], mesh.triangles, 0.455**2 - 0.103**2)

    def test_masses_of_an_irregular_sheet_sum_to_density_thickness_area(self):
        rng = np.random.default_rng(6)
        nodes, triangles = grid(5, jitter=0.1, rng=rng)
        edge = [i for i in range(36) if i < 6 or i >= 30 or i % 6 in (0, 5)]
        nodes[edge] = grid(5)[0][edge]
        for turn in (np.eye(3), rotation(rng)):
            self.check_sum(nodes @ turn.T, triangles, (5 * 0.02) ** 2)

    def test_each_corner_has_a_third_of_its_triangles(self):
        nodes, triangles = grid(3, jitter=0.1, rng=np.random.default_rng(7))
        net = Membrane(material=scene.film(), nodes=nodes.tolist(), triangles=triangles.tolist())
        expected = np.zeros(len(nodes))
        for a, b, c in triangles:
            (ux, uy, _), (vx, vy, _) = nodes[b] - nodes[a], nodes[c] - nodes[a]
            expected[[a, b, c]] += 1420.0 * 7.5e-6 * 0.5 * abs(ux * vy - uy * vx) / 3
        np.testing.assert_allclose(net.masses, expected, rtol=1e-12)

    def test_cables_and_point_masses_add_to_their_nodes(self):
        nodes = [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0.1, 0.1, 0], [0.1, 0.3, 0]]
        net = Membrane(
            material=scene.film(),
            nodes=nodes,
            triangles=[(0, 1, 2)],
            cables=[(2, 3), (3, 4)],
            cableDensity=2e-4,
            pointMasses=[0, 0, 0, 0, 0.36e-3],
        )
        third = 1420.0 * 7.5e-6 * 0.005 / 3
        expected = [third, third, third + 1e-5, 1e-5 + 2e-5, 2e-5 + 0.36e-3]
        np.testing.assert_allclose(net.masses, expected, rtol=1e-12)


if __name__ == "__main__":
    unittest.main()

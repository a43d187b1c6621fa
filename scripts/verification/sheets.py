# SPDX-License-Identifier: GPL-2.0-or-later
"""Sheets of triangles: what modulus, Poisson ratio and stiffness the springs of (5) amount to.

The small-strain stiffness matrix of a sheet is assembled from the plugin's sides and stiffnesses. Its
boundary nodes take an affine displacement, the inner ones go to equilibrium, and the energy gives the
sheet's mean stiffness, of which the moduli follow. A petal of the sail, fixed at its inner edge and
pulled at its outer one, is compared with plane-stress finite elements: those of CalculiX, and in the
fast run constant-strain triangles of our own, which are held against CalculiX in the full one.
"""

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import membrane
import numpy as np
from membrane import geometry, scene
from membrane.mesh import sail_mesh
from scipy import sparse
from scipy.sparse.linalg import spsolve

from . import Check, at_most, recorded

YOUNG, POISSON, THICKNESS = 3.2e9, 0.34, 7.5e-6
POISSONS = (-0.5, 0.0, 0.2, 1 / 3, 0.34, 0.5)
CELLS = 12  # of a square sheet; the boundary is affine, so even lattices do not depend on it
LENGTH = 0.02  # of a cell [m]
REFINES, FAST_REFINES = (1, 2, 4), (1,)
LOAD = 1.0  # on the outer edge of the petal [N]
PULL = 1e-5  # displacement of the outer edge [m]

EXACT = 1e-9
DIGITS = 1e-5  # CalculiX prints seven digits
UNCHANGED = 1e-6
WHY = "linear, so it changes only with (5) or the mesh"


# --- sheets ---


def strip_of_cells(diagonals):
    """Flat square sheet of CELLS x CELLS cells, cut in two: nodes (N, 3) [m], triangles (T, 3).

    diagonals: 'one', all alike, or 'alternating', every second one crosswise (union jack).
    """
    rows = CELLS + 1
    i, j = (axis.ravel() for axis in np.mgrid[:rows, :rows])
    nodes = LENGTH * np.column_stack([i, j, np.zeros(rows * rows)])
    i, j = (axis.ravel() for axis in np.mgrid[:CELLS, :CELLS])
    a = i * rows + j
    b, c, d = a + rows, a + rows + 1, a + 1
    cross = (i + j) % 2 == 1 if diagonals == "alternating" else np.zeros(len(a), dtype=bool)
    first = np.column_stack([a, b, np.where(cross, d, c)])
    second = np.column_stack([np.where(cross, b, a), c, d])
    return nodes, np.concatenate([first, second])


def equilateral_sheet():
    """Parallelogram of equilateral triangles: nodes (N, 3) [m], triangles (T, 3)."""
    nodes, triangles = strip_of_cells("one")
    # The diagonal from (0, 0) to (1, 1) becomes as long as the sides at 120 degrees to each other.
    x, y, z = nodes.T
    return np.column_stack([x - 0.5 * y, np.sqrt(0.75) * y, z]), triangles


def petal(refine):
    """Petal 0 of the paper's sail: nodes (N, 3) [m], triangles (T, 3), inner and outer edge's nodes."""
    mesh = sail_mesh(refine=refine)
    kept = np.unique(np.concatenate([row[0] for row in mesh.rows]))
    number = np.full(len(mesh.nodes), -1)
    number[kept] = np.arange(len(kept))
    triangles = number[mesh.triangles]
    triangles = triangles[np.all(triangles >= 0, axis=1)]
    return mesh.nodes[kept], triangles, number[mesh.rows[0][0]], number[mesh.rows[-1][0]]


# --- stiffness matrices, degrees of freedom x0, y0, x1, y1, … ---


def springs(nodes, triangles, poisson=POISSON):
    """The plugin's sides (S, 2), their stiffnesses (S,) [N/m], and the area of the sheet [m2]."""
    net = membrane.Membrane(
        material=scene.film(YOUNG, poisson, 1420.0, THICKNESS),
        nodes=nodes.tolist(),
        triangles=triangles.tolist(),
        allowNegativeStiffness=True,
    )
    return np.array(net.sides), np.array(net.stiffnesses), net.area


def assemble(count, corners, blocks):
    """Sparse matrix (2 count, 2 count) from blocks (E, 2 c, 2 c) on nodes corners (E, c)."""
    freedoms = (2 * corners[:, :, None] + np.arange(2)).reshape(len(corners), -1)
    rows = np.broadcast_to(freedoms[:, :, None], blocks.shape)
    columns = np.broadcast_to(freedoms[:, None, :], blocks.shape)
    shape = (2 * count, 2 * count)
    return sparse.csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=shape)


def spring_matrix(nodes, triangles, poisson=POISSON):
    """Stiffness matrix [N/m] of the springs at rest: k n n^T on both ends of each side."""
    sides, stiffness, _ = springs(nodes, triangles, poisson)
    along = (nodes[sides[:, 1]] - nodes[sides[:, 0]])[:, :2]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    stretch = np.concatenate([-along, along], axis=1)
    blocks = stiffness[:, None, None] * stretch[:, :, None] * stretch[:, None, :]
    return assemble(len(nodes), sides, blocks)


def film_matrix(nodes, triangles):
    """Stiffness matrix [N/m] of constant-strain triangles in plane stress."""
    corners = nodes[triangles][:, :, :2]
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    area = 0.5 * (opposite[:, 0, 0] * opposite[:, 1, 1] - opposite[:, 0, 1] * opposite[:, 1, 0])
    slope = np.stack([-opposite[..., 1], opposite[..., 0]], axis=2) / (2 * area)[:, None, None]
    strain = np.zeros((len(triangles), 3, 6))
    strain[:, 0, 0::2], strain[:, 1, 1::2] = slope[..., 0], slope[..., 1]
    strain[:, 2, 0::2], strain[:, 2, 1::2] = slope[..., 1], slope[..., 0]
    weighted = area[:, None, None] * (plane_stress() @ strain)
    return assemble(len(nodes), triangles, np.swapaxes(strain, 1, 2) @ weighted)


def plane_stress():
    """Stiffness (3, 3) [N/m] of the film for strains xx, yy and 2 xy."""
    shear = 0.5 * (1 - POISSON)
    matrix = np.array([[1, POISSON, 0], [POISSON, 1, 0], [0, 0, shear]])
    return YOUNG * THICKNESS / (1 - POISSON**2) * matrix


def equilibrium(matrix, known, values, load=0.0):
    """Displacements (2 N,) [m] where those of freedoms `known` have `values`, and load [N] elsewhere."""
    free = np.setdiff1d(np.arange(matrix.shape[0]), known)
    moved = np.zeros(matrix.shape[0])
    moved[known] = values
    force = np.broadcast_to(load, moved.shape) - matrix @ moved
    moved[free] = spsolve(matrix[free][:, free].tocsc(), force[free])
    return moved


# --- moduli of a sheet ---


def mean_stiffness(nodes, triangles, poisson=POISSON):
    """Stiffness (3, 3) [N/m] of a sheet of springs for mean strains xx, yy and 2 xy."""
    matrix = spring_matrix(nodes, triangles, poisson)
    area = geometry.triangle_areas(nodes, triangles).sum()
    sides, _, shares = geometry.unique_sides(triangles)
    boundary = np.unique(sides[shares == 1])
    known = np.concatenate([2 * boundary, 2 * boundary + 1])
    x, y, _ = nodes.T
    fields = []
    for u, v in ((x, 0 * x), (0 * x, y), (0.5 * y, 0.5 * x)):
        affine = np.column_stack([u, v]).ravel()
        fields.append(equilibrium(matrix, known, affine[known]))
    fields = np.array(fields)
    return fields @ (matrix @ fields.T) / area


def moduli(stiffness):
    """Moduli of a sheet over those of the film, and its Poisson ratios, from (3, 3) [N/m]."""
    s = YOUNG * THICKNESS * np.linalg.inv(stiffness)
    return {
        "uniaxial along x, modulus / E": 1 / s[0, 0],
        "uniaxial along x, Poisson ratio": -s[1, 0] / s[0, 0],
        "uniaxial along y, modulus / E": 1 / s[1, 1],
        "uniaxial along y, Poisson ratio": -s[0, 1] / s[1, 1],
        "equibiaxial, modulus / (E / (1 - nu))": 2 * (1 - POISSON) / s[:2, :2].sum(),
        "shear, modulus / G": 2 * (1 + POISSON) / s[2, 2],
        "shear at 45 degrees, modulus / G": 2 * (1 + POISSON) / (s[0, 0] + s[1, 1] - 2 * s[0, 1]),
    }


# --- single triangles ---


def energy_error(corners, poisson):
    """Largest error [-] of the energy of three springs in uniaxial stress along each side in turn."""
    sides, stiffness, area = springs(corners, np.array([[0, 1, 2]]), poisson)
    span = corners[sides[:, 1]] - corners[sides[:, 0]]
    length = np.linalg.norm(span, axis=1)
    along = span / length[:, None]
    errors = []
    for pulled in along:
        stress = YOUNG * 1e-3 * np.outer(pulled, pulled)
        strain = ((1 + poisson) * stress - poisson * np.trace(stress) * np.eye(3)) / YOUNG
        stretch = np.einsum("si,ij,sj->s", along, strain, along) * length
        film = 0.5 * np.trace(stress) ** 2 / YOUNG * THICKNESS * area
        errors.append(abs(0.5 * np.sum(stiffness * stretch**2) / film - 1))
    return max(errors)


def worst_energy_error():
    """Worst energy_error over random triangles, angles down to some degrees, and how many."""
    rng = np.random.default_rng(11)
    errors = []
    for poisson in POISSONS:
        while len(errors) % 50 or not errors or len(errors) <= 50 * POISSONS.index(poisson):
            corners = np.column_stack([rng.normal(size=(3, 2)), np.zeros(3)])
            if geometry.triangle_angles(corners, np.array([[0, 1, 2]])).min() > 0.1:
                errors.append(energy_error(corners, poisson))
    return max(errors), len(errors)

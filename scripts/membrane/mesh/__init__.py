# SPDX-License-Identifier: GPL-2.0-or-later
"""Meshes: the square sail, plain sheets, folds, crease patterns, FOLD, gmsh. Knows no YADE."""

from .square_sail import LINE_KINDS, SailMesh, mesh_of, sail_mesh  # noqa: F401
from .square_sail import sheet_mesh, tip_masses  # noqa: F401

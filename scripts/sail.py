# SPDX-License-Identifier: GPL-2.0-or-later
"""Any sheet as a spinning sail: a crease pattern in a FOLD file, or a mesh of gmsh."""

from membrane.cli import run

run("sail", module="deploy", sail="sheet")

# SPDX-License-Identifier: GPL-2.0-or-later
"""Charts accuracy against time: path, time step, mesh and parts left out, on one grid."""

from membrane.cli import run

run("chart")

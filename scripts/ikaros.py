# SPDX-License-Identifier: GPL-2.0-or-later
"""IKAROS, the flight sail: the second stage of its deployment, on a hub that turns freely."""

from membrane.cli import run

run("ikaros", module="deploy", sail="ikaros")

# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs a grid over any parameters of any sail, and makes one report."""

from membrane.cli import run

run("sweep", "stopped; the same command goes on from here")

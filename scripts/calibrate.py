# SPDX-License-Identifier: GPL-2.0-or-later
"""Finds the alpha_crease and beta whose deployment follows a measured curve, and how surely."""

from membrane.cli import run

run("calibrate", "stopped by Ctrl-C; run it again to continue")

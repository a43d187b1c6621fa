# SPDX-License-Identifier: GPL-2.0-or-later
"""Sweeps over alpha_c and beta, by default the paper's Table 2, and makes one report."""

from membrane.cli import run

run("sweep", "stopped; the same command goes on from here")

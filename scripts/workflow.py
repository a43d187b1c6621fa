# SPDX-License-Identifier: GPL-2.0-or-later
"""Starts the Snakemake workflow, unless a file of configuration is missing or cannot be used."""

from membrane.cli import run

run("workflow")

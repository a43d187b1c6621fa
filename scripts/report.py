# SPDX-License-Identifier: GPL-2.0-or-later
"""Writes report.html from the other results of runs: `scripts/run.sh report FOLDER ...`."""

from membrane.cli import run

run("report")

# SPDX-License-Identifier: GPL-2.0-or-later
"""Renders sail.mp4 and sail.gif from the shapes of runs: `scripts/run.sh animate FOLDER ...`."""

from membrane.cli import run

run("animate")

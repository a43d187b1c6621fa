# SPDX-License-Identifier: GPL-2.0-or-later
"""Measures the speed of the plugin and writes reference/bench.json."""

from membrane.cli import run

run("bench")

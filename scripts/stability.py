# SPDX-License-Identifier: GPL-2.0-or-later
"""Measures where the method becomes unstable, and writes tables and pictures into
reference/stability/."""

from membrane.cli import run

run("stability")

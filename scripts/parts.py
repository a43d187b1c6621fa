# SPDX-License-Identifier: GPL-2.0-or-later
"""Leaves out each part of the model in turn: what it changes in the answer, and what it costs."""

from membrane.cli import run

run("parts")

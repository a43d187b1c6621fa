# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs the verification suite and writes reference/verification.json."""

from membrane.cli import run

run("verify")

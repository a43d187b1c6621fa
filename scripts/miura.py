# SPDX-License-Identifier: GPL-2.0-or-later
"""A Miura-ori sheet, read from a FOLD file, spins and is unfolded by masses at its corners."""

from membrane.cli import run

run("miura", module="deploy", sail="miura")

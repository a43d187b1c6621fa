# SPDX-License-Identifier: GPL-2.0-or-later
"""How accurate is it? A spinning disk of film vibrates as Lamb and Southwell computed in 1921."""

from membrane.cli import run

run("disk")

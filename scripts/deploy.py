# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper's scene: the small-scale sail is folded, spun up, released and deploys."""

from membrane.cli import run

run("deploy")

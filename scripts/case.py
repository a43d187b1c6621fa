# SPDX-License-Identifier: GPL-2.0-or-later
"""One case of the paper's scene, whole or not at all, as part of a sweep or alone."""

from membrane.cli import run

run("case", "stopped by Ctrl-C; run it again to continue")

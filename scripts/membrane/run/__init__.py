# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs of sails, from a mesh to results: the paper's, those from files, cases, checkpoints."""

from .. import Membrane  # noqa: F401 (without YADE it says so)

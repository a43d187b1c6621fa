# SPDX-License-Identifier: GPL-2.0-or-later
"""Sweeps over the paper's parameters: grid, batch, report. Only the cases themselves need YADE."""

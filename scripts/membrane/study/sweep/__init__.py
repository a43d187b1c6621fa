# SPDX-License-Identifier: GPL-2.0-or-later
"""Sweeps over parameters of any sail: grid, jobs, report. Only the cases themselves need YADE."""

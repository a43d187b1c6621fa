# SPDX-License-Identifier: GPL-2.0-or-later
"""Studies made of runs: sweeps, calibration, verification, benchmarks, maps of stability."""

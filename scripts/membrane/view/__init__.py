# SPDX-License-Identifier: GPL-2.0-or-later
"""Looking at runs: plots, page and its viewer, film, YADE's window."""

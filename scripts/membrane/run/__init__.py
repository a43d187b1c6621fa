# SPDX-License-Identifier: GPL-2.0-or-later
"""One driver runs any sail of the kinds in `sails`, from a mesh to results; only it needs YADE."""

# SPDX-License-Identifier: GPL-2.0-or-later
"""Calibration: alpha_crease and beta from a measured curve of the early deployment.

The logarithms of both are searched, for the curves depend on factors rather than on differences.
Near-by parameters give curves that jump about by a little: the folded sail comes to rest in
slightly different states, and from about 0.1 s after the release tiny differences grow. Everything
here is made for that scatter: steps are large beside it, and it counts in the uncertainty.

None of these modules needs YADE in its own process.
"""

NAMES = ("alpha_crease", "beta")
COLUMNS = {"phase_difference": "rad", "deployment_rate": "-"}  # of a target, with their units
CHAOS = 0.12  # [s] after the release; later, single curves say little

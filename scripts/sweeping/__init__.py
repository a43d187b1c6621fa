# SPDX-License-Identifier: GPL-2.0-or-later
"""Sweeps over the paper's parameters: grid, batch, report. Only the cases themselves need YADE.

Those modules of `membrane` that need no YADE (parameters, measures, files, history, own,
unfinished, plots, commands, case_folder, progress) are used as they are; the package's own code,
which loads the plugin, is left out.
"""

import importlib.util
import sys

if "membrane" not in sys.modules and "yade.wrapper" not in sys.modules:
    _found = importlib.util.find_spec("membrane")
    if _found is None:
        raise ImportError("sweeping: the package membrane is not on Python's path")
    sys.modules["membrane"] = importlib.util.module_from_spec(_found)

# SPDX-License-Identifier: GPL-2.0-or-later
"""The sources, in which the built package lies, too: studies of the plugin itself need them.

What they find goes into reference/, and there is the paper's model a second time.
"""

import sys
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType

_above = [p for start in (__file__, sys.argv[0]) for p in Path(start).resolve().parents]
ROOT = next((folder for folder in _above if (folder / "reference" / "forces.py").is_file()), None)
if ROOT is None:
    raise ImportError("membrane.study: this needs the sources of the plugin, which are not here")
REFERENCE, BUILD, SCRIPTS = (ROOT / name for name in ("reference", "build", "scripts"))

paper = ModuleType("reference.forces")
SourceFileLoader(paper.__name__, str(REFERENCE / "forces.py")).exec_module(paper)

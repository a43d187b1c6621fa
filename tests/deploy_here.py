# SPDX-License-Identifier: GPL-2.0-or-later
"""Driver of test_source_tree: `deploy_here.py FOLDER` deploys a small sail on both paths.

FOLDER/facts.json says where the classes came from.
"""

import json
import sys
from pathlib import Path
from unittest.mock import patch

from yade import config, system, wrapper

folder = Path(sys.argv[1])
own = hasattr(wrapper, "Membrane")  # YADE's own, before anything of ours is imported
with patch.object(config, "version", "of tomorrow" if own else config.version):
    import membrane
    from membrane import _load
    from membrane.parameters import SailParameters
    from membrane.run import driver

facts = {
    "package": membrane.__file__,
    "native": own and "membrane._membrane" not in sys.modules,
    "listed": "MembranePhys" in system.childClasses("IPhys", recurse=True),
    "members": {name: dir(getattr(membrane, name)) for name in membrane.__all__},
}
if own:
    kept = wrapper.MembraneWatch
    del wrapper.MembraneWatch
    try:
        _load.load()
    except ImportError as error:
        facts["refused"] = str(error)
    wrapper.MembraneWatch = kept
for path in ("law2", "fused"):
    wrapper.Omega().reset()
    parameters = SailParameters(
        path=path, fold_lines=3, inner_width=0.15, duration=0.02, spin_up_tolerance=1e-2
    )
    driver.deploy(parameters, folder / path, pictures=False, page=False)
(folder / "facts.json").write_text(json.dumps(facts), encoding="utf-8")

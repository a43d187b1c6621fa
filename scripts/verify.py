# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs the verification suite and writes reference/verification.json.

Run it by `scripts/run.sh verify [options]`, or by `yade -n -x scripts/verify.py [options]`. Exits with 1
if a check does not hold.
"""

import argparse
import importlib
import json
import sys
import time
from pathlib import Path

SCRIPTS = Path(sys.argv[0]).resolve().parent  # YADE keeps __file__ for itself
sys.path.append(str(SCRIPTS))

MODULES = ["forces", "sheets", "spinning"]
RESULTS = SCRIPTS.parent / "reference" / "verification.json"


def command_line():
    """Parsed sys.argv."""
    parser = argparse.ArgumentParser(prog="verify", description="Run the verification suite.")
    parser.add_argument(
        "--only",
        nargs="+",
        choices=MODULES,
        metavar="MODULE",
        default=MODULES,
        help=f"run only these of {', '.join(MODULES)}; the others keep their results in the file",
    )
    parser.add_argument(
        "--fast", action="store_true", help="only what takes seconds; then no file is written"
    )
    return parser.parse_args()


def kept(path, modules):
    """Entries of earlier results in the file `path` that belong to `modules`."""
    if not path.exists():
        return []
    return [entry for entry in json.loads(path.read_text())["checks"] if entry["module"] in modules]


def run(modules, full):
    """Run `modules`, print their tables; returns (module, Check) pairs."""
    from verification import table

    found = []
    for number, name in enumerate(modules, start=1):
        print(f"verify: {number} of {len(modules)}, {name} …", file=sys.stderr, flush=True)
        start = time.monotonic()
        checks = importlib.import_module(f"verification.{name}").checks(full)
        if len({check.name for check in checks}) < max(1, len(checks)):
            raise RuntimeError(f"{name}: no checks, or two of one name")
        print("\n".join(table(name, checks)), flush=True)
        print(f"verify: {name} took {time.monotonic() - start:.1f} s", file=sys.stderr, flush=True)
        found += [(name, check) for check in checks]
    return found


def main():
    """Run the suite; returns the exit status."""
    arguments = command_line()
    modules = [name for name in MODULES if name in arguments.only]
    found = run(modules, not arguments.fast)
    failed = [f"{name}: {check.name}" for name, check in found if not check.holds]
    if not arguments.fast:
        from membrane.sail import versions, write_json

        entries = kept(RESULTS, [name for name in MODULES if name not in modules])
        entries += [{**check.as_dict(), "module": name} for name, check in found]
        entries.sort(key=lambda entry: MODULES.index(entry["module"]))
        header = {"version": versions()["membrane"], "made_by": "scripts/run.sh verify"}
        write_json(RESULTS, {**header, "versions": versions(), "checks": entries})
        print(f"Wrote {RESULTS}")
    for text in failed:
        print(f"verify: does not hold: {text}", file=sys.stderr)
    print(f"{len(found) - len(failed)} of {len(found)} checks hold.")
    return 1 if failed else 0


sys.exit(main())

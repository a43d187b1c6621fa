# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs the verification suite and writes reference/verification.json.

Run it by `scripts/run.sh verify [options]`, or by `yade -n -x scripts/verify.py [options]`. Exits
with 1 if a check does not hold.
"""

import argparse
import importlib
import json
import sys
import time
from pathlib import Path

from membrane.commands import plain_errors

SCRIPTS = Path(sys.argv[0]).resolve().parent  # YADE keeps __file__ for itself
sys.path.append(str(SCRIPTS))

MODULES = ["forces", "sheets", "spinning", "deployment", "paper"]
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
        "--quick",
        "--fast",
        action="store_true",
        help="only what takes seconds; then no file is written",
    )
    return parser.parse_args()


def run(name, full):
    """Run one module and print its table; returns its list of Check."""
    from verification import table

    start = time.monotonic()
    found = importlib.import_module(f"verification.{name}").checks(full)
    if not found or len({check.name for check in found}) < len(found):
        raise RuntimeError("it has no checks, or two of one name")
    print("\n".join(table(name, found)), flush=True)
    print(f"verify: {name} took {time.monotonic() - start:.1f} s", file=sys.stderr, flush=True)
    return found


def save(name, found):
    """Put the results of one module into RESULTS, beside those of the others."""
    from membrane.files import write_json
    from membrane.sail import versions

    entries, made_with = [], {}
    if RESULTS.exists():
        before = json.loads(RESULTS.read_text(encoding="utf-8"))
        others = [module for module in MODULES if module != name]
        entries = [entry for entry in before["checks"] if entry["module"] in others]
        made_with = {m: used for m, used in before["made_with"].items() if m in others}
    made_with[name] = versions()
    entries += [{**check.as_dict(), "module": name} for check in found]
    content = {
        "version": versions()["membrane"],
        "made_by": "scripts/run.sh verify",
        "made_with": {m: made_with[m] for m in MODULES if m in made_with},
        "checks": sorted(entries, key=lambda entry: MODULES.index(entry["module"])),
    }
    write_json(RESULTS, content)


def main():
    """Run the suite; returns the exit status."""
    arguments = command_line()
    modules = [name for name in MODULES if name in arguments.only]
    count, failed = 0, []
    for number, name in enumerate(modules, start=1):
        print(f"verify: {number} of {len(modules)}, {name} …", file=sys.stderr, flush=True)
        try:
            found = run(name, not arguments.quick)
        except RuntimeError as error:
            print(f"verify: {name}: {error}", file=sys.stderr)
            return 1
        if not arguments.quick:
            save(name, found)
        count += len(found)
        failed += [f"{name}: {check.name}" for check in found if not check.holds]
    for text in failed:
        print(f"verify: does not hold: {text}", file=sys.stderr)
    print(f"{count - len(failed)} of {count} checks hold.")
    if not arguments.quick:
        print(f"Results are in {RESULTS}")
    return 1 if failed else 0


with plain_errors("verify"):
    sys.exit(main())

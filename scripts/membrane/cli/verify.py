# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs the verification suite and writes reference/verification.json.

Exits with 1 if a check does not hold.
"""

import argparse
import importlib
import json
import sys
import time

from ..files import write_json
from ..run.driver import versions
from ..study.sources import REFERENCE
from ..study.verification import table
from .options import add_only

MODULES = ["forces", "sheets", "film", "spinning", "deployment", "mesh_dependence", "paper"]
RESULTS = REFERENCE / "verification.json"


def command_line() -> argparse.Namespace:
    """Parsed sys.argv."""
    parser = argparse.ArgumentParser(prog="verify", description="Run the verification suite.")
    text = f"run only these of {', '.join(MODULES)}; the others keep their results in the file"
    add_only(parser, MODULES, text)
    parser.add_argument(
        "--quick",
        "--fast",
        action="store_true",
        help="only what takes seconds; then no file is written",
    )
    return parser.parse_args()


def run(name: str, full: bool) -> list:
    """Run one module and print its table; returns its list of Check."""
    start = time.monotonic()
    found = importlib.import_module(f"membrane.study.verification.{name}").checks(full)
    if not found or len({check.name for check in found}) < len(found):
        raise RuntimeError("it has no checks, or two of one name")
    print("\n".join(table(name, found)), flush=True)
    print(f"verify: {name} took {time.monotonic() - start:.1f} s", file=sys.stderr, flush=True)
    return found


def save(name: str, found: list) -> None:
    """Put the results of one module into RESULTS, beside those of the others."""
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


def main() -> int:
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

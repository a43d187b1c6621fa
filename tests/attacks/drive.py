# SPDX-License-Identifier: GPL-2.0-or-later
"""Attacks the plugin that scripts/run.sh has built with sanitizers, in YADE processes that may die.

`scripts/run.sh attack [--short] [NAME ...]`
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SUITE = Path(__file__).with_name("suite.py")
TIMES = {"long": (30, 500), "short": (3, 60)}  # attacks on each target, and damaged scenes
PROBE = "probe"  # an attack that has to do harm
# Of a report: what happened, and where in the plugin.
TELLING = re.compile(
    r"^.*(?:runtime error: |ERROR: AddressSanitizer|Assertion '|terminate called|Error: ).*$"
    r"|^ *#\d+ .* in .*/(?:pkg/membrane|tests)/.*$",
    re.MULTILINE,
)


def environment():
    """Variables with which YADE, not built with sanitizers, can load a module that is."""
    libraries = [
        subprocess.check_output(["g++", f"-print-file-name={name}.so"], text=True).strip()
        for name in ("libasan", "libubsan", "libstdc++")
    ]
    not_yades = ":".join(f"handle_{name}=2" for name in ("segv", "abort", "sigfpe", "sigill"))
    return {
        **os.environ,
        "LD_PRELOAD": " ".join(libraries),
        # Boost compares names in a file with shorter ones, up to where they differ.
        "ASAN_OPTIONS": f"detect_leaks=0:strict_memcmp=0:{not_yades}",
        "UBSAN_OPTIONS": "print_stacktrace=1",
    }


def start(note, *arguments):
    """Run the suite once: what it has printed, and what its note tells at the end."""
    done = subprocess.run(
        ["yade", "-n", "-x", str(SUITE), str(note), *map(str, arguments)],
        env=environment(),
        cwd=note.parent,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
    )
    if not note.exists():
        sys.exit(f"attack: the suite did not begin:\n{done.stdout}")
    return done.stdout, note.read_text(encoding="utf-8")


def carry_out(note, *arguments):
    """Run the suite, after each attack that ends it once more from there; the harm done."""
    harm, begin = [], 0
    while True:
        said, story = start(note, *arguments, "--from", begin)
        harm += re.findall(r"^HARM (.*)$", said, re.MULTILINE)
        number, _, story = story.partition(" ")
        if number == "done":
            return harm, int(story)
        report = [line.group(0).strip() for line in TELLING.finditer(said)][:6]
        harm.append("\n    ".join([story, *(report or said.splitlines()[-6:])]))
        begin = int(number) + 1


def main():
    """Attack; returns the exit status."""
    parser = argparse.ArgumentParser(prog="attack", description="Attack the plugin in YADE.")
    parser.add_argument("--short", action="store_true", help="a tenth of the attacks")
    parser.add_argument("names", nargs="*", metavar="NAME", help="as printed of one that did harm")
    given = parser.parse_args()
    each, damaged = TIMES["short" if given.short else "long"]
    chosen = ["--each", each, "--damaged", damaged]
    for name in given.names:
        chosen += ["--name", name]
    workers = os.cpu_count()
    with tempfile.TemporaryDirectory(prefix="membrane-attacks-") as folder:
        notes = [Path(folder) / str(number) for number in range(workers)]
        if not carry_out(notes[0], "--name", PROBE)[0]:
            parser.exit(2, "attack: memory that was freed can be read: no sanitizer is at work\n")
        with ThreadPoolExecutor(workers) as pool:
            jobs = [
                pool.submit(carry_out, note, *chosen, "--part", number, workers)
                for number, note in enumerate(notes)
            ]
        ends = [job.result() for job in jobs]
    harm = [one for found, _ in ends for one in found]
    for one in harm:
        print(f"attack: {one}")
    print(f"attack: {sum(count for _, count in ends)} attacks, {len(harm)} did harm")
    return 1 if harm else 0


if __name__ == "__main__":
    sys.exit(main())

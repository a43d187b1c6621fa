# SPDX-License-Identifier: GPL-2.0-or-later
"""Attacks on the plugin within this process, by drive.py: `yade -n -x suite.py NOTE [options]`.

NOTE is a file that tells what is under way, for those who find this process dead.
"""

import argparse
import ctypes
import functools
import sys
from pathlib import Path

folder = Path(sys.argv[0]).resolve().parent
sys.path[:0] = [str(folder), str(folder.parent)]

import attacks  # noqa: E402
import damage  # noqa: E402


def probe(name, tell):
    """Read memory that was freed, as a plugin with a fault would."""
    tell(name)
    libc = ctypes.CDLL(None)
    libc.malloc.restype = ctypes.c_void_p
    place = ctypes.c_void_p(libc.malloc(64))
    libc.free(place)
    libc.memcmp(place, place, 64)


def carry_out(names, note, begin):
    """Carry out attacks; `note` is called with the number of each and what it is about to do."""
    for number, name in enumerate(names[begin:], begin):
        story = []

        def tell(what):
            story.append(what)
            note(f"{number} {', '.join(story)}")

        kind = name.partition(".")[0]
        try:
            {"probe": probe, "damaged": damage.carry_out}.get(kind, attacks.carry_out)(name, tell)
        except attacks.Harm as harm:
            print(f"HARM {', '.join(story)}: {harm}".replace("\n", " "), flush=True)
    note(f"done {len(names)}")


def main():
    """Carry out the attacks that were asked for."""
    parser = argparse.ArgumentParser(prog="suite")
    parser.add_argument("note", type=Path)
    parser.add_argument("--each", type=int)
    parser.add_argument("--damaged", type=int)
    parser.add_argument("--name", action="append")
    parser.add_argument("--part", type=int, nargs=2, default=(0, 1))
    parser.add_argument("--from", type=int, default=0, dest="begin")
    given = parser.parse_args()
    names = given.name or [*attacks.names(given.each), *damage.names(given.damaged)]
    part, parts = given.part
    note = functools.partial(given.note.write_text, encoding="utf-8", errors="replace")
    carry_out(names[part::parts], note, given.begin)


main()

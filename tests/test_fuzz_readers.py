# SPDX-License-Identifier: GPL-2.0-or-later
"""Damaged and malicious files: every reader gives a whole, valid object or raises `BadFile`.

10,000 files with --full, a part of them otherwise; the same ones in every run. Memory is bounded
meanwhile, so that a count that is believed before it is borne out makes the test fail.
"""

import copy
import importlib
import json
import os
import random
import re
import resource
import sys
import unittest
from functools import lru_cache

import numpy as np
from membrane import msh
from membrane.files import BadFile
from membrane.fold_format import LETTERS, FoldFile, FoldFrame, read_fold, write_fold
from membrane.geometry import crease_corners
from membrane.miura import miura
from membrane.output import HistoryWriter, read_history
from membrane.parameters import SailParameters, check, read_parameters
from membrane.patterns import crease_pattern
from support import FULL, ROOT, gmsh_sheet, scratch

sys.path.append(str(ROOT / "scripts"))
target = importlib.import_module("calibration.target")

FILES = 10_000 if os.environ.get(FULL) else 1_500
MEMORY = 2**30  # bytes that a reader of files of a few kilobytes may ask for

NASTY = [
    *(b"NaN", b"Infinity", b"-Infinity", b"nan", b"inf", b"1e999", b"-1e308", b"1_0", b"0x10"),
    *(b"-1", b"0", b"1", b"2", b"3.5", b"4294967296", b"2147483647", b"18446744073709551615"),
    *(b"99999999999999999999999", b"9" * 5000, b"1000000000", b"null", b"true", b'""', b"[]"),
    *(b"{}", b'"M"', b"", b",", b"\x00", b"\xff\xfe", b"\\ud800", b"\n", b'"', b"[" * 3000),
]
VALUES = [
    *(
        None,
        True,
        False,
        -1,
        0,
        1,
        2,
        7,
        10**9,
        2**63,
        10**400,
        -0.5,
        1e308,
        "",
        "M",
        "X",
        "MV",
    ),
    *([], {}, [[]], [None], [1, 2], [0, 0], [[0, 1], [1]], {"a": 1}, "\ud800", [1.5, 2.5, 3.5]),
]
NESTED = "deep"  # stands for a list nested deeper than Python's stack


def damaged(content, rng):
    """Bytes with a few things wrong."""
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
        content = rng.choice(BLOWS)(content, rng)
    return content


def _flip(content, rng):
    if not content:
        return content
    at = rng.randrange(len(content))
    return content[:at] + bytes([content[at] ^ (1 << rng.randrange(8))]) + content[at + 1 :]


def _cut(content, rng):
    return content[: rng.randrange(len(content) + 1)]


def _drop(content, rng):
    at = rng.randrange(len(content) + 1)
    return content[:at] + content[at + rng.choice((1, 2, 8, 40, 200)) :]


def _repeat(content, rng):
    at = rng.randrange(len(content) + 1)
    end = at + rng.choice((1, 8, 40, 200))
    return content[:end] + content[at:]


def _swap(content, rng):
    a, b, c = sorted(rng.randrange(len(content) + 1) for _ in range(3))
    return content[:a] + content[b:c] + content[a:b] + content[c:]


def _number(content, rng):
    found = list(re.finditer(rb"-?\d+(\.\d+)?(e[+-]?\d+)?", content))
    if not found:
        return content
    hit = rng.choice(found)
    return content[: hit.start()] + rng.choice(NASTY) + content[hit.end() :]


def _word(content, rng):
    found = list(re.finditer(rb"[^\s,\[\]{}:]+", content))
    if not found:
        return content
    hit = rng.choice(found)
    return content[: hit.start()] + rng.choice(NASTY) + content[hit.end() :]


def _line(content, rng):
    lines = content.splitlines(keepends=True)
    if not lines:
        return content
    at = rng.randrange(len(lines))
    lines[at : at + 1] = rng.choice(([], [lines[at]] * 2, [rng.choice(lines)], [b"\n"]))
    return b"".join(lines)


BLOWS = (_flip, _cut, _drop, _repeat, _swap, _number, _number, _word, _line)


def damaged_json(content, rng):
    """A JSON text that still is one, with a few values, keys or lengths that make no sense."""
    top = json.loads(content)
    for _ in range(rng.choice((1, 1, 2, 4))):
        holder, key = rng.choice(_places(top))
        kind = rng.randrange(7)
        if kind == 0:
            del holder[key]
        elif kind == 1 and isinstance(holder, list):
            holder.insert(key, copy.deepcopy(holder[key]))
        elif kind == 2 and isinstance(holder[key], list):
            holder[key] = holder[key] * rng.choice((0, 2, 50))
        elif kind == 3:
            other, name = rng.choice(_places(top))
            holder[key] = copy.deepcopy(other[name])
        elif kind == 4:
            holder[key] = NESTED
        elif kind == 5 and isinstance(top.get("file_frames"), list):
            for frame in top["file_frames"]:
                if isinstance(frame, dict):
                    frame.update(frame_parent=rng.randrange(-1, 6), frame_inherit=True)
        else:
            holder[key] = copy.deepcopy(rng.choice(VALUES))
        if not top:
            break
    text = json.dumps(top).replace(f'"{NESTED}"', "[" * 2000 + "]" * 2000)
    if rng.random() < 0.1:
        text = text.replace("{", '{"frame_unit": "m", "frame_unit": "cm", ', 1)
    return text.encode()


def _places(top):
    """Every (list or object, key) of a JSON value; at most a few thousand."""
    found, left = [], [top]
    while left and len(found) < 3000:
        holder = left.pop()
        keys = list(holder) if isinstance(holder, dict) else range(len(holder))
        for key in keys:
            found.append((holder, key))
            if isinstance(holder[key], (dict, list)) and holder[key]:
                left.append(holder[key])
    return found or [({"": 0}, "")]


# ----------------------------------------------------------------------------- what is fed and how


@lru_cache(maxsize=None)
def fold_seeds():
    """A pattern with its folded form, a patch without faces, a chain of frames."""
    folder, seeds = scratch() / "fuzz_seeds", []
    folder.mkdir(exist_ok=True)
    square = np.array([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0.5, 1, 0), (1.5, 1, 0)], float)
    patch = FoldFrame(
        coords=square,
        edges=np.array([(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (0, 4)]),
        letters=np.array(list("BBBBCV")),
        unit="cm",
        custom={"membrane:note": [1, 2, {"a": None}]},
    )
    for number, content in enumerate((miura(2, 2), FoldFile((patch,)))):
        write_fold(folder / f"{number}.fold", content)
        seeds.append((folder / f"{number}.fold").read_bytes())
    chain = json.loads(seeds[1])
    chain["file_frames"] = [
        {"frame_parent": i, "frame_inherit": True, "frame_title": str(i)} for i in range(4)
    ]
    return [*seeds, json.dumps(chain).encode()]


@lru_cache(maxsize=None)
def msh_seeds():
    """Meshes of gmsh in all versions, text and binary."""
    files = (2.2, 0), (2.2, 1), (4.0, 0), (4.1, 0), (4.1, 1)
    return [gmsh_sheet(*file).read_bytes() for file in files]


@lru_cache(maxsize=None)
def history_seeds():
    path = scratch() / "fuzz_history.csv"
    with HistoryWriter(path, {"time": "s", "rate": "-", "work": "J"}) as history:
        for i in range(12):
            history.write({"time": 0.1 * i, "rate": 1 / (1 + i), "work": -(1e-9**i)})
    return [path.read_bytes()]


@lru_cache(maxsize=None)
def target_seeds():
    rows = [f"{i / 1000},{0.5 - i * i / 900},{(i / 14) ** 3},measured" for i in range(14)]
    return ["\n".join(["time,phase_difference,deployment_rate,note", *rows, ""]).encode()]


@lru_cache(maxsize=None)
def parameter_seeds():
    values = SailParameters().as_dict()
    return [json.dumps(values).encode(), json.dumps({"parameters": values}).encode()]


def check_fold(test, content):
    """Every array is whole and within bounds; what was read can be written and read again."""
    for frame in content.frames:
        count = 2**31 if frame.coords is None else len(frame.coords)
        if frame.coords is not None:
            test.assertEqual(frame.coords.shape, (count, 3))
            test.assertTrue(np.all(np.isfinite(frame.coords)))
        ids = [] if frame.edges is None else [*frame.edges]
        for loop in [*ids, *(frame.faces or ())]:
            test.assertTrue(np.all((loop >= 0) & (loop < count)))
        for values in (frame.letters, frame.angles):
            test.assertTrue(values is None or len(values) == len(ids))
        test.assertLessEqual(set([] if frame.letters is None else frame.letters), set(LETTERS))
        test.assertTrue(frame.angles is None or np.all(np.abs(frame.angles) <= 180))
    path = scratch() / "fuzz_again.fold"
    write_fold(path, content)
    again = read_fold(path)
    for one, two in zip(content.frames, again.frames, strict=True):
        for name in ("coords", "edges", "letters", "angles"):
            np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
        test.assertEqual(one.custom, two.custom)
    try:
        crease_pattern(content, unit=1.0)
    except ValueError as error:
        test.assertNotIn("\n", str(error))


def check_msh(test, sheet):
    """A surface of one orientation, with nothing missing."""
    test.assertTrue(np.all(np.isfinite(sheet.nodes)))
    test.assertEqual(set(range(len(sheet.nodes))), set(sheet.triangles.ravel().tolist()))
    test.assertEqual(crease_corners(sheet.triangles, sheet.creases).shape, (len(sheet.creases), 4))
    test.assertEqual(len(sheet.creases), len(sheet.crease_signs))
    test.assertGreater(sheet.area, 0)


def check_history(test, columns):
    """Columns of equal length, of finite numbers."""
    test.assertEqual(len({len(values) for values in columns.values()}), 1)
    test.assertTrue(all(np.all(np.isfinite(values)) for values in columns.values()))
    test.assertTrue(all(columns))


def check_target(test, found):
    """Curves of finite numbers at growing times, which vary."""
    test.assertEqual(found.values.shape, (len(found.columns), len(found.times)))
    test.assertTrue(np.all(np.isfinite([found.times, *found.values])))
    test.assertTrue(np.all(np.diff(found.times) > 0) and np.all(np.isfinite(found.noise)))


def check_parameters(test, parameters):
    check(parameters)


READERS = {
    "fold": (read_fold, fold_seeds, check_fold, (damaged, damaged_json), 4),
    "msh": (msh.read_msh, msh_seeds, check_msh, (damaged,), 3),
    "csv": (read_history, history_seeds, check_history, (damaged,), 2),
    "target": (target.read_target, target_seeds, check_target, (damaged,), 1),
    "json": (read_parameters, parameter_seeds, check_parameters, (damaged, damaged_json), 1),
}


class TestFuzzedReaders(unittest.TestCase):
    """READERS: reader, seeds, check, ways to damage, share of the files."""

    def setUp(self):
        self.limits = resource.getrlimit(resource.RLIMIT_AS)
        for _, seeds, *_ in READERS.values():
            seeds()
        pages = int(open("/proc/self/statm").read().split()[0])
        most = pages * resource.getpagesize() + MEMORY
        resource.setrlimit(resource.RLIMIT_AS, (most, self.limits[1]))

    def tearDown(self):
        resource.setrlimit(resource.RLIMIT_AS, self.limits)

    def test_undamaged_files_are_read(self):
        for kind, (read, seeds, is_whole, *_) in READERS.items():
            for number, content in enumerate(seeds()):
                with self.subTest(kind=kind, seed=number):
                    is_whole(self, read(self.written(kind, content)))

    def test_every_file_is_read_whole_or_refused_in_one_sentence(self):
        shares = sum(share for *_, share in READERS.values())
        for kind, (read, seeds, is_whole, ways, share) in READERS.items():
            rng = random.Random(f"readers {kind}")
            refused, count = 0, FILES * share // shares
            for number in range(count):
                content = rng.choice(ways)(rng.choice(seeds()), rng)
                path = self.written(kind, content)
                with self.subTest(kind=kind, file=number):
                    refused += not self.whole(read, is_whole, path)
            # Some damage is none: a blank, another digit. Most must be seen.
            self.assertGreater(refused, 0.4 * count, kind)
            self.assertLess(refused, count, kind)

    def test_what_is_cut_off_is_refused(self):
        for kind, (read, seeds, is_whole, *_) in READERS.items():
            for number, content in enumerate(seeds()):
                content = content.rstrip()
                size = len(content)
                is_table = kind in ("csv", "target")
                step = max(1, size // (size if is_table else 200))
                for end in range(0, size, step):
                    if is_table and content[:end].endswith(b"\n"):
                        continue  # a table of fewer lines is one
                    with self.subTest(kind=kind, seed=number, end=end):
                        found = self.whole(read, is_whole, self.written(kind, content[:end]))
                        # A measured table may lack the end of its last line: then who can tell?
                        self.assertTrue(kind == "target" or not found)

    def whole(self, read, is_whole, path):
        """Whether a file is read; if not, it is refused as it must be."""
        try:
            found = read(path)
        except BadFile as error:
            self.assertTrue(str(error).startswith(f"{path}: "), error)
            self.assertNotIn("\n", str(error))
            self.assertLess(len(str(error)), len(str(path)) + 400)
            return False
        is_whole(self, found)
        return True

    def written(self, kind, content):
        path = scratch() / f"fuzzed.{kind}"
        path.write_bytes(content)
        return path


if __name__ == "__main__":
    unittest.main()

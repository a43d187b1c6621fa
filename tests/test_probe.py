# SPDX-License-Identifier: GPL-2.0-or-later
"""`scripts/run.sh probe` knows this YADE, and sees what another release has otherwise."""

import re
import subprocess
import unittest
from functools import lru_cache

import yade.config
from support import ROOT, run_yade, scratch

FACTS = ROOT / "pkg" / "membrane" / "yade-abi" / "facts"
HERE = yade.config.version.strip()
FIRST = "2023.02a"
OTHER = "2025.2.0" if HERE == FIRST else FIRST


@lru_cache(maxsize=None)
def said():
    """What it says of this YADE beside itself, another, and itself without one virtual function."""
    library = scratch() / "allocations.so"
    source = ROOT / "scripts" / "probing" / "allocations.cpp"
    subprocess.run(["g++", "-std=c++17", "-shared", "-fPIC", source, "-o", library], check=True)
    kept = (FACTS / f"{HERE}.txt").read_text(encoding="utf-8")
    before = re.sub(r"(?m)^Bound  144  28  \w+", "Bound  144  27  01234567", kept)
    (scratch() / "before.txt").write_text(before, encoding="utf-8")
    beside = ["--beside", HERE, OTHER, scratch() / "before"]
    done = run_yade(ROOT / "scripts" / "probe.py", *beside, LD_PRELOAD=str(library))
    if done.returncode:
        raise AssertionError(done.stderr)
    parts = re.split(r"(?m)^probe: YADE (.*)\n", done.stdout)
    return parts[:6:2], parts[1:6:2]


class TestProbe(unittest.TestCase):
    def test_nothing_differs_from_what_is_kept_of_this_release(self):
        (lines, *_), (counts, *_) = said()
        self.assertTrue(lines.endswith("\nnothing differs\n"), lines)
        self.assertRegex(counts, rf"^{HERE} beside {HERE}: \d\d classes, 0 differences$")

    def test_what_the_releases_have_otherwise_is_told(self):
        lines = said()[0][1]
        sizes = (432, 440) if HERE == FIRST else (440, 432)
        self.assertIn("NewtonIntegrator: size {}, not {}\n".format(*sizes), lines)
        sign = "-" if HERE == FIRST else "+"
        for attribute in ("niterOmelyan1998", "normalizeEvery", "rotAlgorithm"):
            self.assertIn(f" {sign}{attribute}:", lines)
        told = set(re.findall("^([A-Z][A-Za-z]+): ", lines, re.MULTILINE))
        since = {"FrictPhys", "Shape", "Sphere"} if HERE > "2026" else set()
        self.assertEqual(told, {"NewtonIntegrator", *since}, lines)

    def test_a_virtual_function_more_is_told(self):
        lines, counts = said()[0][2], said()[1][2]
        start = "Bound: 28 words of virtual table, not 27, or others: "
        self.assertRegex(lines, rf"^{start}.*, getClassIndex, .*\n$")
        self.assertIn("38 classes, 1 differences", counts)

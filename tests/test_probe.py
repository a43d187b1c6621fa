# SPDX-License-Identifier: GPL-2.0-or-later
"""`scripts/run.sh probe` knows this YADE, and sees what another release has otherwise."""

import re
import subprocess
import unittest
from functools import lru_cache

import yade.config
from support import ROOT, run_yade, scratch

FACTS = ROOT / "pkg" / "membrane" / "yade-abi" / "facts"
SCRIPTS = ROOT / "scripts"


@lru_cache(maxsize=None)
def allocations():
    """The library that remembers allocations."""
    library = scratch() / "allocations.so"
    source = SCRIPTS / "probing" / "allocations.cpp"
    subprocess.run(["g++", "-std=c++17", "-shared", "-fPIC", source, "-o", library], check=True)
    return str(library)


class TestProbe(unittest.TestCase):
    def probe(self, *options):
        """What it prints, after YADE's own lines."""
        done = run_yade(SCRIPTS / "probe.py", *options, LD_PRELOAD=allocations())
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_nothing_differs_from_what_is_kept_of_this_release(self):
        said = self.probe()
        here = yade.config.version.strip()
        self.assertRegex(said, rf"nothing differs\nprobe: YADE {here} beside {here}: \d\d classes")

    def test_what_the_releases_have_otherwise_is_told(self):
        here = yade.config.version.strip()
        first = "2023.02a"
        other = "2025.2.0" if here == first else first
        said = self.probe("--beside", other)
        sizes = (432, 440) if here == first else (440, 432)
        self.assertIn("NewtonIntegrator: size {}, not {}\n".format(*sizes), said)
        sign = "-" if here == first else "+"
        for attribute in ("niterOmelyan1998", "normalizeEvery", "rotAlgorithm"):
            self.assertIn(f" {sign}{attribute}:", said)
        told = set(re.findall("^([A-Z][A-Za-z]+): ", said, re.MULTILINE))
        since = {"FrictPhys", "Shape", "Sphere"} if here > "2026" else set()
        self.assertEqual(told, {"NewtonIntegrator", *since}, said)

    def test_a_virtual_function_more_is_told(self):
        here = yade.config.version.strip()
        kept = (FACTS / f"{here}.txt").read_text(encoding="utf-8")
        before = re.sub(r"(?m)^Bound  144  28  \w+", "Bound  144  27  01234567", kept)
        (scratch() / "before.txt").write_text(before, encoding="utf-8")
        said = self.probe("--beside", scratch() / "before")
        told = (
            r"\nBound: 28 words of virtual table, not 27, or others: .*, getClassIndex, .*\nprobe: "
        )
        self.assertRegex(said, told)
        self.assertIn("38 classes, 1 differences", said)

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
        other = {"2023.02a": "2025.2.0"}.get(here, "2023.02a")
        said = self.probe("--beside", other)
        sizes = {"2023.02a": "432", "2025.2.0": "440"}
        self.assertIn(f"NewtonIntegrator: size {sizes[here]}, not {sizes[other]}", said)
        sign = "-" if here == "2023.02a" else "+"
        for attribute in ("niterOmelyan1998", "normalizeEvery", "rotAlgorithm"):
            self.assertIn(f" {sign}{attribute}:", said)
        self.assertEqual(len(re.findall("^[A-Z][A-Za-z]+: ", said, re.MULTILINE)), 2, said)

    def test_a_virtual_function_more_is_told(self):
        here = yade.config.version.strip()
        kept = (FACTS / f"{here}.txt").read_text(encoding="utf-8")
        before = re.sub(r"(?m)^Shape  96  28  \w+", "Shape  96  27  01234567", kept)
        (scratch() / "before.txt").write_text(before, encoding="utf-8")
        said = self.probe("--beside", scratch() / "before")
        told = (
            r"\nShape: 28 words of virtual table, not 27, or others: .*, getClassIndex, .*\nprobe: "
        )
        self.assertRegex(said, told)
        self.assertIn("38 classes, 1 differences", said)

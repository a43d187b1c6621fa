# SPDX-License-Identifier: GPL-2.0-or-later
"""What `scripts/run.sh bench --only roofline` is made of: counts, levels, roofs, its program.

Nothing here measures a speed. Some tests need valgrind.
"""

import re
import shutil
import subprocess
import unittest
from pathlib import Path
from unittest import mock

from membrane.study.benchmarks import roofline, sheet
from support import long, scratch
from yade import config

QUICK = True


# Two instructions of a program that call a library between them; costs end at the last that is
# not 0, and the line after "calls=" holds all of the called function.
CALLGRIND = """\
events: Ir Dr D1mr D1mw
ob=/bin/program
fn=outer
0x10 7 3 1
0x14 7
cob=/lib/library.so
cfn=inner
calls=7 0x20
0x14 700 5 2 2
fn=other
0x10 2
ob=/lib/library.so
fn=inner
0x20 700 5 2 2
totals: 716 8 3 2
"""
OBJDUMP = """
program:     file format elf64-x86-64

0000000000001000 <add>:
    1000:\tvaddpd %ymm0,%ymm1,%ymm2
    1004:\tvsqrtpd (%rdi),%xmm3
    1008:\tmulsd  %xmm1,%xmm0
    100c:\tvfmadd213pd %zmm0,%zmm1,%zmm2
    1010:\tvfnmadd231sd %xmm0,%xmm1,%xmm2
    1014:\tvmaxpd %ymm0,%ymm1,%ymm2
    1018:\tvaddps %ymm0,%ymm1,%ymm2
    101c:\tvpaddd %ymm0,%ymm1,%ymm2
    1020:\tret
"""
MEBI = 1 << 20
KNOWN = [
    roofline.Level("L1", 32768, 64, 8, 16384),
    roofline.Level("L2", MEBI, 64, 8, MEBI // 2),
    roofline.Level("memory", 0, 0, 0, 16 * MEBI),
]


def limits(**changes):
    """Limits of a machine, as the program tells them, with `changes`."""
    rates = {"peak": 16e9, "fused": 32e9, "divisions": 4e9, "roots": 2e9, "clock": 2e9}
    return {**rates, "bandwidth": [64e9, 32e9, 8e9], **changes}


def told(held, moved, seconds):
    """What the program tells of 100 sides between 50 nodes."""
    counts = {"nodes": 50, "sides": 100, "creases": 0, "triangles": 0}
    return {**counts, "held": held, "moved": moved, "seconds": seconds}


class TestMachineCode(unittest.TestCase):
    def test_instructions_of_called_functions_are_counted_once_and_where_they_are(self):
        totals, counts = roofline.executed(CALLGRIND.splitlines(keepends=True))
        self.assertEqual(totals, {"Ir": 716, "Dr": 8, "D1mr": 3, "D1mw": 2})
        self.assertEqual(counts["/bin/program", "outer"], {0x10: 7, 0x14: 7})
        self.assertEqual(counts["/bin/program", "other"], {0x10: 2})
        self.assertEqual(counts["/lib/library.so", "inner"], {0x20: 700})
        self.assertEqual(sum(sum(c.values()) for c in counts.values()), totals["Ir"])

    def test_operations_are_those_on_each_double_of_a_register(self):
        found = roofline.arithmetic(OBJDUMP.splitlines())
        wanted = {0x1000: 4, 0x1004: 2, 0x1008: 1, 0x100C: 16, 0x1010: 2}
        self.assertEqual(found, wanted)


class TestRoof(unittest.TestCase):
    def test_caches_are_read_in_order_and_instructions_left_out(self):
        folder = scratch() / "cache"
        shutil.rmtree(folder, ignore_errors=True)
        caches = [("2", "Unified", "512K"), ("1", "Instruction", "16K"), ("1", "Data", "32K")]
        for number, (level, kind, size) in enumerate(caches):
            cache = folder / f"index{number}"
            cache.mkdir(parents=True)
            for name, text in {
                "level": level,
                "type": kind,
                "size": size,
                "coherency_line_size": "64",
                "ways_of_associativity": "8",
            }.items():
                (cache / name).write_text(text + "\n")
        inner, outer, memory = roofline.levels(folder)
        self.assertEqual((inner.name, inner.size, inner.line, inner.ways), ("L1", 32768, 64, 8))
        self.assertEqual((outer.name, outer.size, memory.name), ("L2", 524288, "memory"))
        self.assertLess(inner.probe, inner.size)
        self.assertTrue(inner.size < outer.probe < outer.size)
        self.assertGreater(memory.probe, 10 * outer.size)

    def test_machine_that_hides_its_caches_is_refused(self):
        with self.assertRaisesRegex(RuntimeError, "sizes of the caches"):
            roofline.levels(scratch() / "no_such_folder")

    def test_data_lie_in_the_first_level_that_holds_them(self):
        for size, name in ((1, "L1"), (32768, "L1"), (32769, "L2"), (MEBI + 1, "memory")):
            self.assertEqual(roofline.level_of(size, KNOWN).name, name)

    def test_share_is_that_of_the_roof_over_the_intensity(self):
        flops = 33 * 100 + 36 * 50
        # From memory 0.5 flops a byte allow 4 Gflop/s, from L2 16; more than the peak 8 a byte.
        for held, intensity, roof in ((2 * MEBI, 0.5, 4e9), (MEBI, 0.5, 16e9), (MEBI, 8, 16e9)):
            seconds = 4 * flops / roof
            given = told(held, flops / intensity, seconds)
            point = roofline.Point(False, [given], [limits()], KNOWN)
            (share,) = [e for e in point.entries() if "attainable" in e.name]
            self.assertAlmostEqual(share.value, 0.25)

    def test_divisions_and_roots_take_their_share_of_the_time(self):
        # 150 divisions at 4e9/s and 100 roots at 2e9/s: 87.5 ns.
        point = roofline.Point(False, [told(1, 1, 350e-9)], [limits()], KNOWN)
        (share,) = [e for e in point.entries() if "roots" in e.name]
        self.assertAlmostEqual(share.value, 0.25)

    def test_picture_is_drawn(self):
        runs = [told(2 * MEBI, 1e4, 1e-6)]
        points = [roofline.Point(case, runs, [limits()], KNOWN) for case in (False, True)]
        path = scratch() / "roofline.png"
        roofline.plot(roofline.limit_entries([limits()], KNOWN), points, KNOWN, path)
        self.assertEqual(path.read_bytes()[:4], b"\x89PNG")


@unittest.skipUnless(shutil.which("valgrind"), "needs valgrind")
@unittest.skipUnless("avx2" in Path("/proc/cpuinfo").read_text(), "recorded with AVX2")
@unittest.skipUnless(config.version.strip() == "2023.02a", "recorded with Debian 12's compiler")
class TestInstructions(unittest.TestCase):
    """A guard of speed without a clock. A kernel that was made better gets another figure here."""

    # Of 10 steps of 34 x 34 nodes: springs and damping; creases and drag, too.
    RECORDED = {False: 1_024_597, True: 2_007_513}

    def test_kernels_take_at_most_a_twentieth_more_than_recorded(self):
        roofline.build()
        counting = ["valgrind", "--tool=callgrind", "--instr-atstart=no"]
        for everything, recorded in self.RECORDED.items():
            done = subprocess.run(
                [*counting, *map(str, roofline.sheet(34, everything, 2, 10))],
                check=True,
                capture_output=True,
                text=True,
                cwd=scratch(),
            )
            found = int(re.search(r"refs: +([\d,]+)", done.stderr)[1].replace(",", ""))
            self.assertLess(found, 1.05 * recorded)
            self.assertGreater(found, 0.5 * recorded)  # it did run


@long
@unittest.skipUnless(shutil.which("valgrind"), "needs valgrind")
class TestProgram(unittest.TestCase):
    SIDE = 34

    @classmethod
    def setUpClass(cls):
        roofline.build()
        cls.found = {
            everything: roofline.simulate(cls.SIDE, everything, roofline.levels())
            for everything in (False, True)
        }

    def test_sheet_is_that_of_the_other_benchmarks(self):
        plan = sheet.square_sheet(self.SIDE)
        counts = self.found[True]["sheet"]
        self.assertEqual(counts["nodes"], len(plan.nodes))
        self.assertEqual(counts["sides"], len(plan.sides()))
        self.assertEqual(counts["triangles"], len(plan.triangles))
        self.assertEqual(counts["creases"], len(plan.creases))
        self.assertEqual(self.found[False]["sheet"]["creases"], 0)

    def test_counted_operations_are_those_of_the_machine_code(self):
        for everything, found in self.found.items():
            roofline.check(found, everything)

    def test_a_wrong_count_is_refused(self):
        for element, right in roofline.FLOPS.items():
            for wrong in (right - 2, right + 2):
                with mock.patch.dict(roofline.FLOPS, {element: wrong}):
                    with self.assertRaisesRegex(RuntimeError, f"{element}.*do not fit"):
                        roofline.check(self.found[True], True)

    def test_caches_that_hold_all_miss_less(self):
        for found in self.found.values():
            misses = list(found["misses"].values())
            self.assertGreater(misses[0], found["sheet"]["sides"])
            self.assertLess(misses[1], 0.1 * misses[0])


if __name__ == "__main__":
    unittest.main()

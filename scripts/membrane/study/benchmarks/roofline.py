# SPDX-License-Identifier: GPL-2.0-or-later
"""How far the kernels are from what one core can do, and their instructions and cache misses.

The kernels run by themselves, in `roofline.cpp`: plainly for times, in turn with the machine's
limits; and in valgrind, which counts instructions and simulates the caches, since not every
machine lets anybody read its counters. Its caches prefetch nothing: what it calls a miss is a
line that had to come from further away, not a wait.
"""

import json
import math
import re
import shutil
import statistics
import subprocess
import tempfile
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from membrane.view.plots import save

from ..sources import BUILD, REFERENCE, ROOT
from . import Entry, Settings, cases
from .sheet import SIDES
from .turns import entry, take_turns

PROGRAM = BUILD / "roofline"
PICTURE = REFERENCE / "roofline.png"
NAMES = {False: "springs", True: "all forces"}  # by `everything`, as in cases

# Floating-point operations of one element and step, counted in the sources: each sum, difference,
# product, quotient, square root and atan2 is one; comparisons, changes of sign and choices are
# none, nor is what depends on no element, as rho/12. `check` holds them against the machine code.
FLOPS = {
    # SideKernel: span 3, length 6, inverse 1, tension 2, brake 3 + 5 + 2, sum 1, pull/length 1,
    # components 3, added to both nodes 6.
    "sides": 33,
    # CreaseKernel: spans 9, length 6, inverse 1, area vectors 18, their lengths 12, heights 2,
    # lever 1, feet 12, arguments of the angle 12, atan2 1, turn 1, collapsed or not 3,
    # opening directions 10; forces on C and D 11, on A and B 20; added to four nodes 12.
    "creases": 131,
    # DragKernel: spans 6, area vector 9, dot products 15, added to three nodes 3.
    "triangles": 33,
    # LeapfrogKernel: 1/m 1, acceleration 3 + 3 + 4, velocity 6, velocity extrapolated 9, place 6,
    # whether it is finite 4.
    "nodes": 36,
}
FLOPS_IN_AIR = 7  # of a node besides: drag 4, added 3
ATAN2 = {"creases": 1}  # calls of the C library, whose inner operations are not counted
DIVISIONS = {"sides": 1, "creases": 3, "nodes": 1}
ROOTS = {"sides": 1, "creases": 3}
KERNELS = {  # the functions that work on them
    "sides": "together",
    "creases": "paperCreases",
    "triangles": "addDragWeights",
    "nodes": "freely|inAir",
}
TOLERANCE = 0.01  # of a kernel's count: sums over whole vectors after each block are not in it

Counts = dict[tuple[str, str], Counter]  # runs by address, by object file and function

WARM, STEPS = 2, 2  # in valgrind, which repeats itself
INSTRUCTION = re.compile(r" *([0-9a-f]+):\t(\S+)(?: +(\S+))?")
ARITHMETIC = re.compile(r"v?(add|sub|mul|div|sqrt|fn?m(?:add|sub)\d+)([ps])d")


@dataclass(frozen=True)
class Level:
    """A level of the memory."""

    name: str
    size: int  #: of the cache [bytes]; of memory 0
    line: int  #: of its lines [bytes]; of memory 0
    ways: int  #: lines among which a place in memory may choose
    probe: int  #: size of the arrays that measure its bandwidth [bytes]


def levels(folder: Path = Path("/sys/devices/system/cpu/cpu0/cache")) -> list[Level]:
    """List of Level, from the fastest to the memory."""
    found = []
    for cache in sorted(folder.glob("index*")):
        kind, *numbers = (
            (cache / name).read_text(encoding="utf-8").strip()
            for name in ("type", "level", "size", "coherency_line_size", "ways_of_associativity")
        )
        if kind != "Instruction":
            number, kibibytes, line, ways = (int(number.rstrip("K")) for number in numbers)
            found.append((number, 1024 * kibibytes, line, ways))
    if len(found) < 2:
        raise RuntimeError(f"{folder} does not tell the sizes of the caches")
    caches, inner = [], 0
    for number, size, line, ways in sorted(found):
        # Well inside this cache and outside the one before.
        probe = min(size // 2, max(4 * inner, size // 8))
        caches.append(Level(f"L{number}", size, line, ways, probe))
        inner = size
    return [*caches, Level("memory", 0, 0, 0, 16 * inner)]


def level_of(size: int, known: Sequence[Level]) -> Level:
    """The first Level that holds `size` bytes."""
    return next(level for level in known if level.size >= size or level is known[-1])


def operations(counts: dict[str, int], what: dict[str, int]) -> int:
    """How many operations `what` (a number for one element) makes for `counts` of elements."""
    return sum(number * counts[element] for element, number in what.items())


def flops(counts: dict[str, int], everything: bool) -> int:
    """Floating-point operations of a step on a sheet with `counts` of elements."""
    return operations(counts, FLOPS) + everything * FLOPS_IN_AIR * counts["nodes"]


def attainable(intensity: float, bandwidth: float, peak: float) -> float:
    """The roof [flop/s] over an intensity [flop/byte]; `bandwidth` [byte/s], `peak` [flop/s]."""
    return min(peak, bandwidth * intensity)


def answer(command: Sequence) -> dict:
    """What a command prints, as JSON."""
    return json.loads(said(command))


def said(command: Sequence) -> str:
    """What a command prints."""
    done = subprocess.run(list(map(str, command)), capture_output=True, encoding="utf-8")
    if done.returncode:
        raise RuntimeError(f"{command[0]} failed: {(done.stdout + done.stderr).strip()[-600:]}")
    return done.stdout


def build() -> None:
    """Compile the program, and see that valgrind is there."""
    for tool, package in {"valgrind": "valgrind", "objdump": "binutils"}.items():
        if not shutil.which(tool):
            raise RuntimeError(f"there is no {tool}; on Debian: apt-get install {package}")
    said(["cmake", "-S", ROOT, "-B", BUILD])
    said(["cmake", "--build", BUILD, "--target", PROGRAM.name])


def sheet(side: int, everything: bool, warm: int, steps: int) -> list:
    """Command that runs a sheet."""
    return [PROGRAM, "sheet", side, int(everything), warm, steps]


# ---------------------------------------------------------------------------------------------------
# Instructions, misses and operations, by valgrind.


def executed(lines: Iterable[str]) -> tuple[dict[str, int], Counts]:
    """Instructions that a callgrind file tells of, written with --dump-instr=yes, uncompressed.

    Gives the totals of each event, and for each pair of object file and function a Counter of the
    runs of the instruction at each address.
    """
    events: list[str] = []
    totals: list[int] = []
    counts: Counts = {}
    current: Counter = Counter()
    file, inclusive = "", False
    for line in lines:
        if line.startswith("events:"):
            events = line.split()[1:]
        elif line.startswith("totals:"):
            totals = list(map(int, line.split()[1:]))
        elif line.startswith("ob="):
            file = line[3:].strip()
        elif line.startswith("fn="):
            current = counts.setdefault((file, line[3:].strip()), Counter())
        elif line.startswith("calls="):
            inclusive = True  # the next line is about all that the called function did
        elif line.startswith("0x"):
            if not inclusive:
                address, instructions = line.split()[:2]
                current[int(address, 16)] += int(instructions)
            inclusive = False
    return dict(zip(events, totals)), counts


def arithmetic(listing: Iterable[str]) -> dict[int, int]:
    """Operations on doubles in the instruction at each address, from what objdump lists."""
    found = {}
    for line in listing:
        parts = INSTRUCTION.match(line)
        known = ARITHMETIC.fullmatch(parts[2]) if parts else None
        if parts and known:
            registers = parts[3] or ""
            packed = 8 if "zmm" in registers else 4 if "ymm" in registers else 2
            lanes = packed if known[2] == "p" else 1
            found[int(parts[1], 16)] = lanes * (2 if known[1].startswith("f") else 1)
    return found


def operations_of(path: Path | str, counts: Counts) -> dict[str, int]:
    """Operations on doubles in the functions of an object file, by name, from `executed`."""
    known = arithmetic(said(["objdump", "-d", "--no-show-raw-insn", path]).splitlines())
    return {
        function: sum(number * known.get(address, 0) for address, number in runs.items())
        for (file, function), runs in counts.items()
        if file == str(path)
    }


def simulate(side: int, everything: bool, known: Sequence[Level]) -> dict:
    """Instructions, misses and operations of a step.

    They are "instructions"; "flops" by the name of a function; "misses" by the name of a cache;
    "sheet": what the program said.
    """
    first, *outer = known[:-1]
    misses = {}
    for last in outer:  # valgrind knows two levels at a time
        told, events, counts = in_valgrind(sheet(side, everything, WARM, STEPS), first, last)
        misses[first.name] = (events["D1mr"] + events["D1mw"]) / STEPS
        misses[last.name] = (events["DLmr"] + events["DLmw"]) / STEPS
    functions = {}
    for path in {path for path, _ in counts}:
        if path == str(PROGRAM) or Path(path).name.startswith("libmvec."):  # the latter has atan2
            functions.update(operations_of(path, counts))
    return {
        "sheet": told,
        "instructions": events["Ir"] / STEPS,
        "misses": misses,
        "flops": {name: number / STEPS for name, number in functions.items()},
    }


def in_valgrind(command: list, first: Level, last: Level) -> tuple[dict, dict[str, int], Counts]:
    """What a command prints, as JSON, and what `executed` reads of its run with two caches."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "callgrind.out"
        told = answer(
            ["valgrind", "--tool=callgrind", "--cache-sim=yes", "--instr-atstart=no"]
            + ["--dump-instr=yes", "--dump-line=no", "--compress-pos=no"]
            + ["--compress-strings=no", f"--callgrind-out-file={file}"]
            + [f"--D1={first.size},{first.ways},{first.line}"]
            + [f"--LL={last.size},{last.ways},{last.line}"]
            + command
        )
        with open(file, encoding="utf-8") as lines:
            return told, *executed(lines)


def check(found: dict, everything: bool) -> None:
    """Raise RuntimeError if FLOPS are not those of the machine code that ran."""
    counts = found["sheet"]["computed"]
    for element, kernel in KERNELS.items():
        each = FLOPS[element] - ATAN2.get(element, 0)
        each += FLOPS_IN_AIR if everything and element == "nodes" else 0
        wanted = each * counts[element]
        made = sum(n for name, n in found["flops"].items() if re.search(rf"\b({kernel})\(", name))
        if not abs(made - wanted) <= TOLERANCE * wanted:
            raise RuntimeError(
                f"{element} ({NAMES[everything]}): {made:.0f} operations instead of {wanted:.0f}: "
                f"FLOPS in {Path(__file__).name} do not fit the kernel any more"
            )


# ---------------------------------------------------------------------------------------------------
# Entries and the picture.


def measure(settings: Settings) -> list[Entry]:
    """Entries of the limits, and of both cases of a sheet in all sizes, one thread."""
    build()
    known, sides = levels(), settings.sizes(SIDES)
    wanted = [(side, everything) for everything in cases.FORCES for side in sides]
    settings.tell(f"kernels and limits, {', '.join(str(side * side) for side in sides)} nodes")
    machine = [PROGRAM, "limits", *(level.probe for level in known)]
    takers: dict = {None: partial(answer, machine)}
    for side, everything in wanted:
        steps = cases.steps(settings, side * side)
        command = sheet(side, everything, max(1, steps // 10), steps)
        takers[side, everything] = partial(answer, command)
    taken = take_turns(takers, settings.rounds, settings.quiet)
    limits = taken.pop(None)

    found, points = limit_entries(limits, known), []
    for (side, everything), told in taken.items():
        settings.tell(f"{NAMES[everything]} on {side * side} nodes in valgrind")
        simulated = simulate(side, everything, known)
        check(simulated, everything)
        point = Point(everything, told, limits, known)
        points.append(point)
        found += point.entries() + simulated_entries(point, simulated)
    if not settings.quick:
        plot(found, points, known, PICTURE)
    return settings.quiet.mark(found)


def limit_entries(limits: list[dict], known: Sequence[Level]) -> list[Entry]:
    """Entries of what the machine can do at most."""
    rates = {
        "peak, sums and products": ("peak", 1e-9, "Gflop/s"),
        "peak, fused multiply-adds (not used)": ("fused", 1e-9, "Gflop/s"),
        "divisions": ("divisions", 1e-9, "1e9/s"),
        "square roots": ("roots", 1e-9, "1e9/s"),
        "clock": ("clock", 1e-9, "GHz"),
    }
    found = [
        entry(name, [factor * one[key] for one in limits], unit, None)
        for name, (key, factor, unit) in rates.items()
    ]
    for i, level in enumerate(known):
        each = [1e-9 * one["bandwidth"][i] for one in limits]
        found.append(entry(bandwidth_name(level), each, "GB/s", None))
    return found


def bandwidth_name(level: Level) -> str:
    """Name of the entry of a Level's bandwidth."""
    return f"bandwidth, {level.name}"


class Point:
    """A case at one size under its roof.

    `told` is what the program said of the sheet, round by round, and `limits` parallel to it what
    it said of the machine, whose levels are `known`.
    """

    def __init__(
        self, everything: bool, told: list[dict], limits: list[dict], known: Sequence[Level]
    ) -> None:
        self.sheet, self.everything = told[0], everything
        self.level = level_of(self.sheet["held"], known)
        self.flops = flops(self.sheet, everything)
        self.intensity = self.flops / self.sheet["moved"]
        self.seconds = [one["seconds"] for one in told]
        self.rates = [self.flops / seconds for seconds in self.seconds]
        self.roofs = [
            attainable(self.intensity, one["bandwidth"][known.index(self.level)], one["peak"])
            for one in limits
        ]
        divisions, roots = (operations(self.sheet, what) for what in (DIVISIONS, ROOTS))
        self.dividing = [divisions / one["divisions"] + roots / one["roots"] for one in limits]
        self.cycles = [one["clock"] * seconds for one, seconds in zip(limits, self.seconds)]

    def entry(self, name: str, numbers: list[float], unit: str) -> Entry:
        """An Entry of this point."""
        return entry(f"{NAMES[self.everything]}, {name}", numbers, unit, self.sheet["nodes"])

    def entries(self) -> list[Entry]:
        """Entries of times, operations and roofs."""
        sides = self.sheet["sides"]
        shares = [rate / roof for rate, roof in zip(self.rates, self.roofs)]
        dividing = [alone / whole for alone, whole in zip(self.dividing, self.seconds)]
        return [
            self.entry("time", [1e9 * s / sides for s in self.seconds], "ns a side and step"),
            self.entry("operations", [self.flops / sides], "flops a side and step"),
            self.entry("least traffic", [self.sheet["moved"] / sides], "bytes a side and step"),
            self.entry("intensity", [self.intensity], "flops a byte"),
            self.entry("attained", [1e-9 * rate for rate in self.rates], "Gflop/s"),
            self.entry(f"attained over attainable from {self.level.name}", shares, "-"),
            self.entry("divisions and roots alone, over the time", dividing, "-"),
        ]


def simulated_entries(point: Point, simulated: dict) -> list[Entry]:
    """Entries of what valgrind counted."""
    sides, instructions = point.sheet["sides"], simulated["instructions"]
    all_flops = sum(simulated["flops"].values())
    found = [
        point.entry("instructions", [instructions / sides], "a side and step"),
        point.entry("instructions a cycle", [instructions / c for c in point.cycles], "-"),
        point.entry("operations with padding and inside atan2", [all_flops / point.flops], "-"),
    ]
    for name, misses in simulated["misses"].items():
        found.append(
            point.entry(f"{name} misses, simulated", [misses / sides], "lines a side and step")
        )
    return found


def plot(found: list[Entry], points: list[Point], known: Sequence[Level], path: Path | str) -> None:
    """Roofs of the machine, and where the cases lie under them, as a picture at `path`.

    Those of the limits must be among the entries `found`.
    """
    value = {one.name: one.value for one in found if one.nodes is None}
    peak, fused = (value[name] for name in value if name.startswith("peak"))
    rates = {point: 1e-9 * statistics.median(point.rates) for point in points}
    bandwidths = {level.name: value[bandwidth_name(level)] for level in known}
    least = 0.7 * min(peak / max(bandwidths.values()), *(point.intensity for point in points))
    most = 6 * max(point.intensity for point in points)
    figure = Figure(figsize=(7.5, 5.2), layout="constrained")
    axes = figure.subplots()
    axes.set(xscale="log", yscale="log", xlim=(least, most))
    axes.set(ylim=(0.5 * min(rates.values()), 1.6 * peak))
    _draw_roofs(
        axes, bandwidths, peak, f"sums and products, {peak:.0f} Gflop/s (fused: {fused:.0f})"
    )
    _draw_points(axes, rates)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("")
    axes.set(xlabel="operations a byte of the least traffic [flop/byte]")
    axes.set(ylabel="operations a second [Gflop/s]")
    axes.grid(alpha=0.3)
    axes.legend(frameon=False, fontsize=9, loc="lower right")
    save(figure, path)


def _draw_roofs(axes: Axes, bandwidths: dict[str, float], peak: float, words: str) -> None:
    """Lines of the bandwidths [GB/s] by name up to the peak [Gflop/s], and that, with `words`."""
    (least, most), (lowest, _) = axes.get_xlim(), axes.get_ylim()
    for name, bandwidth in bandwidths.items():
        axes.plot([lowest / bandwidth, peak / bandwidth], [lowest, peak], color="0.4")
        start = 1.08 * max(least, lowest / bandwidth)
        below = name == "L3"  # it is close to L2
        axes.text(
            start,
            (0.96 if below else 1.06) * bandwidth * start,
            f"{name}, {bandwidth:.0f} GB/s",
            rotation=math.degrees(math.atan(bandwidth)),
            rotation_mode="anchor",
            transform_rotates_text=True,
            va="top" if below else "bottom",
            fontsize=9,
        )
    axes.plot([peak / max(bandwidths.values()), most], [peak, peak], color="0.4")
    axes.text(0.95 * most, 1.05 * peak, words, ha="right", fontsize=9)


def _draw_points(axes: Axes, rates: dict[Point, float]) -> None:
    """A mark at the rate [Gflop/s] of each Point."""
    sizes = sorted({point.sheet["nodes"] for point in rates})
    for point, rate in rates.items():
        marker = "osD^"[sizes.index(point.sheet["nodes"]) % 4]
        colour = "C1" if point.everything else "C0"
        label = f"{NAMES[point.everything]}, {point.sheet['nodes']:,} nodes"
        axes.plot(point.intensity, rate, marker, color=colour, label=label, linestyle="none")

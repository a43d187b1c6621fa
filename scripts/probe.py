# SPDX-License-Identifier: GPL-2.0-or-later
"""Tells how the classes of this YADE differ from those of the nearest known release.

Run it by `scripts/run.sh probe`. Of each class that the headers in pkg/membrane/yade-abi declare it
compares size, virtual table and attributes with the facts kept there; --write keeps those of this
YADE. It needs no plugin.
"""

import argparse
import ctypes
import platform
import re
import subprocess
import sys
import zlib
from pathlib import Path

import yade.config
from yade import wrapper

ABI = Path(sys.argv[0]).resolve().parents[1] / "pkg" / "membrane" / "yade-abi"
FACTS = "class  size  words of its virtual table  their checksum  attributes"


def declared():
    """Names of the classes that the headers declare."""
    text = "".join(path.read_text(encoding="utf-8") for path in ABI.rglob("*.hpp"))
    return sorted(set(re.findall(r"YADE_ABI_LAYOUT\(\s*(\w+),", text)) - {"Class"})


def size(name):
    """What YADE asks operator new for to make an object [bytes], as text; - if it makes none."""
    allocated = ctypes.CDLL(None).membrane_allocated
    allocated.argtypes, allocated.restype = [ctypes.c_void_p], ctypes.c_size_t
    try:
        made = getattr(wrapper, name)()
    except (AttributeError, TypeError):  # not known to Python, or not to be made there
        return "-"
    place = re.search(r"0x[0-9a-f]+", str(made))
    return str(allocated(int(place[0], 16)) or "-") if place else "-"


def attributes(name):
    """Its own attributes as name:type, in alphabetical order, joined by commas; - for none."""
    own = vars(getattr(wrapper, name, object)).items()
    types = {
        key: re.search(r":yattrtype:`([^`]*)`", getattr(value, "__doc__", "") or "")
        for key, value in own
    }
    found = sorted(f"{key}:{kind[1].replace(' ', '')}" for key, kind in types.items() if kind)
    return ",".join(found) or "-"


def said_by(*command):
    """Lines that a tool of binutils prints."""
    done = subprocess.run(command, capture_output=True, encoding="utf-8", check=True)
    return done.stdout.splitlines()


def libraries():
    """YADE's."""
    return sorted(Path(yade.config.libDir).glob("lib*.so"))


def virtual_tables(names):
    """Functions in the virtual tables, of all bases in order, by class."""
    tables = {}
    for library in map(str, libraries()):
        places = {}
        for line in said_by("nm", "-DS", "--defined-only", library):
            cells = line.split()
            mangled = re.fullmatch(r"_ZTVN4yade\d+([A-Z]\w*)E", cells[-1])
            if mangled and len(cells) == 4 and mangled[1] in names and mangled[1] not in tables:
                places[mangled[1]] = int(cells[0], 16), int(cells[1], 16)
        if not places:
            continue
        rows = (line.split() for line in said_by("readelf", "-rW", library))
        slots = {
            int(row[0], 16): row[4] for row in rows if len(row) > 4 and row[2] == "R_X86_64_64"
        }
        for name, (start, length) in places.items():
            tables[name] = [slots.get(start + word, "-") for word in range(0, length, 8)]
    return tables


def facts():
    """Facts by class, of which there are any, and the functions of the virtual tables."""
    names = declared()
    tables = virtual_tables(names)
    found = {}
    for name in names:
        table = tables.get(name, [])
        checksum = format(zlib.crc32(" ".join(table).encode()), "08x")
        row = [size(name), str(len(table)), checksum if table else "-", attributes(name)]
        if row != ["-", "0", "-", "-"]:
            found[name] = row
    return found, tables


def read(path):
    """The facts that a file keeps, by class."""
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = [line.split() for line in lines if line and not line.startswith("#")]
    return {row[0]: row[1:] for row in rows}


def write(path, found):
    """Keep facts in a file."""
    here = yade.config.version.strip()
    head = ["# SPDX-License-Identifier: GPL-2.0-or-later"]
    head += [f"# YADE {here}, as `scripts/run.sh probe --write` found it:", f"# {FACTS}"]
    rows = [f"{name}  {'  '.join(row)}" for name, row in found.items()]
    path.write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")


def number(version):
    """A version as numbers, to be compared."""
    return [int(digits) for digits in re.findall(r"\d+", version)]


def nearest():
    """The known release that is this one or, without it, the last before it."""
    here = number(yade.config.version)
    known = sorted((path.stem for path in (ABI / "facts").glob("*.txt")), key=number)
    return [release for release in known if number(release) <= here or release == known[0]][-1]


def functions(mangled):
    """Names of functions, without the parameters."""
    names = said_by("c++filt", "-p", *mangled)
    return [name.rpartition("::")[2] for name in names]


def differences(known, found, tables):
    """Yield a line for each class in which the two differ."""
    for name in sorted({*known, *found}):
        before, now = known.get(name), found.get(name)
        if before is None or now is None:
            yield f"{name}: {'new' if before is None else 'no longer'} in the headers"
            continue
        if before[0] != now[0]:
            yield f"{name}: size {now[0]}, not {before[0]}"
        if before[1:3] != now[1:3]:
            order = ", ".join(functions(tables.get(name, [])))
            yield f"{name}: {now[1]} words of virtual table, not {before[1]}, or others: {order}"
        old, new = set(before[3].split(",")), set(now[3].split(","))
        if old != new:
            gone = "".join(f" -{text}" for text in sorted(old - new))
            yield f"{name}: attributes" + "".join(f" +{text}" for text in sorted(new - old)) + gone


def row():
    """The line of releases.txt for this YADE and system, with ? where it is not known here."""
    here = yade.config.version.strip()
    year, minor = (number(here) + [0])[:2]
    needed = " ".join(said_by("readelf", "-d", *map(str, libraries())))
    boost = re.search(r"libboost_\w+\.so\.([\d.]+)", needed)
    system = platform.freedesktop_os_release()
    name = f"{system['NAME'].removesuffix(' GNU/Linux')} {system.get('VERSION_ID', '?')}"
    cells = [here, f"{year}{minor:02}", boost[1] if boost else "?"]
    cells += [f"{sys.version_info[0]}.{sys.version_info[1]}", "?"]
    return "  ".join([*cells, system.get("VERSION_CODENAME", "?"), name])


def main():
    """Compare or keep."""
    parser = argparse.ArgumentParser(prog="probe", description=__doc__.partition("\n")[0])
    parser.add_argument("--write", action="store_true", help="keep the facts of this YADE")
    parser.add_argument(
        "--beside", nargs="+", metavar="RELEASE", default=[nearest()], help="default: %(default)s"
    )
    arguments = parser.parse_args()
    here = yade.config.version.strip()
    found, tables = facts()
    if arguments.write:
        write(ABI / "facts" / f"{here}.txt", found)
        return 0
    for release in arguments.beside:
        lines = list(differences(read(ABI / "facts" / f"{release}.txt"), found, tables))
        print("\n".join(lines) if lines else "nothing differs")
        counts = f"{len(found)} classes, {len(lines)} differences"
        print(f"probe: YADE {here} beside {release}: {counts}")
    if nearest() != here:
        print(f"as a line of {ABI.name}/releases.txt, with its LLVM for the ?: {row()}")
    return 0


sys.exit(main())

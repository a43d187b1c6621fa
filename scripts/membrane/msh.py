# SPDX-License-Identifier: GPL-2.0-or-later
"""Meshes of gmsh (.msh, versions 2.2 and 4.1, text or binary), read through meshio.

meshio trusts a file's counts: it would make arrays of any size that a header names, and leave
parts of them unset where the file ends early. Therefore the sections that matter are walked
through first, count by count, and meshio gets those only.

Physical groups of curves named M or mountain, V or valley become creases; all named groups are
kept by name, so that a group of points "tips" can bear masses and a group "hub" be driven.
"""

import contextlib
import io
import os
import re
import tempfile

import numpy as np

from .files import BadFile, read_bytes, shown
from .geometry import MOUNTAIN, VALLEY, area_vectors, crease_corners, cut_quadrangles
from .geometry import unique_sides
from .pattern_mesh import SheetMesh

VERSIONS = ("2.2", "4.1")
CREASES = {"m": MOUNTAIN, "mountain": MOUNTAIN, "v": VALLEY, "valley": VALLEY}
SURFACES = {"triangle": 3, "quad": 4}
NODES_OF = {15: 1, 1: 2, 2: 3, 3: 4}  # nodes of each kind of element that a sheet may have
FARTHEST = 1e12
LARGEST_TAG_SHARE = 100  # tags of nodes may have gaps, but not such that tables by tag are huge


def read_msh(path, unit=1.0):
    """Read a triangulated sheet.

    Quadrangles are cut in two; nodes that no triangle has are left out; a sheet in the plane is
    turned so that all its triangles are counter-clockwise seen from +z.

    Parameters
    ----------
    path : path
    unit : float
        Length of the file's unit [m].

    Returns
    -------
    SheetMesh

    Raises
    ------
    BadFile
        Whatever is wrong, in one sentence.
    OSError
        If the file cannot be opened.
    """
    if not (np.isfinite(unit) and unit > 0):
        raise ValueError(f"unit = {unit} m: must be finite and > 0")
    walk = _Walk(path, read_bytes(path))
    points, blocks, names = _through_meshio(path, walk)
    if points.shape != (walk.nodes, 3):
        raise BadFile(path, "$Nodes", f"{len(points)} nodes were read of {walk.nodes}")
    if not np.all(np.abs(points) <= FARTHEST):
        node = int(np.argmax(~np.all(np.abs(points) <= FARTHEST, axis=1)))
        raise BadFile(path, "$Nodes", f"node {node} lies at {points[node].tolist()}")
    triangles, creases, signs, groups = _sorted_out(path, points, blocks, names)
    triangles = _one_side_up(path, points, triangles)
    creasing = {(name.lower(), dim) for name, dim, _ in names if name.lower() in CREASES}
    used = np.unique(triangles)
    row = np.full(len(points), -1)
    row[used] = np.arange(len(used))
    try:
        crease_corners(triangles, creases)
    except ValueError as error:
        raise BadFile(path, "", str(error)) from None
    return SheetMesh(
        nodes=unit * points[used],
        triangles=row[triangles],
        creases=row[creases],
        crease_signs=signs,
        groups={name: row[ids][row[ids] >= 0] for name, ids in groups.items()},
        others=tuple(name for name in groups if (name.lower(), 1) not in creasing),
    )


def _sorted_out(path, points, blocks, names):
    """Triangles (T, 3), creases (C, 2), their signs (C,), and nodes by name of group."""
    triangles, creases, signs, groups = [], [], [], {}
    for kind, cells, tag in blocks:
        if cells.size and not (0 <= cells.min() and cells.max() < len(points)):
            raise BadFile(path, "$Elements", f"a {kind} names a node that is not in $Nodes")
        if kind in SURFACES:
            try:
                triangles.append(cells if kind == "triangle" else cut_quadrangles(points, cells))
            except ValueError as error:
                raise BadFile(path, "$Elements", str(error)) from None
        for name, dimension, group in names:
            if group == tag and dimension == {"vertex": 0, "line": 1}.get(kind, 2):
                groups.setdefault(name, []).append(cells.ravel())
                if kind == "line" and name.lower() in CREASES:
                    creases.append(cells)
                    signs.append(np.full(len(cells), CREASES[name.lower()]))
    if not sum(map(len, triangles)):
        raise BadFile(path, "$Elements", "has no triangles")
    return (
        np.concatenate(triangles).astype(int),
        np.concatenate([np.empty((0, 2), dtype=int), *creases]).astype(int),
        np.concatenate([np.empty(0, dtype=int), *signs]),
        {name: np.unique(np.concatenate(ids)).astype(int) for name, ids in groups.items()},
    )


def _one_side_up(path, points, triangles):
    """The triangles, counter-clockwise seen from one side; refused if they form no surface."""
    ahead = np.roll(triangles, -1, axis=1)
    if np.any(triangles == ahead):
        t = int(np.argmax(np.any(triangles == ahead, axis=1)))
        raise BadFile(path, "$Elements", f"triangle {t} has a node twice")
    height = np.ptp(points[np.unique(triangles), 2])
    vectors = area_vectors(points, triangles)
    if height <= 1e-9 * np.max(np.ptp(points, axis=0)):
        under = vectors[:, 2] < 0
        triangles = np.where(under[:, None], triangles[:, ::-1], triangles)
    flat = np.linalg.norm(vectors, axis=1) <= 0
    if np.any(flat):
        raise BadFile(path, "$Elements", f"triangle {int(np.argmax(flat))} has no area")
    _, _, shares = unique_sides(triangles)
    if shares.max() > 2:
        raise BadFile(path, "$Elements", "three triangles share a side; a sheet has two at most")
    directed = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    if len(np.unique(directed, axis=0)) < len(directed):
        raise BadFile(path, "$Elements", "neighbouring triangles face opposite ways")
    return triangles


def _through_meshio(path, walk):
    """Points, blocks (kind, cells, physical tag) and names (name, dimension, tag) by meshio."""
    try:
        import meshio
    except ImportError:
        raise ValueError(
            "reading .msh files needs meshio: apt-get install python3-meshio"
        ) from None
    handle, checked = tempfile.mkstemp(suffix=".msh")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(walk.sections())
        said = io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            mesh = meshio.gmsh.read(checked)
        tags = mesh.cell_data.get("gmsh:physical")
        if tags is None or len(tags) != len(mesh.cells):
            tags = [None] * len(mesh.cells)
        blocks = []
        for block, values in zip(mesh.cells, tags):
            blocks.extend(_by_tag(block.type, np.asarray(block.data), values))
        names = [(name, int(dim), int(tag)) for name, (tag, dim) in mesh.field_data.items()]
        return np.asarray(mesh.points, dtype=float), blocks, names
    except Exception as error:  # meshio raises whatever comes up
        told = str(error) or type(error).__name__
        raise BadFile(path, "", f"meshio cannot read it: {told[:200]}") from None
    finally:
        os.remove(checked)


def _by_tag(kind, cells, tags):
    """A block of cells in parts of one physical tag each (None: of no group)."""
    if tags is None or len(tags) != len(cells):
        return [(kind, cells, None)]
    return [(kind, cells[tags == tag], int(tag)) for tag in np.unique(tags)]


class _Walk:
    """Goes through a .msh file section by section; every count must be borne out by the file.

    Attributes
    ----------
    nodes : int
        Number of nodes.
    """

    def __init__(self, path, content):
        self._path, self._content, self._at = path, content, 0
        self._kept, self._seen = [], set()
        self.nodes, self._node_tags, self._entities = 0, None, None
        self._binary = False
        name = self._next_section()
        if name != "MeshFormat":
            raise BadFile(path, "", "does not begin with $MeshFormat: it is no mesh of gmsh")
        version = self._format()
        walks = {
            "PhysicalNames": self._walk_names,
            "Entities": self._walk_entities,
            "Nodes": self._walk_nodes_22 if version == "2.2" else self._walk_nodes_41,
            "Elements": self._walk_elements_22 if version == "2.2" else self._walk_elements_41,
        }
        while name := self._next_section():
            if name in self._seen:
                raise BadFile(path, f"${name}", "is there twice")
            if name in walks:
                self._seen.add(name)
                self._walk(name, walks[name])
            else:
                self._at = self._end_of(name)[1]
        for name in ("Nodes", "Elements"):
            if name not in self._seen:
                raise BadFile(path, f"${name}", "is missing")

    def sections(self):
        """The bytes of the sections that were walked through, and no others."""
        return b"".join(self._kept)

    def _next_section(self):
        """Go behind the next `$Name` line; its name, or None at the end of the file."""
        while self._content[self._at : self._at + 1].isspace():
            self._at += 1
        if self._at == len(self._content):
            return None
        stop = self._content.find(b"\n", self._at)
        line = self._content[self._at : stop if stop >= 0 else None].strip()
        name = re.fullmatch(rb"\$([A-Za-z]{1,40})", line)
        if stop < 0 or not name or name[1].startswith(b"End"):
            shown_line = shown(line.decode("ascii", "replace"))
            raise BadFile(
                self._path, f"byte {self._at}", f"a section begins here, not {shown_line}"
            )
        self._at = stop + 1
        return name[1].decode()

    def _end_of(self, name):
        """Where a section's content ends, and where its closing line does."""
        mark = b"$End" + name.encode()
        stop = self._content.find(mark, self._at)
        if stop < 0:
            raise BadFile(self._path, f"${name}", f"is cut off: there is no $End{name}")
        return stop, stop + len(mark)

    def _format(self):
        """The version; sets whether the file is binary."""
        stop, after = self._end_of("MeshFormat")
        content = self._content[self._at : stop]
        words = content.split(b"\n")[0].split()
        version = words[0].decode("ascii", "replace") if words else ""
        version = {"2": "2.2", "4": "4.1"}.get(version, version)
        if version not in VERSIONS:
            raise BadFile(
                self._path, "$MeshFormat", f"is of version {shown(version)}; 2.2 and 4.1 are read"
            )
        if words[1:] not in ([b"0", b"8"], [b"1", b"8"]):
            raise BadFile(self._path, "$MeshFormat", "must be text or binary (0 or 1), of size 8")
        self._binary = words[1] == b"1"
        if self._binary:
            one = content.split(b"\n", 1)[1][:4] if b"\n" in content else b""
            if one != np.array([1], "<i4").tobytes():
                raise BadFile(self._path, "$MeshFormat", "has the bytes of its numbers reversed")
        head = f"$MeshFormat\n{version} {words[1].decode()} 8\n".encode()
        one = np.array([1], "<i4").tobytes() + b"\n" if self._binary else b""
        self._kept.append(head + one + b"$EndMeshFormat\n")
        self._at = after
        return version

    def _walk(self, name, walk):
        """Walk through a section's content and keep it."""
        binary = self._binary and name != "PhysicalNames"
        if binary:
            cursor = _Bytes(self._path, f"${name}", self._content, self._at)
        else:
            stop, after = self._end_of(name)
            cursor = _Words(self._path, f"${name}", self._content[self._at : stop])
        kept = walk(cursor)
        if binary:
            kept = self._content[self._at : cursor.at]
            self._at = cursor.at
            after = self._end_of(name)[1]
            if self._content[cursor.at : after].strip() != b"$End" + name.encode():
                raise BadFile(self._path, f"${name}", "holds more than its counts say")
        else:
            cursor.finish()
            kept = kept or self._content[self._at : stop].strip()
        self._at = after
        begin, end = f"${name}\n".encode(), f"\n$End{name}\n".encode()
        self._kept.append(begin + kept + end)

    def _walk_names(self, cursor):
        """Names of physical groups; they may hold blanks."""
        lines = b" ".join(cursor.words).decode("utf-8", "replace")
        count, *_ = cursor.whole(1)
        names = re.findall(r'([0-3]) (-?\d{1,9}) "([^"]{1,200})"', lines)
        if (
            len(names) != count
            or " ".join([str(count), *(f'{d} {t} "{n}"' for d, t, n in names)]) != lines
        ):
            raise BadFile(self._path, "$PhysicalNames", f"does not hold the {count} names it says")
        if len({name for *_, name in names}) < len(names):
            raise BadFile(self._path, "$PhysicalNames", "has a name twice")
        cursor.skip()
        plain = [f'{d} {t} "{name}"' for d, t, name in names]
        return "\n".join([str(count), *plain]).encode()

    def _walk_entities(self, cursor):
        self._entities = set()
        for dimension, count in enumerate(cursor.sizes(4)):
            for _ in range(count):
                self._entities.add((dimension, *cursor.whole(1)))
                cursor.real(3 if dimension == 0 else 6)
                cursor.whole(*cursor.sizes(1))
                if dimension:
                    cursor.whole(*cursor.sizes(1))

    def _walk_nodes_22(self, cursor):
        (count,) = cursor.line_count()
        self._take_tags(cursor.records(count, "<i4", 3))

    def _walk_nodes_41(self, cursor):
        blocks, total, _, _ = cursor.sizes(4)
        tags = []
        for _ in range(blocks):
            *_, parametric = cursor.whole(3)
            (count,) = cursor.sizes(1)
            if parametric:
                raise BadFile(self._path, "$Nodes", "has nodes with parameters, which are not read")
            tags.append(cursor.sizes(count))
            cursor.real(3 * count)
        found = np.concatenate(tags) if tags else np.empty(0, dtype=int)
        if len(found) != total:
            raise BadFile(self._path, "$Nodes", f"says {total} nodes and has {len(found)}")
        self._take_tags(found)

    def _take_tags(self, tags):
        """Note the nodes' tags; refuse those that no table by tag could hold."""
        self.nodes, self._node_tags = len(tags), np.sort(tags)
        if not self.nodes:
            raise BadFile(self._path, "$Nodes", "has no nodes")
        if np.any(np.diff(self._node_tags) == 0):
            raise BadFile(self._path, "$Nodes", "has a tag twice")
        least, most = int(self._node_tags[0]), int(self._node_tags[-1])
        if least < 1 or most > 1000 + LARGEST_TAG_SHARE * self.nodes:
            raise BadFile(self._path, "$Nodes", f"has tags from {least} to {most}")

    def _check_nodes(self, kind, tags):
        """Refuse elements of nodes that are not there."""
        if self._node_tags is None:
            raise BadFile(self._path, "$Elements", "comes before $Nodes")
        if not np.all(np.isin(tags, self._node_tags)):
            bad = int(np.asarray(tags)[np.argmin(np.isin(tags, self._node_tags))])
            raise BadFile(self._path, "$Elements", f"names node {bad}, which is not in $Nodes")

    def _size_of(self, kind):
        """Nodes of a kind of element."""
        if kind not in NODES_OF:
            raise BadFile(
                self._path,
                "$Elements",
                f"has elements of kind {kind}; a sheet has points (15), lines (1), triangles (2) "
                "and quadrangles (3)",
            )
        return NODES_OF[kind]

    def _walk_elements_41(self, cursor):
        blocks, total, _, _ = cursor.sizes(4)
        found = 0
        for _ in range(blocks):
            dimension, entity, kind = cursor.whole(3)
            if self._entities is not None and (dimension, entity) not in self._entities:
                raise BadFile(
                    self._path, "$Elements", f"names entity {entity} of dimension {dimension}"
                )
            size = self._size_of(kind)
            if dimension != {1: 0, 2: 1}.get(size, 2):
                raise BadFile(self._path, "$Elements", f"has kind {kind} in dimension {dimension}")
            (count,) = cursor.sizes(1)
            rows = np.reshape(cursor.sizes(count * (1 + size)), (count, 1 + size))
            self._check_nodes(kind, rows[:, 1:].ravel())
            found += count
        if found != total:
            raise BadFile(self._path, "$Elements", f"says {total} elements and has {found}")

    def _walk_elements_22(self, cursor):
        (total,) = cursor.line_count()
        lines, found = [str(total)], 0
        while found < total:
            if self._binary:
                kind, count, marks = cursor.whole(3)
            else:
                number, kind, marks = cursor.whole(3)
                count = 1
            size = self._size_of(kind)
            if not (1 <= count <= total - found and 0 <= marks <= 100):
                raise BadFile(self._path, "$Elements", f"has a block of {count} with {marks} tags")
            row = cursor.whole(count * (self._binary + marks + size))
            self._check_nodes(kind, np.reshape(row, (count, -1))[:, -size:].ravel())
            if not self._binary:
                lines.append(" ".join(map(str, [number, kind, marks, *row])))
            found += count
        # Here meshio counts lines, not numbers.
        return "\n".join(lines).encode()


class _Words:
    """Numbers of a section in text, taken one after the other."""

    def __init__(self, path, place, content):
        self._path, self._place = path, place
        self.words, self._at = content.split(), 0

    def _take(self, count, kind):
        count = int(count)
        if count > len(self.words) - self._at:
            raise BadFile(self._path, self._place, "ends before the numbers that its counts say")
        words = self.words[self._at : self._at + count]
        self._at += count
        try:
            # Python takes 1_0 for 10, others do not.
            return [kind(word if b"_" not in word else b"?") for word in words]
        except ValueError:
            bad = next(word for word in words if b"_" in word or not _is(kind, word))
            told = shown(bad.decode("ascii", "replace"))
            raise BadFile(self._path, self._place, f"has {told} where a number must be") from None

    def whole(self, count):
        """Whole numbers of 32 bits."""
        found = self._take(count, int)
        if any(abs(x) >= 2**31 for x in found):
            raise BadFile(self._path, self._place, "has a whole number of more than 32 bits")
        return found

    def sizes(self, count):
        """Counts and tags: whole numbers >= 0."""
        found = self._take(count, int)
        if any(not 0 <= x < 2**53 for x in found):
            raise BadFile(self._path, self._place, "has a count or tag that is out of range")
        return found

    def real(self, count):
        """Real numbers."""
        return self._take(count, float)

    def line_count(self):
        """The count at the head of a section of version 2.2."""
        return self.sizes(1)

    def records(self, count, _, reals):
        """First numbers of `count` records of a whole number and some real ones."""
        found = []
        for _ in range(count):
            found += self.whole(1)
            self.real(reals)
        return found

    def skip(self):
        """Take what is left."""
        self._at = len(self.words)

    def finish(self):
        """Refuse a section that holds more than its counts say."""
        if self._at != len(self.words):
            raise BadFile(self._path, self._place, "holds more than its counts say")


def _is(kind, word):
    try:
        kind(word)
        return True
    except ValueError:
        return False


class _Bytes:
    """Numbers of a section in binary, taken one after the other; `at` is the place in the file."""

    def __init__(self, path, place, content, at):
        self._path, self._place, self._content, self.at = path, place, content, at

    def _take(self, count, kind):
        size = int(count) * np.dtype(kind).itemsize
        if size > len(self._content) - self.at:
            raise BadFile(self._path, self._place, "ends before the numbers that its counts say")
        found = np.frombuffer(self._content, kind, int(count), self.at)
        self.at += size
        return found

    def whole(self, count):
        """Whole numbers of 32 bits."""
        return self._take(count, "<i4").tolist()

    def sizes(self, count):
        """Counts and tags: whole numbers >= 0."""
        found = self._take(count, "<u8")
        if np.any(found >= 2**53):
            raise BadFile(self._path, self._place, "has a count or tag that is out of range")
        return found.tolist()

    def real(self, count):
        """Real numbers."""
        return self._take(count, "<f8")

    def line_count(self):
        """The count at the head of a section of version 2.2, which is text."""
        stop = self._content.find(b"\n", self.at, self.at + 40)
        word = self._content[self.at : stop].strip()
        if stop < 0 or not word.isdigit():
            raise BadFile(self._path, self._place, "does not begin with a count")
        self.at = stop + 1
        return [int(word)]

    def records(self, count, whole, reals):
        """First numbers of `count` records of a whole number and some real ones."""
        return self._take(count, [("tag", whole), ("at", "<f8", (reals,))])["tag"].tolist()

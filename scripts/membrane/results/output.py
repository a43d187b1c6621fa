# SPDX-License-Identifier: GPL-2.0-or-later
"""Files of results: ParaView time series of a mesh, and a table of scalars over time."""

import csv
import io
import math
import os
import re
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkObject, vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_LINE, VTK_TRIANGLE, vtkCellArray, vtkUnstructuredGrid
from vtkmodules.vtkCommonMisc import vtkErrorCode
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

from ..files import BadFile, add_to_sum, flush, is_value, named, read_text, replace_text, write_json
from .history import read_history  # noqa: F401  (belongs to HistoryWriter; free of VTK)


class NotFinite(ValueError):
    """A result that is no finite number."""


CELL_TYPES = {2: VTK_LINE, 3: VTK_TRIANGLE}
PVD_HEAD = '<VTKFile type="Collection" version="1.0">\n<Collection>\n'
PVD_FOOT = "</Collection>\n</VTKFile>\n"


class VtkSeries:
    """Time series of one set of cells: a .vtu file for each frame and a .pvd file of times.

    Open `folder`/`name`.pvd in ParaView. It is complete after each frame, so it can be read at any
    time, also after a crash. Write the film's triangles and its lines (sides, creases, tethers) as
    two series.

    The folder is made if missing; files of an earlier series of this name are removed, but for
    frames at `times` [s], which this one continues. `cells`, (M, 2) or (M, 3), are node ids of
    lines or of triangles, the same in all frames.
    """

    def __init__(self, folder: str | Path, name: str, cells: np.ndarray, times: Any = ()) -> None:
        cells = np.asarray(cells)
        if cells.ndim != 2 or cells.shape[1] not in CELL_TYPES:
            raise ValueError(f"cells of shape {cells.shape}: must be (M, 2) or (M, 3)")
        self.folder, self.name, self.cells = Path(folder), name, cells
        self.frames = [(time, _frame_file(name, i)) for i, time in enumerate(times)]
        self._cell_array = cell_array(cells)
        self._sum, self._settled = sha256(), 0  # of the first frames
        self.folder.mkdir(parents=True, exist_ok=True)
        kept = {file for _, file in self.frames}
        of_this_name = re.compile(re.escape(name) + r"_\d{6,}\.vtu")
        for earlier in self.folder.iterdir():
            if of_this_name.fullmatch(earlier.name) and earlier.name not in kept:
                earlier.unlink()
        if kept:
            self._list_frames()

    def write(self, time: float, positions: np.ndarray, cell_data: dict | None = None) -> None:
        """Append a frame at a `time` [s] later than that of the one before; returns its .vtu Path.

        `positions` (N, 3) [m] are of the nodes; `cell_data` has values (M,) or vectors (M, 3) at
        the cells by name, for instance `area_strain`. NotFinite, a ValueError, if one is no
        finite number.
        """
        if self.frames and time <= self.frames[-1][0]:
            raise ValueError(f"time = {time} s: must be > {self.frames[-1][0]} s, the last frame's")
        points = vtkPoints()
        points.SetData(numpy_to_vtk(_finite("positions", positions), deep=True))
        grid = vtkUnstructuredGrid()
        grid.SetPoints(points)
        grid.SetCells(CELL_TYPES[self.cells.shape[1]], self._cell_array)
        for label, values in (cell_data or {}).items():
            if np.shape(values) not in ((len(self.cells),), (len(self.cells), 3)):
                raise ValueError(
                    f"cell_data[{label!r}] of shape {np.shape(values)}: "
                    f"must be ({len(self.cells)},) or ({len(self.cells)}, 3), one for each cell"
                )
            array = numpy_to_vtk(_finite(label, values), deep=True)
            array.SetName(label)
            grid.GetCellData().AddArray(array)
        path = self.folder / _frame_file(self.name, len(self.frames))
        _write_grid(grid, path)
        self.frames.append((float(time), path.name))
        self._list_last_frame()
        return path

    def state(self) -> dict:
        """What it takes to go on with the series, ready for JSON; all frames are on the disk then.

        Gives the frames' `times` [s] and the checksum `sum` of their files.
        """
        for _, name in self.frames[self._settled :]:
            flush(self.folder / name)
            add_to_sum(self._sum, self.folder / name)
        self._settled = len(self.frames)
        flush(self.folder)
        return {"times": [time for time, _ in self.frames], "sum": self._sum.hexdigest()}

    def positions(self, number: int) -> np.ndarray:
        """Positions (N, 3) [m] of the nodes in a frame, double, read back from its file."""
        return read_frame(self.folder / self.frames[number][1])[0].copy()

    def _list_last_frame(self):
        """Add the last frame to the .pvd file, over its closing lines and in one piece.

        Replacing the file would be safe, too, but some file systems wait for the disk then.
        """
        if len(self.frames) == 1:
            self._list_frames()
            return
        path = self.folder / f"{self.name}.pvd"
        with named(path), open(path, "r+b") as stream:
            stream.seek(-len(PVD_FOOT), os.SEEK_END)
            stream.write((_pvd_line(*self.frames[-1]) + PVD_FOOT).encode())

    def _list_frames(self):
        """Replace the .pvd file by one that lists all frames."""
        lines = "".join(_pvd_line(*frame) for frame in self.frames)
        replace_text(self.folder / f"{self.name}.pvd", PVD_HEAD + lines + PVD_FOOT)


def _frame_file(name, number):
    """Name of the file of a frame of a series."""
    return f"{name}_{number:06d}.vtu"


def is_whole_series(folder: str | Path, name: str, state: dict) -> bool:
    """Whether all frames are there that the `state` of a VtkSeries tells of, as they were then."""
    checksum = sha256()
    try:
        for number in range(len(state["times"])):
            add_to_sum(checksum, folder / _frame_file(name, number))
    except OSError:
        return False
    return checksum.hexdigest() == state["sum"]


def _pvd_line(time, file):
    """What a .pvd file says of a frame."""
    return f'<DataSet timestep="{time!r}" part="0" file={quoteattr(file)}/>\n'


class HistoryWriter:
    """Table of scalars over time as .csv: a line of names, then a line for each call of `write`.

    Each line reaches the file at once. The `units` by column name, in the order of the columns, "-"
    for none, go to a .units.json file of the same stem. The file at `path` is overwritten, unless
    there is a `state`: what `state()` gave of an earlier table, which this one continues.
    """

    def __init__(self, path: str | Path, units: dict[str, str], state: dict | None = None) -> None:
        self.path, self.columns = Path(path), tuple(units)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        write_json(self.path.with_suffix(".units.json"), units)
        self._file = open(self.path, "r+b" if state else "wb")
        self._size, self._sum = state["size"] if state else 0, sha256()
        if state:
            add_to_sum(self._sum, self.path, self._size)
            self._file.truncate(self._size)
            self._file.seek(self._size)
        else:
            self._line(self.columns)

    def state(self) -> dict:
        """What it takes to go on with the table, ready for JSON; all of it is on the disk then.

        Gives its `size` [bytes] and its checksum `sum`.
        """
        os.fsync(self._file.fileno())
        flush(self.path.parent)
        return {"size": self._size, "sum": self._sum.hexdigest()}

    def write(self, values: dict) -> None:
        """Append a line; `values` gives a finite number for every column by name.

        ValueError if a column is missing or unknown; NotFinite, if its value is no finite number.
        """
        wrong = sorted(set(values) ^ set(self.columns))
        if wrong:
            raise ValueError(f"columns missing or unknown in {self.path.name}: {', '.join(wrong)}")
        row = [float(values[name]) for name in self.columns]
        for name, value in zip(self.columns, row):
            if not math.isfinite(value):
                raise NotFinite(f"{name} = {value}: must be finite, in {self.path.name}")
        self._line(map(repr, row))

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> "HistoryWriter":
        return self

    def __exit__(self, *error: Any) -> None:
        self.close()

    def _line(self, fields):
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerow(fields)
        line = text.getvalue().encode()
        with named(self.path):
            self._file.write(line)
            self._file.flush()
        self._size += len(line)
        self._sum.update(line)


def is_whole_table(path: str | Path, state: dict) -> bool:
    """Whether a table holds what the `state` of a HistoryWriter tells of, as it was then."""
    try:
        return add_to_sum(sha256(), path, state["size"]).hexdigest() == state["sum"]
    except OSError:
        return False


def list_series(path: str | Path) -> list[tuple[float, Path]]:
    """Times [s] and .vtu files of a .pvd file of VtkSeries: list of (float, Path), not empty.

    BadFile if it is no list of files in its own folder at rising times.
    """
    path = Path(path)
    try:
        items = list(ElementTree.fromstring(read_text(path)).iter("DataSet"))
    except ElementTree.ParseError as error:
        raise BadFile(path, "", f"is no XML: {error}") from None
    series: list = []
    for number, item in enumerate(items):
        time, name = item.get("timestep", ""), item.get("file", "")
        if not is_value(time) or not name or Path(name).name != name:
            raise BadFile(path, f"shape {number}", "must have a finite time and the name of a file")
        if series and float(time) <= series[-1][0]:
            raise BadFile(path, f"shape {number}", "must be later than the one before")
        series.append((float(time), path.parent / name))
    if not series:
        raise BadFile(path, "", "lists no shapes")
    return series


def read_frame(path: str | Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Positions (N, 3) [m] and cell data, (M,) by name, of a .vtu file of VtkSeries."""
    grid = _read_grid(path)
    data = grid.GetCellData()
    arrays = [data.GetArray(i) for i in range(data.GetNumberOfArrays())]
    fields = {array.GetName(): vtk_to_numpy(array) for array in arrays}
    return vtk_to_numpy(grid.GetPoints().GetData()), fields


def read_cells(path: str | Path, corners: int) -> np.ndarray:
    """Node ids (M, `corners`) of the cells of a .vtu file of VtkSeries; BadFile if they differ."""
    grid = _read_grid(path)
    count, nodes = grid.GetNumberOfCells(), grid.GetNumberOfPoints()
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    if len(cells) != corners * count or cells.min() < 0 or cells.max() >= nodes:
        raise BadFile(path, "", f"must hold cells of {corners} of its {nodes} nodes each")
    return cells.reshape(count, corners)


def _read_grid(path):
    """The grid of a .vtu file, read by VTK, which says nothing itself."""
    if not Path(path).is_file():
        raise FileNotFoundError(f"{path}: there is no such file")
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(os.fsencode(path))
    with _silent():
        reader.Update()
    grid = reader.GetOutput()
    if not grid.GetNumberOfPoints() or not grid.GetNumberOfCells():
        raise BadFile(path, "", "could not be read")
    return grid


@contextmanager
def _silent():
    """VTK says nothing itself."""
    said = vtkObject.GetGlobalWarningDisplay()
    vtkObject.GlobalWarningDisplayOff()
    try:
        yield
    finally:
        vtkObject.SetGlobalWarningDisplay(said)


def cell_array(cells: np.ndarray) -> Any:
    """Rows of node ids (M, n) as a vtkCellArray."""
    offsets = np.arange(0, cells.size + 1, cells.shape[1], dtype=np.int64)
    array = vtkCellArray()
    array.SetData(
        numpy_to_vtkIdTypeArray(offsets, deep=True),
        numpy_to_vtkIdTypeArray(cells.astype(np.int64).ravel(), deep=True),
    )
    return array


def _write_grid(grid, path):
    """Write a grid as a .vtu file in binary; raise OSError if that fails."""
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(os.fsencode(path))
    writer.SetInputData(grid)
    # LZ4 would take a fifth of the time, but meshio does not read it.
    writer.SetCompressorTypeToZLib()
    writer.SetCompressionLevel(1)
    writer.EncodeAppendedDataOff()  # bytes as they are, not as base64
    with _silent():
        writer.Write()
    code = writer.GetErrorCode()  # which Write itself takes for success
    if code:
        reason = vtkErrorCode.GetStringFromErrorCode(code)
        raise OSError(f"{path}: could not be written: {reason}")


def _finite(name, values):
    """`values` as a contiguous array; raise NotFinite if one is not."""
    values = np.ascontiguousarray(values)
    if not np.all(np.isfinite(values)):
        raise NotFinite(f"{name}: has values that are not finite")
    return values

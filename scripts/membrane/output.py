# SPDX-License-Identifier: GPL-2.0-or-later
"""Files of results: ParaView time series of a mesh, and a table of scalars over time."""

import csv
import json
import math
import os
from pathlib import Path
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_LINE, VTK_TRIANGLE, vtkCellArray, vtkUnstructuredGrid
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

CELL_TYPES = {2: VTK_LINE, 3: VTK_TRIANGLE}
PVD_HEAD = '<VTKFile type="Collection" version="1.0">\n<Collection>\n'
PVD_FOOT = "</Collection>\n</VTKFile>\n"


class VtkSeries:
    """Time series of one set of cells: a .vtu file for each frame and a .pvd file of times.

    Open `folder`/`name`.pvd in ParaView. It is complete after each frame, so it can be read at any
    time, also after a crash. Write the film's triangles and its lines (sides, creases, tethers)
    as two series.

    Parameters
    ----------
    folder : path
        Made if missing.
    name : str
        Stem of the files; those of an earlier series of this name are removed.
    cells : (M, 2) or (M, 3) int
        Node ids of lines or of triangles, the same in all frames.
    """

    def __init__(self, folder, name, cells):
        cells = np.asarray(cells)
        if cells.ndim != 2 or cells.shape[1] not in CELL_TYPES:
            raise ValueError(f"cells of shape {cells.shape}: must be (M, 2) or (M, 3)")
        self.folder, self.name, self.cells = Path(folder), name, cells
        self._cell_array = cell_array(cells)
        self.frames = []
        self.folder.mkdir(parents=True, exist_ok=True)
        for earlier in self.folder.glob(f"{name}_*.vtu"):
            earlier.unlink()

    def write(self, time, positions, cell_data=None):
        """Append a frame.

        Parameters
        ----------
        time : float
            Time [s], later than that of the frame before.
        positions : (N, 3) float
            Positions of the nodes [m].
        cell_data : dict of (M,) float or int, optional
            Values at the cells by name, for instance `area_strain`.

        Returns
        -------
        Path
            The .vtu file.
        """
        if self.frames and time <= self.frames[-1][0]:
            raise ValueError(f"time = {time} s: must be > {self.frames[-1][0]} s, the last frame's")
        points = vtkPoints()
        points.SetData(numpy_to_vtk(_finite("positions", positions), deep=True))
        grid = vtkUnstructuredGrid()
        grid.SetPoints(points)
        grid.SetCells(CELL_TYPES[self.cells.shape[1]], self._cell_array)
        for label, values in (cell_data or {}).items():
            if np.shape(values) != (len(self.cells),):
                raise ValueError(
                    f"cell_data[{label!r}] of shape {np.shape(values)}: "
                    f"must be ({len(self.cells)},), one for each cell"
                )
            array = numpy_to_vtk(_finite(label, values), deep=True)
            array.SetName(label)
            grid.GetCellData().AddArray(array)
        path = self.folder / f"{self.name}_{len(self.frames):06d}.vtu"
        _write_grid(grid, path)
        self.frames.append((float(time), path.name))
        self._list_last_frame()
        return path

    def _list_last_frame(self):
        """Add the last frame to the .pvd file, over its closing lines and in one piece.

        Replacing the file would be safe, too, but some file systems wait for the disk then.
        """
        time, file = self.frames[-1]
        line = f'<DataSet timestep="{time!r}" part="0" file={quoteattr(file)}/>\n'
        collection = self.folder / f"{self.name}.pvd"
        if len(self.frames) == 1:
            _replace(collection, PVD_HEAD + line + PVD_FOOT)
            return
        with open(collection, "r+b") as stream:
            stream.seek(-len(PVD_FOOT), os.SEEK_END)
            stream.write((line + PVD_FOOT).encode())


class HistoryWriter:
    """Table of scalars over time as .csv: a line of names, then a line for each call of `write`.

    Each line reaches the file at once. The units go to a .units.json file of the same stem.

    Parameters
    ----------
    path : path
        The .csv file; overwritten.
    units : dict of str
        Unit by column name, in the order of the columns; "-" for none.
    """

    def __init__(self, path, units):
        self.path, self.columns = Path(path), tuple(units)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        _replace(self.path.with_suffix(".units.json"), json.dumps(units, indent=2) + "\n")
        self._file = open(self.path, "w", newline="")
        self._line(self.columns)

    def write(self, values):
        """Append a line; `values` gives a finite number for every column by name.

        Raises
        ------
        ValueError
            If a column is missing or unknown, or its value is no finite number.
        """
        wrong = sorted(set(values) ^ set(self.columns))
        if wrong:
            raise ValueError(f"columns missing or unknown in {self.path.name}: {', '.join(wrong)}")
        row = [float(values[name]) for name in self.columns]
        for name, value in zip(self.columns, row):
            if not math.isfinite(value):
                raise ValueError(f"{name} = {value}: must be finite, in {self.path.name}")
        self._line(map(repr, row))

    def close(self):
        """Close the file."""
        self._file.close()

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.close()

    def _line(self, fields):
        csv.writer(self._file, lineterminator="\n").writerow(fields)
        self._file.flush()


def list_series(path):
    """Times [s] and .vtu files of a .pvd file of VtkSeries: list of (float, Path)."""
    items = ElementTree.parse(path).iter("DataSet")
    return [(float(item.get("timestep")), Path(path).parent / item.get("file")) for item in items]


def read_frame(path):
    """Positions (N, 3) [m] and cell data, (M,) by name, of a .vtu file of VtkSeries."""
    if not Path(path).is_file():
        raise FileNotFoundError(f"{path}: there is no such file")
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    if not grid.GetNumberOfPoints():
        raise OSError(f"{path}: could not be read")
    data = grid.GetCellData()
    arrays = [data.GetArray(i) for i in range(data.GetNumberOfArrays())]
    fields = {array.GetName(): vtk_to_numpy(array) for array in arrays}
    return vtk_to_numpy(grid.GetPoints().GetData()), fields


def read_history(path):
    """Columns of a .csv file of HistoryWriter: dict of (S,) float by name."""
    with open(path, newline="") as file:
        names, *rows = csv.reader(file)
    table = np.array(rows, dtype=float).reshape(-1, len(names))
    return {name: table[:, i] for i, name in enumerate(names)}


def cell_array(cells):
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
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.SetCompressorTypeToLZ4()  # a fifth of zlib's time, somewhat larger
    writer.EncodeAppendedDataOff()  # bytes as they are, not as base64
    if writer.Write() != 1:
        raise OSError(f"{path}: could not be written")


def _finite(name, values):
    """`values` as a contiguous array; raise ValueError if one is not finite."""
    values = np.ascontiguousarray(values)
    if not np.all(np.isfinite(values)):
        raise ValueError(f"{name}: has values that are not finite")
    return values


def _replace(path, text):
    """Write a text file so that readers see either the old one or the new one."""
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    os.replace(part, path)

# SPDX-License-Identifier: GPL-2.0-or-later
"""Animation of a run as sail.mp4 and sail.gif, rendered off-screen from its ParaView series.

VTK draws into the memory of a virtual X server (Xvfb), so no screen is needed; ffmpeg makes films
of the pictures. One picture for each shape of the run: none is made up between two shapes.
"""

import contextlib
import os
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from math import cos, radians, sin
from pathlib import Path

import numpy as np
import vtkmodules.vtkRenderingFreeType  # noqa: F401, text
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401, makes windows that draw
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkCylinderSource, vtkSphereSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkActor2D, vtkLight, vtkPolyDataMapper
from vtkmodules.vtkRenderingCore import vtkPolyDataMapper2D, vtkProperty, vtkRenderer
from vtkmodules.vtkRenderingCore import vtkRenderWindow, vtkTextActor

from ..files import replacing
from ..results import own
from ..results.finished_run import FinishedRun, read_run
from ..results.output import cell_array, read_frame
from .plots import FILM, SPOOL, VIEW

FILES = ("sail.mp4", "sail.gif")
SIZE = (1280, 720)  # of the film [pixels]
RATE = 25  # pictures a second
GIF_LARGEST = 3e6  # [bytes]
GIF_PICTURES = 101
GIF_WIDTHS = (480, 400, 320, 240)  # tried in turn [pixels]

UNDERSIDE = (0.74, 0.77, 0.82)
INK = (0.12, 0.15, 0.20)
FOLD_LINE = (0.45, 0.28, 0.10)
MARK = (0.92, 0.93, 0.95)
PAPER, SKY = (0.96, 0.97, 0.98), (0.84, 0.88, 0.93)  # background, bottom and top
LINE_WIDTH = 2  # of fold lines and tethers [pixels]
MARGIN = 1.1  # of the view beyond what it shows
TIP_RADIUS = 0.014  # as drawn, over half the view's diagonal; a tip mass has no size in the model


def animate(folder: Path | str) -> list[Path]:
    """Render `folder`/sail.mp4 and sail.gif of a run's output folder; returns the films.

    From its shapes and summary.json. RuntimeError if Xvfb or ffmpeg are missing or fail.
    """
    folder = Path(folder)
    for program, package in {"Xvfb": "xvfb", "ffmpeg": "ffmpeg"}.items():
        if not shutil.which(program):
            raise RuntimeError(f"no animation without {program} (apt-get install {package})")
    run = read_run(folder)
    own.add_to_list(folder, FILES)
    films = [folder / name for name in FILES]
    with replacing(films[0]) as film, replacing(films[1]) as gif:
        with virtual_display(), contextlib.closing(Stage(run)) as stage:
            _encode(film, (stage.picture(i) for i in range(len(run.shapes))))
        _write_gif(film, gif, len(run.shapes))
    return films


@contextlib.contextmanager
def virtual_display() -> Iterator[None]:
    """An X server without a screen, as DISPLAY, as long as the context lasts."""
    reading, writing = os.pipe()
    command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", "1280x1024x24"]
    server = subprocess.Popen(
        [*command, "-nolisten", "tcp"],
        pass_fds=[writing],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # Ctrl-C is for us: Xlib would end the process if the server went
    )
    os.close(writing)
    before = os.environ.get("DISPLAY")
    try:
        with os.fdopen(reading, encoding="utf-8") as answer:
            number = answer.readline().strip()
        if not number:
            raise RuntimeError(f"Xvfb ended with status {server.wait()}")
        os.environ["DISPLAY"] = f":{number}"
        yield
    finally:
        os.environ.pop("DISPLAY", None)
        if before is not None:
            os.environ["DISPLAY"] = before
        server.terminate()
        server.wait()


class Stage:
    """The scene in VTK: sail, tethers, tip masses, spool, time and scale bar.

    The projection is parallel, so that the scale bar holds for all lengths across the view.
    """

    def __init__(self, run: FinishedRun) -> None:
        self.run, self.shapes = run, run.shapes
        times = [time for time, _ in run.shapes]
        self.turned = run.turned(times)
        self.points = vtkPoints()
        self.points.SetNumberOfPoints(len(read_frame(run.shapes[0][1])[0]))
        self.turn = vtkTransform()
        self.renderer = vtkRenderer()
        self.renderer.GradientBackgroundOn()
        self.renderer.SetBackground(PAPER)
        self.renderer.SetBackground2(SKY)
        self.window = vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(4)
        self.window.SetSize(*SIZE)
        self.window.AddRenderer(self.renderer)
        self._add_film()
        self._add_lines(run.creases, FOLD_LINE)
        self._add_lines(run.cables, INK)
        if run.spool:
            self._add_spool()
        self._add_light()
        reach = self._aim()
        self._add_tips(TIP_RADIUS * reach)
        self._add_scale_bar()
        self.clock = self._add_text("", 40, (0.03, 0.90))
        if pace(times):
            self._add_text(pace(times), 22, (0.03, 0.85))

    def picture(self, i: int) -> np.ndarray:
        """Shape number `i` as an image (height, width, 3) of bytes, top row first."""
        time, path = self.shapes[i]
        positions, _ = read_frame(path)
        self.points.SetData(numpy_to_vtk(positions, deep=True))
        self.points.Modified()
        for ball, tip in zip(self.tips, self.run.tips):
            ball.SetPosition(positions[tip])
        self.turn.Identity()
        self.turn.RotateZ(np.degrees(self.turned[i]))
        self.clock.SetInput(f"t = {time:.3f} s")
        self.window.Render()
        pixels = vtkUnsignedCharArray()
        width, height = SIZE
        self.window.GetPixelData(0, 0, width - 1, height - 1, 0, pixels, 0)
        return vtk_to_numpy(pixels).reshape(height, width, 3)[::-1]

    def close(self) -> None:
        """Give the window back; the X server must not end before."""
        self.window.Finalize()

    def _surface(self, source, colour):
        """Add what `source` makes, in one colour, and return its actor."""
        mapper = vtkPolyDataMapper()
        if isinstance(source, vtkPolyData):
            mapper.SetInputData(source)
        else:
            mapper.SetInputConnection(source.GetOutputPort())
        actor = vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().SetColor(*colour)
        actor.GetProperty().SetAmbient(0.2)
        self.renderer.AddActor(actor)
        return actor

    def _add_film(self):
        film = vtkPolyData()
        film.SetPoints(self.points)
        film.SetPolys(cell_array(self.run.triangles))
        actor = self._surface(film, FILM)
        # Lines on the film lie in front of it.
        actor.GetMapper().SetResolveCoincidentTopologyToPolygonOffset()
        top, under = actor.GetProperty(), vtkProperty()
        for face, colour in ((top, FILM), (under, UNDERSIDE)):
            face.SetColor(*colour)
            face.SetInterpolationToFlat()
            face.SetAmbient(0.3)
            face.SetDiffuse(0.65)
            face.SetSpecular(0.15)
            face.SetSpecularPower(12)
        actor.SetBackfaceProperty(under)

    def _add_lines(self, pairs, colour):
        lines = vtkPolyData()
        lines.SetPoints(self.points)
        lines.SetLines(cell_array(pairs))
        look = self._surface(lines, colour).GetProperty()
        look.SetLineWidth(LINE_WIDTH)
        look.RenderLinesAsTubesOn()  # plain lines sink into film that is seen at a slant
        look.LightingOff()

    def _add_tips(self, radius):
        ball = vtkSphereSource()
        ball.SetRadius(radius)
        ball.SetThetaResolution(24)
        ball.SetPhiResolution(16)
        self.tips = [self._surface(ball, INK) for _ in self.run.tips]
        for actor in self.tips:
            actor.GetProperty().SetSpecular(0.4)

    def _add_spool(self):
        """A cylinder about the axis, with a mark by which one sees it turn."""
        radius, height = self.run.spool or (0.0, 0.0)
        body = vtkCylinderSource()
        body.SetRadius(radius)
        body.SetHeight(height)
        body.SetResolution(72)
        mark = vtkCubeSource()
        mark.SetCenter(0.52 * radius, 0, 0)
        mark.SetXLength(radius)
        mark.SetYLength(radius / 8)
        mark.SetZLength(1.01 * height)
        upright = vtkTransform()
        upright.SetInput(self.turn)
        upright.RotateX(90)  # VTK's cylinders stand along y
        self._surface(body, SPOOL).SetUserTransform(upright)
        self._surface(mark, MARK).SetUserTransform(self.turn)

    def _add_light(self):
        """Light from beside the viewer, so that folds stand out."""
        self.renderer.AutomaticLightCreationOff()
        light = vtkLight()
        light.SetLightTypeToCameraLight()
        light.SetPosition(-1.2, 1.0, 0.6)
        light.SetFocalPoint(0, 0, 0)
        self.renderer.AddLight(light)
        fill = vtkLight()
        fill.SetLightTypeToHeadlight()
        fill.SetIntensity(0.25)
        self.renderer.AddLight(fill)

    def _aim(self):
        """Look as in shapes.png, at what the sail and the spool reach in all the shapes.

        Returns half the diagonal [m] of what is seen.
        """
        elevation, azimuth = radians(VIEW["elev"]), radians(VIEW["azim"])
        towards = np.array(
            [cos(elevation) * cos(azimuth), cos(elevation) * sin(azimuth), sin(elevation)]
        )
        right = np.array([-sin(azimuth), cos(azimuth), 0])
        screen = np.array([right, np.cross(towards, right)])  # right and up
        low, high = self._spool_extent(elevation) if self.run.spool else (np.inf, -np.inf)
        for _, path in self.shapes:
            places = read_frame(path)[0] @ screen.T
            low, high = np.minimum(low, places.min(axis=0)), np.maximum(high, places.max(axis=0))
        half = (high - low) / 2
        half += TIP_RADIUS * np.hypot(*half)
        reach = np.hypot(*half)
        focus = (low + high) / 2 @ screen
        camera = self.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetPosition(*(focus + 4 * reach * towards))
        camera.SetFocalPoint(*focus)
        camera.SetViewUp(0, 0, 1)
        camera.SetParallelScale(MARGIN * max(half[1], half[0] * SIZE[1] / SIZE[0]))
        camera.SetClippingRange(0.5 * reach, 8 * reach)
        return reach

    def _spool_extent(self, elevation):
        """Lower left and upper right (2,) [m] of the spool seen from an elevation [rad]."""
        radius, height = self.run.spool or (0.0, 0.0)
        corner = np.array([radius, height / 2 * cos(elevation) + radius * sin(elevation)])
        return -corner, corner

    def _add_scale_bar(self):
        """A bar of 1, 2 or 5 times a power of ten, at most a fifth of the picture wide."""
        per_metre = SIZE[1] / (2 * self.renderer.GetActiveCamera().GetParallelScale())
        widest = SIZE[0] / 5
        power = 10 ** np.floor(np.log10(widest / per_metre))
        length = max(step * power for step in (1, 2, 5) if step * power * per_metre <= widest)
        left, low, wide, line = 0.03 * SIZE[0], 0.06 * SIZE[1], length * per_metre, 3
        first, last = line / 2, wide - line / 2  # up to the outer edges of the lines
        corners = [(first, 9), (first, 0), (last, 0), (last, 9)]
        points = vtkPoints()
        for x, y in corners:
            points.InsertNextPoint(left + x, low + y, 0)
        bar = vtkPolyData()
        bar.SetPoints(points)
        bar.SetLines(cell_array(np.array([[0, 1], [1, 2], [2, 3]])))
        mapper = vtkPolyDataMapper2D()
        mapper.SetInputData(bar)
        actor = vtkActor2D()
        actor.SetMapper(mapper)
        actor.GetProperty().SetColor(*INK)
        actor.GetProperty().SetLineWidth(line)
        self.renderer.AddActor2D(actor)
        label = f"{length:g} m" if length >= 1 else f"{1e3 * length:g} mm"
        middle = ((left + wide / 2) / SIZE[0], (low + 14) / SIZE[1])
        self._add_text(label, 22, middle).GetTextProperty().SetJustificationToCentered()

    def _add_text(self, text, size, place):
        """Add text of `size` [pixels] at `place`, in shares of the picture."""
        actor = vtkTextActor()
        actor.SetInput(text)
        actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedDisplay()
        actor.SetPosition(*place)
        actor.GetTextProperty().SetFontSize(size)
        actor.GetTextProperty().SetColor(*INK)
        self.renderer.AddActor2D(actor)
        return actor


def pace(times: Sequence[float]) -> str:
    """How much slower or faster than reality a film of shapes at `times` [s] is, in words.

    Rounded, since intervals are whole steps; empty where it is as fast, or has one shape.
    """
    share = RATE * (times[-1] - times[0]) / max(1, len(times) - 1)
    if share > 1.05:
        return f"speeded up {round(share, 1):g} times"
    return f"slowed down {round(1 / share, 1):g} times" if 0 < share < 0.95 else ""


def _encode(path, pictures):
    """Write an MP4 film of images (height, width, 3) of bytes."""
    width, height = SIZE
    source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(RATE)]
    target = (
        "-c:v libx264 -preset fast -crf 18 -pix_fmt yuv420p -movflags +faststart -f mp4".split()
    )
    encoder = subprocess.Popen(
        _ffmpeg(*source, "-i", "-", *target, path),
        stdin=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    try:
        with contextlib.suppress(BrokenPipeError):  # its message tells more
            assert encoder.stdin
            for picture in pictures:
                encoder.stdin.write(picture.tobytes())
        _, said = encoder.communicate()
    except BaseException:
        encoder.kill()
        encoder.communicate()
        raise
    if encoder.returncode:
        words = said.decode(errors="replace").strip()
        raise RuntimeError(f"ffmpeg failed on {path}: {words[-300:]}")


def _write_gif(film, gif, pictures):
    """Write a GIF of the film, as large as GIF_LARGEST allows, of every n-th picture."""
    skip = -(-pictures // GIF_PICTURES)
    for width in GIF_WIDTHS:
        look = (
            f"select=not(mod(n\\,{skip})),setpts=N/({RATE}/{skip})/TB,"
            f"scale={width}:-2:flags=lanczos,split[a][b];[a]palettegen=max_colors=64[p];"
            "[b][p]paletteuse=dither=bayer:bayer_scale=4"
        )
        command = _ffmpeg("-i", film, "-vf", look, "-r", f"{RATE}/{skip}", "-f", "gif", gif)
        done = subprocess.run(
            command, capture_output=True, encoding="utf-8", errors="replace", start_new_session=True
        )
        if done.returncode:
            raise RuntimeError(f"ffmpeg failed on {gif}: {done.stderr.strip()[-300:]}")
        if gif.stat().st_size <= GIF_LARGEST:
            return


def _ffmpeg(*arguments):
    return ["ffmpeg", "-y", "-loglevel", "error", *map(str, arguments)]

# SPDX-License-Identifier: GPL-2.0-or-later
"""What the tests share: small membranes, forces of a state, the released sail, the main run."""

import atexit
import contextlib
import io
import os
import shutil
import subprocess
import tempfile
import unittest
from functools import lru_cache
from pathlib import Path

import membrane
import numpy as np
from membrane import scene
from membrane.mesh import sail_mesh
from membrane.parameters import SailParameters
from membrane.results.output import read_history
from membrane.run import driver
from membrane.run.sails.sheet import PatternParameters
from membrane.scene import spool
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from yade import config
from yade import wrapper as yade

ROOT = Path(__file__).resolve().parents[1]
# YADE was built with pkg/membrane in its source tree: the classes are its own.
NATIVE = (Path(config.libDir) / "libpkg_membrane.so").exists()
VIEW = hasattr(yade, "GlExtraDrawer")
FULL = "MEMBRANE_FULL_TESTS"
O = yade.Omega()  # noqa: E741, YADE's own name for it


def long(test):
    """Mark a test, or a class of tests, that runs only with --full."""
    return unittest.skipUnless(os.environ.get(FULL), "long; run with --full")(test)


def of_the_plugin(test):
    """Mark a test, or a class of tests, of the extension module, which a YADE tree does without."""
    return unittest.skipIf(NATIVE, "the classes are native")(test)


def of_the_view(test):
    """Mark a test, or a class of tests, of YADE's 3D view, without which a YADE may be built."""
    return unittest.skipUnless(VIEW, "YADE was built without its 3D view")(test)


class SceneTest(unittest.TestCase):
    """A test that starts from an empty scene."""

    def setUp(self):
        O.reset()


class CommandTest(unittest.TestCase):
    """A test of a command of scripts/."""

    def ends_with_one_sentence(self, done, command, *parts):
        """A CompletedProcess of `command` has failed with one sentence that holds all `parts`."""
        self.assertNotIn(done.returncode, (0, None))
        said = [line for line in done.stderr.splitlines() if f"{command}: " in line]
        self.assertEqual(len(said), 1, done.stderr)
        for part in parts:
            self.assertIn(part, said[0])
        self.assertNotIn("Traceback", done.stdout + done.stderr)

    def ends_without_a_run(self, command):
        """`command`, given a folder that holds no run, ends with one sentence about it."""
        done = run_yade(ROOT / "scripts" / f"{command}.py", scratch() / "nowhere")
        self.ends_with_one_sentence(done, command)
        self.assertRegex(done.stderr, f"(?m)^{command}: .*(summary.json|viewer|Xvfb)")


class Sheet:
    """A membrane in the scene, whose forces can be asked for in any state, without motion.

    Attributes
    ----------
    membrane : Membrane
    engine : MembraneForceEngine
        Its attributes may be set between two questions.
    """

    def __init__(self, nodes, triangles=(), *, material=None, engine=None, **options):
        self.rest = np.asarray(nodes, dtype=float)
        self.membrane = scene.add_membrane(self.rest, triangles, material=material, **options)
        self.engine = membrane.MembraneForceEngine(
            membrane=self.membrane, forceTimeStep=True, **(engine or {})
        )
        self.loop = interaction_loop(self.membrane)
        self.states = [O.bodies[i].state for i in self.membrane.bodyIds]
        self.masses = np.array(self.membrane.masses)

    def place(self, positions, velocities=None):
        """Put the nodes at `positions` (N, 3) [m] with `velocities` (N, 3) [m/s], default 0."""
        velocities = np.zeros_like(positions) if velocities is None else velocities
        for state, x, v in zip(self.states, np.asarray(positions).tolist(), velocities.tolist()):
            state.pos, state.vel = x, v
        self.engine.forgetVelocities()
        return self

    def _forces(self, *engines):
        O.engines = [yade.ForceResetter(), *engines]
        O.step()
        return np.array([O.forces.f(i, True) for i in self.membrane.bodyIds])

    def side_forces(self):
        """Forces (N, 3) [N] of the interaction loop: the sides, without damping."""
        return self._forces(self.loop)

    def engine_forces(self):
        """Forces (N, 3) [N] of the engine: creases, damping, drag."""
        return self._forces(self.engine)

    def all_forces(self):
        """Forces (N, 3) [N] of both."""
        return self._forces(self.loop, self.engine)

    def run_engines(self, *, gravity=(0, 0, 0), ledger=False):
        """Set O.engines to those of a run in time; returns the ledger or None."""
        newton = yade.NewtonIntegrator(damping=0, gravity=gravity)
        book = [membrane.MembraneLedger(forces=self.engine, gravity=gravity)] if ledger else []
        O.engines = [yade.ForceResetter(), self.loop, self.engine, newton, *book]
        return book[0] if book else None

    def positions(self):
        """Present positions (N, 3) [m]."""
        return np.array([state.pos for state in self.states])

    def velocities(self):
        """Present velocities (N, 3) [m/s]; they belong to half a step before the positions."""
        return np.array([state.vel for state in self.states])


def interaction_loop(net, *laws):
    """The InteractionLoop of a membrane, with further `laws`."""
    return yade.InteractionLoop(
        [membrane.Ig2_MembraneNode_MembraneNode_MembraneGeom()],
        [membrane.Ip2_MembraneMat_MembraneMat_MembranePhys(membrane=net)],
        [membrane.Law2_MembraneGeom_MembranePhys_Buckling(), *laws],
    )


def unit_film(poisson=0.34, density=1.0):
    """Material with E h = 1 N/m."""
    return scene.film(young=1.0, poisson=poisson, density=density, thickness=1.0)


def rotation(rng):
    """A random rotation matrix (3, 3)."""
    matrix, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return matrix * np.sign(np.linalg.det(matrix))


def grid(cells, length=0.02, jitter=0.0, rng=None):
    """Flat square sheet of `cells` x `cells` squares cut in two: nodes (N, 3) [m], triangles.

    `jitter` moves the nodes in their plane by up to that share of a cell.
    """
    rows = cells + 1
    i, j = np.meshgrid(np.arange(rows), np.arange(rows), indexing="ij")
    nodes = length * np.column_stack([i.ravel(), j.ravel(), np.zeros(rows * rows)])
    if jitter:
        nodes[:, :2] += jitter * length * rng.uniform(-1, 1, size=(len(nodes), 2))
    corner = (i * rows + j)[:-1, :-1].ravel()
    a, b, c, d = corner, corner + rows, corner + rows + 1, corner + 1
    return nodes, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def film_of_the_sail(**parameters):
    """The sail without tethers: mesh, nodes (F, 3) [m]; flat."""
    mesh = sail_mesh(**parameters)
    return mesh, mesh.nodes[: mesh.film_size]


def plane_stress_stiffness(corners, young=1.0, poisson=0.34, thickness=1.0):
    """Stiffnesses (3,) [N/m] of the sides opposite the corners (3, 3) of a triangle.

    Straight from the definition: the springs hold the energy of the film in uniaxial stress
    along each side in turn; strains from the strain tensor, not from the paper's p_ij.
    """
    sides = np.roll(corners, -1, axis=0) - np.roll(corners, -2, axis=0)
    length = np.linalg.norm(sides, axis=1)
    along = sides / length[:, None]
    area = 0.5 * np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0]))
    cosine2 = (along @ along.T) ** 2
    strain = (cosine2 - poisson * (1 - cosine2)) / young
    energy = np.full(3, 0.5 / young * thickness * area)
    return np.linalg.solve(0.5 * (strain * length) ** 2, energy)


def fold_angle(a, b, c, d, valley):
    """Angle [rad] between ABC and BAD in (-pi/2, 3 pi/2]: from the one to the other about AB.

    Seen along AB with C to the right, the film's upper side is up: a valley opens from C upwards.
    """
    along = (b - a) / np.linalg.norm(b - a)
    ahead = (c - a) - along * np.dot(c - a, along)
    ahead /= np.linalg.norm(ahead)
    up = np.cross(along, ahead)
    turn = np.angle(complex(np.dot(d - a, ahead), np.dot(d - a, up)))
    turn = turn if valley else -turn
    return (turn + np.pi / 2) % (2 * np.pi) - np.pi / 2


def engines_by_class():
    """The scene's engines by class name."""
    return {type(engine).__name__: engine for engine in O.engines}


def force_engine():
    """The scene's MembraneForceEngine or MembraneIntegrator."""
    (engine,) = [e for e in O.engines if isinstance(e, membrane.MembraneForceEngine)]
    return engine


def node_states(net):
    """Positions and velocities (2, N, 3) of a membrane's nodes in the scene."""
    states = [O.bodies[i].state for i in net.bodyIds]
    return np.array([[s.pos for s in states], [s.vel for s in states]])


def set_engines(net, *, driven=(), touching=(), gravity=0.0, **values):
    """`scene.set_engines` with SceneParameters of these values; gravity may be a vector [m/s2]."""
    down = gravity if np.isscalar(gravity) else -gravity[2]
    p = scene.SceneParameters(gravity=down, **values)
    made = scene.set_engines(net, p, driven=driven, touching=touching)
    if not np.isscalar(gravity):
        made.newton.gravity = made.ledger.gravity = gravity
    return made


@lru_cache(maxsize=None)
def scratch():
    """A folder that goes away with the process."""
    folder = tempfile.mkdtemp(prefix="membrane-tests-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


@contextlib.contextmanager
def quiet():
    """Keep progress bars off the terminal."""
    with contextlib.redirect_stderr(io.StringIO()):
        yield


def release_sail(threads=None, **changes):
    """Put the paper's sail just after its release into the scene, at its own time step.

    The spin-up is cut short: the state need not be at rest to the last digit. `threads`: of a
    MembraneIntegrator.
    """
    O.reset()
    parameters = SailParameters(spin_up_tolerance=1e-3, **changes)
    made, spinning = driver.build(parameters)
    if threads:
        spinning.forces.ompThreads = threads
    with quiet():
        driver.spin_up(spinning, parameters)
    driver.release(made, spinning, parameters.omega, parameters.dt)


@lru_cache(maxsize=None)
def released_sail(path="law2"):
    """File with the scene of `release_sail`, on one of the scene's paths."""
    release_sail(path=path)
    file = scratch() / f"released_{path}.yade.gz"
    O.save(str(file), quiet=True)
    O.reset()
    return file


class MainRun:
    """The main run at the defaults, done once.

    Attributes
    ----------
    parameters : SailParameters
    folder : Path
    summary : dict
    history : dict of (S,) float
    """

    def __init__(self):
        O.reset()
        self.parameters = SailParameters()
        self.folder = scratch() / "main_run"
        with quiet():
            self.summary = driver.deploy(self.parameters, self.folder, pictures=False, page=False)
        self.history = read_history(self.folder / "history.csv")
        self.phases = np.column_stack([self.history[f"phase_difference_{i}"] for i in range(4)])
        O.reset()


@lru_cache(maxsize=None)
def short_run():
    """Output folder of a run of 0.1 s with 21 shapes."""
    O.reset()
    folder = scratch() / "short_run"
    p = SailParameters(duration=0.1, shapes_interval=5e-3, spin_up_tolerance=1e-2)
    with quiet():
        driver.deploy(p, folder, pictures=False, page=False)
    O.reset()
    return folder


@lru_cache(maxsize=None)
def pattern_run():
    """Output folder of a Miura-ori sheet that flies free for 20 ms, with 5 shapes."""
    O.reset()
    folder = scratch() / "pattern_run"
    file = ROOT / "scripts" / "patterns" / "miura.fold"
    about = {"duration": 0.02, "shapes_interval": 5e-3, "crease_law": "conservative"}
    p = PatternParameters(file=str(file), size=0.0375, omega=60.0, **about)
    with quiet():
        driver.deploy(p, folder, pictures=False, page=False)
    O.reset()
    return folder


@lru_cache(maxsize=None)
def free_hub_run():
    """Output folder of a run of 0.1 s on a light hub that turns freely, with 11 shapes."""
    O.reset()
    folder = scratch() / "free_hub_run"
    p = SailParameters(
        fold_lines=3,
        inner_width=0.15,
        hub_inertia=1e-5,
        gravity=0.0,
        duration=0.1,
        spin_up_tolerance=1e-2,
    )
    with quiet():
        driver.deploy(p, folder, pictures=False, page=False)
    O.reset()
    return folder


def read_grid(path):
    """Points (N, 3), cell data by name and cells (M, n) of a .vtu file, by VTK's own reader."""
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    data = grid.GetCellData()
    values = {
        data.GetArrayName(i): vtk_to_numpy(data.GetArray(i))
        for i in range(data.GetNumberOfArrays())
    }
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    return (
        vtk_to_numpy(grid.GetPoints().GetData()),
        values,
        cells.reshape(grid.GetNumberOfCells(), -1),
    )


@lru_cache(maxsize=None)
def main_run():
    """The MainRun of this process."""
    return MainRun()


def contacts():
    """Number of contacts of tether masses with the spool."""
    return sum(type(i.phys).__name__ == "FrictPhys" and i.isReal for i in O.interactions)


def wind_a_tether(path="law2"):
    """A taut chain that lies on a quarter of the turning spool; its outer end is held."""
    O.reset()
    omega, piece, radius = 40.0, 3e-3, 0.0254
    arc = np.arange(-13, 1) * piece / radius
    on_spool = radius * np.column_stack([np.cos(arc), np.sin(arc), np.zeros_like(arc)])
    away = np.column_stack([np.full(8, radius), np.arange(1, 9) * piece, np.zeros(8)])
    nodes = np.concatenate([on_spool, away])
    cables = [(i, i + 1) for i in range(len(nodes) - 1)]
    tether = scene.add_membrane(0.99 * nodes, [], cables=cables, positions=nodes)
    ids = tether.bodyIds
    made = set_engines(
        tether,
        path=path,
        driven=[*spool.add_spool(), ids[0]],
        touching=ids[1:-1],
        omega=omega,
        zeta=0.3,
    )
    made.hold([0, len(nodes) - 1])
    O.dt = 0.1 * made.forces.criticalTimeStep()
    scene.advance(2000)
    return made


@lru_cache(maxsize=None)
def gmsh_sheet(version=4.1, binary=False, size=0.1, parts=0, **options):
    """A .msh file of gmsh: a square of 0.4 m with a mountain along x = 0, tips and a hub.

    `parts`: into how many it is partitioned; `options` are those of gmsh's Mesh, as SaveAll=1.
    """
    import gmsh

    gmsh.initialize(readConfigFiles=False)
    gmsh.option.setNumber("General.Terminal", 0)
    geo, model = gmsh.model.geo, gmsh.model
    corners = ((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2), (0, -0.2), (0, 0.2), (0, 0))
    p = [geo.addPoint(*place, 0, size) for place in corners]
    ends = ((0, 4), (4, 1), (1, 2), (2, 5), (5, 3), (3, 0), (4, 6), (6, 5))
    lines = [geo.addLine(p[a], p[b]) for a, b in ends]
    left = geo.addCurveLoop([lines[i] for i in (0, 6, 7, 4, 5)])
    right = geo.addCurveLoop([*(lines[i] for i in (1, 2, 3)), -lines[7], -lines[6]])
    faces = [geo.addPlaneSurface([loop]) for loop in (left, right)]
    geo.synchronize()
    groups = (0, p[:4], "tips"), (0, p[6:], "hub"), (1, lines[6:], "mountain"), (2, faces, "film")
    for dimension, tags, name in groups:
        model.setPhysicalName(dimension, model.addPhysicalGroup(dimension, tags), name)
    options = {**options, "MshFileVersion": version, "Binary": binary}
    for name, value in options.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)
    model.mesh.generate(2)
    if parts:
        model.mesh.partition(parts)
    path = scratch() / f"sheet_{size}_{parts}_{'_'.join(map(str, options.values()))}.msh"
    gmsh.write(str(path))
    gmsh.finalize()
    return path


def yade_environment():
    """Environment variables with which `yade` finds this package."""
    package = str(Path(membrane.__file__).parents[1])
    path = os.pathsep.join(filter(None, [package, os.environ.get("PYTHONPATH")]))
    return {**os.environ, "PYTHONPATH": path, "MPLBACKEND": "Agg"}


def run_yade(script, *arguments, threads=1, folder=None, environment=None, **changes):
    """Run `yade -n -x` on a script in `folder`; returns the CompletedProcess, output as text."""
    return subprocess.run(
        ["yade", "-n", "-x", f"-j{threads}", str(script), *map(str, arguments)],
        cwd=folder or scratch(),
        env={**(environment or yade_environment()), **changes},
        capture_output=True,
        text=True,
        timeout=600,
    )

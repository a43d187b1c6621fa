# SPDX-License-Identifier: GPL-2.0-or-later
"""The plugin loads into the YADE for which it was built, and into no other."""

import importlib.machinery
import re
import shlex
import shutil
import subprocess
import sys
import unittest
from pathlib import Path
from unittest.mock import patch

import membrane
import yade.config
from membrane import _layout, _load
from support import ROOT, of_the_plugin, run_yade, scratch
from yade import wrapper

MODULE = f"_membrane{importlib.machinery.EXTENSION_SUFFIXES[0]}"
LATE = """
from yade import utils
from yade.wrapper import *
O = Omega()
O.bodies.append(utils.sphere((0, 0, 0.0148), 0.01))
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()]),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_FrictPhys()],
        [Law2_ScGeom_FrictPhys_CundallStrack()],
    ),
    NewtonIntegrator(),
]
O.dt = 1e-7
O.step()
from membrane import scene
corners = [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0)]
net = scene.add_membrane(corners, [(0, 1, 2)], radius=0.005, interactions=False)
for i in net.bodyIds:
    O.bodies[i].bounded = True
O.step()
print("contacts:", sum(i.isReal for i in O.interactions))
"""


IMPORT = "import membrane\nprint('loaded')"


def wrong(value):
    """Another value of the same type."""
    return tuple(x + 1 for x in value) if isinstance(value, tuple) else value + 1


def package(name, module=None):
    """A copy of the package in a folder of its own, as PYTHONPATH; with another `module`."""
    folder = scratch() / name
    here = Path(membrane.__file__).parent
    kept = shutil.ignore_patterns("_membrane*", "__pycache__", "viewer*")
    shutil.copytree(here, folder / "membrane", ignore=kept)
    if module:
        (folder / "membrane" / MODULE).write_bytes(module)
    return folder


def imported(folder):
    """The CompletedProcess of YADE that imports the package from there."""
    script = folder / "import_it.py"
    script.write_text(IMPORT, encoding="utf-8")
    return run_yade(script, PYTHONPATH=str(folder))


@of_the_plugin
class TestLayout(unittest.TestCase):
    def setUp(self):
        self.native = sys.modules.get("membrane._membrane")
        self.assertIsNotNone(self.native, "the plugin's classes did not come from its module")

    def test_this_yade_has_the_layout(self):
        _layout.check(self.native, wrapper)

    def test_each_member_that_reads_otherwise_is_refused_by_name(self):
        trips = list(_layout.round_trips(self.native, wrapper))
        members = {(cls, name) for cls, wrote, _ in trips for name in wrote}
        self.assertGreater(len(members), 70)
        for place, (cls, wrote, seen) in enumerate(trips):
            for name in wrote:
                off = [*trips]
                off[place] = cls, wrote, {**seen, name: wrong(seen[name])}
                with patch.object(_layout, "round_trips", return_value=off):
                    with self.assertRaises(ImportError) as caught:
                        _layout.check(self.native, wrapper)
                said = str(caught.exception)
                self.assertRegex(
                    said, rf"lays out its classes differently.* {cls}\.{name} was set to"
                )
                self.assertNotIn("\n", said)

    def test_what_is_set_is_not_what_was_there(self):
        """Else a member would seem to be where another lies."""
        for cls, values in _layout._settings(wrapper).items():
            seen = self.native.fields_of(getattr(wrapper, cls)())
            for name, value in values.items():
                self.assertNotEqual(seen[name], value, f"{cls}.{name}")
            plain = [value for value in values.values() if isinstance(value, (int, float))]
            numbers = [value for value in plain if not isinstance(value, bool)]
            self.assertEqual(len(set(numbers)), len(numbers), cls)

    def test_module_with_the_layout_of_another_release_is_refused(self):
        """Of those members that differ between Debian 12 and 13 the plugin uses one."""
        build = Path(membrane.__file__).parents[2]
        made = build / "CMakeFiles" / "membrane_plugin.dir"
        flags = (made / "flags.make").read_text(encoding="utf-8")
        rows = re.findall(r"^CXX_(?:DEFINES|INCLUDES|FLAGS) = (.*)$", flags, re.MULTILINE)
        options = re.sub(r"-O\d|-Werror", "", " ".join(rows))
        if "yade-abi" not in options:
            self.skipTest("compiled against YADE's own headers")
        here = re.search(r"YADE_ABI_RELEASE=(\d+)", options)[1]
        other = "202302" if here > "202302" else "202502"
        source = ROOT / "pkg" / "membrane" / "module.cpp"
        others = [path for path in made.rglob("*.o") if path.stem != source.name]
        module = scratch() / "other_release.so"
        command = ["g++", "-shared", "-fPIC", *shlex.split(options.replace(here, other))]
        linked = [source, *others, build / "libmembrane_mechanics.a"]
        subprocess.run([*command, *linked, "-o", module], check=True)
        done = imported(package("other_layout", module.read_bytes()))
        self.assertNotEqual(done.returncode, 0)
        said = "differently from Debian's: NewtonIntegrator.mask was set to 40 but reads as"
        self.assertIn(said, done.stderr)

    def test_writing_through_wrong_offsets_is_refused(self):
        native = self.native

        class WritesElsewhere:
            def __getattr__(self, name):
                return getattr(native, name) if name != "write_state" else lambda *_: None

        with self.assertRaisesRegex(ImportError, r"State\.vel was set to .* but reads as"):
            _layout.check(WritesElsewhere(), wrapper)

    def test_the_check_leaves_the_scene_as_it_was(self):
        omega = wrapper.Omega()
        before = omega.dt, omega.trackEnergy, len(omega.bodies), len(omega.materials)
        _layout.check(self.native, wrapper)
        after = omega.dt, omega.trackEnergy, len(omega.bodies), len(omega.materials)
        self.assertEqual(after, before)


@of_the_plugin
class TestBuildFolder(unittest.TestCase):
    def test_objects_of_another_release_do_not_stay(self):
        """As after an upgrade of the system; all that is built here is an empty project."""
        sources, run = scratch(), ROOT / "scripts" / "run.sh"
        for path in (run, ROOT / "pkg" / "membrane" / "yade-abi" / "releases.txt"):
            copy = sources / path.relative_to(ROOT)
            copy.parent.mkdir(parents=True)
            shutil.copy(path, copy)
        project = "cmake_minimum_required(VERSION 3.25)\nproject(empty NONE)\n"
        (sources / "CMakeLists.txt").write_text(project, encoding="utf-8")
        build = sources / "build"
        old, made_for = build / "CMakeFiles" / "old.o", build / ".made-for"
        command = [sources / "scripts" / "run.sh", "build"]
        subprocess.run(command, check=True)
        old.touch()
        subprocess.run(command, check=True)
        self.assertTrue(old.exists())
        said = made_for.read_text(encoding="utf-8")
        here = yade.config.version.strip()
        self.assertIn(f"YADE {here}\n", said)
        made_for.write_text(said.replace(here, "2001.1"), encoding="utf-8")
        subprocess.run(command, check=True)
        self.assertFalse(old.exists())

    def test_cmake_by_hand_refuses_a_folder_of_another_release(self):
        done = subprocess.run(
            ["cmake", "-S", ROOT, "-B", scratch() / "build", "-DMEMBRANE_YADE=2001.1"],
            capture_output=True,
            text=True,
        )
        self.assertNotEqual(done.returncode, 0)
        here = yade.config.version.strip()
        said = " ".join(done.stderr.split())
        self.assertIn(f"is for YADE 2001.1, but here is YADE {here}: begin anew by `cmake", said)


@of_the_plugin
class TestVersion(unittest.TestCase):
    def refused(self, *running, parts):
        """The module is not loaded into a YADE of another version or precision."""
        with self.assertRaises(ImportError) as caught:
            _load._module(*running)
        said = str(caught.exception)
        self.assertNotIn("\n", said)
        for part in (*running, *parts):
            self.assertIn(part, said)

    def test_another_version_is_refused(self):
        here = yade.config.version.strip()
        known = "2025.2.0" if here == "2023.02a" else "2023.02a"
        built = f"built for YADE {here} (PrecisionDouble)"
        self.refused(known, "PrecisionDouble", parts=[built, "scripts/run.sh build"])
        only = f"can be built for {', '.join(_load._systems())} only"
        self.refused("2024.01", "PrecisionDouble", parts=[built, only])

    def test_another_precision_is_refused(self):
        here = yade.config.version.strip()
        self.refused(here, "PrecisionLongDouble", parts=["PrecisionDouble"])

    def test_the_module_itself_knows_its_release(self):
        module = Path(sys.modules["membrane._membrane"].__file__)
        self.assertEqual(module.name, MODULE)
        self.assertEqual(_load.built_for(module), yade.config.version.strip())

    def test_module_of_another_release_is_refused_before_it_is_loaded(self):
        for content, sentence in (
            (b"no ELF file: membrane for YADE 2001.1\0", "membrane: built for YADE 2001.1 "),
            (None, "membrane: .*_membrane.* is missing; scripts/run.sh build makes it"),
            (b"membrane for YADE %s\0" % yade.config.version.encode(), " does not fit Python "),
        ):
            with self.subTest(sentence):
                name = f"refused_{len(content or '')}"
                done = imported(package(name, content))
                self.assertNotEqual(done.returncode, 0)
                self.assertRegex(done.stderr.strip().splitlines()[-1], sentence)

    def test_module_of_another_python_is_no_module(self):
        folder = package("other_python")
        release = b"membrane for YADE %s\0" % yade.config.version.encode()
        (folder / "membrane" / "_membrane.cpython-30-x86_64-linux-gnu.so").write_bytes(release)
        done = imported(folder)
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(done.stderr, "_membrane.cpython-30.*so does not fit Python 3")

    def test_loading_again_gives_the_same_classes(self):
        for name, cls in _load.load().items():
            self.assertIs(cls, getattr(membrane, name))

    def test_engines_that_were_there_before_meet_nodes(self):
        """YADE's tables of classes are as large as they were, and asserted to be large enough."""
        script = scratch() / "late.py"
        script.write_text(LATE, encoding="utf-8")
        done = run_yade(script)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("contacts: 1", done.stdout)

    def test_plain_python_is_told_to_use_yade(self):
        folder = str(Path(membrane.__file__).parents[1])
        done = subprocess.run(
            [
                "/usr/bin/python3",
                "-c",
                f"import sys; sys.path.insert(0, {folder!r}); from membrane import Membrane",
            ],
            capture_output=True,
            text=True,
        )
        self.assertNotEqual(done.returncode, 0)
        last = done.stderr.strip().splitlines()[-1]
        self.assertRegex(last, "ImportError: membrane: no YADE is running.*yade script.py")


if __name__ == "__main__":
    unittest.main()

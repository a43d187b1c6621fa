# SPDX-License-Identifier: GPL-2.0-or-later
"""The plugin loads into the YADE for which it was built, and into no other."""

import subprocess
import sys
import unittest
from pathlib import Path

import membrane
import yade.config
from membrane import _load
from support import of_the_plugin, run_yade, scratch
from yade import wrapper

TABLES = tuple(
    f"fields_of_{thing}" for thing in ("body", "interaction", "engine", "drawer", "scene")
)


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


class OneFieldOff:
    """What the compiled offsets would find if one of them were wrong."""

    def __init__(self, native, table, field):
        self.native, self.table, self.field = native, table, field

    def __getattr__(self, name):
        real = getattr(self.native, name)
        if name != self.table:
            return real

        def read(*objects):
            seen = real(*objects)
            value = seen[self.field]
            seen[self.field] = not value if isinstance(value, bool) else wrong(value)
            return seen

        return read


def wrong(value):
    """Another value of the same type."""
    if isinstance(value, tuple):
        return tuple(x + 1 for x in value)
    return value + "x" if isinstance(value, str) else value + 1


@of_the_plugin
class TestLayout(unittest.TestCase):
    def setUp(self):
        self.native = sys.modules.get("membrane._membrane")
        self.assertIsNotNone(self.native, "the plugin's classes did not come from its module")

    def test_this_yade_has_the_layout(self):
        _load.check_layout(self.native, wrapper)

    def test_each_field_that_reads_otherwise_is_refused_by_name(self):
        seen = {}

        class Listening(OneFieldOff):
            """Notes the fields that are compared."""

            def __getattr__(self, name):
                real = getattr(self.native, name)
                if name not in TABLES:
                    return real

                def read(*objects):
                    seen[name] = real(*objects)
                    return seen[name]

                return read

        compared = {
            (cls, name)
            for cls, wrote, _ in _load._round_trips(Listening(self.native, None, None), wrapper)
            for name in wrote
        }
        self.assertEqual(set(seen), set(TABLES))
        refused = set()
        for table in TABLES:
            for field in seen[table]:
                try:
                    _load.check_layout(OneFieldOff(self.native, table, field), wrapper)
                except ImportError as error:
                    self.assertIn("lays out its classes otherwise", str(error))
                    self.assertNotIn("\n", str(error))
                    refused.add(str(error).split(": ")[2].split(" was set")[0])
        written = {f"{cls}.{name}" for cls, name in compared if cls != "State"}
        self.assertEqual(refused, written)
        self.assertGreater(len(refused), 30)

    def test_writing_through_wrong_offsets_is_refused(self):
        native = self.native

        class WritesElsewhere:
            def __getattr__(self, name):
                return getattr(native, name) if name != "write_state" else lambda *_: None

        with self.assertRaisesRegex(ImportError, r"State\.vel was set to .* but reads as"):
            _load.check_layout(WritesElsewhere(), wrapper)

    def test_the_check_leaves_the_scene_as_it_was(self):
        omega = wrapper.Omega()
        before = omega.dt, omega.trackEnergy, len(omega.bodies), len(omega.materials)
        _load.check_layout(self.native, wrapper)
        after = omega.dt, omega.trackEnergy, len(omega.bodies), len(omega.materials)
        self.assertEqual(after, before)


class TestVersion(unittest.TestCase):
    def refused(self, name, value):
        kept = getattr(yade.config, name)
        setattr(yade.config, name, value)
        try:
            with self.assertRaises(ImportError) as caught:
                _load._check_version()
        finally:
            setattr(yade.config, name, kept)
        text = str(caught.exception)
        self.assertNotIn("\n", text)
        for part in ("2023.02a", "PrecisionDouble", value):
            self.assertIn(part, text)

    def test_another_version_is_refused(self):
        self.refused("version", "2024.01")

    def test_another_precision_is_refused(self):
        self.refused("highPrecisionName", "PrecisionLongDouble")

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
                f"import sys; sys.path.insert(0, {folder!r}); import membrane",
            ],
            capture_output=True,
            text=True,
        )
        self.assertNotEqual(done.returncode, 0)
        last = done.stderr.strip().splitlines()[-1]
        self.assertRegex(last, "ImportError: membrane: no YADE is running.*yade script.py")


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-2.0-or-later
"""The rooms of the package: who imports whom, what needs no YADE, names of earlier versions."""

import ast
import graphlib
import importlib
import re
import subprocess
import unittest

import membrane
from membrane import _former
from support import ROOT, scratch, yade_environment

QUICK = True

SCRIPTS = ROOT / "scripts"
ROOMS = ("", "mesh", "scene", "results", "view", "run", "study", "cli")  # the first: the ground
PLAIN_COMMANDS = "errors|options|calibrate|sweep"
WITH_YADE = "scene|run.(case|checkpoint|driver|last_good|record)|view.window"
WITH_YADE += "|study.(benchmarks|chart|disk|parts|sources|stability|verification)"
WITH_YADE += f"|cli.(?!{PLAIN_COMMANDS})"  # or with the sources


def modules(folder):
    """Files of the modules of a package by their full names."""
    files = {}
    for path in folder.rglob("*.py"):
        parts = path.relative_to(folder.parent).with_suffix("").parts
        files[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return files


def imports(name, files):
    """Names of modules of its package that the module `name` imports, wherever it does so."""
    package = name.split(".")[: None if files[name].stem == "__init__" else -1]
    top = package[0]
    for node in ast.walk(ast.parse(files[name].read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (a.name for a in node.names if a.name.split(".")[0] == top)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) + 1 - node.level] if node.level else []
            origin = ".".join([*base, *([node.module] if node.module else [])])
            if origin.split(".")[0] == top:
                parts = (f"{origin}.{a.name}" for a in node.names)
                yield from (part if part in files else origin for part in parts)


def arrows(folder):
    """By module of a package, those that must be loaded before it."""
    files, found = modules(folder), {}
    for name in files:
        wanted = set(imports(name, files))
        for target in list(wanted):  # packages are loaded before what is in them
            steps = target.split(".")
            above = {".".join(steps[:n]) for n in range(1, len(steps))}
            wanted |= {package for package in above if not f"{name}.".startswith(f"{package}.")}
        found[name] = wanted
    return found


def room(name):
    """Number of the room of a module."""
    parts = name.split(".")
    return ROOMS.index(parts[1]) if len(parts) > 1 and parts[1] in ROOMS else 0


def faults(folder):
    """Sentences about imports that are upwards, in a circle, or of modules that are not there."""
    graph = arrows(folder)
    pairs = [(name, other) for name, others in sorted(graph.items()) for other in sorted(others)]
    said = [f"{a} imports {b}, which is not there" for a, b in pairs if b not in graph]
    said += [f"{a} imports upwards: {b}" for a, b in pairs if room(b) > room(a)]
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        said.append(f"a circle: {' imports '.join(reversed(error.args[1]))}")
    return said


def package(name, **sources):
    """A package `membrane` in a folder `name`, of modules with `sources`; __ stands for a dot."""
    folder = scratch() / name / "membrane"
    for module, source in sources.items():
        path = folder.joinpath(*module.split("__")).with_suffix(".py")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(source, encoding="utf-8")
    for place in {folder, *(path.parent for path in folder.rglob("*.py"))}:
        (place / "__init__.py").touch()
    return folder


def plain_python(*words):
    """The CompletedProcess of Python without YADE: of a script, or of "-c" and a text."""
    command = ["/usr/bin/python3", *words]
    return subprocess.run(command, env=yade_environment(), capture_output=True, text=True)


class TestArrows(unittest.TestCase):
    def test_nobody_imports_upwards_nor_in_a_circle(self):
        graph = arrows(SCRIPTS / "membrane")
        self.assertEqual({room(name) for name in graph}, set(range(len(ROOMS))))
        self.assertGreater(sum(map(len, graph.values())), 300)
        self.assertEqual(faults(SCRIPTS / "membrane"), [])

    def test_an_import_upwards_is_found_wherever_it_stands(self):
        for number, line in enumerate(
            (
                "from membrane.view.plots import save",
                "import membrane.view.plots as plots",
                "def late():\n    from ..view import plots",
                "try:\n    from ..view.plots import save\nexcept ImportError:\n    pass",
            )
        ):
            folder = package(f"up_{number}", view__plots="", mesh__sheet=line, geometry="")
            said = [s for s in faults(folder) if s.startswith("membrane.mesh.sheet imports upw")]
            self.assertIn("membrane.mesh.sheet imports upwards: membrane.view.plots", said)

    def test_the_ground_may_not_import_a_room(self):
        folder = package("ground", geometry="from .mesh import sheet", mesh__sheet="")
        self.assertIn("membrane.geometry imports upwards: membrane.mesh.sheet", faults(folder))

    def test_imports_downwards_are_right(self):
        late = "def late():\n    from ..mesh import sheet"
        folder = package(
            "down", view__plots=late, mesh__sheet="from .. import geometry", geometry=""
        )
        self.assertEqual(faults(folder), [])

    def test_a_circle_is_found_also_through_a_package(self):
        late = "def late():\n    from . import one"
        (said,) = faults(package("circle", mesh__one="from .two import x", mesh__two=late))
        self.assertRegex(said, "a circle: (membrane.mesh.(one|two)( imports |$)){3}")
        folder = package("through", mesh__one="from .. import geometry", geometry="")
        (folder / "mesh" / "__init__.py").write_text("from .one import x", encoding="utf-8")
        self.assertEqual(faults(folder), [])
        (folder / "mesh" / "one.py").write_text("from membrane.mesh import x", encoding="utf-8")
        (said,) = faults(folder)
        self.assertRegex(said, "a circle: .*membrane.mesh.one imports membrane.mesh")

    def test_names_of_earlier_versions_are_for_others(self):
        folder = package("former", cli__draw="from membrane.plots import save", view__plots="")
        said = ["membrane.cli.draw imports membrane.plots, which is not there"]
        self.assertEqual(faults(folder), said)

    def test_no_script_changes_the_path_or_imports_another(self):
        scripts = {path.stem for path in SCRIPTS.rglob("*.py")}
        for path in SCRIPTS.rglob("*.py"):
            text = path.read_text(encoding="utf-8")
            self.assertNotRegex(text, r"sys\.path\b", path)
            if path.parent == SCRIPTS:
                taken = re.findall(r"^ *(?:from|import) (\w+)", text, re.MULTILINE)
                self.assertFalse(scripts & set(taken), path)


class TestWithoutYade(unittest.TestCase):
    def test_all_else_can_be_imported(self):
        names = [
            n for n in modules(SCRIPTS / "membrane") if not re.match(f"membrane.({WITH_YADE})", n)
        ]
        self.assertGreater(len(names), 40)
        text = "import importlib, sys\nfor name in {}:\n    importlib.import_module(name)\n"
        text += "print(sorted(n for n in sys.modules if n.split('.')[0] == 'yade'))"
        done = plain_python("-c", text.format(names))
        self.assertEqual((done.returncode, done.stdout), (0, "[]\n"), done.stderr)

    def test_who_asks_for_a_class_is_told_to_use_yade(self):
        for line in (
            "from membrane import Membrane",
            "import membrane; membrane.MembraneForceEngine",
            "from membrane import *",
            "from membrane import scene",
            "import membrane.run.driver",
        ):
            done = plain_python("-c", line)
            self.assertEqual(done.returncode, 1, line)
            last = done.stderr.strip().splitlines()[-1]
            self.assertRegex(last, "^ImportError: membrane: no YADE is running.*yade script.py")

    def test_commands_that_need_it_say_so_in_one_sentence(self):
        for command in ("deploy", "case", "chart", "verify", "ikaros"):
            done = plain_python(SCRIPTS / f"{command}.py")
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, f"^{command}: .*no YADE is running; .*\n$")

    def test_what_nobody_knows_is_no_attribute(self):
        done = plain_python("-c", "import membrane; print(hasattr(membrane, 'nothing'))")
        self.assertEqual(done.stdout, "False\n", done.stderr)
        self.assertFalse(hasattr(membrane, "nothing"))


class TestNames(unittest.TestCase):
    def test_every_class_is_a_name_of_the_package(self):
        found = {}
        exec("from membrane import *", found)
        self.assertLessEqual({"Membrane", "MembraneForceEngine", "GlExtra_Membrane"}, set(found))
        self.assertEqual(set(membrane.__all__), set(found) - {"__builtins__"})

    def test_names_of_earlier_versions_are_the_same_modules(self):
        for name, place in _former.ROOMS.items():
            former = importlib.import_module(f"membrane.{name}")
            self.assertIs(former, importlib.import_module(f"membrane.{place}.{name}"))
            self.assertEqual(former.__spec__.name, f"membrane.{place}.{name}")
            self.assertIs(getattr(membrane, name), former)
        with self.assertRaisesRegex(ImportError, "No module named 'membrane.nothing'"):
            importlib.import_module("membrane.nothing")


if __name__ == "__main__":
    unittest.main()

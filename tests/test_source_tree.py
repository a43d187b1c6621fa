# SPDX-License-Identifier: GPL-2.0-or-later
"""Built into a YADE tree, the classes are YADE's own and do what those of the plugin do.

A whole YADE takes an hour to build; here the plugin's objects, linked as a tree would link them,
lie beside the installed YADE's libraries.
"""

import json
import os
import platform
import re
import shutil
import subprocess
import unittest
from functools import lru_cache
from pathlib import Path

import membrane
from support import ROOT, of_the_plugin, run_yade, scratch, yade_environment
from yade import config

BUILD = Path(membrane.__file__).parents[2]
LIBRARY = BUILD / "symbol-check" / "libpkg_membrane.so"


@lru_cache(maxsize=None)
def tree():
    """A YADE_PREFIX with libpkg_membrane.so, and the Python package copied as the README says."""
    prefix, installed = scratch() / "tree", Path(config.libDir)
    libraries = prefix / installed.relative_to(Path(config.prefix).resolve())
    python = libraries / "py"
    python.mkdir(parents=True)
    for library in (*installed.glob("lib*.so"), LIBRARY):
        (libraries / library.name).symlink_to(library)
    (python / "yade").symlink_to(installed / "py" / "yade")
    shutil.copytree(ROOT / "scripts" / "membrane", python / "membrane")
    return prefix


def deployed(name, **environment):
    """Results and facts of deploy_here.py in a YADE of this environment."""
    folder = scratch() / name
    folder.mkdir()
    done = run_yade(ROOT / "tests" / "deploy_here.py", folder, environment=environment)
    if done.returncode:
        raise AssertionError(done.stdout + done.stderr)
    facts = json.loads((folder / "facts.json").read_text(encoding="utf-8"))
    files = {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*.*")
        if path.name not in ("facts.json", "wall_time.json")
    }
    return facts, files


@of_the_plugin
class TestSourceTree(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        bare = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        cls.facts, cls.files = deployed("native", **bare, YADE_PREFIX=str(tree()))

    def test_classes_are_native_whatever_the_version(self):
        self.assertTrue(self.facts["native"])
        self.assertTrue(self.facts["listed"])

    def test_package_is_the_copy_in_the_tree(self):
        self.assertEqual(Path(self.facts["package"]).parents[5], tree())

    def test_tree_with_another_version_of_the_classes_is_refused(self):
        self.assertIn("without MembraneWatch", self.facts["refused"])
        self.assertNotIn("\n", self.facts["refused"])

    def test_deployments_are_those_of_the_plugin_byte_for_byte(self):
        facts, files = deployed("plugin", **yade_environment())
        self.assertFalse(facts["native"])
        self.assertEqual(facts["members"], self.facts["members"])
        self.assertGreater(len(files), 10)
        self.assertEqual(set(files), set(self.files))
        for name, content in files.items():
            self.assertTrue(content == self.files[name], name)


@of_the_plugin
@unittest.skipUnless(platform.machine() == "x86_64", "the kernels are vectorised for x86-64")
class TestVectors(unittest.TestCase):
    def test_roots_are_taken_four_at_a_time_without_flags_of_cmake(self):
        """A YADE tree gives none but -O3; scalar roots are those of single elements."""
        made = BUILD / "CMakeFiles" / "membrane_mechanics.dir"
        flags = (made / "flags.make").read_text(encoding="utf-8")
        if "-O3" not in flags:
            self.skipTest("not an optimised build")
        self.assertNotRegex(flags, "math|trapping|contract|march")
        for kernel in ("SideKernel", "CreaseKernel"):
            file = made / "pkg" / "membrane" / "kernels" / f"{kernel}.cpp.o"
            code = subprocess.run(
                ["objdump", "-d", file], check=True, capture_output=True, text=True
            ).stdout
            loops = "".join(one for one in code.split("\n\n") if ".avx2>:" in one)
            self.assertGreaterEqual(len(re.findall(r"\bvsqrtpd .*%ymm", loops)), 6, kernel)
            self.assertEqual(len(re.findall(r"\bv?sqrtsd\b", loops)), 0, kernel)


if __name__ == "__main__":
    unittest.main()

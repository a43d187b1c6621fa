# SPDX-License-Identifier: GPL-2.0-or-later
"""Texts are UTF-8 whatever the locale, and names of files that are not are refused before a run."""

import ast
import os
import subprocess
import unittest

from membrane.cli.options import file, folder
from membrane.parameters import Refused
from membrane.view import report
from support import ROOT, CommandTest, scratch, yade_environment

QUICK = True

READ_OR_WRITTEN = {"read_text", "write_text", "open", "fdopen", "TemporaryFile"}
TABLES = {"savetxt", "genfromtxt", "loadtxt"}
STARTED = {"run", "Popen", "check_output"}


def name(call):
    """Name of the function that is called, and of what it belongs to."""
    if isinstance(call.func, ast.Name):
        return call.func.id, ""
    if isinstance(call.func, ast.Attribute):
        return call.func.attr, getattr(call.func.value, "id", "")
    return "", ""


def takes_the_locales(call):
    """Whether a call would decode or encode text as the locale says."""
    function, owner = name(call)
    given = {keyword.arg for keyword in call.keywords}
    if function in STARTED:
        return bool(given & {"text", "universal_newlines"})
    if function in TABLES and owner == "np":
        return "encoding" not in given and not (call.args and name_of_file(call.args[0]))
    if function not in READ_OR_WRITTEN or owner in ("os", "gmsh", "model") and function == "open":
        return False
    if function.endswith("_text") and not owner and isinstance(call.func, ast.Name):
        return False  # a reader of our own
    values = [getattr(node, "value", None) for a in call.args for node in ast.walk(a)]
    modes = [value for value in values if isinstance(value, str) and set(value) <= set("rwaxbt+")]
    return "encoding" not in given and not any("b" in mode for mode in modes)


def name_of_file(node):
    """Whether something is a variable `file`, one that is open."""
    return isinstance(node, ast.Name) and node.id == "file"


class TestSources(unittest.TestCase):
    def test_every_text_file_names_its_encoding(self):
        paths = [*(ROOT / "scripts").rglob("*.py"), *(ROOT / "reference").glob("*.py")]
        self.assertGreater(len(paths), 50)
        calls = [
            (path, node)
            for path in paths
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.Call)
        ]
        self.assertGreater(sum(name(call)[0] in READ_OR_WRITTEN for _, call in calls), 20)
        wrong = [f"{path}:{call.lineno}" for path, call in calls if takes_the_locales(call)]
        self.assertEqual(wrong, [])

    def test_calls_that_do_not_are_found(self):
        for call in (
            "open(path)",
            "open(path, 'w')",
            "path.read_text()",
            "path.write_text(text)",
            "np.savetxt(path, rows)",
            "subprocess.run(command, text=True)",
        ):
            self.assertTrue(takes_the_locales(ast.parse(call).body[0].value), call)


class TestLocale(unittest.TestCase):
    """A locale that knows none but ASCII letters: what fails in any other fails here, too."""

    def test_a_run_leaves_the_same_files(self):
        found = []
        ascii_only = {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}
        options = ["--fold-lines", "3", "--inner-width", "0.15", "--duration", "0.004"]
        options += ["--spin-up-tolerance", "1e-2", "--shapes-interval", "0.002"]
        for number, locale in enumerate(({}, ascii_only)):
            out = scratch() / f"locale_{number}" / "same_name"
            done = subprocess.run(
                ["yade", "-n", "-x", ROOT / "scripts" / "deploy.py", *options, "--out", out],
                env={**yade_environment(), **locale},
                capture_output=True,
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            files = (path for path in out.rglob("*") if path.is_file())
            found.append({path.relative_to(out): path.read_bytes() for path in files})
            for path in list(found[-1]):
                if path.name == "wall_time.json":
                    del found[-1][path]
        self.assertEqual(found[0], found[1])
        names = {str(path) for path in found[0]}
        self.assertEqual("report.html" in names, report.TEMPLATE.is_file())


class TestNames(CommandTest):
    BAD = b"prufung-\xfc"  # as ISO-8859-1 has it

    def test_names_that_are_no_utf8_are_refused(self):
        for word in (self.BAD, self.BAD + b"/out", b"a/" + self.BAD):
            for kind in (folder, file):
                with self.assertRaisesRegex(Refused, r"udcfc.*must be UTF-8"):
                    kind(os.fsdecode(word))
        self.assertEqual(str(folder("prüfung")), "prüfung")

    def test_commands_refuse_them_before_the_run(self):
        for script, *words in (
            ("deploy.py", b"--out", self.BAD),
            ("sail.py", self.BAD + b".fold"),
            ("deploy.py", b"--parameters", self.BAD),
        ):
            with self.subTest(script=script):
                done = subprocess.run(
                    ["yade", "-n", "-x", ROOT / "scripts" / script, *words],
                    cwd=scratch(),
                    env=yade_environment(),
                    capture_output=True,
                    text=True,
                )
                self.ends_with_one_sentence(done, script[:-3], "must be UTF-8")
        self.assertNotIn(self.BAD, os.listdir(os.fsencode(scratch())))

    def test_case_of_such_a_name_in_a_report_is_a_sentence(self):
        sweep = os.fsencode(scratch() / "sweep_of_bad_names")
        case = os.path.join(sweep, self.BAD, b"unfinished")
        os.makedirs(case)
        with open(os.path.join(case, b"begun.json"), "w") as file:
            file.write("{}")
        done = subprocess.run(
            ["/usr/bin/python3", ROOT / "scripts" / "sweep.py", "report", sweep],
            env=yade_environment(),
            capture_output=True,
            text=True,
        )
        self.ends_with_one_sentence(done, "sweep", "udcfc", "must be UTF-8")


if __name__ == "__main__":
    unittest.main()

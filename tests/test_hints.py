# SPDX-License-Identifier: GPL-2.0-or-later
"""Every public function and method of the package says of what types its arguments and result are.

mypy checks that they are right: `scripts/run.sh format --check`.
"""

import ast
import re
import unittest

from support import ROOT

QUICK = True

SCRIPTS = ROOT / "scripts"


def public(body):
    """Pairs of a class, or None, and a function in it, of those in `body` that others may call."""
    for node in body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from ((node, function) for _, function in public(node.body))
        elif isinstance(node, ast.FunctionDef) and re.match("(?!_)|__", node.name):
            yield None, node
        elif isinstance(node, (ast.If, ast.Try, ast.With)):
            yield from public(ast.iter_child_nodes(node))


def unhinted(source):
    """Names of the public functions in a module's text that lack the type of something."""
    for within, function in public(ast.parse(source).body):
        static = any(
            isinstance(d, ast.Name) and d.id == "staticmethod" for d in function.decorator_list
        )
        given = function.args
        every = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
        hints = [one.annotation for one in every[within is not None and not static :] if one]
        if None in (*hints, function.returns):
            yield f"{within.name}.{function.name}" if within else function.name


class TestHints(unittest.TestCase):
    def test_every_public_function_has_them(self):
        files = sorted((SCRIPTS / "membrane").rglob("*.py"))
        self.assertGreater(len(files), 100)
        for path in files:
            self.assertEqual(list(unhinted(path.read_text(encoding="utf-8"))), [], path)

    def test_what_is_missing_is_found(self):
        for line in (
            "def f(a): ...",
            "def f(a: int): ...",
            "def f(a) -> int: ...",
            "def f(*a) -> int: ...",
            "def f(*, a) -> int: ...",
            "def f(**a) -> int: ...",
            "if True:\n    def f(): ...",
            "try:\n    pass\nfinally:\n    def f(): ...",
        ):
            self.assertEqual(list(unhinted(line)), ["f"], line)
        for line in ("def m(self): ...", "@staticmethod\n    def m(a) -> int: ..."):
            self.assertEqual(list(unhinted(f"class C:\n    {line}")), ["C.m"], line)

    def test_what_others_do_not_see_needs_none(self):
        for line in (
            "def f() -> int:\n    def g(a): ...",
            "def _f(a): ...",
            "class _C:\n    def m(a): ...",
            "class C:\n    def m(self) -> int: ...",
        ):
            self.assertEqual(list(unhinted(line)), [], line)


if __name__ == "__main__":
    unittest.main()

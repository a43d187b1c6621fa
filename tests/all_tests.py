# SPDX-License-Identifier: GPL-2.0-or-later
"""All test modules of this folder as one, so that one runner runs them and sums them up once."""

from pathlib import Path

chosen = []  # names of modules; empty: all


def quick():
    """Names of the modules that need no scene, as they say themselves."""
    files = sorted(Path(__file__).parent.glob("test_*.py"))
    return [file.stem for file in files if "\nQUICK = True\n" in file.read_text(encoding="utf-8")]


def load_tests(loader, standard_tests, pattern):
    """Gather the tests, by unittest's protocol."""
    found = sorted(path.stem for path in Path(__file__).parent.glob("test_*.py"))
    return loader.loadTestsFromNames(chosen or found)

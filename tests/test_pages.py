# SPDX-License-Identifier: GPL-2.0-or-later
"""What the pages say of the sources: links, files, commands, options, parameters, short lines."""

import re
import unittest
from dataclasses import fields
from functools import lru_cache

import numpy as np
from membrane.parameters import KINDS
from membrane.run.sails import SAILS
from membrane.run.sails.sheet import PatternParameters, read_sheet
from support import ROOT, scratch

QUICK = True

GUIDE = ROOT / "reference" / "guide"
README = ROOT / "README.md"
PAGES = (
    README,
    *sorted((ROOT / "reference").glob("*.md")),
    *sorted(GUIDE.glob("*.md")),
    ROOT / "reference" / "stability" / "README.md",
    ROOT / "pkg" / "membrane" / "yade-abi" / "README.md",
)
FOREIGN = "apt-get|cmake|gdb|yade-batch"  # lines with options that are not ours


def text(page):
    """Of a page."""
    return page.read_text(encoding="utf-8")


def blocks(page, language):
    """Contents of a page's blocks of code in a language."""
    return re.findall(rf"(?ms)^```{language}\n(.*?)^```$", text(page))


def prose(page):
    """A page without its blocks of code."""
    return re.sub(r"(?ms)^```.*?^```$", "", text(page))


@lru_cache(maxsize=None)
def anchors(page):
    """Names that GitHub gives to a page's headings."""
    titles = re.findall(r"(?m)^#+ (.*)$", prose(page))
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def code(page):
    """Lines of shell and pieces of code in the prose, where commands and options are named."""
    lines = [line for block in blocks(page, "sh") for line in block.replace("\\\n", "").split("\n")]
    return [*lines, *re.findall(r"`([^`\n]+)`", prose(page))]


class TestForm(unittest.TestCase):
    def test_the_readme_is_short(self):
        self.assertLessEqual(len(text(README).splitlines()), 120)

    def test_lines_are_short(self):
        for page in (README, *GUIDE.glob("*.md")):
            for number, line in enumerate(text(page).splitlines(), 1):
                self.assertLessEqual(len(line), 120, f"{page}, line {number}")

    def test_the_contents_name_every_page(self):
        named = re.findall(r"(?m)^\| \[.*?\]\((.*?)\)", text(GUIDE / "README.md"))
        self.assertEqual({*named, "README.md"}, {page.name for page in GUIDE.glob("*.md")})

    def test_the_script_of_the_readme_is_the_example(self):
        example = text(ROOT / "scripts" / "examples" / "example.py")
        self.assertEqual(blocks(README, "python"), [example.partition("\n")[2]])


class TestNames(unittest.TestCase):
    def test_links_lead_somewhere(self):
        count = 0
        for page in PAGES:
            for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
                if re.match("https?:", target):
                    continue
                name, _, anchor = target.partition("#")
                file = (page.parent / name).resolve() if name else page
                self.assertTrue(file.is_file(), f"{page}: {target}")
                if anchor:
                    self.assertIn(anchor, anchors(file), f"{page}: {target}")
                count += 1
        self.assertGreater(count, 60)

    def test_files_of_the_repository_are_there(self):
        count = 0
        for page in PAGES:
            for name in re.findall(
                r"`((?:scripts|pkg|tests|reference|\.ci)/[\w./-]+)`", prose(page)
            ):
                there = (ROOT / name).exists() or name.endswith(".log")
                self.assertTrue(there, f"{page}: {name}")
                count += 1
        self.assertGreater(count, 20)

    def test_commands_are_there(self):
        script = text(ROOT / "scripts" / "run.sh")
        cases = re.search(r"(?ms)^case \$command in$(.*?)^esac$", script)
        known = set(re.findall(r"[\w-]+", " ".join(re.findall(r"(?m)^([\w |-]+)\)", cases[1]))))
        usage = script.partition("<<'END'\n")[2].partition("\nEND\n")[0]
        told = set(re.findall(r"(?m)^  ([a-z]+)\b", usage))
        found = set()
        for page in PAGES:
            for line in code(page):
                found.update(re.findall(r"(?:run\.sh|yade-membrane) ([a-z]\w*)", line))
        self.assertEqual(found - (known & told), set())
        self.assertGreater(len(found), 20)

    def test_sails_are_there(self):
        command = r"run\.sh (?:deploy|case|sweep) (?!report)([a-z]\w+)(?![\w./])"
        found = {name for p in PAGES for line in code(p) for name in re.findall(command, line)}
        self.assertLessEqual({"ikaros", "miura"}, found)
        self.assertLessEqual(found - {"tiny"}, set(SAILS))  # which a page makes

    def test_options_are_there(self):
        sources = [*ROOT.glob("scripts/membrane/cli/*.py"), ROOT / "scripts" / "run.sh"]
        sources += [ROOT / "tests" / "run_tests.py", ROOT / "tests" / "attacks" / "drive.py"]
        sources += [ROOT / "scripts" / "probe.py", GUIDE / "make_site.py"]
        known = {name for file in sources for name in re.findall(r"--[a-z][a-z0-9-]+", text(file))}
        for kind in KINDS.values():
            known |= {f"--{item.name.replace('_', '-')}" for item in fields(kind)}
        found = set()
        for page in PAGES:
            for line in code(page):
                if not re.search(FOREIGN, line):
                    found.update(re.findall(r"(?<![\w-])--[a-z][a-z0-9-]+", line))
        self.assertEqual(found - known, set())
        self.assertGreater(len(found), 40)

    def test_fragments_stand_in_the_sources(self):
        sources = [text(file) for file in (ROOT / "scripts" / "membrane").rglob("*.py")]
        found = [block for page in PAGES for block in blocks(page, "py")]
        self.assertGreaterEqual(len(found), 2)
        for block in found:
            self.assertTrue(any(block in source for source in sources), block)


class TestPatterns(unittest.TestCase):
    def test_the_pleats_are_a_pattern(self):
        (pattern,) = blocks(GUIDE / "patterns.md", "json")
        file = scratch() / "pleats.fold"
        file.write_text(pattern, encoding="utf-8")
        sheet = read_sheet(PatternParameters(file=str(file), unit=0.01, size=0.02))
        self.assertAlmostEqual(np.ptp(sheet.nodes[:, 0]), 0.2)
        self.assertLess(np.ptp(sheet.start, axis=0).min(), np.ptp(sheet.start, axis=0).max())
        self.assertEqual(set(sheet.crease_signs.tolist()), {1, -1})
        places = np.unique(np.round(sheet.nodes[sheet.creases][:, :, 0], 9))
        np.testing.assert_allclose(np.diff(places), 0.05)
        self.assertEqual(len(places), 3)


if __name__ == "__main__":
    unittest.main()

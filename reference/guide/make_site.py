# SPDX-License-Identifier: GPL-2.0-or-later
"""Makes the HTML site build/docs, in YADE: `yade -n -x reference/guide/make_site.py`."""

import pkgutil
import shutil
import sys
from dataclasses import fields
from pathlib import Path

import membrane
from membrane.run.sails import SAILS

HERE = Path(sys.argv[0]).resolve().parent  # YADE keeps __file__ for itself
ROOT = HERE.parents[1]
SITE = ROOT / "build" / "docs"
ROOMS = ("ground", "mesh", "scene", "results", "view", "run", "study")
PROGRAMS = ("membrane.study.benchmarks.worker",)  # run when they are imported
MATHJAX = Path("/usr/share/javascript/mathjax")  # of which formulas need these files
FORMULAS = (
    *("MathJax.js", "config/TeX-AMS_CHTML-full.js", "extensions", "fonts/HTML-CSS/TeX/woff"),
    *("jax/element", "jax/input/TeX", "jax/output/CommonHTML"),
)
GO_ON = '<meta charset="utf-8"><meta http-equiv="refresh" content="0; url=README.html">\n'


def table(kind):
    """All parameters of a class of parameters, as a table of Markdown."""
    rows = [("parameter", "default", "unit", "source", "meaning"), ("---",) * 5]
    for item in fields(kind):
        about, value = item.metadata, item.default
        default = f"{value:g}" if isinstance(value, float) else str(value)
        rows.append((f"`{item.name}`", default, about["unit"], about["source"], about["text"]))
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def write_parameters(file):
    """The page of the parameters of all kinds of sail."""
    text = "# Parameters of all kinds of sail\n"
    for name, kind in SAILS.items():
        text += f"\n## {name}: {kind.title}\n\n{table(kind.parameters)}"
    file.write_text(text, encoding="utf-8")


def modules():
    """Full names of the package's modules by room."""
    found = {room: [] for room in ROOMS}
    for module in pkgutil.walk_packages(membrane.__path__, "membrane."):
        room = module.name.split(".")[1]
        if "._" not in module.name and room != "cli" and module.name not in PROGRAMS:
            found[room if room in found else "ground"].append(module.name)
    return found


def write_api(folder):
    """Pages of the classes and the modules, for autodoc."""
    folder.mkdir(parents=True, exist_ok=True)
    pages = {"plugin": [("class", f"membrane.{name}") for name in membrane.__all__]}
    pages |= {room: [("module", name) for name in names] for room, names in modules().items()}
    titles = {"plugin": "The plugin's classes", "ground": "The ground"}
    for page, things in pages.items():
        title = titles.get(page, f"membrane.{page}")
        text = [title, "=" * len(title)]
        for kind, name in things:
            text += ["", name, "-" * len(name), "", f".. auto{kind}:: {name}"]
        (folder / f"{page}.rst").write_text("\n".join(text) + "\n", encoding="utf-8")
    names = "".join(f"   {page}\n" for page in pages)
    write_parameters(folder / "parameters.md")
    index = f"Reference\n=========\n\n.. toctree::\n   :maxdepth: 2\n\n   parameters\n{names}"
    (folder / "index.rst").write_text(index, encoding="utf-8")


def main():
    """Returns the exit status."""
    from sphinx.cmd.build import build_main

    source = ROOT / "build" / "docs-source"
    source.mkdir(parents=True, exist_ok=True)
    for name in ("README.md", "LICENSE", "reference", "pkg", "scripts", "tests"):
        link = source / name
        if not link.is_symlink():
            link.symlink_to(ROOT / name)
    write_api(source / "api")
    if status := build_main(["-qW", "--keep-going", "-c", str(HERE), str(source), str(SITE)]):
        return status
    for name in FORMULAS:
        copy = shutil.copytree if (MATHJAX / name).is_dir() else shutil.copy
        target = SITE / "_static" / "mathjax" / name
        if not target.exists():
            target.parent.mkdir(parents=True, exist_ok=True)
            copy(MATHJAX / name, target)
    (SITE / "index.html").write_text(GO_ON, encoding="utf-8")
    print(f"made {SITE / 'index.html'}")
    return 0


sys.exit(main())

# SPDX-License-Identifier: GPL-2.0-or-later
"""How Sphinx makes the HTML site; make_site.py runs it."""

import re
from inspect import cleandoc

from docutils import nodes
from docutils.parsers.rst import roles

project = "yade-membrane"
copyright = "the authors, GPL-2.0-or-later"
root_doc = "README"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax"]
exclude_patterns = ["pkg/membrane/[!y]*", "scripts", "tests"]
html_theme = "furo"
html_title = "Membranes in YADE"
mathjax_path = "mathjax/MathJax.js?config=TeX-AMS_CHTML-full"  # which make_site.py copies
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
myst_update_mathjax = False  # it means a later MathJax than Debian's
autodoc_default_options = {
    "members": True,
    "member-order": "bysource",
    "exclude-members": "updateAttrs",  # of every class of YADE
}
suppress_warnings = ["ref.python"]  # classes of one name in two modules
pygments_style = "friendly"

# Pages that are in no table of contents of their own, in order, by the page that leads to them.
CONTENTS = {
    "README": ("reference/guide/README", "reference/model", "reference/README", "api/index"),
    "reference/guide/README": (
        *("first-run", "parameters", "own-sail", "patterns", "many-runs", "look", "accuracy"),
        *("speed", "stability", "yade", "install", "extend"),
    ),
    "reference/README": ("CONTRIBUTING", "CHANGELOG", "stability/README"),
    "reference/guide/install": ("/pkg/membrane/yade-abi/README",),
}


def read(app, name, source):
    """Pages are written for GitHub: what Sphinx needs beside that."""
    source[0] = source[0].replace("```math", "```{math}")
    if name in CONTENTS:
        source[0] += "\n\n```{toctree}\n:hidden:\n\n" + "\n".join(CONTENTS[name]) + "\n```\n"


def explain(app, what, name, thing, options, lines):
    """Docstrings of the plugin's classes are written for YADE's manual."""
    # Of a property napoleon would take what precedes a colon for its type.
    text = cleandoc(thing.__doc__) if isinstance(thing, property) else "\n".join(lines)
    text = re.sub(
        r":ydefault:`(.*?)` :yattrtype:`(.*?)` :yattrflags:`.*?`", r"(\2, default \1)", text
    )
    text = re.sub(r"\((.*?), default \)", r"(\1)", text)
    lines[:] = text.split("\n")


def sign(app, what, name, thing, options, signature, returned):
    """Signatures as Boost.Python has them, (Class)arg1 [, (int)count=1], become Python's."""
    if not signature or "(object)" not in signature and ")arg1" not in signature:
        return None
    words, optional = re.subn(r" ?\[(?=, \(|\()", "", signature)
    words = words.removesuffix(optional * "]" + ")") + ")"
    words = re.sub(r"\((object|[A-Z]\w*)\)arg1(, )?", "", words)
    return re.sub(r"\(\w+\)", "", words), (returned or "").rstrip(" :") or None


def yref(name, rawtext, text, lineno, inliner, options={}, content=[]):
    """A reference to a class of YADE, as `Class` or `words<Class>`."""
    return [nodes.literal(rawtext, text.partition("<")[0])], []


def setup(app):
    """What Sphinx calls."""
    roles.register_local_role("yref", yref)
    app.connect("source-read", read)
    app.connect("autodoc-process-docstring", explain, priority=600)  # after napoleon
    app.connect("autodoc-process-signature", sign)

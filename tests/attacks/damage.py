# SPDX-License-Identifier: GPL-2.0-or-later
"""Saved scenes damaged where the plugin's own objects are. All of a case follows from its name."""

import copy
import xml.etree.ElementTree as tree
from functools import lru_cache
from random import Random

from arsenal import CLASSES
from attacks import attempt, follow_up, go_on
from membrane import scene
from situations import World, run
from support import O, scratch

HEAD = '<?xml version="1.0" encoding="UTF-8" standalone="yes" ?>\n<!DOCTYPE boost_serialization>\n'
TEXTS = "nan inf -inf -1 0 1 1e308 -1e308 2147483647 -2147483648 99999999999999999999".split()
TEXTS += ["", "x", "paper"]
# Boost makes room for as many entries as a file says: more would only fill the memory.
MOST = 10**6
STEPS = 20  # after loading


def names(times):
    """Names of damaged scenes."""
    return [f"damaged.{scene.PATHS[number % 2]} {number}" for number in range(times)]


@lru_cache(maxsize=None)
def saved(path):
    """The root of a saved scene."""
    run(path)
    file = scratch() / f"whole_{path}.xml"
    O.save(str(file), quiet=True)
    return tree.parse(file).getroot()


def own_parts(root):
    """Elements of the plugin's objects in a saved scene with their parents: (parent, element).

    Left out are the objects of YADE to which they point: YADE does not look whether its own are
    whole. So are the numbers by which the archive knows objects again.
    """
    classes, found = {}, []

    def walk(element, ours):
        number = element.get("class_id") or element.get("class_id_reference")
        if name := element.get("class_name"):
            classes[number] = name.replace("yade::", "")
        if number in classes:
            ours = classes[number] in CLASSES
        for child in element:
            if ours:
                found.append((element, child))
            walk(child, ours)

    walk(root, False)
    return found


def damage(root, chance, tell):
    """Damage one part of the plugin's own."""
    parts = own_parts(root)
    parent, part = chance.choice(parts)
    leaf = len(part) == 0
    how = chance.choice(("change", "change", "change", "drop", "double", "swap", "empty"))
    tell(f"{how} {parent.tag}/{part.tag}")
    if part.tag == "px":  # a pointer
        part.clear()
        part.set("class_id", "-1")
    elif part.tag == "count":
        part.text = str(chance.choice((0, int(part.text) - 1, int(part.text) + 1, MOST)))
    elif how == "change" and leaf:
        part.text = chance.choice(TEXTS)
        tell(part.text)
    elif how == "drop":
        parent.remove(part)
    elif how == "double":
        parent.insert(list(parent).index(part), copy.deepcopy(part))
    elif how == "swap" and leaf:
        _, other = chance.choice([pair for pair in parts if len(pair[1]) == 0])
        part.text, other.text = other.text, part.text
    elif how == "empty":
        for child in list(part):
            part.remove(child)
        part.text = ""


def carry_out(name, tell):
    """Load the damaged scene of a name and run on; raises Harm as `attacks.carry_out`."""
    tell(name)
    chance = Random(name)
    root = copy.deepcopy(saved(name.split()[0].partition(".")[2]))
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        damage(root, chance, tell)
    file = scratch() / "damaged.xml"
    file.write_text(HEAD + tree.tostring(root, encoding="unicode", short_empty_elements=False))
    O.reset()
    attempt(lambda: O.load(str(file), quiet=True))
    go_on(World(), STEPS)
    follow_up(World())

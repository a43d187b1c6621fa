# SPDX-License-Identifier: GPL-2.0-or-later
"""The configuration of the workflow: a grid over any parameters, and what all cases share."""

import json
import os
from contextlib import suppress
from dataclasses import fields
from itertools import product
from pathlib import Path

import yaml
from membrane.files import BadFile, GivenTwice, one_of_each, read_text, shown
from membrane.parameters import (
    PARSERS,
    TABLE_2_CASES,
    TABLE_2_DURATION,
    SailParameters,
    check_name,
    read_values,
    whole,
)

from .grid import case_name, refuse_other_results

KINDS = {item.name: item.type for item in fields(SailParameters)}
WORDS = {
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    str: "a word",
}
NUMBERS = ("threads", "memory", "minutes")
NAMES = ("grid", "options", "out", *NUMBERS)


def read_config(path):
    """The object (dict) in a file of YAML or JSON, as Snakemake reads it.

    Raises
    ------
    BadFile or OSError
    """
    text = read_text(path)
    try:
        found = _parsed(text)
    except GivenTwice as error:
        raise BadFile(path, str(error), "is given twice") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = f"line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        reason = getattr(error, "problem", None) or "it cannot be read"
        raise BadFile(path, place, f"is no YAML: {reason}") from None
    except RecursionError:
        raise BadFile(path, "", "is nested too deeply") from None
    except ValueError as error:  # a date or a number that Python cannot hold
        raise BadFile(path, "", f"is no YAML: {error}") from None
    if not isinstance(found, dict):
        raise BadFile(path, "", f"must hold names with values, not {shown(found)}")
    return found


def _parsed(text):
    """What a text of JSON or else of YAML says."""
    try:
        return json.loads(text, object_pairs_hook=one_of_each)
    except GivenTwice:
        raise
    except ValueError:
        return yaml.load(text, _Loader)


class _Loader(yaml.SafeLoader):
    """YAML in which one object must not name a key twice."""

    def compose_mapping_node(self, anchor):
        node = super().compose_mapping_node(anchor)
        keys = (key for key, _ in node.value if isinstance(key, yaml.ScalarNode))
        words = (key for key in keys if key.tag != "tag:yaml.org,2002:merge")  # <<
        one_of_each((self.construct_object(word), None) for word in words)
        return node


def check_file(path):
    """Raise BadFile or OSError unless the workflow can use a file of configuration.

    It may be a part of one; the files and folders that it names are not looked at.
    """
    config = read_config(path)
    try:
        check_part(config)
    except ValueError as error:
        raise BadFile(path, "", str(error)) from None


def check(config):
    """The cases that a whole configuration asks for.

    Returns
    -------
    dict of dict
        By the case's name: the values of its parameters in the grid.

    Raises
    ------
    ValueError
        In one sentence, if no case can be run by it.
    """
    check_part(config)
    own = config.get("grid")
    grid = TABLE_2_CASES if own is None else own
    for name in config.get("options") or {}:
        if name in grid:
            which = "" if own else " (Table 2, since none is given)"
            raise ValueError(f"options: {name} is in the grid, too{which}: must be in one of them")
    cases = [dict(zip(grid, values)) for values in product(*grid.values())]
    return {case_name(case): case for case in cases}


def check_words(words):
    """Raise ValueError if words of the form NAME=VALUE, with values in YAML, give a name twice."""
    try:
        one_of_each(word.partition("=")[::2] for word in words)
        for word in words:
            with suppress(yaml.YAMLError):  # then it is a text
                _parsed(word.partition("=")[2])
    except GivenTwice as error:
        raise ValueError(f"--config: {error} is given twice") from None


def check_part(config):
    """Raise ValueError, in one sentence, if a configuration or a part of one cannot be used."""
    for name in config:
        if name not in NAMES:
            raise ValueError(f"{_word(name)} is nothing to configure; known are {', '.join(NAMES)}")
    numbers(config)
    out = config.get("out", "out")
    if not isinstance(out, str) or not out.strip() or set(out) & set("{}\0"):
        raise ValueError(f"out = {shown(out)} must be the name of a folder, without {{ and }}")
    check_name(out)
    if config.get("options") is not None:
        _check_options(config["options"])
    if config.get("grid") is not None:
        _check_grid(config["grid"])


def common(config):
    """Options that all cases of a configuration share."""
    found = {"duration": TABLE_2_DURATION, **(config.get("options") or {})}
    if "parameters" in found:
        found["parameters"] = os.path.expanduser(found["parameters"])
    return found


def numbers(config):
    """What a cluster gives each case: NUMBERS by name, int, those of them that are configured."""
    found = {}
    for name in (name for name in NUMBERS if name in config):
        value = config[name]
        try:
            found[name] = 0 if isinstance(value, bool) else whole(str(value))
        except ValueError:
            found[name] = 0
        if found[name] < 1:
            raise ValueError(f"{name} = {shown(value)} must be a whole number >= 1")
    return found


def folder(config):
    """Name of the folder of the results, which no command takes for an option."""
    name = os.path.expanduser(config["out"])
    return os.path.abspath(name) if name.startswith("-") else name


def check_places(config):
    """Raise ValueError or OSError unless the files and folders of a configuration are as they must.

    They are relative to the present folder.
    """
    out = Path(folder(config))
    refuse_other_results(out)
    there = next(path for path in (out, *out.parents) if path.exists())
    if not (there.is_dir() and os.access(there, os.W_OK)):
        raise ValueError(f"out = {shown(config['out'])}: {there} is no folder to write to")
    if "parameters" in common(config):
        read_values(common(config)["parameters"])


def _check_options(options):
    """Raise ValueError if scripts/case.py would refuse an option."""
    if not isinstance(options, dict):
        raise ValueError(f"options: must be names with values, not {shown(options)}")
    for name, value in options.items():
        if name in KINDS:
            _typed("options", name, value)
        elif name == "no_pictures":
            if value is not True:
                raise ValueError(f"options: no_pictures = {shown(value)} must be true, or left out")
        elif name == "checkpoint_every":
            is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
            if not (is_number and 0 <= value < float("inf")):
                raise ValueError(f"options: checkpoint_every = {shown(value)} s must be >= 0")
        elif name == "parameters":
            if not isinstance(value, str):
                raise ValueError(f"options: parameters = {shown(value)} must be a file's name")
        else:
            raise ValueError(f"options: {_word(name)} is no parameter of the sail")


def _check_grid(grid):
    """Raise ValueError unless a grid has values, and such of parameters."""
    if not isinstance(grid, dict) or not grid:
        raise ValueError(f"grid: must be parameters with lists of values, not {shown(grid)}")
    for name, values in grid.items():
        if name not in KINDS:
            raise ValueError(f"grid: {_word(name)} is no parameter of the sail")
        if not isinstance(values, list) or not values:
            raise ValueError(f"grid: {name} must be a list of values, not {shown(values)}")
        typed = [_typed("grid", name, value) for value in values]
        if len(set(typed)) < len(typed):
            raise ValueError(f"grid: {name}: a value is given twice")


def _typed(place, name, value):
    """The value that scripts/case.py makes of a parameter's; ValueError if it would refuse it."""
    kind = KINDS[name]
    is_switch = isinstance(value, bool)
    try:
        if is_switch != (kind is bool) or not isinstance(value, (int, float, str)):
            raise ValueError
        # YAML takes 1e3 for a text, and the command line gets texts.
        found = value if is_switch else PARSERS[kind](str(value))
    except ValueError:
        raise ValueError(f"{place}: {name} = {shown(value)} must be {WORDS[kind]}") from None
    try:
        SailParameters(**{name: found})
    except ValueError as error:
        raise ValueError(f"{place}: {error}") from None
    return found


def _word(name):
    """A name as a message repeats it."""
    return shown(name)[1:-1] if isinstance(name, str) else shown(name)

# SPDX-License-Identifier: GPL-2.0-or-later
"""The short configuration of a sweep: a file of YAML, turned into words of its command."""

from typing import Any

import yaml
from membrane.files import BadFile, GivenTwice, one_of_each, read_text, shown

MAPS = ("grid", "options")
NAMES = ("sail", *MAPS, "out", "threads", "memory", "minutes", "jobs", "slurm")


def config_words(path: str) -> tuple[str, list[str]]:
    """SAIL, "" if there is none, and the further words that a configuration stands for.

    BadFile or OSError if it is none; who parses the words finds what is no option of the sweep.
    """
    config = read_config(path)
    for name in config:
        if name not in NAMES:
            known = ", ".join(NAMES)
            raise BadFile(path, _word(name), f"is nothing to configure; known are {known}")
    sail, *maps = config.pop("sail", ""), *(config.pop(name, None) or {} for name in MAPS)
    if not isinstance(sail, str):
        raise BadFile(path, "sail", f"must be a word, not {shown(sail)}")
    for name, found in zip(MAPS, maps):
        if not isinstance(found, dict):
            raise BadFile(path, name, f"must be names with values, not {shown(found)}")
    try:
        given = one_of_each((_word(k), v) for values in (*maps, config) for k, v in values.items())
    except GivenTwice as error:
        raise BadFile(path, str(error), "is given twice") from None
    return sail, [word for name, value in given.items() for word in _words(name, value)]


def _words(name, value):
    """An option of this name, with its value or values."""
    flag = f"--{name.replace('_', '-')}"
    if isinstance(value, list):
        return [flag, *map(str, value)]
    return [flag] if value is True else [f"{flag}={value}"]


def _word(name):
    """A name as a message repeats it."""
    return shown(name)[1:-1] if isinstance(name, str) else shown(name)


def read_config(path: str) -> dict[Any, Any]:
    """The object in a file of YAML, as JSON is, too; BadFile or OSError if there is none."""
    text = read_text(path)
    try:
        found = yaml.load(text, _Loader)
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


class _Loader(yaml.SafeLoader):
    """YAML in which one object must not name a key twice."""

    def compose_mapping_node(self, anchor):
        node = super().compose_mapping_node(anchor)
        keys = (key for key, _ in node.value if isinstance(key, yaml.ScalarNode))
        words = (key for key in keys if key.tag != "tag:yaml.org,2002:merge")  # <<
        one_of_each((self.construct_object(word), None) for word in words)
        return node

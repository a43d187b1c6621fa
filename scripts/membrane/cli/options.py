# SPDX-License-Identifier: GPL-2.0-or-later
"""Options of commands: folders, files, numbers, and one for every parameter."""

import argparse
import os
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path
from typing import Any

from ..files import shown
from ..parameters import PARSERS, Refused, SailParameters, check_name, describe
from ..parameters import number, read_values, whole
from ..run.sails import SAILS


def folder(text: str) -> Path:
    """A Path from a word of the command line, which must not be empty."""
    if not text:
        raise Refused("must name a folder")
    return file(text)


def file(text: str) -> Path:
    """A Path from a word of the command line; Refused unless its name is UTF-8."""
    path = Path(os.path.expanduser(text))
    check_name(path)
    return path


def count(text: str) -> int:
    """A whole number from a word of the command line, which must be at least 1."""
    found = whole(text)
    if found < 1:
        raise Refused(f"{text}: must be at least 1")
    return found


def add_out(
    parser: argparse.ArgumentParser, default: str | Path | None = None, text: str = "default: {}"
) -> None:
    """Add the option --out, a folder; its help is `text` with the default."""
    text, default = text.format(default), default and Path(default)
    parser.add_argument("--out", type=folder, default=default, metavar="DIR", help=text)


def add_checkpoints(parser: argparse.ArgumentParser) -> None:
    """Add the option --checkpoint-every."""
    text = "wall time between two checkpoints of a case [s], >= 0 (default 60)"
    form: dict[str, Any] = {"type": _interval, "default": 60.0, "metavar": "SECONDS"}
    parser.add_argument("--checkpoint-every", **form, help=text)


def _interval(word):
    """A time from a word of the command line, which must be finite and not below 0."""
    found = number(word)
    if not 0 <= found < float("inf"):
        raise Refused(f"{word}: must be >= 0 and finite")
    return found


def add_only(
    parser: argparse.ArgumentParser, names: Iterable[str], text: str, word: str = "MODULE"
) -> None:
    """Add the option --only for some of `names`; all by default."""
    about: dict[str, Any] = {
        "choices": names,
        "default": list(names),
        "metavar": word,
        "help": text,
    }
    parser.add_argument("--only", nargs="+", **about)


def chosen_sail(words: list[str], default: str = "square") -> tuple[Any, list[str]]:
    """Class of parameters that the first word of a command line means, and the words that are left.

    That word may be the name of a kind of sail, or that of a file, which stays; or an option: then
    the kind is `default`.
    """
    first = words[0] if words else "-"
    if first in SAILS:
        return SAILS[first].parameters, words[1:]
    if Path(first).suffix.lower() in (".fold", ".msh"):
        default = "sheet"
    elif not first.startswith("-"):
        raise Refused(
            f"SAIL is {first!r}: must be a .fold or .msh file, or one of {', '.join(SAILS)}"
        )
    return SAILS[default].parameters, words


def sails_text() -> str:
    """What a help text tells of the kinds of sail."""
    kinds = "; ".join(f"{name}, {kind.title}" for name, kind in SAILS.items())
    return f"SAIL, if any, comes first: {kinds}; or the name of such a file (default square)."


def add_arguments(
    parser: argparse.ArgumentParser, kind: Any = SailParameters, several: bool = False
) -> None:
    """Add one option for every parameter of a class `kind` to a parser, grouped by source.

    With `several` each takes one value or more, and has none unless it is given.
    """
    for source in dict.fromkeys(item.metadata["source"] for item in fields(kind)):
        group = parser.add_argument_group(f"parameters, {source}")
        for item in fields(kind):
            if item.metadata["source"] == source:
                _add_argument(group, item, several)


def parse(
    parser: argparse.ArgumentParser, kind: Any = SailParameters, words: list[str] | None = None
) -> argparse.Namespace:
    """Arguments of a parser, which gets options for all parameters and one for a file of them.

    What is given on the command line, or in `words` in its place, wins over the file, which wins
    over defaults; `kind` is the class of the parameters. BadFile or OSError if the file is none.
    """
    add_arguments(parser, kind)
    add_file(parser)
    arguments = parser.parse_args(words)
    if arguments.parameters is not None:
        parser.set_defaults(**read_values(arguments.parameters, kind))
        arguments = parser.parse_args(words)
    return arguments


def add_file(parser: argparse.ArgumentParser) -> None:
    """Add the option --parameters, a file of them."""
    text = "take parameters that are not given from this JSON file, as summary.json of a run"
    parser.add_argument("--parameters", type=_named, metavar="FILE", help=text)


def _named(word):
    """The name of a file from a word of the command line."""
    check_name(word)
    return word


def _truth(word):
    """A truth value from a word of the command line."""
    if word.lower() not in ("true", "false"):
        raise Refused(f"must be true or false, not {shown(word)}")
    return word.lower() == "true"


def _add_argument(group, item, several):
    """Add the option for one parameter, a Field, to an argparse group."""
    about = item.metadata
    form: dict[str, Any] = {"nargs": "+"} if several else {}
    if item.name == "file" and not item.default:
        group.add_argument("file", type=_named, help=about["text"], **form)
        return
    flag, text = "--" + item.name.replace("_", "-"), describe(item).replace("%", "%%")
    default = argparse.SUPPRESS if several else item.default
    if item.type is bool and not several:
        group.add_argument(flag, action=argparse.BooleanOptionalAction, default=default, help=text)
        return
    if item.type is bool:
        form = {"nargs": "*", "type": _truth}
    else:
        form |= {"type": PARSERS[item.type], "choices": about["choices"]}
        form["metavar"] = None if about["choices"] else about["unit"].replace("-", "N")
    group.add_argument(flag, default=default, help=text, **form)


def from_arguments(
    arguments: argparse.Namespace, overrides: dict | None = None, kind: Any = SailParameters
) -> Any:
    """Parameters from parsed arguments; `overrides` (a dict, as from a batch table) win."""
    values = {item.name: getattr(arguments, item.name) for item in fields(kind)}
    for name, value in (overrides or {}).items():
        if name not in values:
            known = ", ".join(sorted(values))
            raise ValueError(f"{name} is not a parameter of the sail; it has {known}")
        values[name] = value
    return kind(**values)

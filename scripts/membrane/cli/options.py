# SPDX-License-Identifier: GPL-2.0-or-later
"""Options of commands: folders, files, numbers, and one for every parameter."""

import argparse
import os
from collections.abc import Iterable
from dataclasses import Field, fields
from pathlib import Path
from typing import Any

from ..parameters import PARSERS, Refused, SailParameters, check_name, describe, read_values, whole
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
    """Which kind of sail the first word of a command line means, and the words that are left.

    Parameters
    ----------
    words : list of str
        The first may be the name of a kind, or that of a file, which stays; or an option.
    default : str
        Kind where none is meant.

    Returns
    -------
    kind : class
        Of its parameters.
    words : list of str
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
    parser: argparse.ArgumentParser,
    kind: Any = SailParameters,
    several: dict | None = None,
    defaults: dict | None = None,
) -> None:
    """Add one option for every parameter to an argparse parser, grouped by source.

    Parameters
    ----------
    parser : ArgumentParser
    kind : class
        Of the parameters.
    several : dict, optional
        Defaults, a sequence each, of those parameters that take one value or more.
    defaults : dict, optional
        Of the others, in place of those of `kind`.
    """
    chosen = {**(defaults or {}), **{name: list(v) for name, v in (several or {}).items()}}
    for source in dict.fromkeys(item.metadata["source"] for item in fields(kind)):
        group = parser.add_argument_group(f"parameters, {source}")
        for item in fields(kind):
            if item.metadata["source"] == source:
                add_argument(group, item, chosen.get(item.name, item.default))


def parse(
    parser: argparse.ArgumentParser,
    kind: Any = SailParameters,
    words: list[str] | None = None,
    *,
    several: dict | None = None,
    defaults: dict | None = None,
    root: argparse.ArgumentParser | None = None,
) -> argparse.Namespace:
    """Arguments of an argparse parser with options for all parameters and one for a file of them.

    What is given on the command line wins over the file, which wins over `defaults`, a dict.

    Parameters
    ----------
    parser : ArgumentParser
        Gets the options.
    kind : class
        Of the parameters.
    words : list of str, optional
        In place of those of sys.argv.
    several : dict, optional
        See add_arguments; the file's values of these parameters do not count.
    defaults : dict, optional
        In place of those of `kind`.
    root : ArgumentParser, optional
        Parses, if `parser` is one of its commands.

    Raises
    ------
    BadFile or OSError
    """
    add_arguments(parser, kind, several, defaults)
    text = "take parameters that are not given from this JSON file, as summary.json of a run"
    parser.add_argument("--parameters", type=_named, metavar="FILE", help=text)
    root = root or parser
    arguments = root.parse_args(words)
    file = getattr(arguments, "parameters", None)
    if file is not None:
        values = read_values(file, kind)
        parser.set_defaults(**{n: v for n, v in values.items() if n not in (several or {})})
        arguments = root.parse_args(words)
    return arguments


def _named(word):
    """The name of a file from a word of the command line."""
    check_name(word)
    return word


def add_argument(group: Any, item: Field, default: Any) -> None:
    """Add the option for one parameter to an argparse parser or group.

    Parameters
    ----------
    group : ArgumentParser or its group
    item, default
        As of `describe`.
    """
    if item.name == "file" and not default:
        group.add_argument("file", type=_named, help=item.metadata["text"])
        return
    flag = "--" + item.name.replace("_", "-")
    text = describe(item, default).replace("%", "%%")
    if item.type is bool:
        group.add_argument(flag, action=argparse.BooleanOptionalAction, default=default, help=text)
        return
    choices = item.metadata["choices"]
    metavar = None if choices else item.metadata["unit"].replace("-", "N")
    more = {"nargs": "+"} if isinstance(default, list) else {}
    group.add_argument(
        flag,
        type=PARSERS[item.type],
        default=default,
        choices=choices,
        metavar=metavar,
        help=text,
        **more,
    )


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

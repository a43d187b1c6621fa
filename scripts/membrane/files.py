# SPDX-License-Identifier: GPL-2.0-or-later
"""Reading files of others: bounded, strict, and refused in one sentence where something is wrong.

Every reader of the package raises `BadFile` for whatever a file may hold, and nothing else; only
a file that cannot be opened at all is an OSError.
"""

import json
import math
import os
import secrets
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

LARGEST = 256 * 2**20  # bytes; ten million nodes fill about as much
SHOWN = 60  # characters of a bad value that a message repeats
TEMPORARY = ".membrane-"  # names of files begin by it that are to take the place of others


class BadFile(ValueError):
    """A file that cannot be used: says in one sentence which one, where in it, and why.

    `place` is as `file_frames[2].edges_vertices[7]`, or empty: the file as a whole.
    """

    def __init__(self, path: Path | str, place: str, reason: str) -> None:
        where = f"{path}: {place}" if place else str(path)
        super().__init__(" ".join(f"{where}: {reason}".split()))


def shown(value: object) -> str:
    """A value as a message repeats it: on one line and not too long."""
    # Never the whole of a long list or number: its text may be larger than the file.
    if isinstance(value, (list, dict)):
        return f"a list of {len(value)}" if isinstance(value, list) else "an object"
    if isinstance(value, int) and abs(value) > 10**SHOWN:
        return f"a whole number of {value.bit_length()} bits"
    text = repr(value)
    return text if len(text) <= SHOWN else text[:SHOWN] + "…"


def is_value(text: str) -> bool:
    """Whether a text is a finite number, written as others than Python write it, too."""
    try:
        return "_" not in text and math.isfinite(float(text))
    except ValueError:
        return False


def read_bytes(path: Path | str, largest: int = LARGEST) -> bytes:
    """All of a file's bytes; BadFile if there are none or more than `largest`."""
    with open(path, "rb") as file:
        content = file.read(largest + 1)
    if len(content) > largest:
        raise BadFile(path, "", f"is larger than {largest} bytes, the limit")
    if not content.strip():
        raise BadFile(path, "", "is empty")
    return content


def read_text(path: Path | str, largest: int = LARGEST) -> str:
    """A file's text, which must be UTF-8; BadFile otherwise."""
    try:
        return read_bytes(path, largest).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise BadFile(path, f"byte {error.start}", "is no UTF-8 text") from None


class GivenTwice(ValueError):
    """A key that one object names twice: the message is the key."""


def one_of_each(pairs: Iterable[tuple[Any, Any]]) -> dict:
    """A dict of pairs of key and value; GivenTwice if a key is there twice."""
    found = {}
    for key, value in pairs:
        if key in found:
            raise GivenTwice(shown(key)[1:-1] if isinstance(key, str) else shown(key))
        found[key] = value
    return found


def read_json(path: Path | str, largest: int = LARGEST) -> Any:
    """What a JSON file holds, by the letter of RFC 8259; an object must not name a key twice.

    BadFile also for NaN and Infinity, for numbers too large for a float and for deep nesting.
    """

    def refuse(word: str) -> None:
        raise BadFile(path, "", f"holds {word}, which is not a number in JSON")

    def number(text: str) -> float:
        value = float(text)
        if not math.isfinite(value):
            raise BadFile(path, "", f"holds {text[:SHOWN]}, too large a number")
        return value

    text = read_text(path, largest)
    try:
        return json.loads(
            text, parse_constant=refuse, parse_float=number, object_pairs_hook=one_of_each
        )
    except BadFile:
        raise
    except GivenTwice as error:
        raise BadFile(path, str(error), "is given twice in one object") from None
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise BadFile(path, place, f"is no JSON: {error.msg}") from None
    except RecursionError:
        raise BadFile(path, "", "is nested too deeply") from None
    except ValueError:  # a whole number of more digits than Python converts
        raise BadFile(path, "", "holds a number with too many digits") from None


def read_object(path: Path | str, largest: int = LARGEST) -> dict:
    """The object (dict) that a JSON file holds; BadFile if it holds something else."""
    found = read_json(path, largest)
    if not isinstance(found, dict):
        raise BadFile(path, "", f"must hold an object, not {shown(found)}")
    return found


@contextmanager
def named(path: Path | str) -> Iterator[None]:
    """An OSError in the block that names no file, or a temporary one, names `path`."""
    try:
        yield
    except OSError as error:
        if error.filename is not None and TEMPORARY not in str(error.filename):
            raise
        reason = error.strerror or str(error) or type(error).__name__
        if error.errno is None:
            raise OSError(f"{path}: could not be written: {reason}") from error
        raise OSError(error.errno, f"could not be written: {reason}", str(path)) from error


@contextmanager
def replacing(path: Path | str) -> Iterator[Path]:
    """Give a path to write to, which takes the place of `path` at the end of the block.

    Readers see either the old file or the new one, also after a power cut. Where the block ends by
    an error the old one stays, and what was written is removed; an OSError names the file. A link
    at `path` is replaced itself.
    """
    path = Path(path)
    with named(path):
        part = _new_file(path)
        try:
            yield part
            flush(part)
            os.replace(part, path)
        except BaseException:
            part.unlink(missing_ok=True)
            raise
    with suppress(OSError):  # not every file system can, and no file is lost without it
        flush(path.parent)


def _new_file(path):
    """Make an empty file beside `path` under a name that nothing else has; returns its Path."""
    while True:
        new = path.with_name(TEMPORARY + secrets.token_hex(4))
        with suppress(FileExistsError):
            os.close(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o666))
            return new


def replace_text(path: Path | str, text: str) -> None:
    """Write a text file so that readers see either the old one or the new one."""
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")


def write_json(path: Path | str, content: object) -> None:
    """Write a JSON file so that readers see either the old one or the new one."""
    replace_text(path, json.dumps(content, indent=2, allow_nan=False) + "\n")


def settle(folder: Path | str) -> None:
    """Wait until all in `folder` is on the disk, so that a power cut cannot take it back."""
    folder = Path(folder)
    for path in [*folder.rglob("*"), folder]:
        flush(path)


def add_to_sum(checksum: Any, path: Path | str, size: int = -1) -> Any:
    """Add a file's first `size` bytes, -1: all, to a checksum of hashlib, and give that back."""
    with open(path, "rb") as file:
        checksum.update(file.read(size))
    return checksum


def flush(path: Path | str) -> None:
    """Wait until a file, or the names in a folder, are on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)

# SPDX-License-Identifier: GPL-2.0-or-later
"""Small files that are there as a whole or not at all. Needs no YADE."""

import json
import os
from pathlib import Path


def replace_text(path, text):
    """Write a text file so that readers see either the old one or the new one."""
    path = Path(path)
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    os.replace(part, path)


def write_json(path, content):
    """Write a JSON file so that readers see either the old one or the new one."""
    replace_text(path, json.dumps(content, indent=2, allow_nan=False) + "\n")


def settle(folder):
    """Wait until all in `folder` is on the disk, so that a power cut cannot take it back."""
    folder = Path(folder)
    for path in [*folder.rglob("*"), folder]:
        handle = os.open(path, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)

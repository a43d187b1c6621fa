# SPDX-License-Identifier: GPL-2.0-or-later
"""gmsh in a process of its own: on absurd input it crashes, or asks for any amount of memory."""

import os
import resource
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from collections.abc import Callable
from pathlib import Path
from typing import Any

MEMORY = 8 * 2**30  # bytes that it may ask for


class GmshError(ValueError):
    """What gmsh says of its trouble, or that it crashes."""


def in_gmsh(work: Callable, *arguments: Any) -> Any:
    """What `work(gmsh, *arguments)` gives, in a process that ends with it.

    `work` is a function of a module; its arguments and what it gives go through pickle. GmshError
    if gmsh raises an error, or crashes; ValueError if `work` raises it, or gmsh is not installed.
    """
    with ProcessPoolExecutor(1, get_context("fork"), _begin) as child:
        try:
            return child.submit(_work, work, arguments).result()
        except BrokenProcessPool:
            raise GmshError("it crashes") from None


def _begin():
    """Send what gmsh prints to nowhere, and limit its memory; leave no core on the disk."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    used = (
        int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[0])
        * resource.getpagesize()
    )
    for kind, most in ((resource.RLIMIT_AS, used + MEMORY), (resource.RLIMIT_CORE, 0)):
        soft, hard = resource.getrlimit(kind)
        limits = [limit for limit in (soft, hard, most) if limit != resource.RLIM_INFINITY]
        resource.setrlimit(kind, (min(limits), hard))


def _work(work, arguments):
    try:
        import gmsh
    except ImportError:
        raise ValueError("this needs gmsh: apt-get install python3-gmsh") from None
    gmsh.initialize(readConfigFiles=False)
    try:
        for option, value in (
            ("General.Terminal", 0),
            ("General.NumThreads", 1),  # the same mesh everywhere
            ("General.ExpertMode", 1),  # it must not wait for answers
        ):
            gmsh.option.setNumber(option, value)
        return work(gmsh, *arguments)
    except ValueError:
        raise
    except MemoryError:
        raise GmshError("it wants too much memory") from None
    except Exception as error:  # gmsh raises Exception itself
        raise GmshError(str(error)) from None
    finally:
        gmsh.finalize()

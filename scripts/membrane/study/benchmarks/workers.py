# SPDX-License-Identifier: GPL-2.0-or-later
"""Workers: processes of YADE, each with a scene of its own, that measure when they are asked.

They stay while the others take their turns, so that each scene is built only once.
"""

import json
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

SCRIPT = Path(__file__).resolve().with_name("worker.py")
MARK = "worker: "  # begins the lines that are answers; YADE prints others


class Worker:
    """A process of YADE with one of situations.ALL, with its `options`, in its scene."""

    def __init__(self, situation: str, threads: int = 1, **options: Any) -> None:
        self.name = f"{situation} {options} on {threads} threads"
        self.said = tempfile.TemporaryFile("w+", encoding="utf-8")
        asked = {"situation": situation, "threads": threads, "options": options}
        self.process = subprocess.Popen(
            ["yade", "-n", "-x", "-j", str(threads), str(SCRIPT), json.dumps(asked)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.said,
            encoding="utf-8",
        )
        self._answer()

    def _answer(self):
        for line in self.process.stdout or ():
            if line.startswith(MARK):
                return json.loads(line[len(MARK) :])
        self.said.seek(0)
        raise RuntimeError(f"worker ended ({self.name}): {self.said.read().strip()[-600:]}")

    def measure(self, steps: int) -> dict:
        """What the situation measures in `steps` steps."""
        print(steps, file=self.process.stdin, flush=True)
        return self._answer()

    def timed(self, steps: int, clock: str) -> float:
        """The time by one of its clocks."""
        return self.measure(steps)[clock]

    def close(self) -> None:
        """End the process."""
        try:
            self.process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.communicate()
        self.said.close()


@contextmanager
def workers(plans: dict[Any, dict]) -> Iterator[dict[Any, Worker]]:
    """Start workers, from their arguments (dicts) by name, and end them; gives them by name."""
    with ExitStack() as stack:
        started = {}
        for name, plan in plans.items():
            started[name] = Worker(**plan)
            stack.callback(started[name].close)
        yield started

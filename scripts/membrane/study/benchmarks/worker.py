# SPDX-License-Identifier: GPL-2.0-or-later
"""A process of YADE that builds one situation and measures it whenever it is asked.

Started by `workers.Worker`, since YADE's threads are fixed at the start: takes a
situation and its options as JSON, then numbers of steps, one a line, and answers each with a line
of JSON.
"""

import json
import os
import sys

from membrane.study.benchmarks import situations
from membrane.study.benchmarks.workers import MARK


def say(content: dict) -> None:
    """Print a line that is an answer."""
    print(MARK + json.dumps(content), flush=True)


def main() -> None:
    """Build, then answer until there are no more questions."""
    asked = json.loads(sys.argv[1])
    threads = int(os.environ["OMP_NUM_THREADS"])
    if threads != asked["threads"]:
        raise RuntimeError(f"YADE runs on {threads} threads instead of {asked['threads']}")
    measure = situations.ALL[asked["situation"]](**asked["options"])
    say({"ready": True})
    for line in sys.stdin:
        say(measure(int(line)))


main()

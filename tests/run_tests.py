# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs all tests in YADE: `yade -n -x tests/run_tests.py [--full | --quick] [MODULE ...]`.

--full adds the long ones; --quick takes the modules that say QUICK = True: less than a minute, and
no scene is built. MODULE, as `test_creases`, keeps to the tests named.
"""

import argparse
import os
import signal
import sys
from pathlib import Path

# YADE keeps __file__ for itself.
sys.path.insert(0, str(Path(sys.argv[0]).resolve().parent))


def main():
    """Run the tests; returns the exit status."""
    parser = argparse.ArgumentParser(prog="run_tests", description="Run the tests in YADE.")
    how_many = parser.add_mutually_exclusive_group()
    how_many.add_argument("--full", action="store_true", help="also run the long tests")
    how_many.add_argument("--quick", action="store_true", help="only those that need no scene")
    parser.add_argument("modules", nargs="*", metavar="MODULE", help="as test_creases; default all")
    arguments = parser.parse_args()
    # Commands behind a shell's "&" begin with SIGINT ignored, and hand that on to those they start.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])  # which scripts/run.sh blocks
    for module in arguments.modules:
        if not (Path(sys.path[0]) / f"{module.partition('.')[0]}.py").is_file():
            parser.error(f"there is no test module '{module}'")

    import all_tests
    import support
    import yade.tests

    if arguments.full:
        os.environ[support.FULL] = "1"
    all_tests.chosen = arguments.modules
    if arguments.quick and not arguments.modules:
        all_tests.chosen = all_tests.quick()
    result = yade.tests.testModule("all_tests")
    return 0 if result.wasSuccessful() and result.testsRun else 1


sys.exit(main())

# SPDX-License-Identifier: GPL-2.0-or-later
"""Maps of where the method fails: one module a topic, each measures a limit and what lies beyond.

Each module has `run(quick)`, which writes NAME.csv and NAME.png into reference/stability/ and
returns one line of text; `quick` thins out the scans and writes nothing into reference/. Run them
by scripts/stability.py.
"""

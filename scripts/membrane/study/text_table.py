# SPDX-License-Identifier: GPL-2.0-or-later
"""Tables of texts for the terminal."""

from collections.abc import Collection, Sequence


def aligned(rows: Sequence[Sequence[str]], left: Collection[int]) -> list[str]:
    """Lines of a table of texts (rows of as many), columns `left` to the left, others to the right.

    Parameters
    ----------
    rows : list of sequences of str
    left : sequence of int
        Numbers of columns.
    """
    widths = [max(map(len, column)) for column in zip(*rows)]
    return [
        "  ".join(
            text.ljust(width) if i in left else text.rjust(width)
            for i, (text, width) in enumerate(zip(row, widths))
        ).rstrip()
        for row in rows
    ]

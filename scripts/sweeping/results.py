# SPDX-License-Identifier: GPL-2.0-or-later
"""What the cases of a sweep came to: curves and measures."""

import csv
import io
from dataclasses import dataclass

import numpy as np
from membrane.case_folder import COMPLETE, Status, look
from membrane.files import replace_text
from membrane.measures import first_time_above, lag_and_half_period, swing

from .grid import AXES, case_folders, text

LEVEL = 0.9  # of the deployment rate, whose time is told

# Columns of cases.csv after the parameters: what is measured, its unit and meaning.
MEASURES = {
    "final_rate": ("-", "deployment rate at the end"),
    "largest_rate": ("-", "largest deployment rate"),
    "time_of_rate_0.9": ("s", f"when the deployment rate first exceeds {LEVEL}"),
    "amplitude": ("deg", "largest lag of the mean tip behind the spool"),
    "time_of_amplitude": ("s", "when the largest lag is reached"),
    "period": ("s", "twice the time from the largest lag to the largest lead that follows"),
}


@dataclass
class Result:
    """A case of a sweep.

    Attributes
    ----------
    status : Status
    measures : dict
        MEASURES by name; None where there is none.
    """

    status: Status
    measures: dict

    @property
    def history(self):
        """CURVES (S,) of its history.csv by name; None where there are none."""
        return self.status.history

    @property
    def axes(self):
        """Values of AXES."""
        return tuple(self.status.parameters.get(name) for name in AXES)

    @property
    def degrees(self):
        """Mean phase difference (S,) [deg]."""
        return np.degrees(self.history["phase_difference"])


def read(folder):
    """The Results of all cases of a sweep in `folder`, by rising alpha_c and beta."""
    found = []
    for place, planned in case_folders(folder).items():
        status = look(place, planned or None)
        status.parameters = status.parameters or planned
        is_complete = status.state == COMPLETE
        measured = measure(status.history) if is_complete else dict.fromkeys(MEASURES)
        found.append(Result(status, measured))
    if not found:
        raise ValueError(f"{folder} holds no case")
    return sorted(found, key=lambda r: (*(-1 if v is None else v for v in r.axes), r.status.name))


def measure(history):
    """MEASURES of a history; amplitude and period are None where the run ends before they show."""
    time, rate, phase = (history[n] for n in ("time", "deployment_rate", "phase_difference"))
    lag, half = lag_and_half_period(time, phase)
    lagged = swing(time, phase)["time_of_largest_lag"]
    return {
        "final_rate": float(rate[-1]),
        "largest_rate": float(rate.max()),
        "time_of_rate_0.9": first_time_above(time, rate, LEVEL),
        "amplitude": lag if lagged < time[-1] else None,
        "time_of_amplitude": lagged if lagged < time[-1] else None,
        "period": 2 * half if 0 < half < time[-1] - lagged else None,
    }


def varied(results):
    """Names of the parameters that are not the same in all cases; AXES always and first."""
    known = [r.status.parameters for r in results if r.status.parameters]
    names = dict.fromkeys(name for parameters in known for name in parameters)
    others = [n for n in names if len({repr(p.get(n)) for p in known}) > 1 and n not in AXES]
    return [*AXES, *others]


def write_table(results, path):
    """cases.csv: one row a case; what there is not is left empty."""
    parameters = varied(results)
    stream = io.StringIO()
    rows = csv.writer(stream, lineterminator="\n")
    measures = [name if unit == "-" else f"{name}_{unit}" for name, (unit, _) in MEASURES.items()]
    rows.writerow(["case", *parameters, "outcome", "diverged_at_s", *measures, "reason"])
    for result in results:
        status = result.status
        rows.writerow(
            [status.name]
            + [_plain(status.parameters.get(name)) for name in parameters]
            + [status.state, _plain(status.time)]
            + [_plain(result.measures[name]) for name in MEASURES]
            + [status.reason]
        )
    replace_text(path, stream.getvalue())


def _plain(value):
    """A value as it goes into the table."""
    return "" if value is None else text(value)

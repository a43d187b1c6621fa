# SPDX-License-Identifier: GPL-2.0-or-later
"""Finds parameters of a sail whose deployment follows a measured curve, and how surely.

Run it by `scripts/run.sh calibrate TARGET [options]`; TARGET is a table with a header as
history.csv: `time` [s] since the release, and measures of the sail in SI units, by default
`deployment_rate` and `phase_difference` or one of them; its columns are parted by commas, or by
semicolons, tabs or blanks, and then its decimal point may be a comma. Options that are not listed
here go to scripts/deploy.py, as `--omega 20`: the scene.

About 40 runs of a few seconds; stopped and called again it goes on from those that it has. Writes
calibration.json, calibration.png and runs.csv.
"""

import argparse
import sys
from collections.abc import Callable
from dataclasses import fields
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from ..files import write_json
from ..parameters import RunParameters, whole
from ..progress import announcer
from ..results.own import CALIBRATION
from ..results.unfinished import new_results
from ..study.calibration import BOUNDS, CHAOS, columns_of
from ..study.calibration.picture import draw
from ..study.calibration.runs import Deployments
from ..study.calibration.search import misfit, search
from ..study.calibration.surface import HALF, at_bound, refine
from ..study.calibration.target import read_target
from .options import add_out, chosen_sail, file, sails_text

DEPLOY = Path(sys.argv[0]).resolve().with_name("deploy.py")
OURS = ("duration", "history-interval", "shapes-interval", "no-pictures")
CLOSE_CORRELATION = 0.95
KEPT = "unfinished_runs.jsonl"  # in the output folder until all is done


def command_line() -> tuple[argparse.Namespace, type[RunParameters], list[str]]:
    """Parsed sys.argv with `bounds` by name, the class of parameters, words for the scene."""
    asking = argparse.ArgumentParser(prog="calibrate", add_help=False, allow_abbrev=False)
    asking.add_argument(
        "--sail", default="square", help=sails_text().replace("comes first", "is one of")
    )
    asking.add_argument(
        "--vary",
        nargs=3,
        action="append",
        metavar=("NAME", "LO", "HI"),
        help="a parameter to find and its bounds; may be given twice (default: alpha_crease, beta)",
    )
    asked = asking.parse_known_args()[0]
    kind = chosen_sail([asked.sail])[0]
    parser = _parser(asking, kind, not asked.vary)
    arguments, scene = parser.parse_known_args()
    if asked.vary:
        arguments.bounds = {name.replace("-", "_"): pair for name, *pair in asked.vary}
    else:
        arguments.bounds = {name: getattr(arguments, name) for name in BOUNDS}
    for option in (*OURS, *(name.replace("_", "-") for name in arguments.bounds)):
        if any(word.split("=")[0] == f"--{option}" for word in scene):
            parser.error(f"--{option} is chosen here, not by the caller")
    _check_bounds(parser, kind, arguments.bounds)
    if arguments.seed < 0:
        parser.error(f"--seed {arguments.seed}: must be >= 0")
    return arguments, kind, [asked.sail, *scene] if asked.sail != "square" else scene


def _parser(asking, kind, usual):
    """The parser; if the parameters are the usual ones it has options for their bounds."""
    parser = argparse.ArgumentParser(
        prog="calibrate",
        description=__doc__.split("\n\n", 1)[1],
        formatter_class=argparse.RawDescriptionHelpFormatter,
        parents=[asking],
        allow_abbrev=False,  # --alpha is the scene's
    )
    parser.add_argument("target", type=file, metavar="TARGET", help="table with the curve")
    text = "curve to follow; may be given again (default: those drawn that the table has)"
    known: dict = {"choices": list(columns_of(kind.sail)), "metavar": "MEASURE"}
    parser.add_argument("--column", action="append", **known, help=text)
    for name, bounds in BOUNDS.items() if usual else ():
        text = f"bounds of {name}, > 0; twice the same holds it (default {bounds[0]:g} "
        text += f"{bounds[1]:g})"
        form: dict = {"nargs": 2, "metavar": ("LO", "HI"), "default": bounds}
        parser.add_argument(f"--{name.replace('_', '-')}", **form, help=text)
    text = f"end of the part of the curve that counts [s]; from about {CHAOS:g} s on tiny "
    text += "differences grow, and single curves say little (default 0.1)"
    parser.add_argument("--until", type=float, default=0.1, metavar="SECONDS", help=text)
    add_out(parser, "out/calibration")
    text = "of the points that are tried (default 0)"
    parser.add_argument("--seed", type=whole, default=0, metavar="N", help=text)
    return parser


def _check_bounds(parser, kind, bounds):
    """Make bounds numbers; an error unless these are one or two parameters that can be found."""
    known = [item.name for item in fields(kind) if item.type is float]
    for name, pair in bounds.items():
        flag = f"--{name.replace('_', '-')} {' '.join(map(str, pair))}"
        if name not in known:
            parser.error(f"--vary {name}: must be a parameter of the sail that is a number")
        try:
            low, high = bounds[name] = tuple(map(float, pair))
        except ValueError:
            parser.error(f"{flag}: must be numbers")
        if not 0 < low <= high < np.inf:
            parser.error(f"{flag}: must be > 0 and grow")
    if len(bounds) > 2:
        parser.error("--vary: must be one parameter or two")
    if all(low == high for low, high in bounds.values()):
        parser.error("all parameters are held: nothing to find")


def warnings(
    found: Any, names: list[str], low: np.ndarray, high: np.ndarray, until: float
) -> list[str]:
    """Sentences about what the numbers do not tell."""
    said = []
    for name, sigma, at in zip(names, found.sigma, at_bound(found.point, low, high)):
        if sigma > HALF:
            said.append(
                f"{name} is not identifiable from this curve: its standard deviation is a factor "
                f"of {np.exp(min(sigma, 7)):.2g} or more"
                + ("; hold it, by equal bounds, to learn the other" if len(names) == 2 else "")
            )
        elif at:
            said.append(f"{name} lies at its bound: wider bounds may fit better")
    if len(names) == 2 and abs(found.correlation) > CLOSE_CORRELATION:
        said.append("the parameters are hard to tell apart: see their correlation")
    if found.lack_of_fit > 4:
        said.append(
            "the model does not follow the target: their distance is "
            f"{np.sqrt(found.lack_of_fit):.1f} times what scatter and noise explain"
        )
    if until > CHAOS:
        said.append(f"after about {CHAOS:g} s single curves say little: try --until 0.1")
    return said


def result(
    found: Any, bounds: dict, target: Any, fit: Any, surface: Any, units: dict[str, str]
) -> dict:
    """What calibration.json tells of an Estimate of the parameters with these `bounds`."""
    values = np.exp(found.point)
    parameters = {
        name: {
            "value": value,
            "sigma": value * sigma,
            "sigma_of_logarithm": sigma,
            "bounds": list(bounds[name]),
            "identifiable": bool(sigma <= HALF),
        }
        for name, value, sigma in zip(bounds, values.tolist(), found.sigma.tolist())
    }
    rms = np.sqrt(np.mean((fit - target.values) ** 2, axis=1)).tolist()
    scatter = np.sqrt(np.mean(surface.scatter**2, axis=1)).tolist()
    curves = {
        name: {"unit": units[name], "rms": r, "noise_of_target": n, "scatter_of_runs": s}
        for name, r, n, s in zip(target.columns, rms, target.noise.tolist(), scatter)
    }
    return {
        "parameters": parameters,
        "correlation": found.correlation if len(bounds) == 2 else None,
        "lack_of_fit": found.lack_of_fit,
        "curves": curves,
        "times": [float(target.times[0]), float(target.times[-1])],
    }


def write_runs(path: Path, simulate: Deployments, names: list[str], target: Any) -> None:
    """Table of all runs: parameters and misfit."""
    pairs = zip(simulate.points, simulate.curves)
    rows = [[*np.exp(point), misfit(curves, target)] for point, curves in pairs]
    header = ",".join([*names, "misfit"])
    form = {"delimiter": ",", "fmt": "%.6g", "comments": ""}
    np.savetxt(path, rows, header=header, encoding="utf-8", **form)


def teller(names: list[str], target: Any, say: Callable[[str], None]) -> Callable:
    """A function that tells of each run, by one that tells a line."""
    number = count(1)

    def tell(values, curves):
        where = ", ".join(f"{name} {value:.4g}" for name, value in zip(names, values))
        off = "diverged" if curves is None else f"misfit {misfit(curves, target):.3g}"
        say(f"run {next(number):3d}  {where}: {off}")

    return tell


def main() -> None:
    """Search, refine, report; sys.exit with one sentence if that cannot be."""
    arguments, kind, scene = command_line()
    free = {name: b for name, b in arguments.bounds.items() if b[0] < b[1]}
    names, (low, high) = list(free), np.log(list(free.values())).T
    held = [
        f"--{name.replace('_', '-')}={b[0]!r}"
        for name, b in arguments.bounds.items()
        if name not in free
    ]
    target = read_target(arguments.target, arguments.column or (), arguments.until, kind.sail)
    say = announcer("calibrate")
    tell = teller(names, target, say)
    simulate = Deployments(DEPLOY, names, target, [*scene, *held], tell)
    kept = arguments.out / KEPT
    # A folder that cannot be is refused before the runs.
    with new_results(arguments.out, CALIBRATION) as part:
        if known := simulate.keep(kept):
            say(f"{known} runs are there already, in {kept}")
        say("coarse search: 16 runs, and at most 8 more")
        point = search(simulate, target, low, high, arguments.seed)
        say("surfaces: 18 runs each, one to three of them")
        surface, found = refine(simulate, target, point, low, high, arguments.seed)
        say("the run of the parameters found")
        (fit,) = simulate([found.point])
        if fit is None:
            raise RuntimeError("the run of the parameters found diverges")
        said = warnings(found, names, low, high, arguments.until)
        units = {name: m.unit for name, m in columns_of(kind.sail).items()}
        content = result(found, free, target, fit, surface, units)
        content |= {"warnings": said, "runs": len(simulate), "sail": kind.sail, "scene": scene}
        write_json(part / "calibration.json", content)
        write_runs(part / "runs.csv", simulate, names, target)
        about = target, fit, surface, found, names, simulate.points
        draw(part / "calibration.png", kind, *about)
    kept.unlink(missing_ok=True)
    tell_result(content, arguments.out)


def tell_result(content: dict, out: Path) -> None:
    """Say what calibration.json tells."""
    for name, about in content["parameters"].items():
        share = 100 * about["sigma_of_logarithm"]
        if about["identifiable"]:
            print(f"{name} = {about['value']:.4g} +- {about['sigma']:.2g} ({share:.1f} %)")
        else:
            print(f"{name} is not identifiable; the fit has {about['value']:.4g}")
    if content["correlation"] is not None:
        print(f"correlation {content['correlation']:+.2f}")
    for name, about in content["curves"].items():
        print(
            f"{name}: fit within {about['rms']:.2g} {about['unit']} rms; noise of the target "
            f"{about['noise_of_target']:.2g}, scatter of runs {about['scatter_of_runs']:.2g}"
        )
    for sentence in content["warnings"]:
        print(f"Warning: {sentence}")
    print(f"Look at:\n  {out}/calibration.png\n  {out}/calibration.json")

# SPDX-License-Identifier: GPL-2.0-or-later
"""Finds the alpha_crease and beta whose deployment follows a measured curve, and how surely.

Run it by `scripts/run.sh calibrate TARGET [options]`; TARGET is a table with a header as
history.csv: `time` [s] since the release, and `phase_difference` [rad] or `deployment_rate` [-] or
both; its columns are parted by commas, or by semicolons, tabs or blanks, and then its decimal point
may be a comma. Options that are not listed here go to scripts/deploy.py, as `--omega 20`: the
scene.

About 40 runs of a few seconds; stopped and called again it goes on from those that it has. Writes
calibration.json, calibration.png and runs.csv.
"""

import argparse
import sys
import time
from pathlib import Path

import sweeping  # noqa: F401  (makes parts of membrane importable without YADE)
from membrane.commands import file, folder, plain_errors
from membrane.files import write_json
from membrane.own import CALIBRATION
from membrane.parameters import whole
from membrane.unfinished import new_results

with plain_errors("calibrate"):
    import numpy as np
    from calibration import CHAOS, COLUMNS, NAMES
    from calibration.picture import draw
    from calibration.runs import Deployments
    from calibration.search import misfit, search
    from calibration.surface import HALF, at_bound, refine
    from calibration.target import read_target

BOUNDS = {"alpha_crease": (10.0, 1000.0), "beta": (1.0, 100.0)}
OURS = ("duration", "history-interval", "shapes-interval", "no-pictures")
CLOSE_CORRELATION = 0.95
KEPT = "unfinished_runs.jsonl"  # in the output folder until all is done


def command_line():
    """Parsed sys.argv and the options for the scene."""
    parser = argparse.ArgumentParser(
        prog="calibrate",
        description=__doc__.split("\n\n", 1)[1],
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,  # --alpha is the scene's
    )
    parser.add_argument("target", type=file, metavar="TARGET", help="table with the curve")
    parser.add_argument(
        "--column",
        action="append",
        choices=list(COLUMNS),
        help="curve to follow; may be given twice (default: those that the table has)",
    )
    for name, bounds in BOUNDS.items():
        parser.add_argument(
            f"--{name.replace('_', '-')}",
            nargs=2,
            type=float,
            metavar=("LO", "HI"),
            default=bounds,
            help=f"bounds of {name}, > 0; twice the same holds it (default {bounds[0]:g} "
            f"{bounds[1]:g})",
        )
    parser.add_argument(
        "--until",
        type=float,
        default=0.1,
        metavar="SECONDS",
        help=f"end of the part of the curve that counts [s]; from about {CHAOS:g} s on tiny "
        "differences grow, and single curves say little (default 0.1)",
    )
    parser.add_argument(
        "--out",
        type=folder,
        default=Path("out/calibration"),
        metavar="DIR",
        help="default: out/calibration",
    )
    parser.add_argument(
        "--seed",
        type=whole,
        default=0,
        metavar="N",
        help="of the points that are tried (default 0)",
    )
    arguments, scene = parser.parse_known_args()
    for option in OURS:
        if any(word.split("=")[0] == f"--{option}" for word in scene):
            parser.error(f"--{option} is chosen here, not by the caller")
    for name in NAMES:
        low, high = getattr(arguments, name)
        if not 0 < low <= high < np.inf:
            parser.error(f"--{name.replace('_', '-')} {low:g} {high:g}: must be > 0 and grow")
    if arguments.seed < 0:
        parser.error(f"--seed {arguments.seed}: must be >= 0")
    return arguments, scene


def warnings(found, names, low, high, until):
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


def result(found, names, bounds, said, target, fit, surface, runs, scene):
    """Content of calibration.json."""
    values = np.exp(found.point)
    parameters = {
        name: {
            "value": value,
            "sigma": value * sigma,
            "sigma_of_logarithm": sigma,
            "bounds": list(bounds[name]),
            "identifiable": bool(sigma <= HALF),
        }
        for name, value, sigma in zip(names, values.tolist(), found.sigma.tolist())
    }
    rms = np.sqrt(np.mean((fit - target.values) ** 2, axis=1))
    scatter = np.sqrt(np.mean(surface.scatter**2, axis=1))
    curves = {
        name: {"unit": COLUMNS[name], "rms": r, "noise_of_target": n, "scatter_of_runs": s}
        for name, r, n, s in zip(
            target.columns, rms.tolist(), target.noise.tolist(), scatter.tolist()
        )
    }
    return {
        "parameters": parameters,
        "correlation": found.correlation if len(names) == 2 else None,
        "lack_of_fit": found.lack_of_fit,
        "warnings": said,
        "curves": curves,
        "times": [float(target.times[0]), float(target.times[-1])],
        "runs": runs,
        "scene": scene,
    }


def write_runs(path, simulate, names, target):
    """Table of all runs: parameters and misfit."""
    rows = [
        [*np.exp(point), misfit(curves, target)]
        for point, curves in zip(simulate.points, simulate.curves)
    ]
    np.savetxt(
        path,
        rows,
        delimiter=",",
        fmt="%.6g",
        header=",".join([*names, "misfit"]),
        comments="",
        encoding="utf-8",
    )


def main():
    """Search, refine, report; sys.exit with one sentence if that cannot be."""
    arguments, scene = command_line()
    bounds = {name: tuple(getattr(arguments, name)) for name in NAMES}
    names = [name for name in NAMES if bounds[name][0] < bounds[name][1]]
    if not names:
        sys.exit("calibrate: both parameters are held: nothing to find")
    held = [
        f"--{name.replace('_', '-')}={bounds[name][0]!r}" for name in NAMES if name not in names
    ]
    low, high = np.log([bounds[name] for name in names]).T
    start, count = time.monotonic(), 0

    def tell(values, curves):
        nonlocal count
        count += 1
        where = ", ".join(f"{name} {value:.4g}" for name, value in zip(names, values))
        off = "diverged" if curves is None else f"misfit {misfit(curves, target):.3g}"
        took = time.monotonic() - start
        print(f"run {count:3d}  {took:5.0f} s  {where}: {off}", file=sys.stderr, flush=True)

    target = read_target(arguments.target, arguments.column or (), arguments.until)
    simulate = Deployments(names, target, [*scene, *held], tell)
    with new_results(
        arguments.out, CALIBRATION
    ) as part:  # a folder that cannot be is refused before the runs
        kept = arguments.out / KEPT
        count = simulate.keep(kept)
        if count:
            print(f"{count} runs are there already, in {kept}", file=sys.stderr)
        print("coarse search: 16 runs, and at most 8 more", file=sys.stderr)
        point = search(simulate, target, low, high, arguments.seed)
        print("surfaces: 18 runs each, one to three of them", file=sys.stderr)
        surface, found = refine(simulate, target, point, low, high, arguments.seed)
        print("the run of the parameters found", file=sys.stderr)
        (fit,) = simulate([found.point])
        if fit is None:
            raise RuntimeError("the run of the parameters found diverges")
        said = warnings(found, names, low, high, arguments.until)
        content = result(found, names, bounds, said, target, fit, surface, len(simulate), scene)
        write_json(part / "calibration.json", content)
        write_runs(part / "runs.csv", simulate, names, target)
        picture = part / "calibration.png"
        draw(picture, target, fit, surface, found, names, simulate.points)
    kept.unlink(missing_ok=True)
    for name, about in content["parameters"].items():
        share = 100 * about["sigma_of_logarithm"]
        if about["identifiable"]:
            print(f"{name} = {about['value']:.4g} +- {about['sigma']:.2g} ({share:.1f} %)")
        else:
            print(f"{name} is not identifiable; the fit has {about['value']:.4g}")
    if len(names) == 2:
        print(f"correlation {found.correlation:+.2f}")
    for name, about in content["curves"].items():
        print(
            f"{name}: fit within {about['rms']:.2g} {about['unit']} rms; noise of the target "
            f"{about['noise_of_target']:.2g}, scatter of runs {about['scatter_of_runs']:.2g}"
        )
    for sentence in said:
        print(f"Warning: {sentence}")
    print(f"Look at:\n  {arguments.out}/calibration.png\n  {arguments.out}/calibration.json")


with plain_errors("calibrate", "stopped by Ctrl-C; called again it goes on"):
    main()

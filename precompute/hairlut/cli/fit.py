# SPDX-License-Identifier: BSD-3-Clause
"""hairlut fit: from a BSDF, a grid or draws to textures that sample them, with their measured error."""

import argparse
import json
import math
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter

from ..errors import HairlutError
from ..files import check_folder
from . import OK, add_command

DEFAULT_TOLERANCE = 0.01
DEFAULT_BUDGET, DEFAULT_BUDGET_OF_PARAMETERS = 120.0, 600.0
DEFAULT_SIZE, DEFAULT_SIZE_OF_PARAMETERS = 256.0, 1024.0  # KB
MAX_LOBES = 8

Report = Callable[[str, float], None]

EXAMPLES = """examples:
  hairlut fit my_hair.py --out luts           luts/my_hair/, ready for hairlut_load
  hairlut fit my_hair.py --lobes 4 --tolerance 0.003 --budget 300
  hairlut fit my_hair.py --json --plot my_hair.png > my_hair.json
  hairlut fit goniometer.csv --measure solid-angle --out luts

my_hair.py defines

    def bsdf(theta_r, theta_i, phi):            # or bsdf(theta_r, theta_i, phi, offset)
        ...
        return f

with f per steradian and without the cosine, as in L = integral of f L_i cos(theta_i) domega: the sampler
draws f cos(theta_i). The arguments are numpy arrays that broadcast, in radians: the inclinations of the
viewer and of the light from the plane normal to the fibre, and phi = phi_i - phi_r. offset, in (-1, 1), is
where across its width the fibre is hit, in radii; from there its surface reflects to phi = -2 asin(offset). A
hair whose highlights depend on it is drawn with the offset known. precompute/examples/chiang2016.py is a
whole file, made from a paper in 40 lines.

A hair whose parameters vary from strand to strand names them with their ranges, and a standard value where
that is not the middle; bsdf gets them by name, and one model samples them all:

    PARAMETERS = {"beta_m": (0.05, 0.6), "absorption": (0.05, 5.0, 0.4)}

    def bsdf(theta_r, theta_i, phi, offset, beta_m, absorption):
        ...

precompute/examples/chiang_parameters.py is such a file.

Other data: a header line with theta_r, theta_i, phi, value (radians; theta_r_deg and so on for degrees), as
CSV, or arrays of these names as npz; offset, within [-1, 1], is one column more. Coordinates that repeat are
a grid, which must have each point once, and value is a density there. Otherwise each row is a draw, and
value, which may be left out, its weight."""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = add_command(
        subparsers,
        "fit",
        help="fit a sampler to a hair's BSDF, or to measured scattering",
        description="Fits a mixture of lobes to a hair's BSDF, to a grid of it, or to draws from it, bakes "
        "it, and measures the textures' relative variance and largest weight where they were not fitted to.",
        epilog=EXAMPLES,
    )
    parser.add_argument("data", type=Path, help="a Python file that defines bsdf, or a CSV or npz file")
    parser.add_argument("--out", type=Path, default=Path("luts"), metavar="DIR", help="default: luts")
    parser.add_argument("--name", help="name of the model (default: that of the file)")
    parser.add_argument(
        "--measure",
        choices=("angle", "solid-angle"),
        help="what a grid's values are densities in: theta_i and phi, or steradians (default: angle)",
    )
    parser.add_argument(
        "--lobes", type=int, metavar="K", help=f"how many lobes, 1 to {MAX_LOBES} (default: as many as gain)"
    )
    parser.add_argument(
        "--tolerance",
        type=float,
        default=DEFAULT_TOLERANCE,
        metavar="V",
        help="relative variance above what so many lobes can reach (default: %(default)g)",
    )
    parser.add_argument(
        "--budget",
        type=float,
        metavar="SECONDS",
        help="time by the clock that a fit may take, about: fewer cells where it is short; a hair with "
        "parameters takes half a minute of one core, or more, whatever the budget (default: "
        f"{DEFAULT_BUDGET:g}, for a hair with parameters {DEFAULT_BUDGET_OF_PARAMETERS:g})",
    )
    parser.add_argument(
        "--size",
        type=float,
        metavar="KB",
        help="memory that the textures of a BSDF or a grid may take: where they would take more, they lose "
        f"more (default: {DEFAULT_SIZE:g}, for a hair with parameters {DEFAULT_SIZE_OF_PARAMETERS:g})",
    )
    parser.add_argument("--json", action="store_true", help="print the result as JSON, and nothing else")
    parser.add_argument(
        "--plot", type=Path, metavar="FILE", help="draw the fit and its errors to a PNG, SVG or PDF"
    )
    return parser


def run(args: argparse.Namespace) -> int:
    from rich.console import Console
    from rich.progress import Progress

    name = _checked(args)
    check_folder(args.out / name)
    if args.plot:
        check_folder(args.plot.parent)
    start = perf_counter()
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("reading", total=1.0)

        def report(stage: str, share: float) -> None:
            progress.update(task, description=stage, completed=share)

        model, text, figures, warned = _fitted(args, name, report)
    for warning in warned:
        print(f"hairlut: {args.data}: warning: {warning}", file=sys.stderr)
    from ..exr import write_model

    seconds = perf_counter() - start
    paths = write_model(args.out / name, model)
    size = sum(path.stat().st_size for path in paths)
    if args.json:
        about = {"model": str(args.out / name), "bytes": size, "seconds": seconds}
        print(json.dumps({**about, **figures}, indent=1))
        return OK
    print(text)
    print(f"\n{args.out / name}: {len(paths)} textures, {size / 1024:.0f} KB, in {seconds:.1f} s")
    return OK


def _fitted(args: argparse.Namespace, name: str, report: Report) -> tuple:
    """(model, text for a person, data for a script, warnings)."""
    from ..fit import bsdf, hair, summary
    from ..fit.read import Draws, read

    if args.data.suffix == ".py":
        _no_measure(args, "a BSDF is per steradian")
        given = bsdf.load(args.data)
        if given.parameters:
            return _of_parameters(given, args, name, report)
        density = hair.of_density(given.density, bool(given.offset))
        return _of_hair(density, _what(given), args, name, report)
    data = read(args.data)
    if isinstance(data, Draws):
        from ..fit import drawn

        _no_measure(args, "draws are no values")
        if args.plot:
            raise HairlutError("--plot: draws have no density to plot: leave it out")
        if args.size is not None:
            raise HairlutError("--size: the textures of draws take what they need: leave it out")
        report("cross-validating", 0.0)
        found = drawn.fit(data, name, args.lobes)
        text, figures = summary.drawn_text(args.data, data, found), summary.drawn_data(data, found)
        return summary.with_error(found), text, figures, []
    from ..fit import grid

    return _of_hair(grid.of_grid(data, args.measure == "solid-angle"), data, args, name, report)


def _no_measure(args: argparse.Namespace, why: str) -> None:
    if args.measure:
        raise HairlutError(f"--measure {args.measure}: {why}: leave it out")


def _of_hair(given, what: object, args: argparse.Namespace, name: str, report: Report) -> tuple:
    from ..fit import refine, summary, warnings

    with _named(args.data):
        budget, size = args.budget or DEFAULT_BUDGET, 1024 * (args.size or DEFAULT_SIZE)
        found = refine.fit(given, name, args.tolerance, args.lobes, budget, report, size)
    if args.plot:
        _plot(args.plot, lambda kind: _plotted(given, found, name, kind))
    figures = {"data": str(what), **summary.data(found, args.tolerance)}
    text = f"{args.data}: {what}\n{summary.text(found, args.tolerance)}"
    return summary.with_errors(found), text, figures, warnings.warnings(given, found.promised)


def _what(given) -> str:
    """What a file of a BSDF was taken for."""
    over = f" over {', '.join(parameter.name for parameter in given.parameters)}" if given.parameters else ""
    other = given.offset not in ("", "offset")
    return f"a BSDF{over}" + f", whose {given.offset} is the offset at which the fibre is hit" * other


def _of_parameters(own, args: argparse.Namespace, name: str, report: Report) -> tuple:
    from ..fit import promise, warnings
    from ..fit.strands import box, summary
    from ..fit.strands import fit as fitting

    size = 1024 * (args.size or DEFAULT_SIZE_OF_PARAMETERS)
    budget = args.budget or DEFAULT_BUDGET_OF_PARAMETERS
    with _named(args.data):
        given = box.of_parameters(own.density, own.parameters, bool(own.offset))
        found = fitting.fit(given, name, args.tolerance, args.lobes, budget, report, size)
    if args.plot:
        _plot(args.plot, lambda kind: _plotted_parameters(found, name, kind))
    what = _what(own)
    figures = {"data": what, **summary.data(found, args.tolerance)}
    text = f"{args.data}: {what}\n{summary.text(found, args.tolerance)}"
    at = found.measured
    losses = promise.Losses(at.theta_r, at.offset, at.variance, at.weight, at.light)
    warned = warnings.warnings(given.hair, losses) + summary.warnings(found)
    return summary.with_errors(found), text, figures, warned


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Puts the path before errors that do not name it."""
    try:
        yield
    except HairlutError as error:
        if str(error).startswith(str(path)):
            raise
        raise HairlutError(f"{path}: {error}") from None


def _plotted(given, found, name: str, kind: str) -> bytes:
    from ..fit.plot import plot

    return plot(given, found, name, kind)


def _plotted_parameters(found, name: str, kind: str) -> bytes:
    from ..fit.plot import plot_of_parameters

    return plot_of_parameters(found, name, kind)


def _plot(path: Path, drawn: Callable[[str], bytes]) -> None:
    from ..files import write_whole

    try:
        picture = drawn(path.suffix.removeprefix(".") or "png")
    except ImportError as error:
        raise HairlutError(f"--plot: {error.name} is missing: pip install 'hairlut[report]'") from None
    write_whole(path, picture)


def _checked(args: argparse.Namespace) -> str:
    """The model's name; HairlutError for options that make no sense."""
    from ..exrfile import MODEL_NAME

    name = args.data.stem if args.name is None else args.name
    if not name or Path(name).name != name or name.startswith((".", "-")):
        raise HairlutError(f"--name {name}: expected the name of a directory")
    if not re.fullmatch(MODEL_NAME, name):
        given = f"--name {name}" if args.name else f"{args.data}: a model takes its file's name"
        raise HairlutError(f"{given}: expected 1 to 63 printable ASCII characters: give it by --name")
    for option in ("tolerance", "budget", "size"):
        value = getattr(args, option)
        if value is not None and not (math.isfinite(value) and value > 0):
            raise HairlutError(f"--{option} {value}: expected a finite number above 0")
    if args.lobes is not None and not 1 <= args.lobes <= MAX_LOBES:
        raise HairlutError(f"--lobes {args.lobes}: expected a number from 1 to {MAX_LOBES}")
    if args.plot and args.plot.suffix not in (".png", ".svg", ".pdf"):
        raise HairlutError(f"--plot {args.plot}: expected a name that ends in .png, .svg or .pdf")
    return name

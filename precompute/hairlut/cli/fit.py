"""hairlut fit: from measured, simulated or drawn scattering to model files that hairlut bake takes."""

import argparse
import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

from ..errors import HairlutError
from ..fit.decompose import PARTS
from ..fit.distribution import CELLS, ROWS
from ..fit.family import LOBES as FAMILY_LOBES
from ..fit.family import SHAPES
from ..fit.read import Draws, Grid, read
from . import OK, add_command

Report = Callable[[str, float], None]

DEFAULT_TOLERANCE = 0.01
DEFAULT_BUDGET = 120.0
MAX_LOBES = 8

EXAMPLES = """examples:
  hairlut fit my_hair.py --out luts           luts/my_hair/, ready for hairlut_load
  hairlut fit my_hair.py --lobes 4 --tolerance 0.003 --budget 300
  hairlut fit goniometer.csv --out fits
  hairlut fit bsdf_grid.npz --measure solid-angle && hairlut bake --model fits/bsdf_grid_masses.npz
  hairlut fit offsets.npz && hairlut bake --model fits/offsets --size 64x37 --out baked/offsets
my_hair.py defines bsdf(theta_r, theta_i, phi) or bsdf(theta_r, theta_i, phi, offset), which returns f per
steradian, without the cosine, as in L = integral of f L_i cos(theta_i) domega; the sampler draws f
cos(theta_i). The arguments are numpy arrays that broadcast, in radians: inclinations from the plane normal to
the fibre, and phi = phi_i - phi_r. offset, in (-1, 1), is where across its width the fibre is hit, in radii;
from there its surface reflects to phi = -2 asin(offset). precompute/examples/chiang2016.py is a whole file,
made from a paper in 40 lines.
other data: a header line with theta_r, theta_i, phi, value (radians; theta_r_deg and so on for degrees), as
CSV, or arrays of these names as npz. Coordinates that repeat are a grid, which must have each point once, and
value is a density there. Otherwise each row is a draw, and value, which may be left out, its weight. A grid
with a column offset (within [-1, 1]: where across its width the fibre is hit), or an npz whose value has
four axes (offset, theta_r, theta_i, phi), becomes a family: a model file for each lobe, and a text file of
their weights and turns, in a directory (see the module hairlut.fit.familyfiles)."""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = add_command(
        subparsers,
        "fit",
        help="fit a sampler to a hair's BSDF, or to measured scattering",
        description="Fits lobes to the BSDF that a Python file defines, bakes them, measures the result, and "
        "writes a directory that the C library loads. From a grid or draws (CSV, npz) it writes model files "
        "for hairlut bake: Gaussians, and the masses of the data's own cells.",
        epilog=EXAMPLES,
    )
    parser.add_argument("data", type=Path, help="a Python file that defines bsdf, or a CSV or npz file")
    parser.add_argument("--out", type=Path, metavar="DIR", help="default: luts, or fits for CSV and npz")
    parser.add_argument("--name", help="name of the model (default: that of the data file)")
    parser.add_argument(
        "--measure",
        choices=("angle", "solid-angle"),
        default="angle",
        help="what a grid's values are densities in: theta_i and phi, or steradians (default: angle)",
    )
    parser.add_argument(
        "--lobes",
        metavar="K",
        help=f"how many lobes a BSDF takes, 1 to {MAX_LOBES} (default: as many as gain); for data, "
        f"what it holds: {', '.join(PARTS)} (default: both)",
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
        default=DEFAULT_BUDGET,
        metavar="SECONDS",
        help="time after which the best fit so far is taken (default: %(default)g)",
    )
    parser.add_argument("--json", action="store_true", help="print a BSDF's result as JSON, and nothing else")
    parser.add_argument(
        "--rows",
        type=int,
        default=ROWS,
        help="rows of theta_r that samples are gathered in (default: %(default)s)",
    )
    parser.add_argument(
        "--lobes-per-offset",
        type=int,
        default=FAMILY_LOBES,
        metavar="K",
        help="highlights of a family, each a product of inclination and azimuth (default: %(default)s)",
    )
    parser.add_argument(
        "--shapes-per-lobe",
        type=int,
        default=SHAPES,
        metavar="S",
        help="azimuths of each lobe of a family, each for a part of the offsets: more where highlights "
        "change their shape over the offset, not just their place (default: %(default)s)",
    )
    parser.add_argument("--no-plot", action="store_true", help="write no picture (matplotlib is not needed)")
    return parser


def run(args: argparse.Namespace) -> int:
    from rich.console import Console
    from rich.progress import Progress

    if args.data.suffix == ".py":
        return _bsdf(args)
    args.out = args.out or Path("fits")
    args.lobes = args.lobes or "both"
    if args.lobes not in PARTS:
        raise HairlutError(f"--lobes {args.lobes}: expected one of {', '.join(PARTS)}")
    if args.rows < 2:
        raise HairlutError(f"--rows {args.rows}: expected 2 or more")
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("reading", total=1.0)

        def report(stage: str, share: float) -> None:
            progress.update(task, description=stage, completed=share)

        data = read(args.data)
        print(f"{args.data}: {data}")
        said, paths = (_model if data.offset is None else _family)(data, args, report)
    print(said)
    print("\n" + "\n".join(map(str, paths)))
    return OK


def _model(data: Grid | Draws, args: argparse.Namespace, report: Report) -> tuple[str, list[Path]]:
    """Both models of one distribution: what to say, and what was written."""
    from ..fit.distribution import of_data
    from ..fit.files import text, write_all
    from ..fit.model import fit

    name = args.name or args.data.stem
    result = fit(of_data(data, args.measure == "solid-angle", args.rows, CELLS), args.lobes, report=report)
    paths = list(write_all(result, args.out, name))
    if not args.no_plot:
        report("plotting", 0.0)
        paths.append(_plot(result, args.out / f"{name}_fit.png", name))
    return text(result), paths


def _family(data: Grid | Draws, args: argparse.Namespace, report: Report) -> tuple[str, list[Path]]:
    """The family of a grid over offsets, likewise."""
    from ..fit.family import fit_family
    from ..fit.familyfiles import text, write_family
    from ..fit.offsets import of_data

    if args.lobes != "both":
        raise HairlutError(f"--lobes {args.lobes}: {args.data} has offsets: use --lobes-per-offset")
    if isinstance(data, Draws):
        raise HairlutError(f"{args.data}: draws with offsets: expected a grid of values over the offset")
    family = fit_family(
        of_data(data, args.measure == "solid-angle"), args.lobes_per_offset, args.shapes_per_lobe, report
    )
    folder = args.out / (args.name or args.data.stem)
    written = write_family(family, folder)
    return text(family), [folder, written[-1]]


def _plot(result, path: Path, name: str) -> Path:
    from ..files import write_whole
    from ..fit.plot import plot

    try:
        return write_whole(path, plot(result, name))
    except ImportError as error:
        raise HairlutError(
            f"{error.name} is missing: pip install 'hairlut[report]', or use --no-plot"
        ) from None
    return path


def _bsdf(args: argparse.Namespace) -> int:
    """Fits, bakes and measures a BSDF."""
    from rich.console import Console
    from rich.progress import Progress

    count = _checked(args)
    name, out = args.name or args.data.stem, args.out or Path("luts")

    from ..exr import write_model
    from ..fit import bsdf, doubts, hair, refine, says

    start = perf_counter()
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("reading", total=1.0)

        def report(stage: str, share: float) -> None:
            progress.update(task, description=stage, completed=share)

        given = hair.of_density(*bsdf.load(args.data))
        found = refine.fit(given, name, args.tolerance, count, args.budget, report)
    for doubt in doubts.doubts(given, found.promised):
        print(f"hairlut: {args.data}: warning: {doubt}", file=sys.stderr)
    seconds = perf_counter() - start
    paths = write_model(out / name, says.with_errors(found))
    size = sum(path.stat().st_size for path in paths)
    if args.json:
        told = says.data(found, args.tolerance, seconds)
        print(json.dumps({"data": str(args.data), "model": str(out / name), "bytes": size, **told}, indent=1))
        return OK
    print(says.text(found, args.tolerance, seconds))
    print(f"\n{out / name}: {len(paths)} textures, {size / 1024:.0f} KB")
    return OK


def _checked(args: argparse.Namespace) -> int | None:
    """How many lobes a BSDF is to take, None to choose; HairlutError for options that make no sense."""
    name = args.name or args.data.stem
    if Path(name).name != name or name.startswith((".", "-")):
        raise HairlutError(f"--name {name}: expected the name of a directory")
    for option in ("tolerance", "budget"):
        value = getattr(args, option)
        if not (math.isfinite(value) and value > 0):
            raise HairlutError(f"--{option} {value}: expected a number above 0")
    if args.lobes is None:
        return None
    if not (args.lobes.isdecimal() and 1 <= int(args.lobes) <= MAX_LOBES):
        raise HairlutError(f"--lobes {args.lobes}: expected a number from 1 to {MAX_LOBES}")
    return int(args.lobes)

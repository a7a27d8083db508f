"""hairlut fit: from measured, simulated or drawn scattering to model files that hairlut bake takes."""

import argparse
from collections.abc import Callable
from pathlib import Path

from ..errors import HairlutError
from ..fit.decompose import PARTS
from ..fit.distribution import CELLS, ROWS
from ..fit.family import LOBES as FAMILY_LOBES
from ..fit.family import SHAPES
from ..fit.read import Draws, Grid, read
from . import OK

Report = Callable[[str, float], None]

EXAMPLES = """examples:
  hairlut fit goniometer.csv --out fits
  hairlut fit bsdf_grid.npz --measure solid-angle && hairlut bake --model fits/bsdf_grid_masses.npz
  hairlut fit offsets.npz && hairlut bake --model fits/offsets --size 64x37 --out baked/offsets
the data: a header line with theta_r, theta_i, phi, value (radians; theta_r_deg and so on for degrees), as
CSV, or arrays of these names as npz. Coordinates that repeat are a grid, which must have each point once, and
value is a density there. Otherwise each row is a draw, and value, which may be left out, its weight. A grid
with a column offset (within [-1, 1]: where across its width the fibre is hit), or an npz whose value has
four axes (offset, theta_r, theta_i, phi), becomes a family: a model file for each lobe, and a text file of
their weights and turns, in a directory (see the module hairlut.fit.familyfiles)."""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = subparsers.add_parser(
        "fit",
        help="fit a model to samples or a grid of a scattering distribution",
        description="Fits (a) Gaussian lobes with smooth mean and width and (b) the data's own masses, "
        "writes both as model files, plots them against the data, and says which of them the scene needs.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("data", type=Path, help="CSV or npz file")
    parser.add_argument("--out", type=Path, default=Path("fits"), metavar="DIR", help="default: fits")
    parser.add_argument("--name", help="name of the model (default: that of the data file)")
    parser.add_argument(
        "--measure",
        choices=("angle", "solid-angle"),
        default="angle",
        help="what a grid's values are densities in: theta_i and phi, or steradians (default: angle)",
    )
    parser.add_argument("--lobes", choices=PARTS, default="both", help="what the data holds (default: both)")
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

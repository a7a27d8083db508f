# SPDX-License-Identifier: BSD-3-Clause
"""hairlut bake: from the equations to the textures."""

import argparse
import os
import re
import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from .. import batch_bake, exr, manifest, modelfile, size
from ..errors import HairlutError
from ..lobecheck import find_jump, middle_half
from ..lobes import MODELS, Lobe, Model
from ..measure import measure
from ..model import assemble
from ..table import bake_table
from ..warp import Warp
from . import CHECK_FAILED, OK, add_command

NARROW = 0.01  # of its domain: a lobe whose half lies within less needs a tall and wide table

EXAMPLES = """examples:
  hairlut bake                                      the built-in models into luts/, with V <= 2e-5
  hairlut bake --model fitted --tolerance 1e-3 --out small
  hairlut bake --size 64x64 --out square
  hairlut bake --size 64x64 --warp uniform --out baseline
  hairlut bake --model my_hair.py                   your own lobes (python -m pydoc hairlut.modelfile)
  hairlut bake --model hairs/ --jobs 8 --out baked  every model file in hairs/
  hairlut bake --model theirs.py --timeout 60       stop it after a minute
  parallel hairlut bake --out baked --model ::: hairs/*.py      the same, as the jobs of a queue"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = add_command(
        subparsers,
        "bake",
        help="tabulate the inverse CDF of each lobe of a model, and write the textures",
        description="Integrates each lobe of a model numerically, inverts its CDF and writes a directory "
        "DIR/<model>/ of textures, which the C library loads. Each header states the measured errors.",
        epilog=EXAMPLES,
    )
    parser.add_argument(
        "--model",
        action="append",
        help=f"one of {', '.join(MODELS)}, a model file ({', '.join(modelfile.SUFFIXES)}), or a directory of "
        "model files; files whose textures are up to date are skipped; may be repeated (default: the "
        "built-in models)",
    )
    parser.add_argument(
        "--jobs",
        type=int,
        default=os.cpu_count(),
        metavar="N",
        help="how many models of a directory to bake at the same time",
    )
    parser.add_argument(
        "--timeout",
        type=float,
        metavar="SECONDS",
        help="time limit for each model file, which runs in a process of its own (default: "
        f"{batch_bake.TIMEOUT:g} for the files of a directory, none for a single file)",
    )
    parser.add_argument("--force", action="store_true", help="bake again what is up to date")
    how_large = parser.add_mutually_exclusive_group()
    how_large.add_argument(
        "--tolerance",
        type=float,
        default=size.DEFAULT_TOLERANCE,
        metavar="V",
        help="relative variance that a table may add to an estimate; each table gets the smallest size that "
        "meets it (default: %(default)g)",
    )
    how_large.add_argument(
        "--size", type=parse_size, metavar="WxH", help="columns (u) and rows (theta_r) of every table"
    )
    parser.add_argument(
        "--max-size",
        type=int,
        default=size.DEFAULT_LIMIT,
        metavar="N",
        help="largest width and height that --tolerance may choose (default: %(default)s)",
    )
    parser.add_argument("--out", type=Path, default=Path("luts"), metavar="DIR", help="default: luts")
    parser.add_argument(
        "--warp",
        metavar="WARP",
        help="with --size, the spacing of the columns in u: 'octaves e=NUMBER' or 'uniform' (default: "
        "octaves, with the e that measures best)",
    )
    return parser


def parse_size(text: str) -> tuple[int, int]:
    """(width, height) from "64x32"."""
    match = re.fullmatch(r"(\d{1,6})x(\d{1,6})", text)
    if not match:
        raise argparse.ArgumentTypeError(f"{text!r}: expected WIDTHxHEIGHT, for example 64x64")
    return int(match[1]), int(match[2])


def run(args: argparse.Namespace) -> int:
    if args.warp and not args.size:
        raise HairlutError("--warp: a tolerance chooses the warp itself: give --size too")
    if args.max_size < min(size.ladder(size.DEFAULT_LIMIT)):
        raise HairlutError(
            f"--max-size {args.max_size}: expected {min(size.ladder(size.DEFAULT_LIMIT))} or more"
        )
    args.warp = args.warp and Warp.parse(args.warp)
    names = list(dict.fromkeys(args.model or MODELS))
    if args.timeout is not None or any(Path(name).is_dir() for name in names):
        return run_many(names, args)
    sources = {name: Path(name) for name in names if name not in MODELS}
    for name, source in list(sources.items()):
        if is_current(source, args):
            print(f"{args.out / source.stem}: {batch_bake.UP_TO_DATE}")
            names.remove(name)
    models = {name: modelfile.find(name) for name in names}
    chosen = bake_all(list(models.values()), args)
    if chosen is None:
        return CHECK_FAILED
    for (name, model), choices in zip(models.items(), chosen, strict=True):  # when all have come out
        textures = write(args.out, model, choices)
        if name in sources:
            record(args, sources[name], textures)
    return OK


def is_current(source: Path, args: argparse.Namespace) -> bool:
    """Whether this model file's textures need no baking."""
    return not args.force and manifest.is_current(args.out / source.stem, source, options(args))


def options(args: argparse.Namespace) -> dict:
    """What a model file's textures depend on besides the file."""
    shape = {"size": args.size} if args.size else {"tolerance": args.tolerance, "max_size": args.max_size}
    return {key: str(value) for key, value in {**shape, "warp": args.warp}.items()}


def record(args: argparse.Namespace, source: Path, textures: list[Path]) -> None:
    manifest.record(args.out / source.stem, modelfile.inputs(source), textures, options(args))


def run_many(names: list[str], args: argparse.Namespace) -> int:
    """Bakes directories of model files in processes of their own; 1 if any of them failed."""
    from rich.console import Console
    from rich.progress import Progress

    if args.jobs < 1:
        raise HairlutError(f"--jobs {args.jobs}: expected 1 or more")
    timeout = batch_bake.TIMEOUT if args.timeout is None else args.timeout
    if not timeout > 0:
        raise HairlutError(f"--timeout {timeout:g}: expected seconds above 0")
    paths = [Path(name) for name in names]
    sources = batch_bake.model_files(paths)
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("baking", total=len(sources))

        def report(outcome: batch_bake.Outcome) -> None:
            progress.advance(task)
            print(f"{outcome.source}: {outcome.status} ({outcome.seconds:.1f} s)", flush=True)
            if outcome.status == "failed":
                print(f"  {outcome.text}", file=sys.stderr, flush=True)

        outcomes = batch_bake.bake_many(
            sources, passed_on(args), args.jobs, lambda source: is_current(source, args), timeout, report
        )
    counts = {status: sum(o.status == status for o in outcomes) for status in batch_bake.STATUSES}
    print(f"{len(outcomes)} models: " + ", ".join(f"{count} {status}" for status, count in counts.items()))
    for outcome in outcomes:
        if outcome.status == "failed":
            print(f"  failed: {outcome.source}")
    if counts["failed"]:
        return CHECK_FAILED
    return OK


def passed_on(args: argparse.Namespace) -> list[str]:
    """The options of this command for the command that bakes one model."""
    shape = ["--size", "x".join(map(str, args.size))] if args.size else ["--tolerance", repr(args.tolerance)]
    rest = ["--max-size", str(args.max_size), "--out", str(args.out)]
    warp = ["--warp", str(args.warp)] if args.warp else []
    return [*shape, *rest, *warp, *(["--force"] if args.force else [])]


def bake_all(models: list[Model], args: argparse.Namespace) -> list[list[size.Choice]] | None:
    """The tables of each model; None, with the reason on stderr, if one cannot meet the tolerance."""
    try:
        return [bake_one(model, args) for model in shown(models, "baking")]
    except size.ToleranceError as error:
        print(f"hairlut: {error}{_why(error.lobe)}", file=sys.stderr)
        return None


def shown(items: list, what: str) -> Iterable:
    """The items, with a bar of progress on a terminal."""
    if not sys.stderr.isatty():
        return items
    from rich.console import Console
    from rich.progress import track

    return track(items, what, console=Console(stderr=True), transient=True)


def _why(lobe: Lobe) -> str:
    """Where a density jumps or is narrow, the likely reason why no table meets a tolerance; else nothing."""
    angles = np.linspace(*lobe.theta_r_range, 19)
    for theta_r in angles:
        x = find_jump(lobe, theta_r)
        if x is not None:
            return (
                f". The density jumps at x = {x:.6g} rad where theta_r = {np.degrees(theta_r):.4g} deg: "
                "no smooth table resolves that; replace the jump by a slope"
            )
    angles = np.array(sorted(angles, key=abs))
    width = middle_half(lobe, angles)
    narrow = width < NARROW * (lobe.domain[1] - lobe.domain[0])
    if narrow.any():
        j = int(np.argmax(narrow))
        return (
            f". The density is narrow: it has half of the light within {width[j]:.3g} rad where theta_r = "
            f"{np.degrees(angles[j]):.4g} deg"
        )
    return ""


def bake_one(model: Model, args: argparse.Namespace) -> list[size.Choice]:
    """Tables of the requested size and warp; what was not requested is chosen by measurement."""
    if args.warp:
        tables = [bake_table(lobe, *args.size, args.warp) for lobe in model.lobes]
        pairs = zip(tables, model.lobes, strict=True)
        return [
            size.Choice(table, measure(table, lobe), "size and warp as requested") for table, lobe in pairs
        ]
    if args.size:
        return [size.table_of_size(lobe, *args.size) for lobe in model.lobes]
    return size.smallest_tables(model.lobes, args.tolerance, args.max_size)


def write(out: Path, model: Model, choices: list[size.Choice]) -> list[Path]:
    """Writes a model's files below out, and says what was chosen and why; their paths."""
    tables = {choice.table.name: choice.table for choice in choices}
    errors = {choice.table.name: choice.errors.summary() for choice in choices}
    paths = exr.write_model(out / model.name, assemble(model, tables, errors))
    for choice in choices:
        print(f"{out / model.name / choice.table.name}.exr  {describe(choice)}")
    print(f"{paths[-1]}  {', '.join(model.names)}")
    return paths


def describe(choice: size.Choice) -> str:
    table, errors = choice.table, choice.errors
    return (
        f"{table.width}x{table.height}, {table.nbytes} bytes, {table.warp}: "
        f"V {errors.relative_variance:.2e}, largest weight {errors.largest_weight:.2f} ({choice.reason})"
    )

"""A file checked again from itself alone: its header names the lobe, the lobe says what every texel must be.

Nothing that the bake computed is believed. The lobe is found by the model and table that the header names;
its formula, domain and range must be the header's. Every texel is compared with the quantile of its row, and
the errors of the table are measured and compared with those that the header claims.
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from . import exr, manifest, mixturefile
from .errors import HairlutError
from .exact import exact_at
from .lobes import MODELS, NO_FORMULA, TABLES, Array, Lobe, Model
from .measure import ON_ROWS, Errors, inclinations, measure
from .modelfile import load
from .table import Table

STEPS = 1.0  # of a float by which a texel may miss the quantile
NOISE = 1e-12  # rad, of the quantile itself
CLAIM_SLACK = 1.01
CLAIM_NOISE = 1e-9


@dataclass
class Report:
    """What is known about one file. problems: what is wrong, and where; empty if the file is good. note: what
    could not be checked."""

    path: Path
    problems: list[str] = field(default_factory=list)
    size: str = ""
    note: str = ""
    measured: dict[str, float] = field(default_factory=dict)
    claimed: dict[str, float] = field(default_factory=dict)

    @property
    def ok(self) -> bool:
        return not self.problems


def verify(path: Path, model: Model | None = None) -> list[Report]:
    """Reports on a file, or on every .exr file below a directory.

    model: where the header names no built-in one. It is found if the directory's manifest names its file,
    and that is TOML or npz.
    """
    path = Path(path)
    if not path.exists() and path.suffix != ".exr":  # a table that is missing is a report of its own
        raise HairlutError(f"{path}: no such directory")
    files = sorted(path.rglob("*.exr")) if path.is_dir() else [path]
    if not files:
        raise HairlutError(f"{path}: no .exr file in this directory: expected <model>/<table>.exr")
    beside = filter(None, map(manifest.source, {file.parent for file in files}))
    models = (
        MODELS | {found.name: found for found in map(load, beside)} | ({model.name: model} if model else {})
    )
    reports = [verify_file(file, models) for file in files if file.name != mixturefile.FILE]
    mixtures = [file for file in files if file.name == mixturefile.FILE]
    reports += [_mixture(file) for file in mixtures]
    if path.is_dir():
        for directory in sorted({file.parent for file in files} - {file.parent for file in mixtures}):
            reports += _incomplete(directory)
    return reports


def lobe_of(path: Path, model: Model | None = None) -> Lobe:
    """The lobe that a file's header names; HairlutError where header, file name or directory contradict
    it."""
    return _lobe(path, exr.read(path)[0], MODELS | ({model.name: model} if model else {}))


def _mixture(path: Path) -> Report:
    """The report on a mixture, with the tables that it names, each of which must be of the same bake."""
    report = Report(path)
    try:
        model = exr.read_model(path.parent)
    except HairlutError as error:
        report.problems.append(str(error).removeprefix(f"{path}: "))
        return report
    report.size = f"{len(model.lobes)} lobes, {len(model.tables)} tables"
    return report


def _incomplete(directory: Path) -> list[Report]:
    """A report on each table that a model of format 1 lacks."""
    missing = [name for name in TABLES if not (directory / f"{name}.exr").is_file()]
    return [
        Report(directory / f"{name}.exr", ["the file is missing: bake the model again"]) for name in missing
    ]


def verify_file(path: Path, models: dict[str, Model]) -> Report:
    """The report on one file."""
    report = Report(path)
    try:
        table, report.claimed = exr.read(path)
        report.size = f"{table.width}x{table.height}"
        if table.parameters == NO_FORMULA and table.model not in models:
            report.note = "fitted to a BSDF: checked for form and digest, but not against the BSDF"
            return report
        lobe = _lobe(path, table, models)
    except HairlutError as error:
        report.problems.append(str(error).removeprefix(f"{path}: "))
        return report
    exact = exact_at(lobe, inclinations(table.theta_r_range, table.height))
    report.problems += _texels(table, exact.quantiles(*table.warp.knots(table.width), ON_ROWS))
    errors = measure(table, lobe, exact=exact)
    report.measured = errors.summary()
    report.problems += _claims(errors, report.claimed)
    return report


def _lobe(path: Path, table: Table, models: dict[str, Model]) -> Lobe:
    """The lobe that the header names; HairlutError where header, file name or directory contradict it."""
    if table.model not in models:
        raise HairlutError(
            f"attribute hairlut.model is {table.model!r}, expected one of {', '.join(models)}: "
            "name the model's file with --model"
        )
    directory = path.resolve().parent.name
    if directory in models and directory != table.model:
        raise HairlutError(
            f"attribute hairlut.model is {table.model!r}, but the directory is {directory!r}: "
            "a table of another model stands under this one's name"
        )
    lobe = getattr(models[table.model], table.name)
    expected = {
        "angle": (table.angle, lobe.angle),
        "azimuth": (table.azimuth, lobe.azimuth),
        "domain": (table.domain, lobe.domain),
        "theta_r_range": (table.theta_r_range, lobe.theta_r_range),
        "parameters": (table.parameters, lobe.formula),
    }
    for name, (found, wanted) in expected.items():
        if found != wanted:
            raise HairlutError(
                f"attribute hairlut.{name} is {found!r}, expected {wanted!r}: bake the table again"
            )
    return lobe


def _texels(table: Table, quantiles: Array) -> list[str]:
    """One problem for each wrong row."""
    off = abs(table.texels - quantiles)
    wrong = off > STEPS * np.spacing(abs(table.texels)) + NOISE
    return [_wrong_row(table, quantiles, off, j, wrong[j]) for j in np.flatnonzero(wrong.any(axis=1))]


def _wrong_row(table: Table, quantiles: Array, off: Array, j: int, wrong: Array) -> str:
    where = f"row {j} (theta_r = {table.theta_r[j]:.6g} rad)"
    other = int(abs(table.texels[j] - quantiles).max(axis=1).argmin())
    if other != j and abs(table.texels[j] - quantiles[other]).max() < 1e-6:
        return f"{where} holds the quantiles of row {other}"
    i = int(off[j].argmax())
    return (
        f"{where}: {wrong.sum()} of {table.width} texels are wrong, worst in column {i}: "
        f"{table.texels[j, i]:.9g}, expected {quantiles[j, i]:.9g}, {off[j, i]:.1e} rad off"
    )


def _claims(errors: Errors, claimed: dict[str, float]) -> list[str]:
    """One problem for each error that the header does not claim, or claims too small."""
    problems = []
    for name, value in errors.summary().items():
        if name not in claimed:
            problems.append(f"attribute hairlut.error.{name} is missing, measured {value:.3e}")
        elif not value <= CLAIM_SLACK * claimed[name] + CLAIM_NOISE:
            problems.append(
                f"error {name} is {value:.3e}, attribute hairlut.error.{name} claims {claimed[name]:.3e}"
            )
    return problems

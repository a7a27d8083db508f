# SPDX-License-Identifier: BSD-3-Clause
"""Checks a model's files from the files alone: the headers name the lobes, the lobes say what every texel
must be.

Every number is computed again. The lobe is that of the model and table that the header names; its
formula, domain and range must be the header's. Every texel is compared with the quantile and the slope of its
row, and the errors of the table are measured and compared with those that the header claims. The files of a
directory must belong together: mixture.exr names its tables by their digests. A model that was fitted to data
has no lobes to compare with; its files are checked for being whole and of one bake. What a model draws over
parameters of the hair is checked at random ones: each table's density, found from the angle, integrates to 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from . import exr, interpolant, manifest, mixturefile
from .axes import Axis
from .errors import HairlutError
from .exact import exact_at
from .lobes import MODELS, NO_FORMULA, Array, Lobe, Model
from .measure import NODES, ON_ROWS, WEIGHTS, Errors, inclinations, measure
from .mixture import constant
from .model import BakedModel
from .modelfile import load
from .table import Table, tabulate

STEPS = 1.0  # of a float by which a texel may miss the quantile
NOISE = 1e-12  # rad, of the quantile itself
SLOPE_OFF = 1e-4  # relative: a slope at an end follows from a small difference of two quantiles
SHARE_OFF = 1e-6
NOT_COMPARED = "fitted to a BSDF: checked for form and digest, but not against the BSDF"
PLACES = 64  # random parameters and viewers
DENSITY_OFF = 1e-6
CLAIM_SLACK = 1.01
CLAIM_NOISE = 1e-9


@dataclass
class Report:
    """The result for one file. problems: what is wrong, and where; empty if the file is good.
    note: what could not be checked."""

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

    model: the model, where the header names no built-in one. Not needed if the directory's manifest names
    its file, and that is TOML or npz.
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
    reports = [verify_file(file, models) for file in files]
    if path.is_dir():
        for directory in sorted({file.parent for file in files}):
            reports += _whole(directory, reports)
    return reports


def lobe_of(path: Path, model: Model | None = None) -> Lobe:
    """The lobe that a file's header names; HairlutError where header, file name or directory contradict
    it."""
    return _lobe(path, exr.read(path)[0], MODELS | ({model.name: model} if model else {}))


def _whole(directory: Path, reports: list[Report]) -> list[Report]:
    """The report on the directory as a whole, if each of its files is good by itself; none where there is
    nothing to say."""
    if not all(report.ok for report in reports if report.path.parent == directory):
        return []
    try:
        model = exr.read_model(directory)
    except HairlutError as error:
        path, _, problem = str(error).partition(": ")
        return [Report(Path(path), [problem])]
    if not model.parameters:
        return []
    note = f"{len(model.tables)} tables: densities integrate to 1 at {PLACES} random parameters and viewers"
    problems = _at_random_parameters(model)
    return [Report(directory, problems, note="" if problems else note)]


def _at_random_parameters(model: BakedModel) -> list[str]:
    """One problem for each table whose density does not integrate to 1 at random parameters and viewers."""
    random = np.random.default_rng(24)
    given = {p.name: random.uniform(p.least, p.most, PLACES) for p in model.parameters}
    problems = []
    for table in model.tables:
        theta_r = random.uniform(*table.theta_r_range, PLACES)
        mass = _mass(table, theta_r, given)
        n = int(abs(mass - 1).argmax())
        if not abs(mass[n] - 1) <= DENSITY_OFF:
            place = ", ".join(f"{axis.name} = {given[axis.name][n]:.6g}" for axis in table.axes)
            problems.append(
                f"{table.name}: the density integrates to {mass[n]:.9g}, expected 1, at theta_r = "
                f"{theta_r[n]:.6g}, {place}: bake the model again"
            )
    return problems


def _mass(table: Table, theta_r: Array, given: dict[str, Array]) -> Array:
    """(n,) the integral over each cell of the density of its angles, by Gauss-Legendre sums."""
    cells = interpolant.cells(table, theta_r, given)
    x, slope = cells.read(NODES)

    def spread(values: Array) -> Array:
        return np.broadcast_to(values[:, None, None], x.shape).ravel()

    each = {axis.name: spread(given[axis.name]) for axis in table.axes}
    density = interpolant.pdf(table, spread(theta_r), x.ravel(), each).reshape(x.shape)
    return np.einsum("nik,i,k->n", density * slope, cells.h, WEIGHTS)


def verify_file(path: Path, models: dict[str, Model]) -> Report:
    """The report on one file, a table or mixture.exr."""
    report = Report(path)
    try:
        if path.name == mixturefile.FILE:
            _verify_mixture(path, models, report)
        else:
            _verify_table(path, models, report)
    except HairlutError as error:
        report.problems.append(str(error).removeprefix(f"{path}: "))
    return report


def _verify_mixture(path: Path, models: dict[str, Model], report: Report) -> None:
    found = mixturefile.read(path)
    report.size = f"{len(found.mixture.theta_r)}x{len(found.mixture.offset)}" + _nodes(found.mixture.axes)
    model = models.get(found.model)
    if model is not None and found.parameters:
        raise HairlutError(
            f"attribute hairlut.axes names {', '.join(p.name for p in found.parameters)}, but the lobes of "
            f"{found.model} depend on no parameters"
        )
    if model is None:
        if any(table.parameters != NO_FORMULA for table in exr.read_model(path.parent).tables):
            raise HairlutError(_unknown(found.model, models))
        report.note = NOT_COMPARED
    elif found.mixture.lobes != model.names:
        report.problems.append(
            f"attribute hairlut.lobes is {' '.join(found.mixture.lobes)}, expected {' '.join(model.names)}"
        )
    else:
        expected = constant(model.names, model.shares)
        off = abs(found.mixture.share - expected.share).max(axis=(1, 2))
        report.problems += [
            f"{name}.share is {found.mixture.share[k].ravel()[0]:.6g}, expected {expected.share[k, 0, 0]:.6g}"
            for k, name in enumerate(model.names)
            if off[k] > SHARE_OFF
        ]


def _verify_table(path: Path, models: dict[str, Model], report: Report) -> None:
    table, report.claimed = exr.read(path)
    report.size = f"{table.width}x{table.height}" + _nodes(table.axes)
    if table.model not in models and table.parameters == NO_FORMULA:
        report.note = NOT_COMPARED
        return
    lobe = _lobe(path, table, models)
    exact = exact_at(lobe, inclinations(table.theta_r_range, table.height))
    again = tabulate(lobe, exact, table.width, table.warp, ON_ROWS)
    report.problems += _texels(table, exact.quantiles(*table.warp.knots(table.width), ON_ROWS))
    report.problems += _slopes(table, again.slopes)
    errors = measure(table, lobe, exact=exact)
    report.measured = errors.summary()
    report.problems += _claims(errors, report.claimed)


def _nodes(axes: Sequence[Axis]) -> str:
    """Their numbers, to follow a size."""
    return "".join(f"x{len(axis.nodes)}" for axis in axes)


def _unknown(model: str, models: dict[str, Model]) -> str:
    return (
        f"attribute hairlut.model is {model!r}, expected one of {', '.join(models)}: "
        "name the model's file with --model"
    )


def _lobe(path: Path, table: Table, models: dict[str, Model]) -> Lobe:
    """The lobe that the header names; HairlutError where header, file name or directory contradict it."""
    if table.model not in models:
        raise HairlutError(_unknown(table.model, models))
    directory = path.resolve().parent.name
    if directory in models and directory != table.model:
        raise HairlutError(
            f"attribute hairlut.model is {table.model!r}, but the directory is {directory!r}: "
            "a table of another model stands under this one's name"
        )
    if table.axes:
        raise HairlutError(
            f"attribute hairlut.axes names {table.axes[0].name}, but the lobes of {table.model} depend on no "
            "parameters"
        )
    lobe = getattr(models[table.model], table.name, None)
    if lobe is None:
        raise HairlutError(f"attribute hairlut.table is {table.name!r}, which {table.model} does not have")
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


def _slopes(table: Table, expected: Array) -> list[str]:
    """One problem if a slope is wrong."""
    off = abs(table.slopes / expected - 1)
    if not (off > SLOPE_OFF).any():
        return []
    j, i = np.unravel_index(off.argmax(), off.shape)
    return [
        f"row {j} (theta_r = {table.theta_r[j]:.6g} rad): {(off > SLOPE_OFF).sum()} slopes are wrong, worst "
        f"in column {i}: dxdu is {table.slopes[j, i]:.9g}, expected {expected[j, i]:.9g}"
    ]


def _wrong_row(table: Table, quantiles: Array, off: Array, j: int, wrong: Array) -> str:
    where = f"row {j} (theta_r = {table.theta_r[j]:.6g} rad)"
    other = int(abs(table.texels[j] - quantiles).max(axis=1).argmin())
    if other != j and abs(table.texels[j] - quantiles[other]).max() < 1e-6:
        return f"{where} contains the quantiles of row {other}"
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

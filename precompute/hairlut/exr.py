# SPDX-License-Identifier: BSD-3-Clause
"""Tables and whole models as OpenEXR files (luts/FORMAT.md)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from . import axesfile, mixturefile, slopes
from .axes import check_ranges
from .errors import HairlutError
from .exrfile import (
    MAX_INCLINATION,
    PREFIX,
    REBAKE,
    UNIT,
    Attributes,
    Header,
    common_attributes,
    numbers_text,
    read_image,
    write_image,
)
from .lobes import (
    AZIMUTHS,
    DIRECT,
    DIRECT_PHI,
    DIRECT_THETA,
    MULTIPLE,
    MULTIPLE_THETA,
    NO_AZIMUTH,
    Array,
    space,
)
from .mixture import constant
from .model import BakedLobe, BakedModel
from .parameter import number
from .table import Table, check_size
from .warp import Warp

CELL = "rational quadratic"
OLD_LOBES = {DIRECT: (DIRECT_THETA, DIRECT_PHI), MULTIPLE: (MULTIPLE_THETA, None)}
CHANNELS = {1: ("Y",), 2: ("Y", "dxdu")}
KNOT_TOLERANCE = 1e-6  # of the smaller tail
NARROWEST = 1e-12  # rad
LEAST_WIDTH = 1e-6  # rad, of an interval


def write_model(directory: Path, model: BakedModel) -> list[Path]:
    """Writes directory/<table>.exr for each table, and last mixture.exr; their paths.

    Each file appears whole or not at all; until mixture.exr is there, which names the tables by their
    digests, a reader refuses a directory of old and new files.
    """
    directory = Path(directory)
    paths = []
    for table in model.tables:
        paths.append(directory / f"{table.name}.exr")
        write(paths[-1], table, model.errors.get(table.name))
    paths.append(directory / mixturefile.FILE)
    mixturefile.write(paths[-1], model)
    return paths


def read_model(directory: Path) -> BakedModel:
    """The model of a directory; HairlutError if a file is unfit, missing, or of another bake."""
    directory = Path(directory)
    if not directory.is_dir():
        raise HairlutError(f"{directory}: expected a directory with mixture.exr, or with tables of format 1")
    file = directory / mixturefile.FILE
    if not file.is_file() and not (directory / f"{DIRECT_THETA}.exr").is_file():
        below = sorted(directory.glob(f"*/{mixturefile.FILE}"))
        remedy = f"name the directory of one model, such as {below[0].parent}" if below else REBAKE
        raise HairlutError(f"{file}: no such file: {remedy}")
    mixed = mixturefile.read(file) if file.is_file() else None
    names = {name: mixed.tables[name] for name in mixed.mixture.lobes} if mixed else OLD_LOBES
    read_before: dict[str, tuple[Table, dict[str, float]]] = {}

    def table(name: str | None) -> Table | None:
        if name and name not in read_before:
            read_before[name] = _read(directory / f"{name}.exr", 2 if mixed else 1)
        return read_before[name][0] if name else None

    lobes = tuple(BakedLobe(lobe, table(theta), table(phi)) for lobe, (theta, phi) in names.items())
    errors = {name: found for name, (_, found) in read_before.items()}
    model = mixed.model if mixed else lobes[0].theta.model
    for each, _ in read_before.values():
        _check_member(directory / f"{each.name}.exr", each, model, mixed)
    mixture = mixed.mixture if mixed else constant(tuple(OLD_LOBES))
    errors |= {"mixture": mixed.errors} if mixed else {}
    return BakedModel(model, lobes, mixture, errors, mixed.parameters if mixed else ())


def _check_member(path: Path, table: Table, model: str, mixed: mixturefile.MixtureFile | None) -> None:
    """HairlutError if a table does not belong to the directory that it is in."""
    if table.model != model:
        raise HairlutError(
            f"{path}: attribute {PREFIX}model is {table.model!r}, expected {model!r} as in the other files: "
            "bake them again together"
        )
    if mixed and table.digest != mixed.digests[table.name]:
        raise HairlutError(
            f"{path}: the texels have the digest {table.digest!r}, but mixture.exr names "
            f"{mixed.digests[table.name]!r}: the files are of different bakes; bake them again together"
        )
    try:
        check_ranges(table.axes, mixed.parameters if mixed else ())
    except HairlutError as error:
        raise HairlutError(f"{path}: {error}: bake the model's files again together") from error


def write(path: Path, table: Table, errors: Mapping[str, float] | None = None) -> None:
    """Writes a table to path, named <table.name>.exr."""
    path = Path(path)
    if path.name != f"{table.name}.exr":
        raise HairlutError(f"{path}: table {table.name} must be named {table.name}.exr")
    write_image(path, attributes(table), {"Y": table.texels, "dxdu": table.slopes}, errors or {})


def attributes(table: Table) -> Attributes:
    """The header of a table without its digest and measured errors."""
    return {
        **common_attributes(table.model, table.name),
        "hairlut.angle": table.angle,
        "hairlut.azimuth": table.azimuth,
        "hairlut.theta_r_range": numbers_text(table.theta_r_range),
        "hairlut.domain": numbers_text(table.domain),
        "hairlut.warp": str(table.warp),
        "hairlut.cell": CELL,
        "hairlut.knots": numbers_text(table.warp.u(table.width)),
        **axesfile.of_table(table.axes),
        "hairlut.parameters": table.parameters,
        "hairlut.log_mass": numbers_text(np.round(table.log_mass, 12) + 0.0),  # as on every machine
    }


def read(path: Path) -> tuple[Table, dict[str, float]]:
    """(table, measured errors) of a file. If it is unfit, HairlutError names file, attribute and remedy."""
    path = Path(path)
    if path.name == mixturefile.FILE:
        raise HairlutError(f"{path}: is a mixture, not a table: name {path.parent} or a table in it")
    return _read(path)


def _read(path: Path, of_format: int | None = None) -> tuple[Table, dict[str, float]]:
    """As read; of_format: that of the directory, which is 2 where there is a mixture.exr."""

    def channels_of(header: Header) -> tuple[str, ...]:
        if of_format and header.format != of_format:
            beside = f"as there is {'a' if of_format > 1 else 'no'} {mixturefile.FILE} beside it"
            raise header.failure("format", f"is {header.format}, expected {of_format}, {beside}")
        return CHANNELS[header.format]

    header, channels = read_image(path, channels_of)
    texels = channels[0]
    rows, width = texels.shape
    axes = axesfile.read_table_axes(header)
    height = axesfile.split_rows(header, rows, axes)
    try:
        check_size(width, height)
    except HairlutError as error:
        raise HairlutError(f"{path}: {error}: {REBAKE}") from error
    name = header.one_of("table", (path.stem,), f"rename the file to the table it holds, or {REBAKE}")
    angle, domain = _space(header, name)
    header.one_of("unit", (UNIT,))
    warp = header.parsed("warp", Warp.parse)
    _check_cell(header)
    _check_knots(header, warp, width)
    table = Table(
        model=header.model(),
        name=name,
        angle=header.one_of("angle", (angle,)),
        azimuth=header.one_of("azimuth", AZIMUTHS if angle == "phi" else (NO_AZIMUTH,)),
        domain=_within(header, "domain", *domain),
        theta_r_range=_within(header, "theta_r_range", -MAX_INCLINATION, MAX_INCLINATION),
        parameters=_parameters(header),
        warp=warp,
        texels=texels,
        slopes=np.ones_like(texels),
        log_mass=header.information("log_mass", rows),
        axes=axes,
    )
    if header.format > 1:
        header.check_digest(channels)
    _check_angles(path, table)
    if header.format == 1:
        given = slopes.derived(texels, warp.widths(width)).astype(np.float32)
    else:
        given = channels[1]
        _check_slopes(path, given)
    return replace(table, slopes=given), header.errors()


def _space(header: Header, name: str) -> tuple[str, tuple[float, float]]:
    """(angle, widest domain) that the name of a table allows."""
    try:
        allowed = space(name)
    except HairlutError as error:
        raise header.failure("table", f"is {name!r} ({error})") from error
    return allowed["angle"], allowed["domain"]


def _within(header: Header, name: str, low: float, high: float) -> tuple[float, float]:
    """An interval that lies between two numbers, up to the rounding of a float."""
    found = header.interval(name)
    first, last = np.float32(found)
    if first < np.float32(low) or last > np.float32(high) or last - first < np.float32(LEAST_WIDTH):
        expected = f"two increasing angles in radians from {low:.6g} to {high:.6g}"
        raise header.failure(name, f"is {found[0]!r} {found[1]!r}, expected {expected}")
    return found


def _parameters(header: Header) -> str:
    """Information that a file may lack."""
    found = header.attributes.get("hairlut.parameters")
    return found if isinstance(found, str) else ""


def _check_cell(header: Header) -> None:
    if header.format > 1:
        header.one_of("cell", (CELL,))
        return
    text = header.text("cell")
    name, _, limit = text.partition(" limit=")
    if text != "linear" and not (name == "parabola" and 0.0 <= number(limit) <= 0.95):
        raise header.failure("cell", f"is {text!r}, expected 'linear' or 'parabola limit=NUMBER', 0 to 0.95")


def _check_knots(header: Header, warp: Warp, width: int) -> None:
    """The knots are in the file for readers that do not know the warp: here they guard against a warp that
    is not theirs."""
    knots, (tail, upper) = header.numbers("knots", width), warp.knots(width)
    wrong = ~(abs(np.where(upper, 1 - knots, knots) - tail) <= KNOT_TOLERANCE * tail + 1e-15)
    if wrong.any():
        i = int(np.argmax(wrong))
        expected = warp.u(width)[i]
        found = f"has {knots[i]!r} at column {i}, expected {expected!r} from the warp {warp}"
        raise header.failure("knots", found)


def _check_angles(path: Path, table: Table) -> None:
    texels = table.texels
    wrong = ~np.isfinite(texels)
    if wrong.any():
        j, i = np.argwhere(wrong)[0]
        raise HairlutError(
            f"{path}: row {j}, column {i} is {texels[j, i]}, expected a finite angle: {REBAKE}"
        )
    wrong = ~(np.diff(texels, axis=1) >= np.float32(NARROWEST))
    if wrong.any():
        j, i = np.argwhere(wrong)[0]
        raise HairlutError(
            f"{path}: row {j}, columns {i} and {i + 1} are {texels[j, i]:.9g} and {texels[j, i + 1]:.9g}, "
            f"expected angles that increase by {NARROWEST:g} or more: {REBAKE}"
        )
    low, high = np.float32(table.domain)
    wrong = (texels[:, 0] != low) | (texels[:, -1] != high)
    if wrong.any():
        j = int(np.argmax(wrong))
        raise HairlutError(
            f"{path}: row {j} runs from {texels[j, 0]:.9g} to {texels[j, -1]:.9g}, expected the ends of the "
            f"domain, {low:.9g} and {high:.9g}: {REBAKE}"
        )


def _check_slopes(path: Path, given: Array) -> None:
    low, high = np.float32(slopes.RANGE)
    wrong = ~((given >= low) & (given <= high))
    if wrong.any():
        j, i = np.argwhere(wrong)[0]
        raise HairlutError(
            f"{path}: row {j}, column {i}: dxdu is {given[j, i]:.9g}, expected {low:g} to {high:g}: {REBAKE}"
        )

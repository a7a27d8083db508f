# SPDX-License-Identifier: BSD-3-Clause
"""mixture.exr: the names of a model's lobes, their tables, shares and turns (luts/FORMAT.md)."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import axesfile
from .axes import MAX_PARAMETERS, Parameter
from .errors import HairlutError
from .exrfile import (
    MAX_INCLINATION,
    REBAKE,
    UNIT,
    Attributes,
    Header,
    common_attributes,
    numbers_text,
    read_image,
    write_image,
)
from .lobes import LOBE_NAME, MAX_LOBES, Array, space
from .mixture import MAX_GRID, Mixture
from .model import BakedLobe, BakedModel

FILE = "mixture.exr"
AXES = "theta_r offset"
LOBE_TEXT = r"(?P<theta>\w+) (?P<theta_crc>[0-9a-f]{8})(?: (?P<phi>\w+) (?P<phi_crc>[0-9a-f]{8}))?"
LOBE_FORM = "'NAME_theta DIGEST' or 'NAME_theta DIGEST NAME_phi DIGEST', with 8 hexadecimal digits each"


@dataclass(frozen=True)
class MixtureFile:
    """What mixture.exr says.

    tables      names of each lobe's tables: theta, and phi or None
    digests     digest of each table, as Table.digest
    parameters  those of the whole model
    """

    model: str
    mixture: Mixture
    tables: dict[str, tuple[str, str | None]]
    digests: dict[str, str]
    errors: dict[str, float]
    parameters: tuple[Parameter, ...]


def write(path: Path, model: BakedModel) -> None:
    """Writes mixture.exr: for each node of the parameters a row for each theta_r, with a column an offset."""
    mixture = model.mixture
    channels = {}
    for k, name in enumerate(mixture.lobes):
        share, turn = (values[k].reshape(-1, len(mixture.offset)) for values in (mixture.share, mixture.turn))
        channels |= {f"{name}.share": share, f"{name}.turn": turn}
    attributes: Attributes = {
        **common_attributes(model.name, "mixture"),
        "hairlut.lobes": " ".join(mixture.lobes),
        **{f"hairlut.lobe.{lobe.name}": _tables_text(lobe) for lobe in model.lobes},
        "hairlut.axes": " ".join([*(parameter.name for parameter in model.parameters), AXES]),
        **axesfile.of_mixture(model.parameters, mixture.axes),
        "hairlut.axis.theta_r": numbers_text(mixture.theta_r),
        "hairlut.axis.offset": numbers_text(mixture.offset),
        "hairlut.mirrored": str(int(mixture.mirrored)),
    }
    write_image(path, attributes, channels, model.errors.get("mixture", {}))


def _tables_text(lobe: BakedLobe) -> str:
    return " ".join(f"{table.name} {table.digest.removeprefix('crc32 ')}" for table in lobe.tables)


def read(path: Path) -> MixtureFile:
    """HairlutError, which names file, attribute and remedy, if the file is unfit."""
    header, channels = read_image(path, lambda header: _channel_names(_lobes(header)))
    if header.format < 2:
        raise header.failure("format", f"is {header.format}, expected 2")
    header.one_of("table", ("mixture",))
    header.one_of("unit", (UNIT,))
    names = axesfile.read_names(header, AXES, MAX_PARAMETERS)
    parameters, axes = axesfile.read_parameters(header, names)
    lobes = _lobes(header)
    mirrored = header.one_of("mirrored", ("0", "1")) == "1"
    rows, columns = channels[0].shape
    if rows * columns > MAX_GRID:
        raise HairlutError(
            f"{path}: size is {columns}x{rows}, expected at most {MAX_GRID} nodes in all: {REBAKE}"
        )
    height = axesfile.split_rows(header, rows, axes)
    theta_r = _axis(header, "axis.theta_r", height, -MAX_INCLINATION, MAX_INCLINATION)
    offset = _axis(header, "axis.offset", columns, 0.0 if mirrored else -1.0, 1.0)
    header.check_digest(channels)
    shape = len(lobes), *(len(axis.nodes) for axis in axes), height, columns
    share, turn = (np.stack(channels[first::2]).astype(float).reshape(shape) for first in (0, 1))
    try:
        mixture = Mixture(lobes, theta_r, offset, share, turn, mirrored, axes)
    except HairlutError as error:
        raise HairlutError(f"{path}: {error}: {REBAKE}") from error
    tables, digests = _tables(header, lobes)
    return MixtureFile(header.model(), mixture, tables, digests, header.errors(), parameters)


def _lobes(header: Header) -> tuple[str, ...]:
    text = header.text("lobes")
    lobes = tuple(text.split(" "))
    if (
        len(lobes) > MAX_LOBES
        or len(set(lobes)) < len(lobes)
        or not all(re.fullmatch(LOBE_NAME, n) for n in lobes)
    ):
        raise header.failure("lobes", f"is {text[:80]!r}, expected 1 to 16 different names, a space between")
    return lobes


def _channel_names(lobes: tuple[str, ...]) -> list[str]:
    return [f"{name}.{what}" for name in lobes for what in ("share", "turn")]


def _axis(header: Header, name: str, count: int, low: float, high: float) -> Array:
    """A number for each row or column, increasing also as 32-bit floats, from low to high."""
    nodes = header.numbers(name, count)
    if nodes.min() < low or nodes.max() > high or not (np.diff(nodes.astype(np.float32)) > 0).all():
        expected = f"increasing numbers from {low:.6g} to {high:.6g}"
        raise header.failure(name, f"is {header.text(name)[:60]!r}, expected {expected}")
    return nodes


def _tables(
    header: Header, lobes: tuple[str, ...]
) -> tuple[dict[str, tuple[str, str | None]], dict[str, str]]:
    """(names of each lobe's tables, digest of each table)"""
    tables, digests = {}, {}
    for lobe in lobes:
        attribute = f"lobe.{lobe}"
        text = header.text(attribute)
        match = re.fullmatch(LOBE_TEXT, text, re.ASCII)
        if not match or not _are_kinds(match["theta"], match["phi"]):
            raise header.failure(attribute, f"is {text[:120]!r}, expected {LOBE_FORM}")
        tables[lobe] = match["theta"], match["phi"]
        for kind in ("theta", "phi"):
            name, digest = match[kind], f"crc32 {match[f'{kind}_crc']}"
            if name and digests.setdefault(name, digest) != digest:
                raise header.failure(attribute, f"gives {name} another digest than the lobe before it")
    return tables, digests


def _are_kinds(theta: str, phi: str | None) -> bool:
    try:
        return space(theta)["angle"] == "theta_i" and (phi is None or space(phi)["angle"] == "phi")
    except HairlutError:
        return False

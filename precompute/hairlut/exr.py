"""Tables as OpenEXR files (luts/FORMAT.md): written whole or not at all, and read with suspicion."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import OpenEXR

from . import __version__
from .cell import Cell
from .errors import HairlutError
from .files import replace_whole
from .lobes import DIFFERENCE, NO_AZIMUTH, SUM
from .table import Table, check_size
from .warp import Warp

FORMAT = 1
UNIT = "rad"
PREFIX = "hairlut."
ERROR_PREFIX = "hairlut.error."
REBAKE = "bake it again with 'hairlut bake'"
KNOT_TOLERANCE = 1e-15


def write(path: Path, table: Table, errors: Mapping[str, float] | None = None) -> None:
    """Writes table to path, named <table.name>.exr; a file that is there already is replaced in one step.

    errors: measured errors by name ("relative_variance", ...), written as hairlut.error.<name>.
    """
    path = Path(path)
    if path.name != f"{table.name}.exr":
        raise HairlutError(f"{path}: table {table.name} must be named {table.name}.exr")
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        **attributes(table),
        **{ERROR_PREFIX + name: f"{value:.3e}" for name, value in (errors or {}).items()},
    }
    texels = np.ascontiguousarray(table.texels, np.float32)

    def write_image(temporary: Path) -> None:
        with OpenEXR.File(header, {"Y": texels}) as file:
            file.write(str(temporary))

    replace_whole(path, write_image)


def attributes(table: Table) -> dict[str, str | int]:
    """The header of a table without its measured errors. Numbers are text: a float attribute has 32 bits."""
    return {
        "colorInteropID": "data",
        "hairlut.format": FORMAT,
        "hairlut.generator": f"hairlut {__version__}",
        "hairlut.model": table.model,
        "hairlut.table": table.name,
        "hairlut.angle": table.angle,
        "hairlut.azimuth": table.azimuth,
        "hairlut.unit": UNIT,
        "hairlut.theta_r_range": _numbers(table.theta_r_range),
        "hairlut.domain": _numbers(table.domain),
        "hairlut.warp": str(table.warp),
        "hairlut.cell": str(table.cell),
        "hairlut.knots": _numbers(table.warp.u(table.width)),
        "hairlut.parameters": table.parameters,
        "hairlut.log_mass": _numbers(np.round(table.log_mass, 12) + 0.0),  # what every machine agrees on
    }


def _numbers(values) -> str:
    return " ".join(repr(float(x)) for x in values)


def read(path: Path) -> tuple[Table, dict[str, float]]:
    """(table, measured errors) of a file. If it is unfit, HairlutError names file, attribute and remedy."""
    path = Path(path)
    header, channels = _open(path)
    reader = _Header(path, header)
    _refuse_other_formats(reader)
    texels = _texels(path, header, channels)
    table = Table(
        model=reader.text("model"),
        name=reader.one_of("table", (path.stem,), f"rename the file to the table it holds, or {REBAKE}"),
        angle=reader.one_of("angle", ("theta_i", "phi")),
        azimuth=reader.one_of("azimuth", (SUM, DIFFERENCE, NO_AZIMUTH)),
        domain=reader.interval("domain"),
        theta_r_range=reader.interval("theta_r_range"),
        parameters=reader.text("parameters"),
        warp=reader.parsed("warp", Warp.parse),
        cell=reader.parsed("cell", Cell.parse),
        texels=texels,
        log_mass=reader.numbers("log_mass", len(texels)),
    )
    reader.one_of("unit", (UNIT,))
    _check_knots(reader, table)
    _check_rows(path, table)
    return table, reader.errors()


def _open(path: Path) -> tuple[dict, dict]:
    if path.is_dir():
        raise HairlutError(f"{path}: is a directory: name a file in it")
    if not path.is_file():
        raise HairlutError(f"{path}: no such file: {REBAKE}")
    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            channels = {name: np.array(channel.pixels) for name, channel in file.channels().items()}
            return dict(file.header()), channels
    except Exception as error:  # the binding raises several unrelated types
        raise HairlutError(
            f"{path}: not a complete OpenEXR image ({_first_line(error)}): {REBAKE}"
        ) from error


def _first_line(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]


class _Header:
    """Attributes of one file, each checked as it is asked for."""

    def __init__(self, path: Path, header: dict) -> None:
        self.path, self.header = path, header

    def fail(self, name: str, found: str, remedy: str = REBAKE) -> HairlutError:
        return HairlutError(f"{self.path}: attribute {PREFIX}{name} {found}: {remedy}")

    def text(self, name: str) -> str:
        value = self.header.get(PREFIX + name)
        if value is None:
            raise self.fail(name, "is missing")
        if not isinstance(value, str):
            raise self.fail(name, f"is {value!r}, expected text")
        return value

    def one_of(self, name: str, expected: tuple[str, ...], remedy: str = REBAKE) -> str:
        value = self.text(name)
        if value not in expected:
            raise self.fail(name, f"is {value!r}, expected {' or '.join(map(repr, expected))}", remedy)
        return value

    def numbers(self, name: str, count: int) -> np.ndarray:
        text = self.text(name)
        try:
            values = np.array([float(word) for word in text.split()])
        except ValueError:
            values = np.array([np.nan])
        if len(values) != count or not np.isfinite(values).all():
            raise self.fail(name, f"is {text[:60]!r}, expected {count} finite numbers")
        return values

    def interval(self, name: str) -> tuple[float, float]:
        low, high = self.numbers(name, 2)
        if not low < high:
            raise self.fail(name, f"is {low!r} {high!r}, expected two increasing numbers")
        return float(low), float(high)

    def parsed(self, name: str, parse):
        text = self.text(name)
        try:
            return parse(text)
        except HairlutError as error:
            raise self.fail(name, f"is {text!r} ({error})") from error

    def errors(self) -> dict[str, float]:
        """The measured errors, as many as the file has."""
        names = sorted(name for name in self.header if name.startswith(ERROR_PREFIX))
        return {name[len(ERROR_PREFIX) :]: float(self.numbers(name[len(PREFIX) :], 1)[0]) for name in names}


def _refuse_other_formats(reader: _Header) -> None:
    version = reader.header.get(PREFIX + "format")
    if version is None:
        raise reader.fail("format", "is missing: the file is no hairlut table")
    if not isinstance(version, int) or version < 1:
        raise reader.fail("format", f"is {version!r}, expected {FORMAT}")
    if version > FORMAT:
        raise reader.fail(
            "format", f"is {version}, expected {FORMAT} or less", "use a newer hairlut to read this file"
        )


def _texels(path: Path, header: dict, channels: dict) -> np.ndarray:
    if set(channels) != {"Y"}:
        raise HairlutError(f"{path}: channels are {', '.join(sorted(channels))}, expected Y alone: {REBAKE}")
    texels = channels["Y"]
    if texels.dtype != np.float32:
        raise HairlutError(f"{path}: channel Y is {texels.dtype}, expected 32-bit float: {REBAKE}")
    height, width = texels.shape
    for name in ("dataWindow", "displayWindow"):
        corners = [tuple(int(x) for x in corner) for corner in header[name]]
        if corners != [(0, 0), (width - 1, height - 1)]:
            raise HairlutError(
                f"{path}: {name} is {corners}, expected it to start at 0 0 and span the image: {REBAKE}"
            )
    try:
        check_size(width, height)
    except HairlutError as error:
        raise HairlutError(f"{path}: {error}: {REBAKE}") from error
    return texels


def _check_knots(reader: _Header, table: Table) -> None:
    knots = reader.numbers("knots", table.width)
    expected = table.warp.u(table.width)
    if (abs(knots - expected) > KNOT_TOLERANCE).any():
        i = int(np.argmax(abs(knots - expected)))
        found = f"has {knots[i]!r} at column {i}, expected {expected[i]!r} from the warp {table.warp}"
        raise reader.fail("knots", found)


def _check_rows(path: Path, table: Table) -> None:
    texels = table.texels
    wrong = ~np.isfinite(texels)
    if wrong.any():
        j, i = np.argwhere(wrong)[0]
        raise HairlutError(
            f"{path}: row {j}, column {i} is {texels[j, i]}, expected a finite angle: {REBAKE}"
        )
    wrong = ~(np.diff(texels, axis=1) > 0)
    if wrong.any():
        j, i = np.argwhere(wrong)[0]
        raise HairlutError(
            f"{path}: row {j}, columns {i} and {i + 1} are {texels[j, i]:.9g} and {texels[j, i + 1]:.9g}, "
            f"expected strictly increasing angles: {REBAKE}"
        )
    low, high = np.float32(table.domain)
    wrong = (texels[:, 0] != low) | (texels[:, -1] != high)
    if wrong.any():
        j = int(np.argmax(wrong))
        raise HairlutError(
            f"{path}: row {j} runs from {texels[j, 0]:.9g} to {texels[j, -1]:.9g}, expected the ends of the "
            f"domain, {low:.9g} and {high:.9g}: {REBAKE}"
        )

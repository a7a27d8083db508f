# SPDX-License-Identifier: BSD-3-Clause
"""OpenEXR images of floats with text in their headers: written whole or not at all, and read with suspicion.

What is common to tables (exr.py) and mixtures (mixturefile.py). Nothing is decoded before the header has been
checked: one part of scanlines, a harmless size and compression, and exactly the channels that are expected.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stdout
from pathlib import Path

import numpy as np
import OpenEXR

from . import __version__
from .digest import digest
from .errors import HairlutError
from .files import replace_whole
from .lobes import Array
from .nulldevice import null_device
from .parameter import number

FORMAT = 2
UNIT = "rad"
PREFIX = "hairlut."
ERROR_PREFIX = "hairlut.error."
MAX_INCLINATION = 1.571  # rad, a little more than pi/2: beyond it an inclination is in degrees
MODEL_NAME = r"[ -~]{1,63}"
REBAKE = "bake it again with 'hairlut bake'"
MAGIC = b"\x76\x2f\x31\x01"
MAX_WIDTH, MAX_ROWS, MAX_TEXELS = 4096, 65536, 2**24
DEEP = 0x800  # a flag of the version field
MAX_NAME = 256  # bytes of a name in a header, with its zero
COMPRESSIONS = ("NO_COMPRESSION", "RLE_COMPRESSION", "ZIPS_COMPRESSION", "ZIP_COMPRESSION")

Attributes = dict[str, str | int]


def write_image(
    path: Path, attributes: Attributes, channels: Mapping[str, Array], errors: Mapping[str, float]
) -> None:
    """Writes float channels (H, W) by name; an existing file is replaced in one step.

    errors: measured errors by name ("relative_variance", ...), written as hairlut.error.<name>.
    """
    channels = {name: np.ascontiguousarray(values, np.float32) for name, values in channels.items()}
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        **attributes,
        "hairlut.digest": digest(list(channels.values())),
        **{ERROR_PREFIX + name: f"{value:.3e}" for name, value in errors.items()},
    }

    def write(temporary: Path) -> None:
        with OpenEXR.File(header, channels) as file:
            file.write(str(temporary))

    replace_whole(path, write)


def common_attributes(model: str, name: str) -> Attributes:
    """What the headers of tables and mixtures begin with."""
    return {
        "colorInteropID": "data",
        "hairlut.format": FORMAT,
        "hairlut.generator": f"hairlut {__version__}",
        "hairlut.model": model,
        "hairlut.table": name,
        "hairlut.unit": UNIT,
    }


def numbers_text(values) -> str:
    """Numbers as text, exact in double precision: an OpenEXR float attribute would have 32 bits."""
    return " ".join(repr(float(x)) for x in values)


def read_image(path: Path, expected: Callable[[Header], Sequence[str]]) -> tuple[Header, list[Array]]:
    """(header, channels in the order that expected(header) names them), each (H, W) float32.

    HairlutError, which names file, attribute and remedy, if the file is no such image.
    """
    header = Header(path, dict(_open(path, header_only=True).header()))
    try:
        _refuse_other_formats(header)
        names = expected(header)
        _check_image(header, names)
    except UnicodeDecodeError as error:  # of the binding, where it makes names and values Python's
        raise HairlutError(f"{path}: the header is damaged ({error.reason}): {REBAKE}") from error
    _check_bytes(path)
    channels = _open(path, header_only=False).channels()
    return header, [_floats(path, name, channels[name].pixels) for name in names]


def _floats(path: Path, name: str, pixels: Array) -> Array:
    if pixels.dtype != np.float32:
        raise HairlutError(f"{path}: channel {name} is {pixels.dtype}, expected 32-bit float: {REBAKE}")
    return np.array(pixels)


def _open(path: Path, header_only: bool) -> OpenEXR.File:
    if path.is_dir():
        raise HairlutError(f"{path}: is a directory: name a file in it")
    if not path.is_file():
        raise HairlutError(f"{path}: no such file: check the path, or {REBAKE}")
    with path.open("rb") as start:
        if start.read(len(MAGIC)) != MAGIC:
            raise HairlutError(f"{path}: is no OpenEXR image: {REBAKE}")
    try:
        with null_device(2), redirect_stdout(None):  # the library prints what the error says
            file = OpenEXR.File(str(path), separate_channels=True, header_only=header_only)
    except Exception as error:  # the binding raises several unrelated types
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise HairlutError(f"{path}: not a complete OpenEXR image ({reason}): {REBAKE}") from error
    if not file.parts:
        raise HairlutError(f"{path}: not a complete OpenEXR image, its pixels are cut: {REBAKE}")
    if len(file.parts) != 1:
        raise HairlutError(f"{path}: has {len(file.parts)} parts, expected one: {REBAKE}")
    return file


class Header:
    """Attributes of one file, each checked when it is read."""

    def __init__(self, path: Path, attributes: dict) -> None:
        self.path, self.attributes = path, attributes

    def failure(self, name: str, found: str, remedy: str = REBAKE) -> HairlutError:
        return HairlutError(f"{self.path}: attribute {PREFIX}{name} {found}: {remedy}")

    def text(self, name: str, default: str | None = None) -> str:
        value = self.attributes.get(PREFIX + name, default)
        if value is None:
            raise self.failure(name, "is missing")
        if not isinstance(value, str):
            raise self.failure(name, f"has the type {type(value).__name__}, expected text")
        return value

    def one_of(self, name: str, expected: Sequence[str], remedy: str = REBAKE) -> str:
        value = self.text(name)
        if value not in expected:
            raise self.failure(name, f"is {value!r}, expected {' or '.join(map(repr, expected))}", remedy)
        return value

    def numbers(self, name: str, count: int | None = None) -> Array:
        """As many finite numbers, one space between, or at least one if count is None."""
        text = self.text(name)
        values = np.array([number(word) for word in text.split(" ")])
        if len(values) != (count or len(values)) or not np.isfinite(values).all():
            raise self.failure(
                name, f"is {text[:60]!r}, expected {count or 'one or more'} numbers, one space between"
            )
        return values

    def interval(self, name: str) -> tuple[float, float]:
        low, high = self.numbers(name, 2)
        if not low < high:
            raise self.failure(name, f"is {low!r} {high!r}, expected two increasing numbers")
        return float(low), float(high)

    def parsed(self, name: str, parse: Callable):
        text = self.text(name)
        try:
            return parse(text)
        except HairlutError as error:
            raise self.failure(name, f"is {text!r} ({error})") from error

    def information(self, name: str, count: int = 1) -> Array:
        """Numbers that nothing depends on: NaN where the file lacks them or says something else."""
        try:
            return self.numbers(name, count)
        except HairlutError:
            return np.full(count, np.nan)

    def errors(self) -> dict[str, float]:
        """The measured errors, as many as the file has."""
        names = sorted(name for name in self.attributes if name.startswith(ERROR_PREFIX))
        found = {name[len(ERROR_PREFIX) :]: self.information(name[len(PREFIX) :])[0] for name in names}
        return {name: float(value) for name, value in found.items() if not math.isnan(value)}

    def model(self) -> str:
        """The model's name."""
        name = self.text("model")
        if not re.fullmatch(MODEL_NAME, name):
            raise self.failure("model", f"is {name[:60]!r}, expected 1 to 63 printable ASCII characters")
        return name

    def check_digest(self, channels: Sequence[Array]) -> str:
        """The digest of the channels; HairlutError if the file was written with another."""
        found, named = digest(channels), self.text("digest")
        if found != named:
            reason = f"is {named!r}, but the texels have {found!r}: they were changed after they were written"
            raise self.failure("digest", reason)
        return found

    @property
    def format(self) -> int:
        return self.attributes[PREFIX + "format"]


def _refuse_other_formats(header: Header) -> None:
    version = header.attributes.get(PREFIX + "format")
    if version is None:
        raise header.failure("format", "is missing: the file is no hairlut table")
    if not isinstance(version, int) or version < 1:
        raise header.failure("format", f"is {version!r}, expected 1 to {FORMAT}")
    if version > FORMAT:
        reason = f"is {version}, expected {FORMAT} or less"
        raise header.failure("format", reason, "use a newer hairlut to read this file")


def _word(data: bytes, at: int) -> bytes:
    """A name in a header, up to its zero; of MAX_NAME bytes if that is missing."""
    return data[at : at + MAX_NAME].split(b"\0")[0]


def _check_bytes(path: Path) -> None:
    """What the binding reads over: an image of plain scanlines that says of itself to be deep; and a header
    that names no compression, or has a name longer than any OpenEXR library writes."""
    data = path.read_bytes()
    if int.from_bytes(data[4:8], "little") & DEEP:
        raise HairlutError(f"{path}: is marked as deep data, expected scanlines: {REBAKE}")
    at, name = 8, b""
    while name != b"compression":
        name = _word(data, at)
        kind = _word(data, at + len(name) + 1)
        at += len(name) + len(kind) + 2
        if not name or max(len(name), len(kind)) >= MAX_NAME or at + 4 > len(data):
            raise HairlutError(f"{path}: not a complete OpenEXR image, it names no compression: {REBAKE}")
        at += 4 + int.from_bytes(data[at : at + 4], "little")


def _check_image(header: Header, expected: Sequence[str]) -> None:
    path, attributes = header.path, header.attributes
    if attributes["type"] != OpenEXR.scanlineimage:
        raise HairlutError(f"{path}: is {_last(attributes['type'])}, expected scanlines: {REBAKE}")
    if _last(attributes["compression"]) not in COMPRESSIONS:
        found = _last(attributes["compression"]).removesuffix("_COMPRESSION")
        raise HairlutError(
            f"{path}: compression is {found}, expected NONE, RLE, ZIPS or ZIP: write it with ZIP"
        )
    channels = {channel.name: channel for channel in attributes["channels"]}
    if set(channels) != set(expected):
        raise HairlutError(
            f"{path}: channels are {', '.join(sorted(channels)) or 'none'}, "
            f"expected {', '.join(expected)}: {REBAKE}"
        )
    for name, channel in channels.items():
        if (channel.xSampling, channel.ySampling) != (1, 1):
            sampling = f"{channel.xSampling}x{channel.ySampling}"
            raise HairlutError(f"{path}: channel {name} is sampled {sampling}, expected 1x1: {REBAKE}")
    (left, top), (right, bottom) = corners = [
        tuple(int(x) for x in corner) for corner in attributes["dataWindow"]
    ]
    shown = [tuple(int(x) for x in corner) for corner in attributes["displayWindow"]]
    for name, window in (("dataWindow", corners), ("displayWindow", shown)):
        if (left, top) != (0, 0) or window != corners:
            raise HairlutError(
                f"{path}: {name} is {window}, expected it to start at 0 0 and span the image: {REBAKE}"
            )
    width, rows = right + 1, bottom + 1
    if width > MAX_WIDTH or rows > MAX_ROWS or width * rows > MAX_TEXELS:
        raise HairlutError(
            f"{path}: size is {width}x{rows}, expected at most {MAX_WIDTH}x{MAX_ROWS}, and {MAX_TEXELS} "
            f"texels in all: {REBAKE}"
        )


def _last(value: object) -> str:
    """The name of a value of one of the binding's enumerations."""
    return str(value).rpartition(".")[2]

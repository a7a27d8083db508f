# SPDX-License-Identifier: BSD-3-Clause
"""The columns of a file of scattering data: CSV, or npz with arrays of the same names.

    theta_r, theta_i    inclinations of the viewer and the light, rad, or degrees as theta_r_deg, theta_i_deg
    phi                 relative azimuth phi_i - phi_r, rad, or degrees as phi_deg
    value               what a grid has at its points, or the weight of a draw; not negative
    offset              where across its width the fibre is hit, in radii, within [-1, 1]

A CSV file is UTF-8 with commas between its columns, whose names stand in its first line. Lines that start
with # are comments. No column may have another name, or stand there twice. Numbers that cannot be in the unit
which the name states are refused: whoever really has such angles gives them in the other unit.
"""

from __future__ import annotations

import csv
import difflib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import HairlutError
from ..lobes import HALF_PI, Array
from ..npz import ARCHIVE, ARRAY, SAVE, read_npz
from ..text import decode, read_bytes

TWO_PI = 2 * np.pi
ANGLES = {"theta_r": HALF_PI, "theta_i": HALF_PI, "phi": TWO_PI}
"""The largest magnitude of each angle, rad: phi is the difference of two azimuths."""

PLAIN = {"value": (0.0, np.inf), "offset": (-1.0, 1.0)}
"""The range of each column that is no angle."""

DEGREE = np.pi / 180
ROUNDED = 1e-4  # rad by which an angle written with few digits may exceed its range
OVERSHOOT = 10 * DEGREE
"""By which a few draws of theta_i may miss the hemisphere, as a Gaussian's do; read.py leaves them out."""

ALLOWED = (
    "theta_r, theta_i, phi (radians; theta_r_deg, theta_i_deg, phi_deg for degrees), value and offset, "
    "in lower case"
)
EXPECTED = "a CSV or npz file with " + ALLOWED


@dataclass(frozen=True)
class Column:
    """name: as the file has it; values: numbers in the name's unit; scale: from there to radians, or 1."""

    name: str
    values: Array
    scale: float = 1.0

    def show(self, number: float) -> str:
        """A number, in radians where the column is an angle, as the file would have it."""
        return f"{self.name} = {number / self.scale:.9g}"


@dataclass(frozen=True)
class Columns:
    """The columns of a file by what they are ("theta_r", not "theta_r_deg").

    lines: (N,) the line of each row in a CSV file, counted from 1; None for npz.
    """

    by_base: dict[str, Column]
    lines: Array | None = None

    def __contains__(self, base: str) -> bool:
        return base in self.by_base

    def radians(self, base: str) -> Array:
        """The numbers of a column, angles in radians, clipped to their range."""
        column = self.by_base[base]
        values = column.values * column.scale
        return np.clip(values, -ANGLES[base], ANGLES[base]) if base in ANGLES else values

    def point(self, **numbers: float) -> str:
        """A point in the names and units of the file."""
        return ", ".join(self.by_base[base].show(number) for base, number in numbers.items())

    def place(self, index: tuple[int, ...]) -> str:
        """Where the file has the element of an index."""
        if self.lines is not None:
            return f"line {self.lines[index[0]]}"
        return f"index {list(map(int, index))}, counted from 0"

    def beyond(self, base: str, slack: float = ROUNDED) -> Array:
        """Which of an angle's numbers exceed its range by more than slack, rad."""
        column = self.by_base[base]
        return abs(column.values * column.scale) > ANGLES[base] + slack

    def refuse(self, base: str, wrong: Array, expected: str) -> None:
        """HairlutError naming the first number of a column that is wrong, if there is one."""
        if wrong.any():
            column = self.by_base[base]
            index = np.unravel_index(int(np.argmax(wrong)), wrong.shape)
            raise HairlutError(
                f"{column.name} is {column.values[index]:.9g} on {self.place(index)}: expected {expected}"
            )

    def refuse_beyond(self, base: str, slack: float = ROUNDED) -> None:
        """HairlutError naming the first number of an angle that exceeds its range, with the likely reason."""
        column = self.by_base[base]
        degrees = column.scale < 1
        bound = ANGLES[base] / column.scale
        remedy = "" if degrees else f": if these are degrees, name the column {base}_deg"
        expected = f"an angle within [{-bound:.6g}, {bound:.6g}] {'deg' if degrees else 'rad'}{remedy}"
        self.refuse(base, self.beyond(base, slack), expected)


def read_columns(path: Path) -> Columns:
    """The columns of a file, each checked; HairlutError naming the file, the line and what was expected."""
    data = read_bytes(path, EXPECTED)
    if path.suffix == ".toml":
        raise HairlutError(f"{path}: is a model, not data: bake it with hairlut bake --model {path}")
    if path.suffix == ".npz":
        found, lines = list(read_npz(path).items()), None
    elif data.startswith((ARRAY, ARCHIVE)):
        raise HairlutError(
            f"{path}: is no text, but arrays or an archive: {SAVE}, with a name ending in .npz"
        )
    else:
        found, lines = _from_csv(path, decode(path, data, EXPECTED))
    try:
        columns = Columns(_named(found), lines)
        for base, column in columns.by_base.items():
            _check(columns, base, column)
    except HairlutError as error:
        raise HairlutError(f"{path}: {error}") from None
    return columns


# ---- CSV


def _from_csv(path: Path, text: str) -> tuple[list[tuple[str, Array]], Array]:
    """(name, numbers) of each column, and the line of each row."""
    numbered = [
        (number, line)
        for number, line in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1)
        if line.strip() and not line.startswith("#")
    ]
    if not numbered:
        raise HairlutError(f"{path}: empty: expected a header line theta_r,theta_i,phi,value and numbers")
    names = _header(path, *numbered[0])
    rows = [_numbers(path, number, line, names) for number, line in numbered[1:]]
    if not rows:
        raise HairlutError(f"{path}: no data below the header")
    table = np.array(rows, float)
    return list(zip(names, table.T, strict=True)), np.array([number for number, _ in numbered[1:]])


def _header(path: Path, number: int, line: str) -> list[str]:
    names = [word.strip() for word in _words(path, number, line)]
    for mark, what in ((";", "semicolons"), ("\t", "tabs"), (" ", "spaces"), ("|", "bars")):
        if any(mark in name for name in names):
            raise HairlutError(
                f"{path}: the columns are separated by {what}: expected commas: {line.strip()!r}"
            )
    if all(map(_is_number, names)):
        raise HairlutError(
            f"{path}: line {number} consists of numbers: expected a header line, "
            "such as theta_r,theta_i,phi,value"
        )
    return names


def _numbers(path: Path, number: int, line: str, names: list[str]) -> list[float]:
    words = _words(path, number, line)
    if len(words) != len(names):
        raise HairlutError(
            f"{path}: line {number} has {len(words)} numbers, expected {len(names)}: {', '.join(names)}"
        )
    try:
        if line.isascii() and "_" not in line:
            return [float(word) for word in words]
    except ValueError:
        pass
    name, word = next((n, w) for n, w in zip(names, words, strict=True) if not _is_number(w))
    raise HairlutError(f"{path}: line {number}: {name} is {word.strip()!r}, expected a number")


def _words(path: Path, number: int, line: str) -> list[str]:
    if '"' not in line:
        return line.split(",")
    try:
        return next(csv.reader([line], strict=True))
    except csv.Error as error:
        raise HairlutError(
            f"{path}: line {number}: {error}: expected numbers with commas between them"
        ) from None


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return word.isascii() and "_" not in word


# ---- names and units


def _named(found: list[tuple[str, Array]]) -> dict[str, Column]:
    columns: dict[str, Column] = {}
    for name, values in found:
        base = name.removesuffix("_deg")
        degrees = base != name
        if base not in ANGLES and (degrees or base not in PLAIN):
            raise HairlutError(_unknown(name, [n for n, _ in found]))
        if base in columns:
            other = columns[base].name
            what = (
                f"column {name} stands there twice"
                if other == name
                else f"columns {other} and {name} are both there"
            )
            raise HairlutError(f"{what}: expected it once")
        columns[base] = Column(name, values, DEGREE if degrees else 1.0)
    missing = [name for name in ANGLES if name not in columns]
    if missing:
        names = ", ".join(name for name, _ in found) or "nothing"
        raise HairlutError(f"found {names}: expected a column {missing[0]} or {missing[0]}_deg")
    return columns


def _unknown(name: str, found: list[str]) -> str:
    known = [*ANGLES, *(f"{angle}_deg" for angle in ANGLES), *PLAIN]
    if name.endswith("_rad") and name.removesuffix("_rad") in ANGLES:
        base = name.removesuffix("_rad")
        return f"column {name!r} is not known: name it {base} if it is in radians, {base}_deg if in degrees"
    near = difflib.get_close_matches(name.lower(), known, 1, 0.75)
    if near:
        remedy = f"did you mean {near[0]}?"
    elif "value" not in found:
        remedy = "the numbers of a grid stand in a column value"
    else:
        remedy = "leave it out"
    return f"column {name!r} is not known: expected {ALLOWED}: {remedy}"


def _check(columns: Columns, base: str, column: Column) -> None:
    """HairlutError for the first number that is none, lies outside its range, or is in another unit."""
    values = column.values
    if not values.size:
        raise HairlutError(f"{column.name} is empty: expected numbers")
    columns.refuse(base, ~np.isfinite(values), "a finite number")
    if base in PLAIN:
        low, high = PLAIN[base]
        expected = "0 or more" if base == "value" else "a number within [-1, 1]"
        columns.refuse(base, (values < low) | (values > high), expected)
        return
    columns.refuse_beyond(base, OVERSHOOT if base == "theta_i" else ROUNDED)
    spread, largest = np.ptp(values), abs(values).max()
    if column.scale < 1 and spread > ANGLES[base] / 4 and largest <= ANGLES[base] + ROUNDED:
        raise HairlutError(
            f"{column.name} runs from {values.min():.6g} to {values.max():.6g} degrees, the range of "
            f"radians: name the column {base}, or, if they are degrees, give them in radians"
        )

# SPDX-License-Identifier: BSD-3-Clause
"""Numbers in the text of a file's header, and texts of the form "name key=NUMBER", such as a warp's."""

import math
import re

from .errors import HairlutError

NUMBER = r"(?P<digits>[+-]?([0-9]+\.?[0-9]*|\.[0-9]+))([eE][+-]?[0-9]+)?"
MAX_DIGITS, LARGEST = 100, 1e300


def number(text: str) -> float:
    """A number as luts/FORMAT.md defines it; NaN for any other text, which float() may take."""
    match = re.fullmatch(NUMBER, text)
    if not match or sum(c.isdigit() for c in match["digits"]) > MAX_DIGITS or abs(float(text)) > LARGEST:
        return math.nan
    return float(text)


def parse(text: str, kind: str, key: str, expected: str) -> tuple[str, float]:
    """(name, number) of text, the number 0 where it has none; HairlutError, naming kind, for any other."""
    name, _, parameter = text.partition(" ")
    found, _, given = parameter.partition("=")
    value = number(given) if parameter else 0.0
    if math.isnan(value) or (parameter and found != key):
        raise HairlutError(f"{kind} {text!r} cannot be read: expected {expected}")
    return name, value

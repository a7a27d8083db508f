"""Texts of the form "name key=NUMBER", by which a file's header names a warp or a cell."""

import math

from .errors import HairlutError


def parse(text: str, kind: str, key: str, expected: str) -> tuple[str, float]:
    """(name, number) of text, the number 0 where it has none; HairlutError, naming kind, for any other."""
    name, _, parameter = text.partition(" ")
    found, _, number = parameter.partition("=")
    try:
        value = float(number) if parameter else 0.0
    except ValueError:
        value = math.nan
    if math.isnan(value) or (parameter and found != key):
        raise HairlutError(f"{kind} {text!r} cannot be read: expected {expected}")
    return name, value

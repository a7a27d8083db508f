# SPDX-License-Identifier: BSD-3-Clause
"""Reads npz files, the archives of arrays that numpy.savez writes, whatever state they are in."""

import io
import warnings
from pathlib import Path

import numpy as np

from .errors import HairlutError
from .text import read_bytes

ARRAY = b"\x93NUMPY"  # a .npy file begins so,
ARCHIVE = b"PK"  # and an npz file so
SAVE = "write the arrays with numpy.savez"


def read_npz(path: Path, text: tuple[str, ...] = ()) -> dict[str, np.ndarray]:
    """The arrays of a file by name, as float64, those named in text as they are.

    HairlutError for a file that is cut or none of these, an array that does not consist of real numbers, or
    two of one name.
    """
    data = read_bytes(path, f"an npz file: {SAVE}")
    if data.startswith(ARRAY):
        raise HairlutError(f"{path}: is a single array (.npy), which has no name: {SAVE}")
    if not data.startswith(ARCHIVE):
        raise HairlutError(f"{path}: is not an npz file: {SAVE}")
    arrays: dict[str, np.ndarray] = {}
    for name, array in _members(path, data):
        if name in arrays:
            raise HairlutError(f"{path}: has two arrays {name}: {SAVE}")
        arrays[name] = array if name in text else _numbers(path, name, array)
    return arrays


def _members(path: Path, data: bytes) -> list[tuple[str, np.ndarray]]:
    try:
        with warnings.catch_warnings(), np.load(io.BytesIO(data), allow_pickle=False) as archive:
            warnings.simplefilter("ignore")
            return [(name, archive[name]) for name in archive.files]
    except Exception as error:  # zipfile, zlib and numpy raise many unrelated types for a damaged file
        if "allow_pickle" in str(error):
            raise HairlutError(
                f"{path}: an array consists of Python objects, expected numbers: rows of unequal length?"
            ) from None
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise HairlutError(f"{path}: the npz file is cut or damaged ({reason}): {SAVE} again") from None


def _numbers(path: Path, name: str, array) -> np.ndarray:
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "iuf":
        kind = getattr(array, "dtype", type(array).__name__)
        raise HairlutError(f"{path}: array {name} has the type {kind}, expected real numbers")
    return array.astype(np.float64)

# SPDX-License-Identifier: BSD-3-Clause
"""Text files as users save them: UTF-8, with or without a byte order mark."""

import codecs
from pathlib import Path

from .errors import HairlutError

SAVE_AS = "save the file as UTF-8"
_MARKS_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def read_bytes(path: Path, expected: str) -> bytes:
    """The bytes of a file; HairlutError, saying what was expected, if there is none or it cannot be read."""
    if path.is_dir():
        raise HairlutError(f"{path}: is a directory: expected {expected}")
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise HairlutError(f"{path}: no such file: expected {expected}") from None
    except OSError as error:
        raise HairlutError(f"{path}: cannot be read: {error.strerror or error}") from None


def read_text(path: Path, expected: str) -> str:
    """The text of a file, without a byte order mark; HairlutError for any other encoding than UTF-8."""
    return decode(path, read_bytes(path, expected), expected)


def decode(path: Path, data: bytes, expected: str) -> str:
    """The text of a file's bytes, as read_text."""
    if data.startswith(_MARKS_16) or b"\0" in data[:4]:
        raise HairlutError(f"{path}: the text is UTF-16, expected UTF-8: {SAVE_AS}")
    if b"\0" in data:
        line = data.count(b"\n", 0, data.index(b"\0")) + 1
        raise HairlutError(f"{path}: is no text, line {line} contains a zero byte: expected {expected}")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise HairlutError(
            f"{path}: line {line}: byte {data[error.start]:#04x} is not UTF-8, perhaps Latin-1: {SAVE_AS}"
        ) from None

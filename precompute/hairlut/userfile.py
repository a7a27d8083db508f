# SPDX-License-Identifier: BSD-3-Clause
"""Runs a user's Python file, and the functions it defines, so that whatever they do ends in one clear line.

The code may import the files beside it. It has no standard input, so it never waits for a person. What it
prints goes to standard error, apart from the output of the command. It cannot end the command: sys.exit() is
an error like any other.
"""

from __future__ import annotations

import builtins
import io
import os
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import chdir, contextmanager, redirect_stdout, suppress
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from traceback import extract_tb
from types import ModuleType
from typing import NoReturn

import numpy as np

from .errors import HairlutError
from .nulldevice import null_device
from .text import decode, read_bytes

EXPECTED = "a Python file"
REMEDIES = {  # by a part of the error's text: what a formula written for single numbers runs into
    "converted to Python scalars": "the arguments are arrays: use NumPy's functions instead of math's",
    "truth value of an array": "the arguments are arrays: use np.where, not if, and np.maximum, not max",
}


@dataclass(frozen=True)
class UserFile:
    """What a file defined, and the files beside it that it imported."""

    module: ModuleType
    neighbours: tuple[Path, ...]


def run_file(path: Path) -> UserFile:
    """Runs the file; HairlutError naming the file, the line and the reason where that fails."""
    data = read_bytes(path, EXPECTED)
    if b"\0" in data:
        decode(path, data, EXPECTED)
    module = ModuleType(path.stem)
    module.__file__ = str(path)
    before = set(sys.modules)
    with user_code(path):
        try:
            exec(compile(data, str(path), "exec"), module.__dict__)
        finally:
            neighbours = _forget_neighbours(path.resolve().parent, before)
    return UserFile(module, neighbours)


def guarded(function: Callable, path: Path) -> Callable:
    """A function of the file whose failures are HairlutErrors, as those of run_file."""

    @wraps(function)
    def call(*arguments, **named):
        with _named(path), _without_streams():
            return function(*arguments, **named)

    return call


@contextmanager
def user_code(path: Path) -> Iterator[None]:
    """Lets the code of the file at path run within. What it changes of the process is put back: the working
    directory, the filters of warnings, what NumPy does about an overflow."""
    folder = str(path.resolve().parent)
    kept = sys.dont_write_bytecode
    sys.path.insert(0, folder)
    sys.dont_write_bytecode = True
    try:
        with _named(path), null_device(0), _without_streams(), _put_back():
            yield
    finally:
        sys.dont_write_bytecode = kept
        with suppress(ValueError):
            sys.path.remove(folder)


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Turns whatever the user's code does wrong into a HairlutError naming the file and the line."""
    try:
        yield
    except HairlutError as error:
        text = str(error)
        where = f"{path}{line_of(error, path)}: "
        raise HairlutError(text if text.startswith(str(path)) else where + text) from None
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        raise HairlutError(f"{path}{line_of(error, path)}: {reason(error)}") from None


def line_of(error: BaseException, path: Path | str) -> str:
    """ ":LINE", the line of the file at which the error left it; empty where it was never there."""
    if isinstance(error, SyntaxError) and error.filename == str(path):
        return f":{error.lineno}" if error.lineno else ""
    lines = [frame.lineno for frame in extract_tb(error.__traceback__) if frame.filename == str(path)]
    return f":{lines[-1]}" if lines else ""


def reason(error: BaseException) -> str:
    """The error in one line, with the remedy if there is a plain one."""
    if isinstance(error, SystemExit):
        return "calls sys.exit(): the file may define, but not end the command"
    message = (str(error).splitlines() or [""])[0]
    text = f"{type(error).__name__}: {message}" if message else type(error).__name__
    if isinstance(error, ModuleNotFoundError):
        remedy = f"import it at the file's top, and put it beside the file or install it for {sys.executable}"
        return f"{text}: {remedy}"
    for part, remedy in REMEDIES.items():
        if part in message:
            return f"{text}: {remedy}"
    if isinstance(error, SyntaxError) and error.lineno:
        return text.replace(f" ({Path(error.filename or '').name}, line {error.lineno})", "")
    return text


@contextmanager
def _without_streams() -> Iterator[None]:
    """No standard input, and prints on standard error."""
    kept, sys.stdin = sys.stdin, _NoInput()
    prompt, builtins.input = builtins.input, _no_input
    try:
        with redirect_stdout(sys.stderr):
            yield
    finally:
        sys.stdin, builtins.input = kept, prompt


@contextmanager
def _put_back() -> Iterator[None]:
    with chdir(os.curdir), warnings.catch_warnings(), np.errstate():
        yield


def _no_input(prompt: object = "") -> NoReturn:
    """In place of input(): refuses before a prompt is shown."""
    raise HairlutError("reads standard input: give the file what it needs in another file")


class _NoInput(io.TextIOBase):
    """A standard input that refuses to be read."""

    def readline(self, size: int = -1) -> str:
        _no_input()

    def read(self, size: int = -1) -> str:
        return self.readline()


def _forget_neighbours(folder: Path, before: set[str]) -> tuple[Path, ...]:
    """Drops the modules and packages of the folder that were imported since, for another file may have others
    of the same names; their paths."""
    found = []
    for name in set(sys.modules) - before:
        file = getattr(sys.modules[name], "__file__", None)
        if file and _lies_in(folder, name, Path(file).resolve()):
            found.append(Path(file))
            del sys.modules[name]
    return tuple(sorted(found))


def _lies_in(folder: Path, name: str, file: Path) -> bool:
    """Whether the module was imported from the folder, not from an environment somewhere below it."""
    top = name.partition(".")[0]
    return file.is_relative_to(folder) and file.relative_to(folder).parts[0].partition(".")[0] == top

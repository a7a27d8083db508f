"""Bakes a directory of model files, each in a process of its own: no model can stop or change another.

Each process runs the command that bakes one model, `hairlut bake --model FILE --out DIR`. Nothing passes
between processes but files, so a render farm's queue can run the same command for each file instead.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

from .errors import HairlutError
from .files import write_whole
from .modelfile import SUFFIXES

UP_TO_DATE = "up to date"
STATUSES = ("baked", UP_TO_DATE, "failed")
TIMEOUT = 600.0  # seconds that a model of a directory may take

# -P: import nothing from the working directory, which may hold a folder named hairlut
COMMAND = (sys.executable, "-P", "-m", "hairlut.cli")
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


@dataclass(frozen=True)
class Outcome:
    """What became of one model: one of STATUSES; text is what its process printed."""

    source: Path
    status: str
    text: str
    seconds: float


def model_files(paths: Sequence[Path]) -> list[Path]:
    """The model files among paths and in the directories among them.

    HairlutError if a directory has none, a path is neither, or two would bake to the same textures.
    """
    found = [file for path in paths for file in (_files(path) if path.is_dir() else [path])]
    by_stem: dict[str, Path] = {}
    for file in found:
        if file.suffix not in SUFFIXES or not file.is_file():
            raise HairlutError(f"{file}: neither a directory nor a model file ({', '.join(SUFFIXES)})")
        if file.stem in by_stem:
            raise HairlutError(f"{by_stem[file.stem]} and {file} would both bake to {file.stem}/: rename one")
        by_stem[file.stem] = file
    return found


def _files(folder: Path) -> list[Path]:
    shown = sorted(path for path in folder.iterdir() if not path.name.startswith((".", "_")))
    found = [path for path in shown if path.suffix in SUFFIXES]
    if not found:
        raise HairlutError(f"{folder}: no model files: expected names ending in {', '.join(SUFFIXES)}")
    return found


def family_file(paths: Sequence[Path]) -> Path | None:
    """The file that makes a family of the models of these directories, if there is one; HairlutError if
    there are several, whose models would mix."""
    from .fit import familyfiles  # slow to import

    found = [path / familyfiles.NAME for path in paths if (path / familyfiles.NAME).is_file()]
    if len(found) > 1:
        raise HairlutError(f"{found[0]} and {found[1]}: bake each family into a directory of its own (--out)")
    return found[0] if found else None


def copy_family(file: Path, out: Path) -> Path:
    """Puts a family's file beside the baked models; its new path."""
    return write_whole(out / file.name, file.read_bytes())


def bake_many(
    sources: Sequence[Path],
    options: Sequence[str],
    jobs: int,
    is_current: Callable[[Path], bool],
    timeout: float = TIMEOUT,
    report: Callable[[Outcome], None] = lambda outcome: None,
) -> list[Outcome]:
    """Bakes each model file that is not current with these options of `hairlut bake`, `jobs` at a time, and
    lets none take longer than timeout, in seconds; the outcomes in order."""
    with ThreadPoolExecutor(max_workers=jobs) as pool:
        waiting = [pool.submit(_bake, source, options, is_current, timeout) for source in sources]
        try:
            for done in as_completed(waiting):
                report(done.result())
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [future.result() for future in waiting]


def _bake(
    source: Path, options: Sequence[str], is_current: Callable[[Path], bool], timeout: float
) -> Outcome:
    """Runs the command for one model file, which reads nothing from the terminal."""
    start = monotonic()
    if is_current(source):
        return Outcome(source, UP_TO_DATE, "", monotonic() - start)
    try:
        done = subprocess.run(
            [*COMMAND, "bake", "--model", str(source), *options],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            env=os.environ | ONE_THREAD,
            check=False,
            timeout=timeout,
        )
    except subprocess.TimeoutExpired:
        text = f"hairlut: {source}: not baked after {timeout:g} s: does it loop? else raise --timeout"
        return Outcome(source, "failed", text, monotonic() - start)
    text = done.stdout.strip() or f"no output, exit code {done.returncode}"
    return Outcome(source, "failed" if done.returncode else "baked", text, monotonic() - start)

# SPDX-License-Identifier: BSD-3-Clause
"""Bakes a directory of model files, each in a process of its own: no model can stop or change another.

Each process does what `hairlut bake --model FILE --out DIR` does; a render farm's queue can run that command
for each file instead. Where the system can, the processes are forked from one that has imported everything
already, as to import takes longer than to bake.
"""

from __future__ import annotations

import multiprocessing
import multiprocessing.context
import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic

from .errors import HairlutError
from .modelfile import SUFFIXES

UP_TO_DATE = "up to date"
STATUSES = ("baked", UP_TO_DATE, "failed")
TIMEOUT = 600.0  # seconds that a model of a directory may take

PRELOAD = ["hairlut.cli.bake", "scipy.interpolate"]
ENVIRONMENT = {
    "PYTHONSAFEPATH": "1",  # import nothing from the working directory, which may hold a folder named hairlut
    **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"),
}


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
    os.environ.update(ENVIRONMENT)  # of the processes; this one imports and computes nothing more
    context = _context()
    with ThreadPoolExecutor(max_workers=jobs) as pool, TemporaryDirectory() as folder:
        waiting = [
            pool.submit(_bake, context, source, options, is_current, timeout, Path(folder) / str(n))
            for n, source in enumerate(sources)
        ]
        try:
            for done in as_completed(waiting):
                report(done.result())
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [future.result() for future in waiting]


def _context() -> multiprocessing.context.BaseContext:
    """The way to start processes, which are all daemons of this one."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(PRELOAD)
    return context


def _bake(
    context: multiprocessing.context.BaseContext,
    source: Path,
    options: Sequence[str],
    is_current: Callable[[Path], bool],
    timeout: float,
    printed: Path,
) -> Outcome:
    """Bakes one model file in a process that reads nothing from the terminal, and prints into a file."""
    start = monotonic()
    if is_current(source):
        return Outcome(source, UP_TO_DATE, "", monotonic() - start)
    command = ["bake", "--model", str(source), *options]
    process = context.Process(target=_run, args=(command, str(printed)), daemon=True)
    process.start()
    process.join(timeout)
    if process.is_alive():
        process.kill()
        process.join()
        text = f"hairlut: {source}: not baked after {timeout:g} s: does it loop? else raise --timeout"
        return Outcome(source, "failed", text, monotonic() - start)
    text = printed.read_text(errors="replace").strip() if printed.exists() else ""
    text = text or f"no output, exit code {process.exitcode}"
    return Outcome(source, "failed" if process.exitcode else "baked", text, monotonic() - start)


def _run(command: list[str], printed: str) -> None:
    """Runs a command of hairlut in this process, with the file `printed` for its output."""
    from .cli import main

    with open(printed, "wb") as file, open(os.devnull, "rb") as nothing:
        for stream, descriptor in ((nothing, 0), (file, 1), (file, 2)):
            os.dup2(stream.fileno(), descriptor)
    sys.exit(main(command))

"""Bakes a directory of model files in processes of their own, so that no model can stop another.

Each process runs the command that bakes one model, `hairlut bake --model FILE --out DIR`, for one model after
the other: a family's models share lobes, which it bakes once. A Python file has a process to itself, for its
code could change what is baked after it. Nothing passes between processes but files, and textures do not
depend on which process made them: a render farm's queue can run the same command for each file instead.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from time import monotonic

from .errors import HairlutError
from .files import write_whole
from .fit import familyfiles
from .modelfile import SUFFIXES

UP_TO_DATE = "up to date"
STATUSES = ("baked", UP_TO_DATE, "failed")


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
    found = [path / familyfiles.NAME for path in paths if (path / familyfiles.NAME).is_file()]
    if len(found) > 1:
        raise HairlutError(f"{found[0]} and {found[1]}: bake each family into a directory of its own (--out)")
    return found[0] if found else None


def copy_family(file: Path, out: Path) -> Path:
    """Puts a family's file beside the baked models; its new path."""
    return write_whole(out / familyfiles.NAME, file.read_bytes())


def bake_many(
    sources: Sequence[Path],
    options: Sequence[str],
    jobs: int,
    report: Callable[[Outcome], None] = lambda outcome: None,
) -> list[Outcome]:
    """Bakes each model file with these options of `hairlut bake`, `jobs` at a time; the outcomes in order."""
    idle: SimpleQueue[_Worker] = SimpleQueue()

    def bake(source: Path) -> Outcome:
        worker = idle.get()
        try:
            return worker.bake(source, options)
        finally:
            idle.put(worker)

    with ExitStack() as stack, ThreadPoolExecutor(max_workers=jobs) as pool:
        for _ in range(jobs):
            worker = _Worker()
            stack.callback(worker.close)
            idle.put(worker)
        waiting = [pool.submit(bake, source) for source in sources]
        for done in as_completed(waiting):
            report(done.result())
    return [future.result() for future in waiting]


class _Worker:
    """A process of batch_worker.py, started when it is needed."""

    def __init__(self) -> None:
        self._process: subprocess.Popen | None = None

    def bake(self, source: Path, options: Sequence[str]) -> Outcome:
        start = monotonic()
        if source.suffix == ".py":
            self.close()
        code, text = self._run(["bake", "--model", str(source), *options])
        if source.suffix == ".py":
            self.close()
        status = "failed" if code else UP_TO_DATE if text.endswith(UP_TO_DATE) else "baked"
        return Outcome(source, status, text, monotonic() - start)

    def close(self) -> int:
        """Ends the process, if there is one and it has not ended; its exit code."""
        process, self._process = self._process, None
        if not process:
            return 0
        process.communicate()
        return process.returncode

    def _run(self, command: list[str]) -> tuple[int, str]:
        """(exit code, what was printed)"""
        self._process = self._process or _start()
        try:
            self._process.stdin.write(json.dumps(command) + "\n")
            self._process.stdin.flush()
            answer = self._process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if answer:
            code, text = json.loads(answer)
            return code, text.strip()
        code = self.close()
        return code or 1, f"no output, exit code {code}"


def _start() -> subprocess.Popen:
    one_thread = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    return subprocess.Popen(
        [sys.executable, "-m", "hairlut.batch_worker"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env=os.environ | one_thread,
    )

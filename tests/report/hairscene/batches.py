# SPDX-License-Identifier: BSD-3-Clause
"""Renders in independent batches: their mean is an image of more samples, their spread is the variance.

With the engine's independent sampler, the mean of k images of n samples a pixel has the distribution of
one image of k n samples, so one set of batches serves every sample count. Samplers take turns within a
round, so that a busy machine slows all of them alike; time is processor time of all threads.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from report.hairscene.samplers import REFERENCE, SAMPLERS, SETTINGS, bsdf_dict
from report.hairscene.scene import Hair, light_hair, scene_dict, strand_points, write_strands

Images = NDArray[np.float32]

BATCH = 16  # samples per pixel in a batch
SMALL = (1, 2, 4, 8)  # counts below a batch, rendered as such
SMALL_REPEATS = 8


@dataclass(frozen=True)
class Quality:
    """How much is rendered: pixels, batches per sampler, batches of the reference."""

    width: int = 80
    height: int = 60
    batches: int = 32
    reference_batches: int = 64
    strands: int = 12_000


@dataclass(frozen=True)
class Job:
    """One image: where it belongs and how it is drawn."""

    key: str
    setting: str
    sampler: str
    spp: int
    seed: int


def jobs(quality: Quality) -> Iterator[Job]:
    """Every image, in rounds of all samplers; no seed is used twice within a setting and sampler."""
    for setting in SETTINGS:
        for repeat in range(max(quality.batches, quality.reference_batches)):
            for sampler in SAMPLERS:
                if repeat < quality.batches:
                    yield Job(f"{setting}/{sampler}/{BATCH}", setting, sampler, BATCH, 1000 + repeat)
                if repeat < SMALL_REPEATS:
                    for spp in SMALL:
                        key = f"{setting}/{sampler}/{spp}"
                        yield Job(key, setting, sampler, spp, 2000 + 100 * spp + repeat)
            if repeat < quality.reference_batches:
                yield Job(f"{setting}/reference", setting, REFERENCE, BATCH, 5000 + repeat)


def scenes(mi: Any, quality: Quality, folder: Path) -> dict[tuple[str, str], Any]:
    """A loaded scene for each setting and sampler."""
    strands = folder / "strands.txt"
    write_strands(strand_points(Hair(strands=quality.strands)), strands)
    loaded = {}
    for name, setting in SETTINGS.items():
        for sampler in SAMPLERS:
            bsdf = bsdf_dict(sampler, light_hair(), setting.light_sampling)
            description = scene_dict(mi, strands, bsdf, (quality.width, quality.height), setting.lamps)
            loaded[name, sampler] = mi.load_dict({**description, "integrator": setting.integrator})
    return loaded


def render_all(mi: Any, quality: Quality, folder: Path) -> tuple[dict[str, Images], dict[str, float]]:
    """Images (repeats, height, width, 3) and the processor seconds per sample and pixel, per key."""
    from rich.console import Console
    from rich.progress import Progress

    loaded = scenes(mi, quality, folder)
    work = list(jobs(quality))
    images: dict[str, list[Images]] = {}
    seconds: dict[str, float] = {}
    console = Console(stderr=True)
    with Progress(console=console, disable=not console.is_terminal) as progress:
        task = progress.add_task("rendering", total=sum(job.spp for job in work))
        for job in work:
            start = time.process_time()
            image = np.array(mi.render(loaded[job.setting, job.sampler], spp=job.spp, seed=job.seed))
            seconds[job.key] = seconds.get(job.key, 0.0) + time.process_time() - start
            images.setdefault(job.key, []).append(image.astype(np.float32))
            progress.advance(task, job.spp)
    pixels = quality.width * quality.height
    counts = {key: len(list_) * pixels * samples_per_pixel(key) for key, list_ in images.items()}
    return {k: np.stack(v) for k, v in images.items()}, {k: seconds[k] / counts[k] for k in images}


def samples_per_pixel(key: str) -> int:
    """Of one image under that key."""
    last = key.rsplit("/", 1)[1]
    return BATCH if last == "reference" else int(last)

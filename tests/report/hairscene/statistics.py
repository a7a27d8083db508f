# SPDX-License-Identifier: BSD-3-Clause
"""Variance, bias and their uncertainty from independent batches of images."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from report.hairscene.batches import BATCH, SMALL, Images
from report.hairscene.luminance import luminance

COUNTS = (*SMALL, *(BATCH * 2**k for k in range(5)))  # 1 to 256 samples per pixel


def at_count(batches: Images, small: dict[int, Images], count: int) -> Images:
    """Independent images of `count` samples per pixel (repeats, height, width, 3): at least two."""
    if count in small:
        return small[count]
    size = count // BATCH
    repeats = batches.shape[0] // size
    return batches[: repeats * size].reshape(repeats, size, *batches.shape[1:]).mean(axis=1)


def variance(images: Images) -> float:
    """Mean over the pixels of the luminance's variance between independent images."""
    return float(luminance(images).var(axis=0, ddof=1).mean())


def variance_per_sample(batches: Images) -> tuple[float, float]:
    """Variance of one sample, averaged over the pixels, and its standard error by bootstrap over batches."""
    values = luminance(batches)
    rng = np.random.default_rng(0)
    n = values.shape[0]
    draws = [values[rng.integers(n, size=n)].var(axis=0).mean() * n / (n - 1) for _ in range(200)]
    # drawing with replacement shrinks a sample variance by (n-1)/n on average
    return float(values.var(axis=0, ddof=1).mean() * BATCH), float(np.std(draws) * n / (n - 1) * BATCH)


@dataclass(frozen=True)
class Bias:
    """Mean luminance minus the reference's, and its standard error, both relative to the reference's."""

    relative: float
    error: float

    @property
    def sigmas(self) -> float:
        return self.relative / self.error


def bias(batches: Images, reference: Images) -> Bias:
    mean, error = _mean_and_error(batches)
    truth, truth_error = _mean_and_error(reference)
    return Bias((mean - truth) / truth, float(np.hypot(error, truth_error)) / truth)


def _mean_and_error(batches: Images) -> tuple[float, float]:
    means = luminance(batches).mean(axis=(1, 2))
    return float(means.mean()), float(means.std(ddof=1) / np.sqrt(means.size))

"""The hair scene, generated from a seed: curved B-spline strands, an environment and an area light.

Lengths are in scene units of about 10 cm; y points up, the camera looks along -z.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CONTROL_POINTS = 9


@dataclass(frozen=True)
class Hair:
    """What is drawn: `strands` >= 1 curves, gathered in `locks`, each `radius` thick (half at the tip)."""

    strands: int = 12_000
    locks: int = 60
    radius: float = 0.0045
    seed: int = 1


def strand_points(hair: Hair) -> Array:
    """Control points (strands, CONTROL_POINTS, 4): x, y, z and the radius, roots on an arc of the scalp."""
    rng = np.random.default_rng(hair.seed)
    lock = rng.integers(hair.locks, size=hair.strands)
    s = np.linspace(0.0, 1.0, CONTROL_POINTS)
    centre = _lock_paths(rng, hair.locks, s)[lock]
    radius = hair.radius * rng.uniform(0.75, 1.15, (hair.strands, 1)) * (1.0 - 0.5 * s**3)
    points = centre + _clump(rng, hair.strands, s) + _frizz(rng, hair.strands, s)
    return np.concatenate([points, radius[..., None]], axis=2)


def _lock_paths(rng: np.random.Generator, locks: int, s: Array) -> Array:
    """Centre lines (locks, points, 3): from the parting, over the scalp, then hanging with a wave."""
    root = np.linspace(-0.95, 0.95, locks) + rng.normal(0.0, 0.03, locks)
    length = rng.uniform(1.7, 2.1, locks)[:, None]
    phase, turns = rng.uniform(0.0, 2.0 * np.pi, (2, locks, 1))
    amplitude = rng.uniform(0.03, 0.12, (locks, 1)) * s**1.2
    wave = 2.0 * np.pi * (0.6 + 0.12 * turns) * s
    x = root[:, None] * (1.0 + 0.25 * np.sin(0.5 * np.pi * s)) + amplitude * np.sin(wave + phase)
    y = 1.0 - 0.15 * root[:, None] ** 2 - length * (s + 0.12 * np.sin(np.pi * s) * (s - 0.6))
    bulge = 0.55 * np.sin(np.pi * np.minimum(0.25 + 0.55 * s, 1.0)) * (1.0 - 0.35 * root[:, None] ** 2)
    z = bulge + amplitude * np.cos(wave + phase) + rng.normal(0.0, 0.03, (locks, 1))
    return np.stack([x, y, z], axis=2)


def _clump(rng: np.random.Generator, strands: int, s: Array) -> Array:
    """Offsets from the lock's centre (strands, points, 3): wide at the root, gathered and twisted below."""
    angle = rng.uniform(0.0, 2.0 * np.pi, (strands, 1)) + rng.normal(0.0, 0.5, (strands, 1)) * s
    distance = np.sqrt(rng.uniform(0.0, 1.0, (strands, 1))) * (0.1 - 0.065 * s**0.7)
    return np.stack(
        [distance * np.cos(angle), rng.normal(0.0, 0.06, (strands, 1)) * s, distance * np.sin(angle)], axis=2
    )


def _frizz(rng: np.random.Generator, strands: int, s: Array) -> Array:
    """Each strand's own slow bends (strands, points, 3); one in thirty flies away."""
    size = np.where(rng.random((strands, 1, 1)) < 1.0 / 30.0, 0.09, 0.012)
    steps = rng.normal(0.0, 1.0, (strands, s.size, 3)) * size
    return np.cumsum(steps, axis=1) * s[:, None] ** 0.5 * np.sqrt(4.0 / s.size)


def write_strands(points: Array, path: Path) -> None:
    """The text form that `bsplinecurve` reads: `x y z radius` a line, an empty line between strands."""
    strands = ("\n".join("{:.6g} {:.6g} {:.6g} {:.4g}".format(*p) for p in strand) for strand in points)
    path.write_text("\n\n".join(strands) + "\n")


def environment_pixels(width: int = 128) -> NDArray[np.float32]:
    """Radiance (width/2, width, 3): dim sky over a dark floor, a bright window and a warm lamp."""
    height = width // 2
    up = np.cos(np.pi * (np.arange(height) + 0.5) / height)[:, None, None]
    azimuth = (2.0 * np.pi * (np.arange(width) + 0.5) / width)[None, :, None]
    sky = np.where(up > 0.0, 0.12 + 0.25 * up, 0.04) * np.array([0.75, 0.88, 1.0])
    pixels = np.broadcast_to(sky, (height, width, 3)).copy()
    elevation = np.arcsin(up)
    window = (np.abs(azimuth - np.pi) < 0.45) & (np.abs(elevation - 0.45) < 0.3)
    lamp = (np.abs(azimuth - 0.42 * np.pi) < 0.22) & (np.abs(elevation - 0.35) < 0.2)
    pixels += np.where(window, np.array([9.0, 10.0, 11.0]), 0.0) + np.where(
        lamp, np.array([26.0, 21.0, 15.0]), 0.0
    )
    return pixels.astype(np.float32)

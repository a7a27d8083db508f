# SPDX-License-Identifier: BSD-3-Clause
"""The hair scene, generated from a seed: curved B-spline strands under a sky.

Lengths are in scene units of about 10 cm; y points up, the camera looks along -z.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CONTROL_POINTS = 9

# Mitsuba 3.9 reads past its list of segments where a ray hits the very tip of the last strand (a position
# along all that rounds to 1). A last one, too small and too far away to be hit, keeps renders from crashing.
UNREACHED = "\n".join(f"0 {-4.0 + 1e-4 * k:g} -4 1e-6" for k in range(4))


@dataclass(frozen=True)
class Hair:
    """What is drawn: `strands` >= 1 curves, gathered in `locks`, each `radius` thick (half at the tip)."""

    strands: int = 12_000
    locks: int = 34
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
    """Centre lines (locks, points, 3): from the parting over the forehead, swept aside, ending in a curl."""
    root = np.linspace(-1.0, 1.0, locks)[:, None] + rng.normal(0.0, 0.04, (locks, 1))
    length = rng.uniform(1.35, 1.9, (locks, 1))
    depth = rng.uniform(-0.16, 0.16, (locks, 1))
    phase = rng.uniform(0.0, 2.0 * np.pi, (locks, 1))
    amplitude = rng.uniform(0.05, 0.17, (locks, 1)) * s**1.3
    wave = 2.0 * np.pi * rng.uniform(0.5, 1.2, (locks, 1)) * s + phase
    sweep = rng.normal(0.22, 0.2, (locks, 1)) * s**2
    x = root + sweep + amplitude * np.sin(wave)
    y = 0.95 - 0.12 * root**2 - length * (s - 0.1 * np.sin(np.pi * s))
    z = 0.55 * np.sin(np.pi * (0.2 + 0.6 * s)) - 0.2 * root**2 + depth + amplitude * np.cos(wave)
    return np.stack([x, y, z], axis=2)


def _clump(rng: np.random.Generator, strands: int, s: Array) -> Array:
    """Offsets from the lock's centre (strands, points, 3): wide at the root, gathered and twisted below."""
    angle = rng.uniform(0.0, 2.0 * np.pi, (strands, 1)) + (1.5 + rng.normal(0.0, 0.4, (strands, 1))) * s
    distance = np.sqrt(rng.uniform(0.0, 1.0, (strands, 1))) * (0.12 - 0.095 * s**0.8)
    along = rng.normal(0.0, 0.09, (strands, 1)) * s
    return np.stack([distance * np.cos(angle), along, distance * np.sin(angle)], axis=2)


def _frizz(rng: np.random.Generator, strands: int, s: Array) -> Array:
    """Each strand's own slow bends (strands, points, 3); one in thirty flies away."""
    size = np.where(rng.random((strands, 1, 1)) < 1.0 / 30.0, 0.07, 0.012)
    steps = rng.normal(0.0, 1.0, (strands, s.size, 3)) * size
    return np.cumsum(steps, axis=1) * s[:, None] ** 0.5 * np.sqrt(4.0 / s.size)


def write_strands(points: Array, path: Path) -> None:
    """The text form that `bsplinecurve` reads: `x y z radius` a line, an empty line between strands."""
    strands = ("\n".join("{:.6g} {:.6g} {:.6g} {:.4g}".format(*p) for p in strand) for strand in points)
    path.write_text("\n\n".join([*strands, UNREACHED]) + "\n")


def environment_pixels(width: int = 128) -> NDArray[np.float32]:
    """Radiance (width/2, width, 3): dim sky over a dark floor."""
    height = width // 2
    up = np.cos(np.pi * (np.arange(height) + 0.5) / height)[:, None, None]
    sky = np.where(up > 0.0, 0.12 + 0.25 * up, 0.04) * np.array([0.75, 0.88, 1.0])
    return np.broadcast_to(sky, (height, width, 3)).astype(np.float32)


def light_hair() -> dict[str, object]:
    """The engine's hair with the widths of the source text.

    Its transmission lobe has a standard deviation of 0.28 rad along the fibre (0.29 in eq. 2) and of 0.58
    rad around it (0.59 in eq. 3). A scale tilt of +2 degrees puts that lobe at theta_i = -theta_r - 2
    degrees, the sign that the tables of model `fitted` have.
    """
    return {
        "type": "hair",
        "eumelanin": 0.25,
        "pheomelanin": 0.15,
        "longitudinal_roughness": 0.5,
        "azimuthal_roughness": 0.55,
        "scale_tilt": 2.0,
    }


def brown_hair() -> dict[str, object]:
    """The engine's hair as in precompute/examples/chiang2016.py, to which luts/brown is fitted."""
    return {
        "type": "hair",
        "sigma_a": {"type": "rgb", "value": 0.6},
        "longitudinal_roughness": 0.3,
        "azimuthal_roughness": 0.3,
    }


def scene_dict(mi: Any, strands: Path, bsdf: dict[str, object], size: tuple[int, int]) -> dict[str, object]:
    """The scene for `mi.load_dict`, without an integrator: the strands of that file under the sky, and a
    camera of `size` (width, height) in pixels."""
    transform = mi.ScalarTransform4f()
    view = transform.look_at(origin=[0.6, 0.25, 4.6], target=[0.08, 0.0, 0.3], up=[0, 1, 0])
    film = {
        "type": "hdrfilm",
        "width": size[0],
        "height": size[1],
        "rfilter": {"type": "box"},
        "pixel_format": "rgb",
    }
    return {
        "type": "scene",
        "sensor": {"type": "perspective", "fov": 26, "fov_axis": "x", "to_world": view, "film": film},
        "environment": {"type": "envmap", "bitmap": mi.Bitmap(environment_pixels())},
        "hair": {"type": "bsplinecurve", "filename": str(strands), "bsdf": bsdf},
    }

# SPDX-License-Identifier: BSD-3-Clause
"""How much of what the hair scatters meets other hair, where an estimate of one scattering ends."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from report.hairscene.samplers import bsdf_dict
from report.hairscene.scene import light_hair, scene_dict


def share_that_meets_hair(mi: Any, strands: Path, count: int = 4000) -> float:
    """Share of the energy scattered where the camera sees hair, estimated from `count` camera rays."""
    scene = mi.load_dict(scene_dict(mi, strands, bsdf_dict("fitted", light_hair()), (40, 30), lamps=False))
    sensor, context = scene.sensors()[0], mi.BSDFContext()
    met, scattered = 0.0, 0.0
    for x, y, u, v, w in np.random.default_rng(1).random((count, 5)).tolist():
        ray, _ = sensor.sample_ray(0.0, 0.5, mi.Point2f(x, y), mi.Point2f(0.5, 0.5))
        si = scene.ray_intersect(ray)
        if si.is_valid():
            drawn, weight = si.bsdf().sample(context, si, u, mi.Point2f(v, w))
            energy = float(np.mean(list(weight)))
            scattered += energy
            met += energy * scene.ray_test(si.spawn_ray(si.to_world(drawn.wo)))
    return met / scattered

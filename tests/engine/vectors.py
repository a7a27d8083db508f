# SPDX-License-Identifier: BSD-3-Clause
"""Arrays of directions for the engine's vectorised variants."""

import numpy as np
from engine.chisquare import PHI_PLACES, THETA_PLACES


def directions(mi, theta, phi):
    """As report.hairscene.nearfield.direction, of arrays (n,)."""
    across = np.cos(theta)
    return mi.Vector3f(across * np.sin(phi), np.sin(theta), across * np.cos(phi))


def interactions(mi, theta_r, phi_r):
    si = mi.SurfaceInteraction3f()
    si.wi = directions(mi, theta_r, phi_r)
    return si


def angles(wo):
    """(n, 2) theta and phi of the engine's vectors."""
    x, y, z = np.array(wo)
    return np.stack([np.arctan2(y, np.hypot(x, z)), np.arctan2(x, z)], axis=1)


def numbers(mi, count, seed):
    """sample1 and sample2 of `count` draws."""
    u = np.random.default_rng(seed).random((3, count), dtype=np.float32)
    return mi.Float(u[0]), mi.Point2f(u[1], u[2])


def sample_angles(mi, bsdf, si, count, seed):
    """As engine.chisquare.sample_angles."""
    drawn, _ = bsdf.sample(mi.BSDFContext(), si, *numbers(mi, count, seed))
    return angles(drawn.wo)[np.array(drawn.pdf) > 0.0]


def cell_masses(mi, density, rows, columns):
    """As engine.chisquare.cell_masses; density(wo) of arrays of directions."""
    theta = (np.arange(rows * THETA_PLACES) + 0.5) / (rows * THETA_PLACES) * np.pi - np.pi / 2.0
    phi = (np.arange(columns * PHI_PLACES) + 0.5) / (columns * PHI_PLACES) * 2.0 * np.pi - np.pi
    grid = [part.ravel() for part in np.meshgrid(theta, phi, indexing="ij")]
    values = np.array(density(directions(mi, *grid))).astype(float) * np.cos(grid[0])
    cells = values.reshape(rows, THETA_PLACES, columns, PHI_PLACES).mean(axis=(1, 3))
    return cells * (np.pi / rows) * (2.0 * np.pi / columns)

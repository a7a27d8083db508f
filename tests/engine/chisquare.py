# SPDX-License-Identifier: BSD-3-Clause
"""Pearson's test of a BSDF's sampling against its density, with the engine's own statistic.

`mitsuba.chi2.ChiSquareTest` needs an array variant, and the plugin is scalar. The histogram is taken here, in
the angles (theta, phi) of the fibre, and goes to the function which that class calls: `mitsuba.math.chi2`. It
pools cells whose expected count is below 5; the p-value comes from `mitsuba.math_py.rlgamma`. As there,
a sample in a cell of zero density rejects.
"""

import numpy as np

from report.hairscene.nearfield import direction

POOL_BELOW = 5.0
THETA_PLACES, PHI_PLACES = (48, 8)  # midpoints per cell: the density of a table jumps where its cells meet


def interaction(mi, theta_r, phi_r):
    si = mi.SurfaceInteraction3f()
    si.wi = direction(mi, theta_r, phi_r)
    return si


def sample_angles(mi, bsdf, si, count, seed):
    """Angles (count, 2) of drawn directions; those with a density of 0 are left out."""
    numbers = np.random.default_rng(seed).random((count, 3), dtype=np.float32).tolist()
    context, point, drawn = mi.BSDFContext(), mi.Point2f, []
    for u, v, w in numbers:
        sample, _ = bsdf.sample(context, si, u, point(v, w))
        if sample.pdf > 0.0:
            drawn.append((sample.wo.x, sample.wo.y, sample.wo.z))
    x, y, z = np.array(drawn).T
    return np.stack([np.arctan2(y, np.hypot(x, z)), np.arctan2(x, z)], axis=1)


def cell_masses(mi, density, rows, columns):
    """Integrals of `density(wo)` per steradian over the cells of a (rows, columns) grid of (theta, phi)."""
    theta = (np.arange(rows * THETA_PLACES) + 0.5) / (rows * THETA_PLACES) * np.pi - np.pi / 2.0
    phi = (np.arange(columns * PHI_PLACES) + 0.5) / (columns * PHI_PLACES) * 2.0 * np.pi - np.pi
    values = np.array([[density(direction(mi, t, p)) for p in phi.tolist()] for t in theta.tolist()])
    values *= np.cos(theta)[:, None]
    cells = values.reshape(rows, THETA_PLACES, columns, PHI_PLACES).mean(axis=(1, 3))
    return cells * (np.pi / rows) * (2.0 * np.pi / columns)


def p_value(mi, angles, masses, count):
    """Probability of a statistic this large if the samples followed `masses`; 0 for one where no mass is."""
    import drjit as dr

    observed, _, _ = np.histogram2d(
        *angles.T, bins=masses.shape, range=((-np.pi / 2.0, np.pi / 2.0), (-np.pi, np.pi))
    )
    expected = masses * count
    if np.any((expected == 0.0) & (observed > 0)):
        return 0.0
    order = np.argsort(expected, axis=None)
    array = dr.scalar.ArrayXf64
    statistic, freedom, _, _ = mi.math.chi2(
        array(observed.ravel()[order]), array(expected.ravel()[order]), POOL_BELOW
    )
    return 1.0 - mi.math_py.rlgamma(freedom / 2.0, statistic / 2.0)

# SPDX-License-Identifier: BSD-3-Clause
"""Integrals of the C library's densities, from the density function alone."""

import numpy as np
from runtime.c_library import Model

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
FLOATS = 4096  # panels with fewer floats than this are summed over all of them


GRADED = np.array([0.0, 0.001, 0.004, 0.016, 0.064, 0.25, 0.5, 0.75, 0.936, 0.984, 0.996, 0.999])


def panels(model: Model, axis: str, theta_r: float, knots: np.ndarray, edges=()) -> np.ndarray:
    """Increasing ends of panels in which the density is smooth: the angles of the knots, and edges; between
    them steps that shrink towards both ends, where the slope of a curved cell may all but vanish."""
    x, _ = model.axis_sample(axis, theta_r, knots)
    low, high = x[0], x[-1]
    inner = [edge for edge in np.float32(edges) if low < edge < high]
    ends = np.unique(np.concatenate([x, np.array(inner, np.float32)]))
    graded = ends[:-1, None] + np.diff(ends.astype(float))[:, None] * GRADED
    return np.unique(np.append(graded.astype(np.float32), ends[-1]))


def integrate(model: Model, axis: str, theta_r: float, ends: np.ndarray) -> np.ndarray:
    """(len(ends) - 1,) mass of each panel: Gauss-Legendre, or the trapezoidal rule over every float."""
    low, high = ends[:-1].astype(float), ends[1:].astype(float)
    x = (0.5 * (low + high)[:, None] + 0.5 * (high - low)[:, None] * NODES).astype(np.float32)
    mass = (model.axis_pdf(axis, theta_r, x) * WEIGHTS).sum(axis=1) * 0.5 * (high - low)
    narrow = np.flatnonzero(high - low < FLOATS * np.spacing(np.maximum(np.abs(ends[:-1]), np.abs(ends[1:]))))
    for i in narrow:
        floats = _floats_between(ends[i], ends[i + 1])
        density = model.axis_pdf(axis, theta_r, floats).astype(float)
        mass[i] = np.trapezoid(density, floats.astype(float))
    return mass


def _floats_between(a: np.float32, b: np.float32) -> np.ndarray:
    """Every float from a to b, both of one sign."""
    bits = np.sort(np.array([a, b], np.float32).view(np.int32))
    return np.sort(np.arange(bits[0], bits[1] + 1, dtype=np.int32).view(np.float32))

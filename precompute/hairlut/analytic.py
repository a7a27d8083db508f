# SPDX-License-Identifier: BSD-3-Clause
"""The closed form of a Gaussian lobe cut to its domain (derivation.md). The bake never imports it: it is what
the numerical integration is tested against.

It works on logarithms of the smaller tails, with alpha and beta the ends of the domain in units of
sigma from the mean: nothing is ever taken from 1, and a mass may underflow.
"""

import numpy as np
from scipy.special import log_ndtr, ndtri_exp

from .errors import HairlutError
from .lobes import Array, Lobe


def _moments(lobe: Lobe, theta_r: Array) -> tuple[Array, Array]:
    if lobe.moments is None:
        raise HairlutError(f"{lobe.model}/{lobe.name}: no closed form: only Gaussian lobes have one")
    return lobe.moments(np.asarray(theta_r, float))


def _log_difference(log_b: Array, log_a: Array) -> Array:
    """log(exp(log_b) - exp(log_a)) for log_b >= log_a."""
    with np.errstate(divide="ignore"):
        return log_b + np.log(-np.expm1(log_a - log_b))


def _log_probability(alpha: Array, beta: Array) -> Array:
    """log(Phi(beta) - Phi(alpha)) for alpha <= beta: from the tails below, or above, whichever are
    smaller."""
    mirror = alpha + beta > 0
    a, b = np.where(mirror, -beta, alpha), np.where(mirror, -alpha, beta)
    return _log_difference(log_ndtr(b), log_ndtr(a))


def log_mass(lobe: Lobe, theta_r: Array) -> Array:
    """Logarithm of the part of the Gaussian that lies in the domain, at theta_r (any shape)."""
    mean, sigma = _moments(lobe, theta_r)
    low, high = lobe.domain
    return _log_probability((low - mean) / sigma, (high - mean) / sigma)


def density(lobe: Lobe, theta_r: Array, x: Array) -> Array:
    """Normalised density at x, per rad; 0 outside the domain. Broadcasts."""
    mean, sigma = _moments(lobe, theta_r)
    z = (x - mean) / sigma
    inside = (x >= lobe.domain[0]) & (x <= lobe.domain[1])
    log_p = -0.5 * z * z - log_mass(lobe, theta_r) - np.log(sigma * np.sqrt(2 * np.pi))
    return np.where(inside, np.exp(np.where(inside, log_p, -np.inf)), 0.0)


def tails(lobe: Lobe, theta_r: Array, x: Array) -> tuple[Array, Array]:
    """(mass below x, mass above x), both normalised and to full relative precision. Broadcasts."""
    mean, sigma = _moments(lobe, theta_r)
    low, high = lobe.domain
    z = (np.clip(x, low, high) - mean) / sigma
    log_z = log_mass(lobe, theta_r)
    below = _log_probability((low - mean) / sigma, z)
    above = _log_probability(z, (high - mean) / sigma)
    return np.exp(below - log_z), np.exp(above - log_z)


def quantile(lobe: Lobe, theta_r: Array, m: Array, upper: Array) -> Array:
    """The angle with the part m of the mass below it, or above it where upper. Broadcasts; m = 0 gives the
    end."""
    mean, sigma = _moments(lobe, theta_r)
    low, high = lobe.domain
    alpha, beta = (low - mean) / sigma, (high - mean) / sigma
    with np.errstate(divide="ignore"):
        log_below, log_above = np.log(np.where(upper, 1 - m, m)), np.log(np.where(upper, m, 1 - m))
    # (A7) and (A8): Phi(z) and its complement as sums of positive terms, of which the smaller is inverted
    log_p = np.logaddexp(log_above + log_ndtr(alpha), log_below + log_ndtr(beta))
    log_q = np.logaddexp(log_above + log_ndtr(-alpha), log_below + log_ndtr(-beta))
    z = np.where(log_p < log_q, ndtri_exp(np.minimum(log_p, -0.5)), -ndtri_exp(np.minimum(log_q, -0.5)))
    x = np.clip(mean + sigma * z, low, high)
    return np.where(np.asarray(m) == 0, np.where(upper, high, low), x)

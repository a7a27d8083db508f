# SPDX-License-Identifier: BSD-3-Clause
"""The lobes, the warp and the quantiles again in 40-digit arithmetic, from the equations and nothing else."""

import mpmath as mp
import numpy as np

mp.mp.dps = 40
PI = mp.pi
DEGREE = PI / 180


def moments(model, name, theta_r):
    """(mean, sigma) of the table's angle: eq. (2) to (4), with theta_r a double taken exactly."""
    t = mp.mpf(float(theta_r))
    if name == "direct_phi":
        return PI, t**4 / 4 + mp.mpf("0.59")
    if name == "multiple_theta":
        return (mp.mpf("33.5") * mp.sin(mp.mpf("1.25") * t) - 1) * DEGREE - t, t**4 / 20 + mp.mpf("0.49")
    mu = 3 * t - 2 * DEGREE if model == "printed" else (3 * t - 2) * DEGREE
    return mu - t, mp.mpf("0.29")


def domain(name):
    return (mp.mpf(0), 2 * PI) if name == "direct_phi" else (-PI / 2, PI / 2)


def gaussian_mass(mean, sigma, a, b):
    """Mass of a normal density on [a, b], from the tails on the side of the interval."""
    a, b = (a - mean) / sigma, (b - mean) / sigma
    if a + b > 0:
        a, b = -b, -a
    return (mp.erfc(-b / mp.sqrt(2)) - mp.erfc(-a / mp.sqrt(2))) / 2


def octave(x):
    """(n, g) of x = 2^n (1 + g), 0 <= g < 1."""
    mantissa, exponent = mp.frexp(x)
    return exponent - 1, 2 * mantissa - 1


def curve(s):
    """F: fourths of a power of two in each octave, four octaves a power."""
    n, g = octave(s)
    q, r = divmod(n + 3, 4)
    return mp.ldexp(1 + (r + g) / 4, q)


def curve_back(y):
    """G"""
    q, v = octave(y)
    r = int(mp.floor(4 * v))
    return mp.ldexp(1 + 4 * v - r, 4 * q + r - 3)


def knot(warp, width, i):
    """(m, upper) of column i, from the definition of the warp."""
    folded = min(i, width - 1 - i)
    upper = 2 * i > width - 1
    if warp.name == "uniform" or folded == 0:
        return mp.mpf(folded) / (width - 1), upper
    e = mp.mpf(warp.e)
    f0, f1 = curve(e), curve(e + mp.mpf(1) / 2)
    return curve_back(f0 + 2 * (f1 - f0) / (width - 1) * folded) - e, upper


class Row:
    """One row of a table: what mass lies on either side of an angle."""

    def __init__(self, model, name, theta_r):
        self.mean, self.sigma = moments(model, name, theta_r)
        self.low, self.high = domain(name)
        self.mass = gaussian_mass(self.mean, self.sigma, self.low, self.high)

    def tail(self, x, upper):
        """Mass above x where upper, else below it; beyond the domain, nothing or less than nothing."""
        if upper:
            return gaussian_mass(self.mean, self.sigma, x, self.high) / self.mass
        return gaussian_mass(self.mean, self.sigma, self.low, x) / self.mass

    def is_quantile(self, x, m, upper, ulps):
        """Whether the true quantile of m lies within so many float32 spacings of the float32 x."""
        width = ulps * mp.mpf(float(np.spacing(np.abs(np.float32(x)))))
        below, above = (self.tail(mp.mpf(float(x)) + d, upper) for d in (-width, width))
        return below >= m >= above if upper else below <= m <= above

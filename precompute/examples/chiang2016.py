# SPDX-License-Identifier: BSD-3-Clause
"""Hair after Chiang, Bitterli, Tappan and Burley 2016, for one wavelength: hairlut fit
precompute/examples/chiang2016.py"""

import numpy as np

BETA_M, BETA_N = 0.3, 0.3  # longitudinal and azimuthal roughness, 0 to 1
ABSORPTION = 0.6  # sigma_a times the fibre's radius
ETA, TILT = 1.55, np.radians(2.0)  # index of refraction; angle of the cuticle's scales

TWO_PI = 2 * np.pi
TILTS = 2 * TILT, -TILT, -4 * TILT, 0.0


def variances(beta_m):
    """Longitudinal variance of R, TT, TRT, and all that follow (eq. 7)."""
    v = (0.726 * beta_m + 0.812 * beta_m**2 + 3.7 * beta_m**20) ** 2
    return v, v / 4, 4 * v, 4 * v


def scale(beta_n):
    """Scale of the azimuthal logistic distribution (eq. 8)."""
    return np.sqrt(np.pi / 8) * (0.265 * beta_n + 1.194 * beta_n**2 + 5.372 * beta_n**22)


VARIANCES, S = variances(BETA_M), scale(BETA_N)


def longitudinal(theta_i, theta_r, v):
    """M_p of d'Eon et al. 2011; sinh and I_0 as logarithms, since 1 / v is large for smooth hair."""
    x = np.cos(theta_i) * np.cos(theta_r) / v
    large = np.maximum(x, 12)
    log_i0 = np.where(
        x < 12, np.log(np.i0(np.minimum(x, 12))), large - np.log(TWO_PI * large) / 2 + 1 / (8 * large)
    )
    log_sinh = 1 / v + np.log1p(-np.exp(-2 / v)) - np.log(2)
    return np.exp(log_i0 - np.sin(theta_i) * np.sin(theta_r) / v - log_sinh) / (2 * v)


def azimuthal(phi, s=S):
    """D of eq. 6, a logistic distribution cut to the circle."""
    e = np.exp(-abs((phi + np.pi) % TWO_PI - np.pi) / s)
    return e / (s * (1 + e) ** 2 * np.tanh(np.pi / (2 * s)))


def fresnel(cosine):
    refracted = np.sqrt(1 - (1 - cosine**2) / ETA**2)
    parallel = (ETA * cosine - refracted) / (ETA * cosine + refracted)
    across = (cosine - ETA * refracted) / (cosine + ETA * refracted)
    return (parallel**2 + across**2) / 2


def refracted_angle(theta_r, offset):
    """gamma_t, by Bravais's index of refraction."""
    return np.arcsin(offset * np.cos(theta_r) / np.sqrt(ETA**2 - np.sin(theta_r) ** 2))


def attenuations(theta_r, offset, absorption=ABSORPTION):
    """A_p of the four lobes."""
    path = 2 * np.cos(refracted_angle(theta_r, offset)) / np.sqrt(1 - (np.sin(theta_r) / ETA) ** 2)
    passed, reflected = np.exp(-absorption * path), fresnel(np.cos(theta_r) * np.sqrt(1 - offset**2))
    tt = (1 - reflected) ** 2 * passed
    trt = tt * passed * reflected
    return reflected, tt, trt, trt * passed * reflected / (1 - passed * reflected)


def around(theta_r, phi, offset, s=S):
    """D_p: R, TT and TRT leave in their directions, all that follows evenly around the fibre."""
    inside, outside = refracted_angle(theta_r, offset), np.arcsin(offset)
    return *(azimuthal(phi - 2 * p * inside + 2 * outside - p * np.pi, s) for p in range(3)), 1 / TWO_PI


def bsdf(theta_r, theta_i, phi, offset):
    parts = zip(attenuations(theta_r, offset), TILTS, VARIANCES, around(theta_r, phi, offset), strict=True)
    return sum(a * longitudinal(theta_i, theta_r - t, v) * d for a, t, v, d in parts) / np.cos(theta_i)

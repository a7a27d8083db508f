# SPDX-License-Identifier: BSD-3-Clause
"""A longitudinal lobe with two peaks: reflection at the surface (R), and light that crossed twice (TRT).

The tilt of the scales, 3 degrees, shifts R by twice the tilt and TRT by four times as much to the other
side, so that the two highlights part. TRT is the broader and, on this blond hair, the stronger one.
"""

import numpy as np

from hairlut.modelfile import density, gaussian

TILT = np.radians(3)
SHIFT = -2 * TILT, 4 * TILT
SIGMA = 0.08, 0.16
WEIGHT = 0.4, 0.6


def log_density(theta_i, theta_r):
    def log_peak(shift, sigma, weight):
        z = (theta_i + theta_r - shift) / sigma
        return -0.5 * z * z + np.log(weight / (sigma * np.sqrt(2 * np.pi)))

    return np.logaddexp(*(log_peak(*peak) for peak in zip(SHIFT, SIGMA, WEIGHT, strict=True)))


LOBES = (
    density(
        "direct_theta",
        log_density=log_density,
        formula=f"two Gaussians of theta_i + theta_r; means {SHIFT[0]:.6g}, {SHIFT[1]:.6g}; "
        "sigmas 0.08, 0.16; weights 0.4, 0.6",
    ),
    gaussian("direct_phi", mean=np.pi, sigma=0.7),
    gaussian("multiple_theta", mean=lambda theta_r: -theta_r, sigma=0.4),
)

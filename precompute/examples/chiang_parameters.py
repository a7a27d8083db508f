# SPDX-License-Identifier: BSD-3-Clause
"""Hair after Chiang, Bitterli, Tappan and Burley 2016 over all its roughnesses and absorptions, so that each
strand may have its own: hairlut fit precompute/examples/chiang_parameters.py"""

import numpy as np
from chiang2016 import TILTS, around, attenuations, longitudinal, scale, variances

PARAMETERS = {  # least, most, standard
    "beta_m": (0.05, 0.6, 0.3),  # longitudinal roughness
    "beta_n": (0.1, 0.6, 0.3),  # azimuthal roughness
    "absorption": (0.05, 5.0, 0.6),  # sigma_a times the fibre's radius
}


def bsdf(theta_r, theta_i, phi, offset, beta_m, beta_n, absorption):
    parts = zip(
        attenuations(theta_r, offset, absorption),
        TILTS,
        variances(beta_m),
        around(theta_r, phi, offset, scale(beta_n)),
        strict=True,
    )
    return sum(a * longitudinal(theta_i, theta_r - t, v) * d for a, t, v, d in parts) / np.cos(theta_i)

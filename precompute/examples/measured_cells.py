# SPDX-License-Identifier: BSD-3-Clause
"""A longitudinal lobe that no formula describes: masses of light in cells of theta_i, from a table.

A goniometer's counts would be given in the same way. The table says where its numbers come from.
"""

from pathlib import Path

import numpy as np

from hairlut.modelfile import gaussian, tabulated

INPUTS = ("brown_hair_cells.csv",)

rows = np.loadtxt(Path(__file__).with_name(INPUTS[0]), delimiter=",", skiprows=3)
theta_r, masses = np.radians(rows[:, 0]), rows[:, 1:]
edges = np.linspace(-np.pi / 2, np.pi / 2, masses.shape[1] + 1)

LOBES = (
    tabulated("direct_theta", edges, theta_r, masses, formula="32 cells of theta_i at 18 theta_r"),
    gaussian("direct_phi", mean=np.pi, sigma=0.9),
    gaussian("multiple_theta", mean=lambda theta_r: -theta_r, sigma=0.5),
)

# SPDX-License-Identifier: BSD-3-Clause
"""From what a renderer can evaluate or draw to a baked mixture of lobes.

bsdf runs a user's function, read takes grids and draws from files, and hair, grid and draws make densities
or cells of them. factor, highlights, turning and lobesfit find lobes, smooth and tables bake them, promise
measures the textures, and refine does all that again with finer cells until it is good enough. effort chooses
how coarse it starts within a budget of time. summary, warnings and plot report.

strands/ does the same for a hair with named parameters, whose strands may differ.
"""

# SPDX-License-Identifier: BSD-3-Clause
"""From what a renderer can evaluate or draw to a baked mixture of lobes.

bsdf runs a user's function, read takes grids and draws from files, and hair, grid and draws make densities
or cells of them. factor, highlights, turning and lobesfit find lobes, smooth and tables bake them, promise
measures the textures, and refine does all that again with finer cells until it is good enough. effort chooses
how coarse it starts within a budget of time. summary, warnings and plot report.

A hair with named parameters is a box of hairs. shapes finds its lobes at one corner, by the updates of tied,
and follows them through the box; dependence says which of them a parameter changes. nodeshapes, nodetables
and nodemixture choose each axis' nodes (nodes) and bake over them, boxpromise measures, parameters does it
all, and boxsummary reports.
"""

# SPDX-License-Identifier: BSD-3-Clause
"""From a hair with named parameters to one model over all their values.

box        the hair, and the box of its parameters' values: a place in it is a tuple of them, one hair
firstround how much of the box a budget lets a fit look at
tied       updates of lobes whose shapes several places share
shapes     the lobes' shapes: found at one place in the box, the anchor, and followed from place to place
dependence which shapes change along which parameter
nodes      the fewest nodes of an axis; nodeshapes, nodetables and nodemixture have what is at them
losses     what the baked model's draws cost at random parameters
fit        all of it, again and finer until it is good enough
summary    the result as text, as data and in a header

Shapes are the masses of a lobe's inclinations and azimuths in cells; a table is made from them.
"""

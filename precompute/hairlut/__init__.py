"""Bakes the importance-sampling distributions of a hair shader into lookup textures.

Data flows one way: :mod:`lobes` (the equations) -> :mod:`integrate` -> :mod:`invert` -> :mod:`table` -> :mod:`exr`.
:mod:`warp` places the columns of a table on the axis of the cumulative probability, :mod:`interpolant` is the rule by
which a table is read, and :mod:`analytic` the closed form against which all of it is tested.
"""

__version__ = "1.0.0"

"""Bakes the importance-sampling distributions of a hair shader into lookup textures.

Data flows one way: lobes (the equations) -> integrate -> invert -> table -> exr. warp places the columns of a
table on the axis of the cumulative probability, interpolant is the rule by which a table is read, and
analytic the closed form against which all of it is tested.
"""

__version__ = "1.0.0"

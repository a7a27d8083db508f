"""Tables fitted to what a renderer can evaluate or draw: one model, or one for each offset of the fibre.

distribution and offsets read draws and grids, decompose splits them into lobes, model and family fit those,
files and familyfiles write model files that `hairlut bake` reads.
"""

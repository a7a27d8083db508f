"""Tables fitted to what a renderer can evaluate or draw: one model, or one for each offset of the fibre.

read takes draws and grids from files, distribution and offsets make masses of cells of them, decompose splits
them into lobes, model and family fit those, files and familyfiles write model files that `hairlut bake`
reads.
"""

# SPDX-License-Identifier: BSD-3-Clause
"""Models of the C library made from memory, of what Python has read."""

import numpy as np
from runtime.c_library import Model
from runtime.tables import DIFFERENCE, OCTAVES, SUM, UNIFORM, Description, Lobe, MemoryTable, Mixture

from hairlut.axes import Axis, Parameter
from hairlut.model import BakedModel
from hairlut.table import Table
from runtime import tables


def axes_of(axes: tuple[Axis, ...], parameters: tuple[Parameter, ...]) -> list[tables.Nodes]:
    """Axes, as hairlut_parameter_nodes."""
    names = [parameter.name for parameter in parameters]
    return [tables.Nodes(names.index(axis.name), axis.nodes) for axis in axes]


def table_of(table: Table, parameters: tuple[Parameter, ...] = ()) -> MemoryTable:
    """A table, as hairlut_table."""
    warp = {"uniform": UNIFORM, "octaves": OCTAVES}[table.warp.name]
    texels = np.stack([table.texels, table.slopes], axis=-1).reshape(-1, table.height, table.width, 2)
    axes = axes_of(table.axes, parameters)
    return MemoryTable(texels, table.domain, table.theta_r_range, warp, table.warp.e, axes=axes)


def from_baked(baked: BakedModel) -> Model:
    """A baked model, by hairlut_model_create."""
    made = {table.name: table_of(table, baked.parameters) for table in baked.tables}
    lobes = [
        Lobe(
            lobe.name,
            made[lobe.theta.name],
            lobe.phi and made[lobe.phi.name],
            SUM if lobe.phi and lobe.phi.azimuth == "sum" else DIFFERENCE,
        )
        for lobe in baked.lobes
    ]
    m = baked.mixture
    axes = axes_of(m.axes, baked.parameters)
    mixture = Mixture(m.theta_r, m.offset, m.share, m.turn, int(m.mirrored), axes=axes)
    parameters = [tables.Parameter(p.name, p.least, p.most, p.standard) for p in baked.parameters]
    return Description(lobes, mixture, parameters).create()

# SPDX-License-Identifier: BSD-3-Clause
"""Models of the C library made from memory, of what Python has read."""

import numpy as np
from runtime.c_library import Model
from runtime.tables import DIFFERENCE, OCTAVES, SUM, UNIFORM, Description, Lobe, MemoryTable, Mixture

from hairlut.model import BakedModel
from hairlut.table import Table


def table_of(table: Table) -> MemoryTable:
    """A table, as hairlut_table."""
    warp = {"uniform": UNIFORM, "octaves": OCTAVES}[table.warp.name]
    texels = np.stack([table.texels, table.slopes], axis=-1)
    return MemoryTable(texels, table.domain, table.theta_r_range, warp, table.warp.e)


def from_baked(baked: BakedModel) -> Model:
    """A baked model, by hairlut_model_create."""
    tables = {table.name: table_of(table) for table in baked.tables}
    lobes = [
        Lobe(
            lobe.name,
            tables[lobe.theta.name],
            lobe.phi and tables[lobe.phi.name],
            SUM if lobe.phi and lobe.phi.azimuth == "sum" else DIFFERENCE,
        )
        for lobe in baked.lobes
    ]
    m = baked.mixture
    return Description(lobes, Mixture(m.theta_r, m.offset, m.share, m.turn, int(m.mirrored))).create()

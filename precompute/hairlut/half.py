"""Why tables are not stored as half floats: what rounding the angles to 16 bits does to a table.

Neither pi/2 nor 2 pi is a half float, and near them halves are 1e-3 rad or more apart: a table would lose the
ends of its domain, and its end cells would be flat. study.py compares other 16-bit forms;
tests/report/pages/study.md has the figures.
"""

from dataclasses import replace

import numpy as np

from .errors import HairlutError
from .lobes import Lobe
from .measure import flat_cells, measure
from .table import Table


def as_half(table: Table) -> Table:
    """The table with every angle rounded to a half float."""
    return replace(table, texels=table.texels.astype(np.float16).astype(np.float32))


def refusal(table: Table, lobe: Lobe) -> HairlutError:
    """What half floats would do to the table, as an error."""
    rounded = as_half(table)
    off = abs(rounded.texels[0, [0, -1]] - table.texels[0, [0, -1]]).max()
    with np.errstate(all="ignore"):  # flat cells
        errors = [measure(each, lobe, quantiles=False) for each in (table, rounded)]
    before, after = (each.relative_variance for each in errors)
    return HairlutError(
        f"{lobe.model}/{lobe.name} at {table.width}x{table.height}: half floats are refused: "
        f"{flat_cells(rounded.texels)} cells would be flat, the ends would miss the domain by {off:.1e} rad, "
        f"and V would be {after:.1e} instead of {before:.1e}: leave out --half"
    )

# SPDX-License-Identifier: BSD-3-Clause
"""All tables of a model in the engine's arrays, and how one is read (luts/FORMAT.md), as in interpolant.py.

Where a table depends on parameters of the hair, its cells are first blended over the nodes around them.
Cells of two neighbouring rows are blended linearly in theta_r; a blended cell is the monotone rational
quadratic of cell.py. Here it is written with ratios alone, so that no product leaves the range of a float:
with the fraction f of the cell, g = 1 - f, w its width in x, s = w / h, and e = d / s for its slopes d,

    G = f^2 + g^2 + (e0 + e1) f g,      x = x0 + w (f^2 + e0 f g) / G,

and back from x, with X = (x - x0) / w, Z = (x1 - x) / w:

    B = e0 Z - e1 X,  R = sqrt(B^2 + 4 X Z),  f : g = 2 X : R + B where B >= 0, else R - B : 2 Z,
    density = G / (s R).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np

from ..axes import Parameter, node_count
from ..table import Table
from .arrays import Number, Records, last
from .nodes import ONE_CORNER, Corner, Nodes, ParameterAxis, blend, corners, steps


@dataclass(frozen=True)
class Place:
    """Where a table lies among all: numbers that are the same for every direction, or one for each.

    number        of the table
    cells, knots  of all tables, before this one's
    columns, rows of cells, at one node of the parameters
    low, high     domain, rad; theta_r of the first row, and rows per radian
    """

    number: Number
    cells: Number
    knots: Number
    columns: Number
    rows: Number
    low: Number
    high: Number
    theta_r: Number
    scale: Number


class Axes:
    """The tables of a model, and the nodes of its parameters on which they depend."""

    def __init__(self, tables: Sequence[Table], parameters: Sequence[Parameter] = ()) -> None:
        cells = [_cells(table) for table in tables]
        knots = [_knots(table) for table in tables]
        places = [
            (k, sum(map(len, cells[:k])), sum(map(len, knots[:k])), *_shape(table))
            for k, table in enumerate(tables)
        ]
        self._cells = Records(np.concatenate(cells))
        self._edges = Records(np.concatenate(cells)[:, [0, 4]])
        self._knots = Records(np.concatenate(knots))
        self._places = Records(np.array(places))
        self._most = max(table.width for table in tables) - 1
        self._fixed = [Place(*place) for place in places]
        self._set_grids(tables, [parameter.name for parameter in parameters])

    def _set_grids(self, tables: Sequence[Table], names: Sequence[str]) -> None:
        """The axes of parameters: of each table (first, intervals, parameter, step), the shorter lists
        completed by axes along which nothing changes."""
        scales = [axis.nodes for table in tables for axis in table.axes]
        self._dimensions = max(len(table.axes) for table in tables)
        if not scales:
            return
        self._nodes = Nodes(scales)
        self._grids, k = [], 0
        for table in tables:
            strides = steps([len(axis.nodes) for axis in table.axes])
            grid = []
            for axis, step in zip(table.axes, strides, strict=True):
                grid.append((self._nodes.first[k], self._nodes.intervals[k], names.index(axis.name), step))
                k += 1
            self._grids.append(grid)
        rows = [
            axis for grid in self._grids for axis in grid + [(0, 1, 0, 0)] * (self._dimensions - len(grid))
        ]
        self._axes = Records(np.array(rows))

    def fixed(self, number: int) -> Place:
        """Of a table known to Python."""
        return self._fixed[number]

    def place(self, number: Number) -> Place:
        """Of a table that may differ from direction to direction."""
        place = self._places[number]
        return Place(*map(mi.UInt32, place[:5]), *place[5:])

    def corners(self, table: Place, values: Sequence[Number]) -> list[Corner]:
        """The nodes of a table around the values of the model's parameters, in order."""
        if not self._dimensions:
            return ONE_CORNER
        if isinstance(table.number, int):
            grid = self._grids[table.number]
        else:
            rows = [self._axes[table.number * self._dimensions + a] for a in range(self._dimensions)]
            grid = [tuple(map(mi.UInt32, row)) for row in rows]
        axes = [
            ParameterAxis(first, intervals, _chosen(values, parameter), step)
            for first, intervals, parameter, step in grid
        ]
        return corners(self._nodes, axes)

    def sample(self, table: Place, around: Sequence[Corner], theta_r: Number, u: Number) -> Number:
        """The angle drawn with u in [0, 1), counted from the nearer end of u: exact in both tails."""
        upper = u > 0.5
        m = dr.select(upper, 1 - u, u)
        halves = (table.columns + 1) // 2  # cells that begin below u = 1/2
        i = last(halves, (self._most + 1) // 2, lambda i: self._knots[table.knots + i][0] <= m)
        start, h = self._knots[table.knots + i]
        f = dr.minimum(dr.maximum((m - start) / h, 0), 1)
        x0, d0, x1, d1 = self._cell(table, around, theta_r, dr.select(upper, table.columns - 1 - i, i))
        from_, to = dr.select(upper, x1, x0), dr.select(upper, x0, x1)
        e0, e1 = _ratios(x0, d0, x1, d1, h)
        first, second = dr.select(upper, e1, e0), dr.select(upper, e0, e1)
        return from_ + (to - from_) * (f * f + first * f * (1 - f)) / _denominator(f, 1 - f, first, second)

    def pdf(self, table: Place, around: Sequence[Corner], theta_r: Number, x: Number) -> Number:
        """Density per rad with which sample draws x; 0 outside the domain."""
        row, t = self._row(table, theta_r)

        def at_most(i: Number) -> Number:
            low, high = blend(self._edges, row + i, table.columns * table.rows, around)
            return (1 - t) * low + t * high <= x

        i = last(table.columns, self._most, at_most)
        x0, d0, x1, d1 = self._cell(table, around, theta_r, i)
        h = self._knots[table.knots + i][1]
        e0, e1 = _ratios(x0, d0, x1, d1, h)
        w = x1 - x0
        below, above = (dr.minimum(dr.maximum(part / w, 0), 1) for part in (x - x0, x1 - x))
        bend = e0 * above - e1 * below
        root = dr.sqrt(bend * bend + 4 * below * above)
        a = dr.select(bend >= 0, 2 * below, root - bend)
        b = dr.select(bend >= 0, root + bend, 2 * above)
        f, g = a / (a + b), b / (a + b)
        density = h / w * _denominator(f, g, e0, e1) / root
        return dr.select((x >= table.low) & (x <= table.high), density, 0)

    def _row(self, table: Place, theta_r: Number) -> tuple[Number, Number]:
        """(number of the row's first cell among all, weight of the next row)"""
        at = dr.minimum(dr.maximum((theta_r - table.theta_r) * table.scale, 0), table.rows)
        j = dr.minimum(mi.UInt32(at), table.rows - 1)
        return table.cells + j * table.columns, at - j

    def _cell(self, table: Place, around: Sequence[Corner], theta_r: Number, i: Number) -> list[Number]:
        row, t = self._row(table, theta_r)
        ends = blend(self._cells, row + i, table.columns * table.rows, around)
        return [(1 - t) * a + t * b for a, b in zip(ends[:4], ends[4:], strict=True)]


def _cells(table: Table) -> np.ndarray:
    """(cells, 8): x0 d0 x1 d1 of each cell of a row, and the same of the next row, node by node."""
    knots = np.stack([table.texels, table.slopes], -1)
    rows = np.concatenate([knots[:, :-1], knots[:, 1:]], -1).reshape(
        node_count(table.axes), table.height, table.width - 1, 4
    )
    return np.concatenate([rows[:, :-1], rows[:, 1:]], -1).reshape(-1, 8)


def _knots(table: Table) -> np.ndarray:
    """(columns, 2): m = min(u, 1-u) where a cell begins, and its width in u."""
    return np.stack([table.warp.knots(table.width)[0][:-1], table.warp.widths(table.width)], -1)


def _shape(table: Table) -> tuple[float, ...]:
    """The fields of Place from columns on."""
    low, high = table.theta_r_range
    rows = table.height - 1
    return table.width - 1, rows, *table.domain, low, rows / (high - low)


def _chosen(values: Sequence[Number], parameter: Number) -> Number:
    """The value of a parameter, whose number may differ from direction to direction."""
    if isinstance(parameter, int):
        return values[parameter]
    value = values[0]
    for p in range(1, len(values)):
        value = dr.select(parameter == p, values[p], value)
    return value


def _ratios(x0: Number, d0: Number, x1: Number, d1: Number, h: Number) -> tuple[Number, Number]:
    """e0, e1"""
    return d0 * h / (x1 - x0), d1 * h / (x1 - x0)


def _denominator(f: Number, g: Number, e0: Number, e1: Number) -> Number:
    """G"""
    return f * f + g * g + (e0 + e1) * f * g

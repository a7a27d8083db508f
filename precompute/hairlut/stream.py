# SPDX-License-Identifier: BSD-3-Clause
"""A model as one stream of texels of four floats, as the shaders read it (runtime/shaders/README.md).

Everything a shader would derive from a table is in it: cells of two knots and slopes, what depends on the
column alone, a search tree for each row, the mixture, and all of these for each node of the parameters on
which they depend. Positions inside a stream are relative to its first texel, so that several models can
follow each other in one texture or buffer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from .axes import node_count
from .errors import HairlutError
from .lobes import Array
from .mixture import Mixture, wrap
from .warp import Warp

if TYPE_CHECKING:
    from .axes import Axis
    from .model import BakedModel
    from .table import Table

HEAD, AXIS = 3, 3  # texels of a model's head, and of each of a lobe's two axes
WIDTH = 1024  # a stream is whole rows of a texture of this width
MOST = 1 << 24  # texels: what positions, which are floats, can count
STEEPEST = 4096.0  # slopes are kept within this factor of a cell's own, as in the C library
AZIMUTHS = {"difference": 1.0, "sum": 2.0}  # 0: uniform
LARGEST = 1e38  # a key that is above every angle


def stream(model: BakedModel) -> Array:
    """(n, 4) float32, n a multiple of WIDTH."""
    tables = [table for lobe in model.lobes for table in (lobe.theta, lobe.phi)]
    owners = [owner.axes if owner else () for owner in (model.mixture, *tables)]
    head = np.zeros((head_size(model), 4))
    parts, length = [head], len(head)
    placed: dict[bytes, int] = {}

    def append(texels: Array) -> int:
        nonlocal length
        parts.append(texels.reshape(-1, 4))
        length += len(parts[-1])
        return length - len(parts[-1])

    def append_once(texels: Array) -> int:
        content = texels.tobytes()
        if content not in placed:
            placed[content] = append(texels)
        return placed[content]

    mixture = model.mixture
    theta_r, offset = (
        np.float32(nodes).astype(float) for nodes in (mixture.theta_r, mixture.offset)
    )  # as in C
    head[1] = _place_nodes(append, theta_r)
    head[2] = _place_nodes(append, np.arcsin(offset))
    nodes = [node_count(axes) for axes in owners]
    values = mixture_texels(mixture)
    sizes = [values.size // 4 // nodes[0]]  # texels of one node of each owner
    head[0] = len(model.lobes), mixture.mirrored, append(values), 0
    for k, (table, count) in enumerate(zip(tables, nodes[1:], strict=True)):
        if table is None:
            sizes.append(0)
            continue  # zeros: a uniform azimuth
        texels = table_texels(table)
        sizes.append((len(texels) - table.width // 2) // count)
        head[HEAD + AXIS * k : HEAD + AXIS * (k + 1)] = _axis(table, append_once(texels))
    if model.parameters:
        head[0, 0] *= -1  # so that a shader that knows no parameters draws nothing from it
        head[2, 3] = len(model.parameters)
        first = HEAD + AXIS * len(tables)
        head[first:] = _parameters(model, first, owners, sizes, append_once)
    if length > MOST:
        raise HairlutError(
            f"model {model.name}: {length} texels, expected at most {MOST}: use smaller tables"
        )
    head[0, 3] = length
    parts.append(np.zeros((-length % WIDTH, 4)))
    return np.concatenate(parts).astype(np.float32)


def head_size(model: BakedModel) -> int:
    """Texels of a model's head."""
    tables = [table for lobe in model.lobes for table in (lobe.theta, lobe.phi)]
    size = HEAD + AXIS * len(tables)
    if model.parameters:
        owners = [owner.axes if owner else () for owner in (model.mixture, *tables)]
        size += len(model.parameters) + len(owners) + sum(map(len, owners))
    return size


def table_texels(table: Table) -> Array:
    """(n, 4) of one table: a texel for each folded column, then for each node of its parameters the cells and
    the search trees."""
    u, h = _columns(table)
    parts = [np.stack([u, 1 / h, h, np.zeros_like(u)], axis=1)]
    shape = -1, table.height, table.width
    for x, d in zip(table.texels.reshape(shape), table.slopes.reshape(shape), strict=True):
        angles, slopes = np.asarray(x, float), np.asarray(d, float)
        parts.append(_cells(angles, slopes, h).reshape(-1, 4))
        parts.append(_trees(angles[:-1, 1:-1], angles[1:, 1:-1]))
    return np.concatenate(parts)


def mixture_texels(mixture: Mixture) -> Array:
    """(nodes of the parameters, gaps of theta_r, gaps of the offset, K, 2, 4) shares and turns."""
    grid = len(mixture.theta_r), len(mixture.offset)
    nodes = (
        np.moveaxis(values.reshape(len(mixture.lobes), -1, *grid), 1, 0)
        for values in (mixture.share, mixture.turn)
    )
    return np.stack([_values(share, turn) for share, turn in zip(*nodes, strict=True)])


def _parameters(
    model: BakedModel,
    first: int,
    owners: Sequence[tuple[Axis, ...]],
    sizes: Sequence[int],
    append: Callable[[Array], int],
) -> Array:
    """The part of the head from texel `first` on: (least, most, standard) of each parameter; for the mixture
    and each table (number of axes, place of the first, texels of a node); and for each of their axes what
    _place_nodes gives, with the number of the parameter."""
    names = [parameter.name for parameter in model.parameters]
    ranges = [(each.least, each.most, each.standard, 0) for each in model.parameters]
    owned, listed = [], []
    for axes, size in zip(owners, sizes, strict=True):
        owned.append((len(axes), first + len(names) + len(owners) + len(listed), size, 0))
        for axis in axes:
            nodes = _place_nodes(append, np.float32(axis.nodes).astype(float))
            listed.append((*nodes[:3], names.index(axis.name)))
    return np.array([*ranges, *owned, *listed], float)


def _place_nodes(append: Callable[[Array], int], nodes: Array) -> tuple[float, ...]:
    """(place of the appended nodes, their number, texels of their tree, 0)"""
    return append(_nodes(nodes)), len(nodes), _tree_size(len(nodes) - 2), 0


def _columns(table: Table) -> tuple[Array, Array]:
    """(smaller tail at the nearer knot, width in u) of the cells of half a row."""
    half = table.width // 2
    m, _ = table.warp.knots(table.width)
    return m[:half], table.warp.widths(table.width)[:half]


def _cells(x: Array, d: Array, h: Array) -> Array:
    """(2 half, height, 4) of angles and slopes (height, width): nearer knot x0, width w, h dx/du at both
    ends; from the low end on, then from the high end on, where w and dx/du are negative. An odd number of
    cells has its middle one in both halves."""
    halves = []
    for sign, angles, slopes in ((1.0, x, d), (-1.0, x[:, ::-1], d[:, ::-1])):
        near, far = angles[:, : len(h)], angles[:, 1 : len(h) + 1]
        width = (far - near).astype(np.float32).astype(float)
        ends = [
            sign * np.clip(h * slope, abs(width) / STEEPEST, abs(width) * STEEPEST)
            for slope in (slopes[:, : len(h)], slopes[:, 1 : len(h) + 1])
        ]
        halves.append(np.stack([near, width, *ends], axis=-1).swapaxes(0, 1))
    return np.concatenate(halves)


def _axis(table: Table, first: int) -> Array:
    """(3, 4) the numbers to read a table by: (first texel, columns, height, texels of a row's tree),
    (theta_r of row 0, rows per radian, domain), (e, scale, origin, azimuth): the folded column of
    m = min(u, 1-u) is F(m + e) scale - origin."""
    low, high = np.float32(table.theta_r_range).astype(float)  # the floats that a reader in C would be given
    e = float(np.float32(table.warp.e))
    f0, k = Warp(table.warp.name, e).scale(table.width)
    return np.array(
        [
            [first, table.width, table.height, _tree_size(table.width - 2)],
            [low, (table.height - 1) / (high - low), *np.float32(table.domain)],
            [e, 1 / k, f0 / k, AZIMUTHS.get(table.azimuth, 0.0)],
        ]
    )


def _nodes(x: Array) -> Array:
    """(node, 1 / gap) for each gap between the nodes x, then the tree of the inner ones. A single node has
    one gap, in which nothing changes."""
    x = np.asarray(x, float)
    gaps = np.zeros((max(len(x) - 1, 1), 4))
    gaps[:, 0] = x[: len(gaps)]
    gaps[:, 1] = 1 / np.diff(x) if len(x) > 1 else 0.0
    inner = x[1:-1][None]
    return np.concatenate([gaps, _trees(inner, inner)])


def _values(share: Array, turn: Array) -> Array:
    """(gaps of theta_r, gaps of the offset, K, 2, 4) for each gap and lobe: the shares at its lower offset,
    of both theta_r, and at its upper offset, of sum 1; the turn at the lower theta_r and the shorter arc from
    there to the upper one, at its lower offset, and at its upper offset."""
    share, turn = (
        np.asarray(values, float).transpose(1, 2, 0) for values in (share / share.sum(axis=0), turn)
    )
    (below, above), (turn_below, turn_above) = _sides(share), _sides(turn)
    low, high = zip(*(_sides(part.swapaxes(0, 1)) for part in (below, above)), strict=True)
    shares = [part.swapaxes(0, 1) for part in (*low, *high)]
    turns = []
    for part in (turn_below, wrap(turn_above - turn_below)):
        turns.append([side.swapaxes(0, 1) for side in _sides(wrap(part).swapaxes(0, 1))])
    (from_low, from_high), (arc_low, arc_high) = turns
    pairs = np.stack(shares, axis=-1), np.stack([from_low, arc_low, from_high, arc_high], axis=-1)
    return np.stack(pairs, axis=-2)


def _sides(values: Array) -> tuple[Array, Array]:
    """The values at the lower and at the upper end of each gap along the first axis."""
    return (values, values) if len(values) == 1 else (values[:-1], values[1:])


def _tree_size(keys: int) -> int:
    """Texels of a tree of so many keys: all of its leaves are at one depth."""
    size = 0
    while 2 * size < keys:
        size = 3 * size + 1
    return size


def _trees(row: Array, above: Array) -> Array:
    """(R * size, 4) a search tree for each of R rows of keys (R, n), and for the rows above them. Node k has
    two keys of the row, the same two of the row above, and the nodes 3k + 1 to 3k + 3 below it; behind a leaf
    is the number of keys that are at most x."""
    size = _tree_size(row.shape[1])
    first, second = _order(size)
    filled = [
        np.pad(keys, ((0, 0), (0, 2 * size - keys.shape[1])), constant_values=LARGEST)
        for keys in (row, above)
    ]
    texels = [keys[:, at] for keys in filled for at in (first, second)]
    return np.stack(texels, axis=-1).reshape(-1, 4)


def _order(size: int) -> tuple[Array, Array]:
    """(size,) which of the 2 size sorted keys a node's first and second are."""
    first, second, nodes, leaves = [], [], 1, 2 * size + 1
    while leaves > 1:
        third = leaves // 3
        start = np.arange(nodes) * leaves
        first.append(start + third - 1)
        second.append(start + 2 * third - 1)
        nodes, leaves = 3 * nodes, third
    none = [np.zeros(0, int)]
    return np.concatenate(none + first), np.concatenate(none + second)

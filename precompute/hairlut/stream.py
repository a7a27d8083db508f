# SPDX-License-Identifier: BSD-3-Clause
"""A model as one stream of texels of four floats, as the shaders read it (runtime/shaders/README.md).

Everything a shader would derive from a table is in it: cells of two knots and slopes, what depends on the
column alone, a search tree for each row, and the mixture. Positions inside a stream are relative to its first
texel, so that several models can follow each other in one texture or buffer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .errors import HairlutError
from .lobes import Array
from .mixture import wrap
from .warp import Warp

if TYPE_CHECKING:
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
    axes = [table for lobe in model.lobes for table in (lobe.theta, lobe.phi)]
    head = np.zeros((HEAD + AXIS * len(axes), 4))
    parts, length = [head], len(head)

    def append(texels: Array) -> int:
        nonlocal length
        parts.append(texels.reshape(-1, 4))
        length += len(parts[-1])
        return length - len(parts[-1])

    mixture = model.mixture
    theta_r, offset = (
        np.float32(nodes).astype(float) for nodes in (mixture.theta_r, mixture.offset)
    )  # as in C
    head[1, :3] = append(_nodes(theta_r)), len(theta_r), _tree_size(len(theta_r) - 2)
    arc = np.arcsin(offset)
    head[2, :3] = append(_nodes(arc)), len(arc), _tree_size(len(arc) - 2)
    head[0] = len(model.lobes), mixture.mirrored, append(_values(mixture.share, mixture.turn)), 0
    placed: dict[bytes, int] = {}
    for k, table in enumerate(axes):
        if table is None:
            continue  # zeros: a uniform azimuth
        texels = table_texels(table)
        content = texels.tobytes()
        if content not in placed:
            placed[content] = append(texels)
        head[HEAD + AXIS * k : HEAD + AXIS * (k + 1)] = _axis(table, placed[content])
    if length > MOST:
        raise HairlutError(
            f"model {model.name}: {length} texels, expected at most {MOST}: use smaller tables"
        )
    head[0, 3] = length
    parts.append(np.zeros((-length % WIDTH, 4)))
    return np.concatenate(parts).astype(np.float32)


def table_texels(table: Table) -> Array:
    """(n, 4) of one table: a texel for each folded column, the cells, the search trees."""
    u, h = _columns(table)
    knots = np.stack([u, 1 / h, h, np.zeros_like(u)], axis=1)
    rows = np.asarray(table.texels, float)
    return np.concatenate([knots, _cells(table, h).reshape(-1, 4), _trees(rows[:-1, 1:-1], rows[1:, 1:-1])])


def _columns(table: Table) -> tuple[Array, Array]:
    """(smaller tail at the nearer knot, width in u) of the cells of half a row."""
    half = table.width // 2
    m, _ = table.warp.knots(table.width)
    return m[:half], table.warp.widths(table.width)[:half]


def _cells(table: Table, h: Array) -> Array:
    """(2 half, height, 4) nearer knot x0, width w, h dx/du at both ends; from the low end on, then from the
    high end on, where w and dx/du are negative. An odd number of cells has its middle one in both halves."""
    x, d = (np.asarray(part, float) for part in (table.texels, table.slopes))
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

# SPDX-License-Identifier: BSD-3-Clause
"""A mixture: each lobe's share, and its turn around the fibre, over theta_r and the offset of the hit.

Between nodes both are linear in theta_r and in asin(offset); outside them the nearest node's value continues.
Turns are blended along the shorter arc, first between the rows of theta_r, then between the offsets. Where
shares and turns depend on parameters of the hair, those of each theta_r and offset are blended over the
parameters' nodes first.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .axes import NO_PARAMETERS, Axis, between, check_axes, corners, numbers_of
from .errors import HairlutError
from .lobes import LOBE_NAME, MAX_LOBES, Array

MAX_TURN = 8 * np.pi
MAX_NODES = 4096  # of an axis
MAX_GRID = 2**18  # of all


@dataclass(frozen=True)
class Mixture:
    """K lobes over J nodes of theta_r and N of the offset.

    lobes     names, in order
    theta_r   (J,) rad, increasing; offset (N,) in [-1, 1], increasing; one node where nothing depends on it
    share     (K, ..., J, N) >= 0, in any unit, normalised at each node when they are read; ... has a
              dimension for each of the axes
    turn      (K, ..., J, N) rad, added to the azimuth that the lobe's table gives
    mirrored  whether the offsets are >= 0 and -h mirrors h: turned and relative azimuth negated
    axes      an axis of nodes for each of the hair's parameters on which shares or turns depend
    """

    lobes: tuple[str, ...]
    theta_r: Array
    offset: Array
    share: Array
    turn: Array
    mirrored: bool = False
    axes: tuple[Axis, ...] = ()

    def __post_init__(self) -> None:
        _check_names(self.lobes)
        _check_nodes("theta_r", self.theta_r, -2 * np.pi, 2 * np.pi)
        _check_nodes("offset", self.offset, 0.0 if self.mirrored else -1.0, 1.0)
        check_axes(self.axes)
        nodes = tuple(len(axis.nodes) for axis in self.axes)
        shape = len(self.lobes), *nodes, len(self.theta_r), len(self.offset)
        for name, values in (("share", self.share), ("turn", self.turn)):
            if values.shape != shape:
                order = ", ".join(["lobes", *(axis.name for axis in self.axes), "theta_r", "offset"])
                raise HairlutError(f"{name} has shape {values.shape}, expected ({order}) = {shape}")
        self._refuse("share", self.share, self.share >= 0, "0 or more")
        self._refuse("turn", self.turn, abs(self.turn) <= MAX_TURN, f"at most {MAX_TURN:.6g} rad in size")
        if not (self.share > 0).any(axis=0).all():
            place = np.argwhere(~(self.share > 0).any(axis=0))[0]
            raise HairlutError(f"share: all are 0 at {self._place(place)}: expected at least one above 0")

    def _refuse(self, name: str, values: Array, good: Array, expected: str) -> None:
        good = good & np.isfinite(values)
        if not good.all():
            k, *place = at = tuple(np.argwhere(~good)[0])
            where = f"{self.lobes[k]}.{name} is {values[at]} at {self._place(place)}"
            raise HairlutError(f"{where}: expected a number, {expected}")

    def _place(self, numbers: Sequence[int]) -> str:
        """A node, for an error."""
        named = [*((axis.name, axis.nodes) for axis in self.axes)]
        named += [("theta_r", self.theta_r), ("offset", self.offset)]
        return ", ".join(f"{name} = {nodes[k]:.6g}" for (name, nodes), k in zip(named, numbers, strict=True))

    def at(
        self, theta_r: Array, offset: Array = 0.0, parameters: Mapping[str, Array] = NO_PARAMETERS
    ) -> tuple[Array, Array, Array]:
        """(share (K, ...) of sum 1, turn (K, ...), side (...)) where theta_r, offset and the parameters
        broadcast to (...). parameters: a value for each axis, and perhaps more.

        side: -1 where the hair is mirrored, else 1: relative azimuth = side (azimuth of the table + turn).
        """
        given = [np.asarray(x, float) for x in (theta_r, offset)]
        given += [np.asarray(parameters[axis.name], float) for axis in self.axes if axis.name in parameters]
        theta_r, offset, *_ = np.broadcast_arrays(*given)
        side = np.where(self.mirrored & (offset < 0), -1.0, 1.0)
        place = np.arcsin(np.clip(abs(offset) if self.mirrored else offset, -1.0, 1.0))
        j, t = between(self.theta_r, theta_r)
        n, s = between(np.arcsin(self.offset), place)
        after_j, after_n = np.minimum(j + 1, len(self.theta_r) - 1), np.minimum(n + 1, len(self.offset) - 1)
        node, part = corners(self.axes, parameters, theta_r.shape)
        share, turn = (
            values.reshape(len(self.lobes), -1, *values.shape[-2:]) for values in self._normalised()
        )

        def shares(j: Array, n: Array) -> Array:
            return (part * share[:, node, j, n]).sum(axis=1)

        def turns(j: Array, n: Array) -> Array:
            return _blended_turns(part, turn[:, node, j, n])

        low, high = ((1 - t) * shares(j, k) + t * shares(after_j, k) for k in (n, after_n))
        share_at = (1 - s) * low + s * high
        low, high = (shorter_arc(turns(j, k), turns(after_j, k), t) for k in (n, after_n))
        return share_at, shorter_arc(low, high, s), side

    def parameters_at(self, parameters: Mapping[str, float]) -> Mixture:
        """The mixture at fixed parameters, without axes."""
        if not self.axes:
            return self
        node, part = corners(self.axes, parameters)
        grid = len(self.theta_r), len(self.offset)
        share, turn = (values.reshape(len(self.lobes), -1, *grid)[:, node] for values in self._normalised())
        part = part[:, None, None]
        turn = _blended_turns(part, turn)
        turn = np.where(abs(turn) > MAX_TURN, wrap(turn), turn)
        return replace(self, share=(part * share).sum(axis=1), turn=turn, axes=())

    def _normalised(self) -> tuple[Array, Array]:
        """(shares whose sum is 1 at each node, turns)"""
        return self.share / self.share.sum(axis=0), self.turn


def constant(lobes: tuple[str, ...], shares: Sequence[float] | None = None) -> Mixture:
    """A mixture with constant shares (None: equal ones) and no turns."""
    share = np.ones(len(lobes)) if shares is None else np.asarray(shares, float)
    share = (share / share.sum())[:, None, None]
    return Mixture(lobes, np.zeros(1), np.zeros(1), share, np.zeros_like(share))


def wrap(angle: Array) -> Array:
    """The angle in [-pi, pi)."""
    return (angle + np.pi) % (2 * np.pi) - np.pi


def shorter_arc(a: Array, b: Array, t: Array) -> Array:
    """The angle at the part t of the way from a to b along the shorter arc."""
    return a + t * wrap(b - a)


def _blended_turns(part: Array, turns: Array) -> Array:
    """(K, ...) of turns (K, 2^d, ...): the first, and of each other its part of the shorter arc from it."""
    first = turns[:, :1]
    return turns[:, 0] + (part * wrap(turns - first)).sum(axis=1)


def _check_names(lobes: tuple[str, ...]) -> None:
    if not 1 <= len(lobes) <= MAX_LOBES:
        raise HairlutError(f"{len(lobes)} lobes: expected 1 to {MAX_LOBES}")
    for name in lobes:
        if not re.fullmatch(LOBE_NAME, name):
            raise HairlutError(
                f"lobe {name!r}: expected a name of up to 31 of a-z, 0-9 and _, a letter first"
            )
    if len(set(lobes)) < len(lobes):
        raise HairlutError(f"lobes {' '.join(lobes)}: expected every name once")


def _check_nodes(name: str, nodes: Array, low: float, high: float) -> None:
    if not (nodes.ndim == 1 and 1 <= len(nodes) <= MAX_NODES):
        raise HairlutError(f"axis {name}: has shape {nodes.shape}, expected 1 to {MAX_NODES} numbers")
    inside = np.isfinite(nodes).all() and nodes[0] >= low and nodes[-1] <= high
    if not inside or not (np.diff(nodes) > 0).all():
        raise HairlutError(
            f"axis {name}: is {numbers_of(nodes)}, expected increasing numbers from {low:.6g} to {high:.6g}"
        )

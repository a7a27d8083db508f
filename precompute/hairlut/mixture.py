# SPDX-License-Identifier: BSD-3-Clause
"""A mixture: each lobe's share, and its turn around the fibre, over theta_r and the offset of the hit.

Between nodes both are linear in theta_r and in asin(offset); outside them the nearest node's value continues.
Turns are blended along the shorter arc, first between the rows of theta_r, then between the offsets.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .errors import HairlutError
from .lobes import LOBE_NAME, MAX_LOBES, Array

MAX_TURN = 8 * np.pi
MAX_NODES = 4096  # of an axis
MAX_GRID = 2**18  # of both


@dataclass(frozen=True)
class Mixture:
    """K lobes over J nodes of theta_r and N of the offset.

    lobes     names, in order
    theta_r   (J,) rad, increasing; offset (N,) in [-1, 1], increasing; one node where nothing depends on it
    share     (K, J, N) >= 0, in any unit: each node's sum is 1 where they are read
    turn      (K, J, N) rad, added to the azimuth that the lobe's table gives
    mirrored  whether the offsets are >= 0 and -h mirrors h: turned and relative azimuth negated
    """

    lobes: tuple[str, ...]
    theta_r: Array
    offset: Array
    share: Array
    turn: Array
    mirrored: bool = False

    def __post_init__(self) -> None:
        _check_names(self.lobes)
        _check_nodes("theta_r", self.theta_r, -2 * np.pi, 2 * np.pi)
        _check_nodes("offset", self.offset, 0.0 if self.mirrored else -1.0, 1.0)
        shape = len(self.lobes), len(self.theta_r), len(self.offset)
        for name, values in (("share", self.share), ("turn", self.turn)):
            if values.shape != shape:
                raise HairlutError(
                    f"{name} has shape {values.shape}, expected (lobes, theta_r, offset) = {shape}"
                )
        self._refuse("share", self.share, self.share >= 0, "0 or more")
        self._refuse("turn", self.turn, abs(self.turn) <= MAX_TURN, f"at most {MAX_TURN:.6g} rad in size")
        if not (self.share > 0).any(axis=0).all():
            j, n = np.argwhere(~(self.share > 0).any(axis=0))[0]
            raise HairlutError(
                f"share: all are 0 at theta_r = {self.theta_r[j]:.6g}, offset = {self.offset[n]:.6g}: "
                "expected at least one above 0"
            )

    def _refuse(self, name: str, values: Array, good: Array, expected: str) -> None:
        good = good & np.isfinite(values)
        if not good.all():
            k, j, n = np.argwhere(~good)[0]
            raise HairlutError(
                f"{self.lobes[k]}.{name} is {values[k, j, n]} at theta_r = {self.theta_r[j]:.6g}, "
                f"offset = {self.offset[n]:.6g}: expected a number, {expected}"
            )

    def at(self, theta_r: Array, offset: Array = 0.0) -> tuple[Array, Array, Array]:
        """(share (K, ...) of sum 1, turn (K, ...), side (...)) where theta_r and offset broadcast to (...).

        side: -1 where the hair is mirrored, else 1: relative azimuth = side (azimuth of the table + turn).
        """
        theta_r, offset = np.broadcast_arrays(np.asarray(theta_r, float), np.asarray(offset, float))
        side = np.where(self.mirrored & (offset < 0), -1.0, 1.0)
        place = np.arcsin(np.clip(abs(offset) if self.mirrored else offset, -1.0, 1.0))
        j, t = _between(self.theta_r, theta_r)
        n, s = _between(np.arcsin(self.offset), place)
        after_j, after_n = np.minimum(j + 1, len(self.theta_r) - 1), np.minimum(n + 1, len(self.offset) - 1)
        shares = self.share / self.share.sum(axis=0)
        low, high = ((1 - t) * shares[:, j, k] + t * shares[:, after_j, k] for k in (n, after_n))
        share = (1 - s) * low + s * high
        low, high = (shorter_arc(self.turn[:, j, k], self.turn[:, after_j, k], t) for k in (n, after_n))
        return share, shorter_arc(low, high, s), side


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


def _between(nodes: Array, x: Array) -> tuple[Array, Array]:
    """(node before x, part of the way to the next), x clamped to the nodes' range."""
    at = np.interp(x, nodes, np.arange(len(nodes)))
    i = np.clip(at.astype(int), 0, max(len(nodes) - 2, 0))
    return i, at - i


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
            f"axis {name}: is {numbers(nodes)}, expected increasing numbers from {low:.6g} to {high:.6g}"
        )


def numbers(values: Array) -> str:
    """The first few numbers, for an error."""
    text = " ".join(f"{x:.6g}" for x in values[:6])
    return f"{text} ..." if len(values) > 6 else text

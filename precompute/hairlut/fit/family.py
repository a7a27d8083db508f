"""A hair as a family of models over the offset at which a fibre is hit.

At one offset a fibre's highlights are narrow in azimuth, and they stand elsewhere than at the next. Tables
have no axis for it. But a highlight that moves around the fibre hardly changes its shape, so K models are
drawn from with weights, each turned around the fibre by an angle of its own:

    q(theta_i, phi | theta_r, offset) = sum over k of w_k A_k(theta_i) B_k(phi - t_k)

The weights w_k and the turns t_k are numbers for each theta_r and offset, linear between two offsets in the
offset's angle asin(offset), by which highlights move. The inclinations A_k(theta_i | theta_r) and azimuths
B_k(phi | theta_r) are those of all offsets together; where an azimuth changes its shape over the offset, it
takes several, each for a part of the offsets. familyfit.py finds them all.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..errors import HairlutError
from ..lobes import Array
from ..tabulated import FLOOR
from .model import variance
from .offsets import OffsetData, even_azimuth
from .rows import fit_rows
from .turning import turned

LOBES = 3
"""A hair's first three highlights: reflection, transmission, and reflection inside."""
SHAPES = 1

MAX_LOBES = 8  # readers of a family reserve room for so many


@dataclass(frozen=True)
class Family:
    """data: cells of even azimuth; weight (N, J, K), summing to 1 over K; turn (N, J, K), rad, continuous
    along N and J; theta (J, K, n) and phi (S, J, K, m): cells' masses, each row summing to 1, the middle of
    phi's at pi, far from where a table is cut; shape (N,): which of the S azimuths an offset's lobes have."""

    data: OffsetData
    weight: Array
    turn: Array
    theta: Array
    phi: Array
    shape: Array

    def drawn(self, offset: float) -> Array:
        """(J, n, m) masses of the cells that tables of this family draw at an offset, with their floor."""
        return self._between(*nearness(self.data.offset, offset))

    def variance(self) -> Array:
        """(J,) relative variance of drawing directions where the offset is one of the data's: the mean over
        the light."""
        return self._mean([self.drawn(h) for h in self.data.offset])

    def variance_between(self) -> Array:
        """(J,) the same where each offset but the outermost is drawn as if it were none of the data's:
        what offsets between those of the data lose is less, as their neighbours lie half as far apart."""
        offset, last = self.data.offset, len(self.data.offset) - 1
        between = []
        for o, h in enumerate(offset):
            around = np.arange(len(offset)) != o if 0 < o < last else slice(None)
            between.append(self._at(around).drawn(h))
        return self._mean(between)

    def _at(self, offsets) -> Family:
        """The family of some of its offsets."""
        return Family(
            self.data.at_offsets(offsets),
            self.weight[offsets],
            self.turn[offsets],
            self.theta,
            self.phi,
            self.shape[offsets],
        )

    def _between(self, o: int, t: float) -> Array:
        """(J, n, m) as drawn(), at the part t of the way from the offset number o to the next."""
        weight, turn = ((1 - t) * part[o] + t * part[o + 1] for part in (self.weight, self.turn))
        one = self.data.at[0]
        theta = (1 - FLOOR) * self.theta + FLOOR * np.diff(one.theta_edges) / np.pi
        phi = (1 - FLOOR) * self.phi[self.shape[o + (t > 0.5)]] + FLOOR * one.even
        phi = turned(phi, turn)
        return np.einsum("jk,jkt,jkp->jtp", weight, theta, phi / phi.sum(axis=-1, keepdims=True))

    def _mean(self, drawn: list[Array]) -> Array:
        cost = [variance(one, cells) for one, cells in zip(self.data.at, drawn, strict=True)]
        return (self.data.share * cost).sum(axis=0)


def nearness(offset: Array, at: float) -> tuple[int, float]:
    """(o, t): `at` lies between offset[o] and offset[o+1], at the part t of the way in the offset's angle.
    Outside the range of offset (N,) it is taken to the nearest end."""
    angle = np.arcsin(offset)
    position = float(np.interp(np.arcsin(at), angle, np.arange(len(angle))))
    o = min(int(position), len(angle) - 2)
    return o, position - o


def fit_family(
    data: OffsetData,
    lobes: int = LOBES,
    shapes: int = SHAPES,
    report: Callable[[str, float], None] = lambda stage, share: None,
) -> Family:
    """Fits `lobes` lobes with `shapes` azimuths each, at most as many as offsets. report(stage, share done)
    is called now and then. HairlutError for numbers that make no family."""
    count = len(data.offset)
    if not 1 <= lobes <= MAX_LOBES:
        raise HairlutError(f"{lobes} lobes: expected 1 to {MAX_LOBES}")
    if not 1 <= shapes <= count:
        raise HairlutError(f"{shapes} azimuths for each lobe: expected 1 to {count}, the number of offsets")
    data = even_azimuth(data)
    shape = np.arange(count) * shapes // count
    found = fit_rows(data, lobes, shape, report)
    weight, turn, phi = (
        np.stack([part(row) for row in found], axis=1)
        for part in (lambda row: row.weight, lambda row: row.turn, lambda row: row.phi)
    )
    return Family(data, weight, turn, np.stack([row.theta for row in found]), phi, shape)

# SPDX-License-Identifier: BSD-3-Clause
"""The lobes of one theta_r: inclinations, azimuths, and their shares and turns at each offset.

At an offset h a hair's highlight stands elsewhere around the fibre than at the next, and hardly changes its
shape. So the light p(theta_i, phi | h) is drawn by

    q(theta_i, phi | h) = sum over k of s_k(h) A_k(theta_i) B_k(phi - t_k(h)).

First the azimuths are free at each offset (factor.py). Then each lobe's azimuths are laid upon each other
(turning.py), and all of s, A, B and t are improved together: the masses by multiplicative updates, the turns
by Gauss-Newton steps."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..lobes import Array
from .factor import FILL, LARGEST, POWER, TINY, excess, filled, products, update, variance
from .highlights import Highlight, highlights
from .turning import TWO_PI, track, turned

FIRST_SWEEPS, TRIAL_SWEEPS, SWEEPS = 60, 16, 16
SAME_SWEEPS = 10
MENDED = 10.0
"""The largest p / q that counts where only shares and turns move: a faint highlight that no shape has makes
larger ones, which no share can mend, and to the power of POWER they would decide all shares alone."""
FREE_STEPS = 10
FRESH = 0.02  # part of what the last theta_r lets expect that is replaced by the new one's light
FAINT = 1e-3  # a lobe of this share is half what was expected
PULL = 0.03
"""Part of the expected shapes that replaces each sweep's: where several sets of lobes draw the same light,
this keeps the one that the last theta_r has, and tables may blend their rows."""
LEAST_SHARE = 1e-7
STIFFNESS = 1e-5  # of turns along the offsets, and
NEAR = 1e-5  # of turns to the expected ones, relative to where the lobe moves most light
REACH = np.radians(20.0)  # how far a lobe may turn from what was expected
DAMPING = 0.7  # of a Gauss-Newton step, which is at most one cell long


@dataclass(frozen=True)
class Row:
    """The K lobes of one theta_r: theta (n, K) and phi (K, m) masses of cells, each lobe's of sum 1; share
    (N, K), of sum 1 at each offset; turn (N, K), rad."""

    theta: Array
    phi: Array
    share: Array
    turn: Array

    @property
    def azimuths(self) -> Array:
        """(N, K, m) shares of the lobes times their turned azimuths."""
        return self.share[..., None] * self.turned()

    def turned(self, by: float = 0.0) -> Array:
        """(N, K, m) the lobes' azimuths, turned, and turned further by an angle."""
        if not self.turn.any() and not by:
            return np.broadcast_to(self.phi, (len(self.turn), *self.phi.shape))
        return turned(self.phi[None], self.turn + by)

    def drawn(self) -> Array:
        """(N, n, m) masses of the cells that these lobes draw at each offset."""
        return np.matmul(self.theta, self.azimuths)

    def variance(self, mass: Array) -> float:
        """Mean over the offsets of the relative variance for the light mass (N, n, m)."""
        return float(variance(mass, self.drawn(), (1, 2)).mean())


def first_row(mass: Array, angle: Array, count: int, turning: bool) -> Row:
    """The lobes of the light mass (N, n, m), which sums to 1 at each offset, from nothing. angle (N,): of the
    offsets around the fibre, rad."""
    row = None
    for _ in range(count):
        row = one_more(row, mass, angle, turning)
    return row


def one_more(fewer: Row | None, mass: Array, angle: Array, turning: bool) -> Row:
    """As many lobes as `fewer` and one: the best of what comes from free products, from their highlights, and
    from giving a lobe of `fewer` two shapes."""
    count = 1 if fewer is None else fewer.share.shape[1] + 1
    theta, flat = products(_flat(mass), count)
    light, each = _by_offset(flat, len(mass))
    if not turning:
        return improved(_laid(theta, light, each, np.zeros(light.shape)), mass, angle, FIRST_SWEEPS, turning)
    shape = _strongest(light, each)
    turn = np.stack([track(each[:, k], light[:, k], shape[k]) for k in range(count)], axis=1)
    starts = [
        _laid(theta, light, each, turn),
        _of_highlights(highlights(theta, light[..., None] * each)[:count]),
        *([_split(fewer, mass)] if fewer is not None else []),
    ]
    tried = [improved(start, mass, angle, TRIAL_SWEEPS, turning) for start in starts]
    best = min(tried, key=lambda row: row.variance(mass))
    return improved(best, mass, angle, FIRST_SWEEPS - TRIAL_SWEEPS, turning)


def _split(row: Row, mass: Array) -> Row:
    """The row with two shapes for the lobe whose azimuth changes most over the offset."""
    flat = row.azimuths.transpose(1, 0, 2).reshape(row.share.shape[1], -1)
    _, flat = update(_flat(mass), row.theta, flat, FREE_STEPS, moving=False)
    light, each = _by_offset(flat, len(mass))
    each = turned(each, -row.turn)
    change = (light * variance(each, row.phi[None], 2)).sum(axis=0)
    k = int(change.argmax())
    shapes, amounts = products((light[:, k, None] * each[:, k]).T, 2)  # (m, 2), (2, N)
    amounts = np.maximum(amounts, TINY)
    part = amounts / amounts.sum(axis=0)
    share = np.concatenate([row.share, row.share[:, [k]] * part[1][:, None]], axis=1)
    share[:, k] *= part[0]
    phi = np.concatenate([row.phi, shapes[:, 1][None]])
    phi[k] = shapes[:, 0]
    theta = np.concatenate([row.theta, row.theta[:, [k]]], axis=1)
    return Row(theta, evened(phi), share, np.concatenate([row.turn, row.turn[:, [k]]], axis=1))


def _of_highlights(found: list[Highlight]) -> Row:
    """A lobe for each highlight."""
    azimuths = np.stack([one.light for one in found], axis=1)
    light = np.maximum(azimuths.sum(axis=2), TINY)
    turn = np.stack([one.turn for one in found], axis=1)
    return _laid(np.stack([one.theta for one in found], axis=1), light, azimuths / light[..., None], turn)


def next_row(expected: Row, mass: Array, angle: Array, turning: bool) -> Row:
    """The lobes of the light mass of the next theta_r, where the last ones let expect such."""
    return improved(_moved(expected, mass, turning, True), mass, angle, SWEEPS, turning, expected)


def same_shapes(expected: Row, mass: Array, angle: Array, turning: bool) -> Row:
    """Shares and turns for lobes that keep their shapes."""
    there = _moved(expected, mass, turning, False)
    return improved(there, mass, angle, SAME_SWEEPS, turning, there, shapes=False, largest=MENDED)


def _moved(expected: Row, mass: Array, turning: bool, moving: bool) -> Row:
    """The expected lobes with the shares that free azimuths have, and each lobe turned as a whole; moving:
    with free inclinations."""
    light = mass.sum(axis=(0, 2))[:, None] / len(mass)
    theta = (1 - FRESH) * expected.theta + FRESH * light if moving else expected.theta
    fresh = FRESH / len(expected.phi) * mass.sum(axis=1, keepdims=True)
    azimuths = (1 - FRESH) * expected.azimuths + fresh
    flat = azimuths.transpose(1, 0, 2).reshape(len(expected.phi), -1)
    _, flat = update(_flat(mass), theta, flat, FREE_STEPS, moving)
    share, each = _by_offset(flat, len(mass))
    turn = expected.turn + _further(each, share, expected) if turning and moving else expected.turn
    return replace(expected, share=share / share.sum(axis=1, keepdims=True), turn=turn)


def improved(
    row: Row,
    mass: Array,
    angle: Array,
    sweeps: int,
    turning: bool,
    expected: Row | None = None,
    shapes: bool = True,
    largest: float = LARGEST,
) -> Row:
    """The row after sweeps of updates for the light mass (N, n, m). turning: its turns move; shapes: its
    inclinations and azimuths do. expected: what a lobe without light keeps. largest: p / q that counts."""
    light = mass.sum(axis=(0, 2))[:, None] / len(mass)
    for sweep in range(sweeps):
        if turning and sweep % 2:
            row = replace(row, turn=stepped(row, mass, angle, expected))
        at = row.turned()
        azimuths = row.share[..., None] * at
        e = excess(mass, np.matmul(row.theta, azimuths), largest)
        gain = np.matmul(row.theta.T, e)  # (N, K, m)
        share = row.share * np.einsum("okm,okm->ok", gain, at) ** (1 / POWER)
        theta, phi = row.theta, row.phi
        if shapes:
            theta = np.einsum("onm,okm->nk", e, azimuths, optimize=True) / azimuths.sum(axis=(0, 2))
            theta = filled(row.theta * theta ** (1 / POWER), light)
            back = turned(gain, -row.turn) if row.turn.any() else gain  # turning back is turning's adjoint
            phi = (row.share[..., None] * back).sum(axis=0) / row.share.sum(axis=0)[:, None]
            phi = evened(row.phi * np.maximum(phi, 0) ** (1 / POWER))
            if expected is not None:
                known = (1 - PULL) * row.share.mean(axis=0) / (row.share.mean(axis=0) + FAINT)
                theta = known * theta + (1 - known) * expected.theta
                phi = known[:, None] * phi + (1 - known[:, None]) * expected.phi
        share = np.maximum(share, LEAST_SHARE)
        row = Row(theta, phi, share / share.sum(axis=1, keepdims=True), row.turn)
    return row


def stepped(row: Row, mass: Array, angle: Array, expected: Row | None) -> Array:
    """(N, K) turns after a Gauss-Newton step towards the least sum of (p - q)^2 / q. A turn that moves little
    light is held by its neighbours: along the offsets it bends little, and it is near the expected one."""
    cell = TWO_PI / row.phi.shape[1]
    q = row.drawn()
    weight = 1 / np.maximum(q, 1e-9 * q.max())
    slope = row.share[..., None] * (row.turned(cell / 2) - row.turned(-cell / 2)) / cell  # dq/dt over theta
    along = (np.matmul(row.theta.T, (mass - q) * weight) * slope).sum(axis=2)
    length = (np.matmul((row.theta**2).T, weight) * slope**2).sum(axis=2)
    step = np.clip(DAMPING * along / np.maximum(length, TINY), -cell, cell)
    turn = row.turn + step
    bend = _bend(angle)
    for k in range(turn.shape[1]):
        trust = length[:, k] / max(length[:, k].max(), TINY)
        normal = np.diag(trust + 1e-12) + STIFFNESS * bend
        right = trust * turn[:, k]
        if expected is not None:
            normal += NEAR * np.eye(len(angle))
            right = right + NEAR * expected.turn[:, k]
        turn[:, k] = np.linalg.solve(normal, right)
    return turn


def _bend(angle: Array) -> Array:
    """(N, N) the quadratic form of squared second differences along the angle."""
    count = len(angle)
    rows = np.zeros((max(count - 2, 0), count))
    for i in range(count - 2):
        before, after = angle[i + 1] - angle[i], angle[i + 2] - angle[i + 1]
        rows[i, i : i + 3] = np.array([1 / before, -1 / before - 1 / after, 1 / after]) * (before + after) / 2
    return rows.T @ rows


def _further(each: Array, light: Array, expected: Row) -> Array:
    """(K,) by how much the azimuths (N, K, m) are turned from the expected ones, all offsets together: at one
    offset alone, a faint lobe would jump to where another one is brighter."""
    m = each.shape[2]
    agreement = np.fft.rfft(each) * np.conj(np.fft.rfft(expected.turned()))
    agreement = np.fft.irfft((light[..., None] * agreement).sum(axis=0), m)
    reach = max(int(REACH * m / TWO_PI), 1)
    near = np.concatenate([agreement[..., -reach:], agreement[..., : reach + 1]], axis=-1)
    peak = (near.argmax(axis=-1) - reach) * (TWO_PI / m)
    mean = light.mean(axis=0)
    return peak * (mean / (mean + FAINT))


def _flat(mass: Array) -> Array:
    """(n, N m) of (N, n, m)."""
    return mass.transpose(1, 0, 2).reshape(mass.shape[1], -1)


def _by_offset(flat: Array, offsets: int) -> tuple[Array, Array]:
    """(N, K) light and (N, K, m) masses of sum 1 of the azimuths (K, N m)."""
    each = flat.reshape(len(flat), offsets, -1).transpose(1, 0, 2)
    light = np.maximum(each.sum(axis=2), TINY)
    return light, each / light[..., None]


def _laid(theta: Array, light: Array, each: Array, turn: Array) -> Row:
    """The row whose azimuths are the means of each, laid upon each other."""
    back = turned(each, -turn) if turn.any() else each
    return Row(
        theta, evened((light[..., None] * back).sum(axis=0)), light / light.sum(axis=1, keepdims=True), turn
    )


def _strongest(light: Array, each: Array) -> Array:
    """(K, m) the azimuths (N, K, m) where each lobe has most light, their mean direction turned to pi: far
    from where a table is cut."""
    found = each[light.argmax(axis=0), np.arange(light.shape[1])]
    middles = (np.arange(found.shape[1]) + 0.5) * (TWO_PI / found.shape[1])
    return turned(found, np.pi - np.angle(found @ np.exp(1j * middles)))


def evened(phi: Array) -> Array:
    """phi (K, m) of sum 1, a little of each even."""
    return (1 - FILL) * phi / np.maximum(phi.sum(axis=1, keepdims=True), TINY) + FILL / phi.shape[1]

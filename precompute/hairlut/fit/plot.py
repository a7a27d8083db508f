# SPDX-License-Identifier: BSD-3-Clause
"""A picture of a fit: the hair and its textures, their cost over the viewers, and where weights are large; of
one with parameters, the cost over each."""

from __future__ import annotations

import numpy as np

from .. import figures
from ..lobes import HALF_PI, Array
from . import promise
from .hair import Hair
from .refine import Fitted
from .strands.fit import FittedBox
from .turning import TWO_PI

VIEWERS = -60.0, 0.0, 60.0  # deg
OFFSET = 0.4  # of the viewers' light, and of the map
POINTS = 361, 360
FIREFLY = 10.0


def plot(hair: Hair, found: Fitted, title: str, kind: str = "png") -> bytes:
    """The picture as a file of this kind."""
    figure, axes = figures.new(2, len(VIEWERS) + 1, size=(14, 6), squeeze=False)
    theta_i = np.linspace(-HALF_PI + 1e-3, HALF_PI - 1e-3, POINTS[0])
    phi = (np.arange(POINTS[1]) + 0.5) * (TWO_PI / POINTS[1])
    offset = min(hair.angles(found.axes.offset), key=lambda angle: abs(np.sin(angle) - OFFSET))
    for column, degrees in enumerate(VIEWERS):
        p, q = _densities(hair, found, np.radians(degrees), np.sin(offset), theta_i, phi)
        _marginals(axes[:, column], theta_i, phi, p, q)
        axes[0, column].set_title(f"theta_r = {degrees:.0f} deg")
    axes[0, 0].legend(fontsize="small")
    _losses(axes[0, -1], found)
    _weights(axes[1, -1], theta_i, phi, p, q)
    figure.suptitle(
        f"{title}: offset {np.sin(offset):.2g}, relative variance {found.promised.variance.mean():.4f}"
    )
    return figures.encoded(figure, kind)


def _densities(
    hair: Hair, found: Fitted, theta_r: float, offset: float, theta_i: Array, phi: Array
) -> tuple[Array, Array]:
    """(n, m) of the hair, normalised, and of its textures."""
    theta_r = float(np.clip(theta_r, *hair.theta_r))
    p = np.broadcast_to(hair.density(theta_r, theta_i[:, None], phi, offset), (theta_i.size, phi.size))
    q = promise.drawn(found.model, theta_r, np.array([offset]), theta_i, phi)[0]
    return p * (q.sum() / max(p.sum(), 1e-300)), q


def _marginals(axes, theta_i: Array, phi: Array, p: Array, q: Array) -> None:
    for ax, name, x, over, step in (
        (axes[0], "theta_i", theta_i, 1, TWO_PI / phi.size),
        (axes[1], "phi", phi, 0, np.pi / theta_i.size),
    ):
        ax.fill_between(np.degrees(x), p.sum(axis=over) * step, color="0.85", label="hair")
        ax.plot(np.degrees(x), q.sum(axis=over) * step, color=figures.BLUE, label="textures")
        ax.set(xlabel=f"{name} [deg]", ylim=(0, None))
    axes[0].set_ylabel("density per rad")


def _losses(ax, found: Fitted) -> None:
    loss = found.promised
    order = np.argsort(loss.theta_r)
    ax.semilogy(np.degrees(loss.theta_r[order]), loss.variance.mean(axis=1)[order], ".", color=figures.BLUE)
    ax.semilogy(np.degrees(loss.theta_r[order]), loss.weight.max(axis=1)[order], ".", color=figures.RED)
    ax.set(xlabel="theta_r [deg]", title="variance (blue), largest weight (red)")


def _weights(ax, theta_i: Array, phi: Array, p: Array, q: Array) -> None:
    light = p / np.cos(theta_i)[:, None]
    weight = np.where(light > promise.BRIGHT * light.max(), p / np.maximum(q, 1e-300), np.nan)
    image = ax.pcolormesh(
        np.degrees(phi),
        np.degrees(theta_i),
        np.log10(weight),
        vmin=-1,
        vmax=np.log10(FIREFLY),
        cmap="cividis",
    )
    ax.set(xlabel="phi [deg]", ylabel="theta_i [deg]", title=f"log10 of the weight, {VIEWERS[-1]:.0f} deg")
    ax.figure.colorbar(image, ax=ax)


def plot_of_parameters(found: FittedBox, title: str, kind: str = "png") -> bytes:
    """V and the largest weight of each measured place, over each parameter and theta_r."""
    measured = found.measured
    columns = [(p.name, measured.parameters[:, i]) for i, p in enumerate(found.box.parameters)]
    columns.append(("theta_r [deg]", np.degrees(measured.theta_r)))
    figure, axes = figures.new(1, len(columns), size=(4 * len(columns), 4), squeeze=False)
    for ax, (name, x) in zip(axes[0], columns, strict=True):
        ax.semilogy(x, measured.variance.mean(axis=1), ".", color=figures.BLUE)
        ax.semilogy(x, measured.weight.max(axis=1), ".", color=figures.RED)
        ax.set(xlabel=name)
    axes[0, 0].set_title("variance (blue), largest weight (red)")
    figure.suptitle(f"{title}: relative variance {measured.variance.mean():.4f}")
    return figures.encoded(figure, kind)

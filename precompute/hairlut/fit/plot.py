"""A picture of a fit: the data's marginals, its masses and Gaussians, and what they cost at each theta_r."""

from __future__ import annotations

import numpy as np

from .. import figures
from .decompose import Split
from .files import HUGE, variances
from .model import Fit, cells

SHOWN = 4


def plot(fit: Fit, title: str) -> bytes:
    """The picture as PNG."""
    data = fit.data
    rows = np.unique(np.linspace(0, len(data.theta_r) - 1, SHOWN).round().astype(int))
    masses = fit.split.drawn(data)
    edges = data.theta_edges, data.phi_edges, data.theta_edges
    split = Split(
        fit.split.direct_weight,
        *(cells(g.mean, g.sigma, e) for g, e in zip(fit.gaussians, edges, strict=True)),
    )
    gaussians = split.drawn(data, floor=0.0)
    figure, axes = figures.new(2, len(rows) + 1, size=(3.2 * (len(rows) + 1), 5.6), squeeze=False)
    for column, j in enumerate(rows):
        for axis, name, edge, over in ((0, "theta_i", data.theta_edges, 1), (1, "phi", data.phi_edges, 0)):
            ax = axes[axis, column]
            middle, width = np.degrees((edge[1:] + edge[:-1]) / 2), np.diff(edge)
            ax.fill_between(middle, data.mass[j].sum(over) / width, step="mid", color="0.85", label="data")
            ax.plot(middle, masses[j].sum(over) / width, color=figures.BLUE, label="masses")
            ax.plot(middle, gaussians[j].sum(over) / width, color=figures.RED, ls="--", label="Gaussians")
            ax.set(
                xlabel=f"{name} [deg]",
                title=f"theta_r = {np.degrees(data.theta_r[j]):.3g} deg",
                ylim=(0, None),
            )
    axes[0, 0].set_ylabel("density per rad")
    axes[1, 0].set_ylabel("density per rad")
    axes[0, 0].legend(fontsize="small")
    _costs(fit, axes[0, -1])
    axes[1, -1].legend(*axes[0, -1].get_legend_handles_labels(), loc="upper center", frameon=False)
    axes[1, -1].axis("off")
    figure.suptitle(f"{title}, direct weight {fit.split.direct_weight:.2f}")
    return figures.encoded(figure)


def _costs(fit: Fit, ax) -> None:
    looks = ((figures.GREY, ":"), (figures.GREEN, "-."), (figures.BLUE, "-"), (figures.RED, "--"))
    for (name, values), (colour, style) in zip(variances(fit).items(), looks, strict=True):
        shown = np.clip(values, 1e-4, HUGE)
        ax.semilogy(np.degrees(fit.data.theta_r), shown, style, color=colour, label=name)
    ax.set(xlabel="theta_r [deg]", title="relative variance", ylim=(1e-4, HUGE))

"""What a fit leaves behind: a model of the data's own masses, one of Gaussians, and the numbers of both."""

from __future__ import annotations

import json
from io import BytesIO
from pathlib import Path

import numpy as np

from ..files import write_whole
from ..lobes import DIFFERENCE, DIRECT, DIRECT_PHI, MULTIPLE, Array
from .model import FAILS, Fit, GaussianFit

ROW_STEP = 5.0
HUGE = 1e3
ADVICE = {
    "gaussians": "Gaussians sample this data as well as its own masses: bake the TOML model.",
    "masses": "Gaussians cost this scene samples: bake the npz model, the data's own masses.",
}
LIMIT = 0.1
LIMIT_TEXT = (
    "No tables of this structure do much better: what is left is light whose inclination and azimuth depend "
    "on each other. If that comes from where the fibre is hit, fit a grid with offsets (hairlut fit --help); "
    "else fit a model for each part of it, or mix in another sampler."
)


def write_all(fit: Fit, folder: Path, name: str) -> tuple[Path, Path, Path]:
    """Writes NAME_masses.npz, NAME_gaussians.toml and NAME_fit.json into folder; their paths."""
    contents = {
        "_masses.npz": _npz(fit),
        "_gaussians.toml": toml(fit).encode(),
        "_fit.json": f"{json.dumps(summary(fit), indent=1)}\n".encode(),
    }
    return tuple(write_whole(folder / f"{name}{end}", data) for end, data in contents.items())


def _npz(fit: Fit) -> bytes:
    data, split = fit.data, fit.split
    weight = split.direct_weight
    arrays = {"azimuth": np.array(DIFFERENCE), f"{DIRECT}.share": weight, f"{MULTIPLE}.share": 1 - weight}
    for name, mass, edges in split.tables(data):
        arrays |= {f"{name}.edges": edges, f"{name}.theta_r": data.theta_r, f"{name}.mass": mass}
    file = BytesIO()
    np.savez_compressed(file, **arrays)
    return file.getvalue()


def toml(fit: Fit) -> str:
    """The Gaussians as a model file: the polynomials' values every ROW_STEP degrees of the data's range."""
    low, high = np.degrees(fit.data.theta_r[[0, -1]])
    steps = max(int(np.ceil((high - low) / ROW_STEP)), 1)
    theta_r = np.unique(np.linspace(low, high, steps + 1))
    weight = fit.split.direct_weight
    lines = [
        "# Gaussians fitted by hairlut fit; bake with: hairlut bake --model THIS_FILE",
        "",
        f'azimuth = "{DIFFERENCE}"',
        "",
        "[shares]",
        f"{DIRECT} = {weight:.6g}",
        f"{MULTIPLE} = {1 - weight:.6g}",
    ]
    for gaussian in fit.gaussians:
        lines += ["", f"[{gaussian.name}]", *_polynomials(gaussian), f"theta_r_deg = {_numbers(theta_r)}"]
        key = "mean_deg" if gaussian.name == DIRECT_PHI else "shift_deg"
        sigma = np.exp(np.polyval(gaussian.log_sigma, np.radians(theta_r)))
        lines += [
            f"{key} = {_numbers(np.degrees(np.polyval(gaussian.centre, np.radians(theta_r))))}",
            f"sigma_deg = {_numbers(np.degrees(sigma))}",
        ]
    return "\n".join(lines) + "\n"


def _polynomials(gaussian: GaussianFit) -> list[str]:
    what = "phi" if gaussian.name == DIRECT_PHI else "theta_i + theta_r"
    return [
        f"# mean of {what} [rad] = {_formula(gaussian.centre)}",
        f"# log(sigma / rad) = {_formula(gaussian.log_sigma)}, theta_r in rad",
    ]


def _formula(coefficients: Array) -> str:
    powers = range(len(coefficients) - 1, -1, -1)
    names = {0: "", 1: " theta_r"}
    terms = [f"{c:.6g}{names.get(p, f' theta_r^{p}')}" for c, p in zip(coefficients, powers, strict=True)]
    return " + ".join(reversed(terms))


def _numbers(values: Array) -> str:
    return "[" + ", ".join(f"{v:.6g}" for v in values) + "]"


def summary(fit: Fit) -> dict:
    """The fit as plain data."""
    data = fit.data
    return {
        "direct_weight": fit.split.direct_weight,
        "needed": fit.needed,
        "advice": advice(fit),
        "mean_relative_variance": {key: float(values.mean()) for key, values in variances(fit).items()},
        "rows": [
            {
                "theta_r_deg": float(np.degrees(data.theta_r[j])),
                "samples": None if np.isinf(data.samples[j]) else float(data.samples[j]),
                "relative_variance": {key: float(values[j]) for key, values in variances(fit).items()},
                "gaussians": {g.name: _row(g, j) for g in fit.gaussians},
            }
            for j in range(len(data.theta_r))
        ],
    }


def variances(fit: Fit) -> dict[str, Array]:
    """(J,) relative variances by what draws the data."""
    return {
        "uniform": fit.uniform,
        "marginals": fit.marginal,
        "masses": fit.masses,
        "gaussians": fit.gaussian,
    }


def _row(g: GaussianFit, j: int) -> dict:
    return {
        "mean_deg": float(np.degrees(g.mean[j])),
        "sigma_deg": float(np.degrees(g.sigma[j])),
        "r_squared": float(g.r_squared[j]),
        "relative_variance": float(g.variance[j]),
        "fails": why(g, j),
    }


def why(g: GaussianFit, j: int) -> str:
    """Why the Gaussian does not describe row j; empty where it does."""
    if g.variance[j] <= FAILS:
        return ""
    if g.peaks[j] > 1:
        return f"{g.peaks[j]} peaks"
    if abs(g.skewness[j]) > 0.5:
        return f"skewed ({g.skewness[j]:+.2f})"
    return "heavier tails" if g.r_squared[j] > 0.9 else "another shape"


def advice(fit: Fit) -> str:
    limit = f" {LIMIT_TEXT}" if fit.masses.mean() > LIMIT else ""
    return ADVICE[fit.needed] + limit


def text(fit: Fit) -> str:
    """The fit for a terminal."""
    data = fit.data
    lines = [
        f"share of the direct lobe: {fit.split.direct_weight:.4g}",
        "",
        "relative variance of drawing this data (0 is perfect, 1 costs twice the samples)",
        f"{'theta_r [deg]':>14} {'uniform':>10} {'marginals':>10} {'masses':>10} {'Gaussians':>10}",
    ]
    table = variances(fit).values()
    for j, theta_r in enumerate(np.degrees(data.theta_r)):
        lines.append(f"{theta_r:14.4g} " + " ".join(f"{_short(values[j]):>10}" for values in table))
    lines.append(f"{'all rows':>14} " + " ".join(f"{_short(values.mean()):>10}" for values in table))
    if data.noise.any():
        lines.append(f"of which the noise of finite samples makes about {_short(data.noise.mean())}")
    for g in fit.gaussians:
        failing = [
            f"{np.degrees(data.theta_r[j]):.3g} ({why(g, j)})" for j in range(len(data.theta_r)) if why(g, j)
        ]
        found = f"fails at theta_r [deg] = {', '.join(failing)}" if failing else "holds in every row"
        lines += [
            "",
            f"{g.name}: the Gaussian {found}",
            f"  R^2 from {g.r_squared.min():.4f} to {g.r_squared.max():.4f}",
        ]
        lines += ["  " + line.removeprefix("# ") for line in _polynomials(g)]
    return "\n".join([*lines, "", advice(fit)])


def _short(value: float) -> str:
    return f"> {HUGE:.0f}" if value > HUGE else f"{value:.4f}"

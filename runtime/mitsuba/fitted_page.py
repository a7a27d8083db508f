"""The page luts/report/fit.md and its pictures, from the numbers that fitted_hair.py measured.

.venv/bin/python runtime/mitsuba/fitted_page.py luts/report/fit.json
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import matplotlib
import numpy as np

from hairlut import modelfile
from hairlut.lobes import FITTED

matplotlib.use("Agg")
from matplotlib import pyplot

EXAMPLE = Path(__file__).resolve().parents[2] / "precompute" / "examples" / "wrapped_azimuth.py"
KINDS = ("uniform", "built-in tables", "tables fitted to it", "half tables, half its own", "its own")

PAGE = """# From any hair to its tables

`hairlut fit` turns samples or a grid of a scattering distribution into model files, `hairlut bake --model
FILE` turns those into textures, and the C library loads them as it loads the shipped ones:

    hairlut fit my_grid.npz --measure solid-angle --out fits
    hairlut bake --model fits/my_grid_masses.npz --size 96x37 --out baked
    hairlut_load("baked/my_grid_masses", &model)

These pages' numbers come from

    .venv/bin/python runtime/mitsuba/fitted_hair.py --out luts/report/fit.json
    .venv/bin/python runtime/mitsuba/fitted_page.py luts/report/fit.json

## A hair BSDF that nobody here wrote

Mitsuba's `hair` (Chiang et al. 2016) was evaluated on {grid}, averaged over the offset at which the fibre
is hit, fitted, and baked; then the plugin drew from the tables. Relative variance V of one draw's estimate
of the light that the fibre scatters towards the viewer; a sampler with V needs (1 + V) / (1 + V') times the
samples of one with V' where the light is constant, and V / V' times in general. The offset is random, as it
is within a pixel.

{constant}

In light with a bright window and a small lamp (the light itself makes most of this variance):

{contrasted}

Every mean agrees with that of the fitted tables within three standard errors of their difference, except
those marked *. {deviations}

A picture of {image}: one scattering found by BSDF sampling alone, in sky and lamps: variance of a pixel at
one sample, relative to the squared mean of the image.

{render}

## What the tables can and cannot do

{limits}

{verdict}

## Gaussians or masses?

`hairlut fit` fits both: (a) Gaussians with smooth mean and width, and (b) the data's own masses, split into
a direct part (a product of inclination and azimuth) and a multiple part (uniform azimuth), which
expectation maximisation finds. It prints the relative variance of each, where Gaussians fail and why
(peaks, skew, tails), and which one to bake. For all four hairs it says (b): the Gaussian's tails end where
this BSDF's do not, and a few enormous weights follow.

![brown hair, data and fits](fit_brown.png)

![blond hair, data and fits](fit_blond.png)

## Cut or wrapped

The built-in azimuth lobe is a Gaussian cut to one period; `precompute/examples/wrapped_azimuth.py` wraps it
around the circle. They differ where the lobe is broad: beyond 60 degrees. The wrapped density has no step
at phi = 0.

![cut and wrapped azimuth](fit_wrapped.png)
"""

LIMITS = """| hair | these tables | plain marginals | a model for each of 16 offsets |
|---|---|---|---|
{rows}

The first two columns are against the averaged BSDF: two tables and a mixture weight lose {lost}. The rest
of V above comes from the offset: at one offset this BSDF's highlights are narrow in azimuth and stand
elsewhere than at the next, and the tables, which have no axis for it, spread over all of them. A model for
each offset (the last column, by calculation) would take most of that away; which model to draw from would
be the caller's choice, as the mixture weight is. What then remains is in part that the light itself differs
between offsets, which the BSDF's own sampler keeps too: nearly all of it for black hair, a third for brown.
So the answer to "as well as the sampler that its authors derived by hand" is: yes for the rough hair, where
offsets blur; not for the others without a model for each offset, or half of the draws from the BSDF's own
sampler."""


def table(report: dict, light: str) -> str:
    """A row for each hair and viewer, a column for each sampler."""
    lines = ["| hair | theta_r | " + " | ".join(KINDS) + " |", "|---|---|" + "---|" * len(KINDS)]
    for name, hair in report.items():
        for row in hair["viewers"]:
            cells = [_cell(row, kind, light) for kind in KINDS]
            lines.append(f"| {name} | {row['theta_r_deg']:g} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _cell(row: dict, kind: str, light: str) -> str:
    return f"{row[kind][light]['relative_variance']:.3f}" + ("*" if deviates(row, kind, light) else "")


def deviates(row: dict, kind: str, light: str) -> bool:
    """Whether the mean is more than three standard errors from that of the fitted tables."""
    ours, other = row["tables fitted to it"][light], row[kind][light]
    return abs(ours["mean"] - other["mean"]) > 3 * np.hypot(ours["standard_error"], other["standard_error"])


def deviations(report: dict) -> str:
    found = [
        f"{name} at {row['theta_r_deg']:g} degrees, {kind}, {light}: "
        f"{row[kind][light]['mean'] / row['tables fitted to it'][light]['mean'] - 1:+.2%}"
        for name, hair in report.items()
        for row in hair["viewers"]
        for kind in KINDS
        for light in ("constant", "contrasted")
        if deviates(row, kind, light)
    ]
    count = sum(len(hair["viewers"]) for hair in report.values()) * 2 * (len(KINDS) - 1)
    return f"({count} comparisons; marked: {'; '.join(found) or 'none'}.)"


def renders(report: dict) -> str:
    lines = ["| hair | " + " | ".join(KINDS) + " |", "|---|" + "---|" * len(KINDS)]
    for name, hair in report.items():
        cells = [
            f"{hair['render'][k]['relative_variance']:.3f}, mean {hair['render'][k]['mean']:.4f} ± "
            f"{hair['render'][k]['standard_error']:.4f}"
            for k in KINDS
        ]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def limits(report: dict) -> str:
    predicted = {name: hair["predicted"] for name, hair in report.items()}
    rows = "\n".join(
        f"| {name} | {p['masses']:.4f} | {p['marginals']:.4f} | {p['per_offset']:.4f} |"
        for name, p in predicted.items()
    )
    low, high = (f(p["masses"] for p in predicted.values()) for f in (min, max))
    return LIMITS.format(rows=rows, lost=f"{low:.4f} to {high:.4f}")


def verdict(report: dict) -> str:
    """The moonshot, held against the numbers."""
    lines = []
    for name, hair in report.items():
        share = np.mean(
            [
                (1 + row["tables fitted to it"]["constant"]["relative_variance"])
                / (1 + row["its own"]["constant"]["relative_variance"])
                for row in hair["viewers"]
            ]
        )
        image = hair["render"]
        ratio = image["tables fitted to it"]["relative_variance"] / image["its own"]["relative_variance"]
        against = (
            image["tables fitted to it"]["relative_variance"] / image["built-in tables"]["relative_variance"]
        )
        seconds = sum(hair["seconds"].values())
        lines.append(
            f"- {name}: {seconds:.0f} s from BSDF to textures (the fit {hair['seconds']['fit']:.1f} s), "
            f"{hair['bytes'] / 1024:.0f} KB, direct weight {hair['direct_weight']:.2f}. "
            f"{share:.2f} times the samples of its own sampler in constant light; "
            f"in the picture {ratio:.2f} times its variance, {against:.2f} times that of the built-in tables."
        )
    return "\n".join(lines)


def picture(path: Path) -> None:
    """Cut and wrapped Gaussian in azimuth, side by side, at three viewer inclinations."""
    wrapped = modelfile.find(str(EXAMPLE)).direct_phi
    phi = np.linspace(0, 2 * np.pi, 721)
    figure, axes = pyplot.subplots(1, 3, figsize=(9.6, 2.8), sharey=True)
    for ax, degrees in zip(axes, (0, 60, 85), strict=True):
        for lobe, style, label in ((FITTED.direct_phi, "C3--", "cut"), (wrapped, "C0-", "wrapped")):
            density = np.exp(lobe.log_density(phi, np.full(1, np.radians(degrees))))
            ax.plot(np.degrees(phi), density / np.trapezoid(density, phi), style, label=label)
        ax.set(title=f"theta_r = {degrees} deg", xlabel="phi_i - phi_r [deg]", ylim=(0, None))
    axes[0].set_ylabel("density per rad")
    axes[0].legend()
    figure.tight_layout()
    figure.savefig(path, dpi=90, metadata={"Software": None})


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("numbers", type=Path, metavar="FILE.json")
    args = parser.parse_args()
    report = json.loads(args.numbers.read_text())
    page = PAGE.format(
        grid="18 theta_r x 64 theta_i x 72 phi x 16 offsets",
        image="64x48 pixels, 4000 strands",
        constant=table(report, "constant"),
        contrasted=table(report, "contrasted"),
        deviations=deviations(report),
        render=renders(report),
        limits=limits(report),
        verdict=verdict(report),
    )
    args.numbers.with_suffix(".md").write_text(page)
    picture(args.numbers.with_name("fit_wrapped.png"))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())

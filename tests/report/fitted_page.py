# SPDX-License-Identifier: BSD-3-Clause
"""The page pages/fit.md and its pictures, from the numbers that fitted_hair.py measured.

PYTHONPATH=tests .venv/bin/python -m report.fitted_page tests/report/pages/fit.json
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
from scipy.stats import norm

from hairlut import figures, modelfile
from hairlut.files import write_whole
from hairlut.fit.family import LOBES
from hairlut.lobes import FITTED
from report.fitted_hair import (
    BATCHES,
    GAMMA,
    IMAGE,
    LIGHTS,
    OWN,
    PHI,
    SPP,
    STRANDS,
    THETA_I,
    THETA_R,
    WEIGHED,
)
from report.hairscene.nearfield import LIT
from report.hairscene.offsets import FINE
from report.markdown import table
from report.places import ROOT

EXAMPLE = ROOT / "precompute" / "examples" / "wrapped_azimuth.py"
FAMILY, MODEL, ITS_OWN = "family over offsets", "one fitted model", "its own"
KINDS = ("uniform", "built-in tables", MODEL, FAMILY, "half tables, half its own", ITS_OWN)
ALPHA = 0.01
CLOSE = 1.05  # at most so many times the samples, or the variance at equal time, of the BSDF's own sampler

PAGE = """# From any hair to its tables

`hairlut fit` turns samples or a grid of a scattering distribution into model files, `hairlut bake --model
FILE` turns those into textures, and the C library loads them as it loads the shipped ones:

    hairlut fit my_grid.npz --measure solid-angle --out fits
    hairlut bake --model fits/my_grid_masses.npz --size 96x37 --out baked
    hairlut_load("baked/my_grid_masses", &model)

Most hair scatters differently where it is hit in the middle and near its rim. A grid with one more axis,
`offset`, becomes a family: a model for each highlight, and how strong it is and how far it is turned around
the fibre at each offset. A renderer draws from all of them:

    hairlut fit my_offsets.npz --measure solid-angle --out fits
    hairlut bake --model fits/my_offsets --size 96x37 --out baked/my_offsets
    hairlut_sample_components(lobes, 3, theta_r, phi_r, u_lobe, u_theta, u_phi)

The Mitsuba plugin does this with `family: baked/my_offsets`; `precompute/hairlut/familyfiles.py` has the file
format. These pages' numbers come from

    PYTHONPATH=tests .venv/bin/python -m report.fitted_hair --out tests/report/pages/fit.json
    PYTHONPATH=tests .venv/bin/python -m report.fitted_page tests/report/pages/fit.json

## A hair BSDF that nobody here wrote

Mitsuba's `hair` (Chiang et al. 2016) was evaluated on {grid}, fitted and baked: one model to its mean over
the offset, and a family of {lobes} lobes. Then the plugin drew from the tables. Relative
variance V of one draw's estimate of the light that the fibre scatters towards the viewer ({draws:,} draws);
a sampler with V needs (1 + V) / (1 + V') times the samples of one with V' where the light is constant, and
V / V' times in general. The offset is random, as it is within a pixel; what it changes of the light itself
no sampler of directions takes away. The viewers stand half-way between the grid's.

{constant}
In light with a bright window and a small lamp (the light itself makes most of this variance):

{contrasted}
A picture of {image}: one scattering found by BSDF sampling alone, in sky and lamps. Variance of a pixel at
one sample, relative to the squared mean of the image, with its standard error. The time is of the whole
picture, in processor time, relative to the BSDF's own sampler, which is Mitsuba's `hair` itself: the samplers
took turns, batch by batch, and the median is given with its quartiles.

{render}
## Verdict

"Tables fitted in seconds sample an arbitrary hair BSDF as well as the sampler its authors derived by hand":

{verdict}

{lines}
"Samples" and "picture" are relative to the BSDF's own sampler: samples needed in constant light, the mean
of the three viewers; variance of the picture, also multiplied by its time, with standard errors. Seconds are
of one core.

Largest weights, value over density relative to the light at the same offset, of all directions in which at
least {lit:g} of the brightest light goes (96 x 108 directions x 17 offsets, the largest of three viewers):

{weights}
A weight of w makes one draw count w times the mean: where it meets a lamp, that is a firefly.

## How many offsets, how many lobes

By calculation, without tables: V left by a family that is fitted to N offsets, even in the angle around the
fibre from its middle to its rim, and drawn from at {fine}. The last column is what no sampler takes away.

{offsets}
{lobes} lobes on {count_offsets} offsets are what this page's family has: hair has as many highlights of
different widths along the fibre. With one lobe less, two highlights share one, and what they make together is
no shape that turns with the offset. One lobe more finds nothing.

That is one BSDF, whose highlights keep their shapes. Where azimuths change theirs over the offset,
`hairlut fit --shapes-per-lobe` gives each lobe several (`tests/precompute/test_family.py` has such a hair).
The grid must resolve the highlights: what is narrower than its cells the tables do not know.

## Unbiased

The light was also found by a quadrature of the BSDF (exact to {quadrature:.0e}). Of {count} comparisons, at
a family-wise significance of {alpha:g} (Sidak: {limit:.2f} standard errors), {ours}

The engine's own sampler is not unbiased, which its share of the half-and-half draws inherits. Two things
are off in Mitsuba 3.9. pdf() takes log I0 from a series whose second term it halves: where the argument of
the Bessel function is above 12 the density (and the value) is up to 0.5 % too small, but draws are exact.
And all draws of the fourth lobe lie on theta_i = 0, where pdf() has no such mass ("atom" below). Taken as
they are, {plain} of its {own_count} means are off by more than that limit, the worst by {worst}. With the
density that the draws really have, in closed form (`hairscene/owndensity.py`), and without the atom,
{corrected}

{biases}
## What one model can and cannot do

{marginals}
This is against the mean over the offset: two tables and a mixture weight lose no more. The rest of its V
above comes from the offset: the tables, which have no axis for it, spread over all of its highlights.

## Gaussians or masses?

`hairlut fit` fits both to a grid without offsets: (a) Gaussians with smooth mean and width, and (b) the
data's own masses, split into a direct part (a product of inclination and azimuth) and a multiple part
(uniform azimuth), which expectation maximisation finds. It prints the relative variance of each, where
Gaussians fail and why (peaks, skew, tails), and which one to bake. For all four hairs it says (b): the
Gaussian's tails end where this BSDF's do not, and a few enormous weights follow.

![brown hair, data and fits](fit_brown.png)

![blond hair, data and fits](fit_blond.png)

![black hair, data and fits](fit_black.png)

![rough hair, data and fits](fit_rough.png)

## Cut or wrapped

The built-in azimuth lobe is a Gaussian cut to one period; `precompute/examples/wrapped_azimuth.py` wraps it
around the circle. They differ where the lobe is broad: beyond 60 degrees. The wrapped density has no step
at phi = 0.

![cut and wrapped azimuth](fit_wrapped.png)
"""

VERDICT = """At equal numbers of samples and at equal time, {answer}. "Yes" means that the
family over offsets needs at most {close:.0%} more samples than that sampler in constant light, and that its
picture has at most {close:.0%} more variance at equal time. Its picture takes {times} times as long. To fit
and bake takes {seconds} seconds of one core, to evaluate the BSDF on the grid before that {evaluate}. One
model for all offsets has {ones} times the variance of that sampler."""


def variances(hairs: dict, light: str) -> str:
    """A row for each hair and viewer, a column for each sampler."""
    rows = [
        [name, f"{row['theta_r_deg']:g}", *(f"{row[kind][light]['relative_variance']:.3f}" for kind in KINDS)]
        for name, hair in hairs.items()
        for row in hair["viewers"]
    ]
    return table(["hair", "theta_r", *KINDS], rows)


def renders(hairs: dict) -> str:
    rows = []
    for name, hair in hairs.items():
        image = hair["render"]
        rows.append([name])
        for kind in KINDS:
            low, high = image[kind]["time_quartiles"]
            rows[-1].append(
                f"{image[kind]['relative_variance']:.1f} ± {image[kind]['variance_error']:.1f}, "
                f"time {image[kind]['time']:.2f} ({low:.2f} to {high:.2f})"
            )
    return table(["hair", *KINDS], rows)


def deviation(row: dict, found: dict, light: str) -> float:
    """Standard errors by which a mean is off the quadrature; the quadrature's own error counts."""
    exact = row["light"][light]
    return (found["mean"] - exact["mean"]) / float(np.hypot(found["standard_error"], exact["error"]))


def deviations(hairs: dict, kinds, key: str = "") -> list[float]:
    """Of all hairs, viewers and lights; key: which of a sampler's results, if not its plain ones."""
    return [
        deviation(row, (row[kind][key] if key else row[kind])[light], light)
        for hair in hairs.values()
        for row in hair["viewers"]
        for kind in kinds
        for light in LIGHTS
    ]


def unbiased(hairs: dict) -> dict:
    """What the page says of means."""
    tables = deviations(hairs, [kind for kind in KINDS if kind not in OWN])
    plain, corrected = deviations(hairs, OWN), deviations(hairs, OWN, "corrected")
    count = len(tables) + len(plain) + len(corrected)
    limit = float(norm.isf((1 - (1 - ALPHA) ** (1 / count)) / 2))
    errors = [
        row["light"][k]["error"] / row["light"][k]["mean"]
        for h in hairs.values()
        for row in h["viewers"]
        for k in LIGHTS
    ]
    return {
        "count": count,
        "alpha": ALPHA,
        "limit": limit,
        "quadrature": max(errors),
        "ours": _agree(
            f"all {len(tables)} means of the four samplers that draw from tables or uniformly", tables, limit
        ),
        "plain": sum(abs(z) > limit for z in plain),
        "own_count": len(plain),
        "worst": f"{max(plain, key=abs):+.1f} standard errors",
        "corrected": _agree(f"all {len(corrected)} of these means", corrected, limit),
        "biases": biases(hairs),
    }


def _agree(what: str, found: list[float], limit: float) -> str:
    off = [z for z in found if abs(z) > limit]
    largest = f"the largest deviation is {max(found, key=abs):+.2f}"
    if off:
        return f"{what} agree with it but {len(off)}; {largest}."
    return f"{what} agree with it: {largest}, their mean square {np.mean(np.square(found)):.2f}."


def biases(hairs: dict) -> str:
    """Of the engine's own sampler: how far off its means are, as it is and corrected; the atom's share."""
    rows = []
    for name, hair in hairs.items():
        for row in hair["viewers"]:
            found = row[ITS_OWN]
            cells = [name, f"{row['theta_r_deg']:g}", f"{found['atom']:.2%}"]
            for light in LIGHTS:
                for result in (found, found["corrected"]):
                    off = result[light]["mean"] / row["light"][light]["mean"] - 1
                    cells.append(f"{off:+.2%} ({deviation(row, result[light], light):+.1f})")
            rows.append(cells)
    head = [f"{light}, {how}" for light in LIGHTS for how in ("as it is", "corrected")]
    return table(["hair", "theta_r", "atom", *head], rows)


def offsets(hairs: dict) -> str:
    rows = []
    for name, hair in hairs.items():
        found = hair["by_offset"]
        rows += [
            [name, count]
            + [f"{found['lobes'][k][count]:.4f}" for k in found["lobes"]]
            + [f"{found['none']:.4f}"]
            for count in next(iter(found["lobes"].values()))
        ]
    lobes = [f"{k} lobe{'s' if k != '1' else ''}" for k in next(iter(hairs.values()))["by_offset"]["lobes"]]
    return table(["hair", "N", *lobes, "drawn exactly"], rows)


def marginals(hairs: dict) -> str:
    found = {name: hair["predicted"] for name, hair in hairs.items()}
    rows = [[name, *(f"{v[key]:.4f}" for key in ("masses", "marginals"))] for name, v in found.items()]
    return table(["hair", "this model", "plain marginals"], rows)


def weights(hairs: dict) -> str:
    rows = [
        [name, *(f"{max(row[kind]['largest_weight'] for row in hair['viewers']):.1f}" for kind in WEIGHED)]
        for name, hair in hairs.items()
    ]
    return table(["hair", *WEIGHED], rows)


def samples(hair: dict, kind: str) -> float:
    """Times the samples of the BSDF's own sampler in constant light, mean over the viewers."""
    own = [row[ITS_OWN]["constant"]["relative_variance"] for row in hair["viewers"]]
    mine = [row[kind]["constant"]["relative_variance"] for row in hair["viewers"]]
    return float(np.mean([(1 + a) / (1 + b) for a, b in zip(mine, own, strict=True)]))


def in_picture(hair: dict, kind: str) -> tuple[float, float]:
    """Times the variance of the BSDF's own sampler in the picture, and the standard error of that."""
    mine, own = hair["render"][kind], hair["render"][ITS_OWN]
    ratio = mine["relative_variance"] / own["relative_variance"]
    parts = [r["variance_error"] / r["relative_variance"] for r in (mine, own)]
    return ratio, ratio * float(np.hypot(*parts))


def at_equal_time(hair: dict, kind: str) -> tuple[float, float]:
    """Times the variance of the BSDF's own sampler in the picture, at equal time; its standard error."""
    (ratio, error), image = in_picture(hair, kind), hair["render"][kind]
    time = image["time"]
    return ratio * time, ratio * time * float(np.hypot(error / ratio, image["time_error"] / time))


def verdict(hairs: dict) -> str:
    """The moonshot, held against the numbers."""
    met = {
        name: max(samples(hair, FAMILY), at_equal_time(hair, FAMILY)[0]) <= CLOSE
        for name, hair in hairs.items()
    }
    yes, no = ([name for name, m in met.items() if m is wanted] for wanted in (True, False))
    answer = f"yes, for {_all(yes, hairs)} hair" if yes else "no"
    missed = f", not for {', '.join(no)} hair" if yes and no else ""
    seconds = [hair["seconds"] for hair in hairs.values()]
    return VERDICT.format(
        answer=answer + missed,
        close=CLOSE - 1,
        times=_range([h["render"][FAMILY]["time"] for h in hairs.values()]),
        seconds=_range([s["family_fit"] + s["family_bake"] for s in seconds], 0),
        evaluate=_range([s["evaluate"] for s in seconds], 0),
        ones=_range([in_picture(h, MODEL)[0] for h in hairs.values()]),
    )


def _range(values: list[float], digits: int = 2) -> str:
    low, high = (f"{end(values):.{digits}f}" for end in (min, max))
    return low if low == high else f"{low} to {high}"


def _all(names: list[str], hairs: dict) -> str:
    listed = ", ".join(names)
    return f"all of {listed}" if len(names) == len(hairs) else listed


def lines(hairs: dict) -> str:
    """Numbers of each hair."""
    rows = []
    for name, hair in hairs.items():
        (image, error), seconds = in_picture(hair, FAMILY), hair["seconds"]
        timed, timed_error = at_equal_time(hair, FAMILY)
        one = in_picture(hair, MODEL)
        rows.append(
            [
                name,
                f"{samples(hair, FAMILY):.3f}",
                f"{image:.2f} ± {error:.2f}",
                f"{timed:.2f} ± {timed_error:.2f}",
                f"{seconds['evaluate']:.1f} + {seconds['family_fit']:.1f} + {seconds['family_bake']:.1f} s",
                f"{hair['bytes']['family'] / 1024:.0f} KB",
                f"{samples(hair, MODEL):.2f}",
                f"{one[0]:.2f} ± {one[1]:.2f}",
                f"{seconds['fit'] + seconds['bake']:.0f} s, {hair['bytes']['model'] / 1024:.0f} KB",
            ]
        )
    head = [
        "hair",
        "family: samples",
        "picture",
        "picture at equal time",
        "evaluate + fit + bake",
        "textures",
    ]
    return table([*head, "one model: samples", "picture", "fit and bake, textures"], rows)


def picture(path: Path) -> None:
    """Cut and wrapped Gaussian in azimuth, side by side, at three viewer inclinations."""
    wrapped = modelfile.find(str(EXAMPLE)).direct_phi
    phi = np.linspace(0, 2 * np.pi, 721)
    figure, axes = figures.new(1, 3, size=(9.6, 2.8), sharey=True)
    lobes = (FITTED.direct_phi, figures.RED, "--", "cut"), (wrapped, figures.BLUE, "-", "wrapped")
    for ax, degrees in zip(axes, (0, 60, 85), strict=True):
        for lobe, colour, style, label in lobes:
            density = np.exp(lobe.log_density(phi, np.full(1, np.radians(degrees))))
            ax.plot(np.degrees(phi), density / np.trapezoid(density, phi), style, color=colour, label=label)
        ax.set(title=f"theta_r = {degrees} deg", xlabel="phi_i - phi_r [deg]", ylim=(0, None))
    axes[0].set_ylabel("density per rad")
    axes[0].legend()
    figures.save(figure, path)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("numbers", type=Path, metavar="FILE.json")
    args = parser.parse_args()
    report = json.loads(args.numbers.read_text())
    hairs = report["hairs"]
    page = PAGE.format(
        grid=f"{len(THETA_R)} theta_r x {len(THETA_I)} theta_i x {len(PHI)} phi x {len(GAMMA)} offsets",
        image=f"{IMAGE[0]}x{IMAGE[1]} pixels, {STRANDS} strands, {SPP * BATCHES} samples a pixel",
        draws=report["draws"],
        constant=variances(hairs, "constant"),
        contrasted=variances(hairs, "contrasted"),
        render=renders(hairs),
        verdict=verdict(hairs),
        lines=lines(hairs),
        lobes=LOBES,
        count_offsets=len(GAMMA),
        fine=FINE,
        lit=LIT,
        weights=weights(hairs),
        offsets=offsets(hairs),
        marginals=marginals(hairs),
        **unbiased(hairs),
    )
    write_whole(args.numbers.with_suffix(".md"), page.encode())
    picture(args.numbers.with_name("fit_wrapped.png"))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())

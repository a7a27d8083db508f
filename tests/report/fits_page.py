# SPDX-License-Identifier: BSD-3-Clause
"""The page of fits.py's numbers: every hair beside the sampler of its authors, and the targets that it meets
or not."""

from __future__ import annotations

import numpy as np

from report.markdown import table

SAMPLES, WEIGHT, KILOBYTES, SECONDS, ROUGH_SECONDS = 1.02, 10.0, 256, 60.0, 20.0
FAR_VARIANCE, LAMPS = 0.01, 1.05
PROMISE = 0.25, 0.003

TEXT = """# Hairs that nobody here derived a sampler for

`hairlut fit` gets each hair as a function and nothing else. The numbers below are of its textures, read
through the C library, by a midpoint rule of 432 x 384 directions at 6 viewers between the rows and {offsets}
offsets: a quadrature that the fit has no part in. V is the relative variance of a draw whose offset is
known, the mean over the offsets. The largest weight is that of the brightest directions, above 1e-4 of the
peak of f cos(theta_i). Seconds are of one core, for evaluating, fitting, baking and measuring.

    make fits

"""


NEAR = f"""## Near field: Chiang et al. 2016

The authors' sampler chooses a lobe by its attenuation and draws both angles exactly; for one wavelength it is
perfect, so that 1 + V is what the textures cost. Targets: at most {SAMPLES} times its samples, weights up to
{WEIGHT:.0f}, promises within 25 % or 0.003 of V, textures of {KILOBYTES} KB, {SECONDS:.0f} s
({ROUGH_SECONDS:.0f} s for beta_m of 0.3 and more), and in a sky with a window and a small lamp at most
{LAMPS} times its variance, all viewers together. """


def page(results: dict[str, dict], weights: str = "") -> str:
    """The page in Markdown; weights: the part of weights.py."""
    near = {name: row for name, row in results.items() if "own" in row}
    far = {name: row for name, row in results.items() if "own" not in row}
    return TEXT.format(offsets=5) + _near(near) + _far(far) + _averaged(far) + _drawn(far) + weights


def _near(rows: dict[str, dict]) -> str:
    if not rows:
        return ""
    columns = (
        "hair: beta_m beta_n absorption",
        "samples, own = 1",
        "V",
        "worst viewer",
        "promised V",
        "weight",
        "own weight",
        "variance in lamps, own = 1",
        "samples in lamps, worst viewer",
        "lobes",
        "KB",
        "s",
        "misses",
    )
    shown = []
    for name, row in rows.items():
        own, v = row["own"], np.array(row["variance"])
        samples = (1 + np.array(row["lamps"])) / (1 + np.array(own["lamps"]))
        shown.append(
            (
                name.removeprefix("chiang "),
                f"{_samples(row):.4f}",
                f"{v.mean():.4f}",
                f"{v.max():.4f}",
                f"{row['promise']:.4f} ({row['promise_low']:.4f} to {row['promise_high']:.4f})",
                f"{row['weight']:.1f}",
                f"{own['weight']:.1f}",
                f"{_lamps(row):.3f}",
                f"{samples.max():.3f}",
                row["lobes"],
                f"{row['bytes'] / 1024:.0f}",
                f"{row['seconds']:.0f}",
                ", ".join(_near_misses(name, row)) or "none",
            )
        )
    missed = sum(bool(_near_misses(name, row)) for name, row in rows.items())
    met = f"{len(rows) - missed} of {len(rows)} hairs meet them all."
    return f"{NEAR}{met}\n\n{table(columns, shown)}\n"


def _samples(row: dict) -> float:
    return float((1 + np.mean(row["variance"])) / (1 + np.mean(row["own"]["variance"])))


def _lamps(row: dict) -> float:
    """Variance in lamps, all viewers together: where one sees no lamp, the own sampler has next to none."""
    return float(np.mean(row["lamps"]) / np.mean(row["own"]["lamps"]))


def _near_misses(name: str, row: dict) -> list[str]:
    rough = float(name.split()[1]) >= 0.3
    return [
        what
        for what, missed in (
            ("samples", _samples(row) > SAMPLES),
            ("weight", row["weight"] > WEIGHT),
            ("promise", not _kept(row)),
            ("size", row["bytes"] > KILOBYTES * 1024),
            ("time", row["seconds"] > (ROUGH_SECONDS if rough else SECONDS)),
            ("lamps", _lamps(row) > LAMPS),
        )
        if missed
    ]


def _kept(row: dict) -> bool:
    v = float(np.mean(row["variance"]))
    return abs(row["promise"] - v) <= max(PROMISE[0] * v, PROMISE[1])


def _far(rows: dict[str, dict]) -> str:
    if not rows:
        return ""
    columns = ("hair", "V", "worst viewer", "promised V", "weight", "lobes", "KB", "s", "misses")
    shown = []
    for name, row in rows.items():
        v = np.array(row["variance"])
        misses = [
            what
            for what, missed in (
                ("V", v.max() > FAR_VARIANCE),
                ("weight", row["weight"] > WEIGHT),
                ("promise", not _kept(row)),
            )
            if missed
        ]
        shown.append(
            (
                name,
                f"{v.mean():.4f}",
                f"{v.max():.4f}",
                f"{row['promise']:.4f}",
                f"{row['weight']:.1f}",
                row["lobes"],
                f"{row['bytes'] / 1024:.0f}",
                f"{row['seconds']:.0f}",
                ", ".join(misses) or "none",
            )
        )
    return (
        "## Far field\n\n"
        f"Targets: V of at most {FAR_VARIANCE} at every viewer, weights up to {WEIGHT:.0f}.\n\n"
        + table(columns, shown)
    )


AVERAGED = """
## A pixel wider than a fibre

A hair that is the mean over its offsets scatters what a pixel sees that is wider than the fibre. The authors'
sampler takes a random offset, then draws for it, and its estimate varies with the offset. The textures are
fitted to the mean itself, whose value the renderer must know (a table of it, or a far-field model). Samples
for the same error, authors = 1, all viewers together and the extremes of the viewers:

"""


DRAWN = """
## Huang et al. 2022, seen from afar

The authors' sampler follows a path through the fibre by drawing facets, chooses R, TT or TRT by what each
keeps of the light, and returns that light as a weight. It knows no density (Cycles returns 1 for it), and its
weights vary with absorption and with Fresnel's reflectance. The textures are fitted to f, and a draw of
theirs needs f of its direction, an integral that the authors' draw does without: fewer samples, but dearer
ones. Samples for the same error, authors = 1, all viewers together and the extremes of the viewers; theirs
are measured by 262,144 quasi-random draws a viewer:

"""


def _averaged(rows: dict[str, dict]) -> str:
    """Fits of averages over offsets beside draws at random offsets."""
    return _beside(AVERAGED, rows, "parts")


def _drawn(rows: dict[str, dict]) -> str:
    """Fits beside samplers that return weights."""
    return _beside(DRAWN, rows, "draws")


def _beside(text: str, rows: dict[str, dict], authors: str) -> str:
    shown = []
    for name, row in rows.items():
        if authors in row:
            cells = [name]
            for what in ("variance", "lamps"):
                ratio = (1 + np.array(row[what])) / (1 + np.array(row[authors][what]))
                together = (1 + np.mean(row[what])) / (1 + np.mean(row[authors][what]))
                cells.append(f"{together:.3f} ({ratio.min():.3f} to {ratio.max():.3f})")
            shown.append(tuple(cells))
    if not shown:
        return ""
    return text + table(("hair", "in constant light", "in a sky with a window and a lamp"), shown)

# SPDX-License-Identifier: BSD-3-Clause
"""hairlut beside its rivals, in Markdown: what `make bench` prints and the speed page shows."""

from dataclasses import dataclass

from bench.timing import ARRAYS, Times

from report.markdown import table

CALLS = (
    "vertex", "sample_hair", "pdf_hair", "sample_direct", "pdf_direct", "sample_multiple", "pdf_multiple",
)  # fmt: skip
RIVALS = {
    "floor": "the same tables, with constants",
    "hybrid": "hybrid",
    "plain": "closed form",
    "logistic hybrid": "logistic hybrid",
    "logistic": "logistic",
    "SLEEF": "closed form, SLEEF's erf",
    "Boost": "closed form, Boost.Math",
    "MKL": "closed form, MKL",
    "Box-Muller": "Box-Muller with rejection",
    "Chiang": "Chiang 2016, its own sampler",
}
HOW = {"one": "one at a time", "arrays": "over arrays"}
FORMS = {"one": ("one", "native"), "arrays": ARRAYS}
FLAGS = {
    "native": ", fastest flags",
    "arrays128": ", 128 bits",
    "arrays256": ", 256 bits",
    "arrays512": ", 512 bits",
}


@dataclass(frozen=True)
class Target:
    """How many times as fast as a rival a call has to be."""

    model: str
    call: str
    rival: str
    how: str
    factor: float


TARGETS = (
    Target("fitted", "vertex", "hybrid", "one", 1.5),
    Target("fitted", "vertex", "hybrid", "arrays", 1.0),
    Target("fitted", "sample_hair", "hybrid", "one", 1.7),
    Target("fitted", "sample_hair", "hybrid", "arrays", 1.2),
    Target("fitted", "pdf_hair", "hybrid", "one", 0.8),
    Target("fitted", "pdf_hair", "hybrid", "arrays", 0.9),
    Target("fitted", "pdf_direct", "hybrid", "one", 0.8),
    Target("fitted", "pdf_direct", "hybrid", "arrays", 0.9),
    Target("brown", "vertex", "Chiang", "one", 3.0),
    Target("brown", "vertex", "Chiang", "arrays", 3.0),
)


def report(times: Times) -> str:
    """Everything that one run measured."""
    heading = (
        f"Least times on one thread of {times.place}. In parentheses: times hairlut's; bold: the rival "
        f"is faster. A repeat took {times.interference():.0%} more than the least, in the median.\n"
    )
    parts = [
        heading,
        headline(times),
        targets(times),
        *(beside(times, model, how) for model in times.models() for how in HOW),
    ]
    return "\n".join(part for part in parts if part)


def headline(times: Times) -> str:
    """What a path vertex costs: the whole hair sampled, and the density of a direction that a light chose."""
    rows = []
    for model, rivals in (("fitted", ("hybrid", "plain", "logistic")), ("brown", ("Chiang",))):
        for how, label in HOW.items():
            ours = times.least(model, "vertex", "hairlut", how)
            if ours is None:
                continue
            rows.append((f"hairlut, {model}, {label}", f"{ours:.1f} ns", ""))
            for who in rivals:
                if theirs := times.fastest(model, "vertex", who, how):
                    rows.append((f"{RIVALS[who]}, {label}", f"{theirs:.1f} ns", faster(ours, theirs)))
    return table(("vertex", "time", "who is faster"), rows) if rows else ""


def faster(ours: float, theirs: float) -> str:
    if theirs >= ours:
        return f"hairlut, {theirs / ours:.1f} times"
    return f"**the rival, {ours / theirs:.1f} times**"


def targets(times: Times) -> str:
    """The targets, each met or not met, and what a program for these tables alone (floor.c) reaches."""
    rows = []
    for aim in TARGETS:
        ours = times.least(aim.model, aim.call, "hairlut", aim.how)
        theirs = times.fastest(aim.model, aim.call, aim.rival, aim.how)
        if ours and theirs:
            call = f"{aim.model}, {aim.call}, {HOW[aim.how]}"
            said = "met" if theirs / ours >= aim.factor else "**not met**"
            floor = times.least(aim.model, aim.call, "floor", aim.how)
            bound = f"{theirs / floor:.2f}" if floor else ""
            rows.append((call, RIVALS[aim.rival], f"{theirs / ours:.2f}", bound, aim.factor, said))
    names = ("call", "rival", "hairlut's speed relative to it", "with constants", "target", "")
    return table(names, rows) if rows else ""


def beside(times: Times, model: str, how: str) -> str:
    """A model's calls: hairlut's times, and those of every rival."""
    ours = {call: ns for call in CALLS if (ns := times.least(model, call, "hairlut", how))}
    if not ours:
        return ""
    rows = [("hairlut", *(f"{ns:.1f}" for ns in ours.values()))]
    narrower = [times.least(model, call, "hairlut", "avx2") for call in ours] if how == "arrays" else []
    if any(narrower):
        rows.append(("hairlut, AVX2", *(f"{ns:.1f}" for ns in narrower)))
    for who, label in RIVALS.items():
        for form in FORMS[how]:
            theirs = [times.least(model, call, who, form) for call in ours]
            if any(theirs):
                cells = (compared(ns, ours[call]) for call, ns in zip(ours, theirs, strict=True))
                rows.append((label + FLAGS.get(form, ""), *cells))
    return f"{model}, {HOW[how]}, ns\n\n" + table(("", *ours), rows)


def compared(theirs: float | None, ours: float) -> str:
    """A rival's time, and how many times hairlut's that is: bold where the rival is the faster one."""
    if theirs is None:
        return ""
    text = f"{theirs:.1f} ({theirs / ours:.2f})"
    return text if theirs >= ours else f"**{text}**"

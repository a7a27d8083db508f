# SPDX-License-Identifier: BSD-3-Clause
"""The pages of tests/report/pages/: speed, scale, hard cases, the study behind the design."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from report.markdown import table

PAGES = {
    "make report": (
        (
            "Speed",
            "speed.md",
            "whole calls beside their rivals; time and variance of a sample",
        ),
        ("Scale", "scale.md", "what more lobes, offsets, rows, columns and threads cost"),
        ("The size to ship", "sizes.md", "time, bytes and quasi-random error by the tolerance baked to"),
        ("Hard cases", "hard_cases.md", "the error of narrow, cut, split, flat and broken densities"),
        ("The study", "study.md", "why this warp, these cells, these ends: all alternatives"),
        (
            "Quasi-random numbers",
            "quasi.md",
            "lighting integrals with Sobol points, beside the exact inverse",
        ),
        ("Shaders", "shaders.md", "the same models in shaders, compared with C"),
        ("Explorer", "explorer.html", "lobes, samples and densities to play with, in a browser"),
    ),
    "make render": (
        ("From a BSDF to a lock", "own_hair.md", "a function becomes textures, and a rendered lock of hair"),
        ("Strands that all differ", "strands.md", "a lock, by one model and by one for each group"),
        ("Mitsuba", "variants.md", "what a picture costs with the C++ plugin and with the Dr.Jit BSDF"),
    ),
    "make fits": (
        ("Fitted hairs", "fit.md", "43 hairs as functions, fitted, beside the samplers of their authors"),
        ("Largest weights", "fit_weights.md", "what weights lobes can reach at all, and what fits reach"),
        ("One model for every strand", "parameters.md", "size against samples, at random parameters"),
        ("What parameters cost", "strand_cost.md", "the time of a call with parameters, beside one without"),
    ),
}
"""By the command that makes them: title, file, what the page shows."""

AFTER = """
`hairlut plot luts` draws each table.

![Time per sample against relative variance](speed_error.svg)

![A lobe, its texture, and samples drawn through it](lobe_and_texture.png)
"""


def index() -> str:
    """The page that leads to the others."""
    rows = [
        (f"[{title}]({name})", shows, f"`{command}`")
        for command, pages in PAGES.items()
        for title, name, shows in pages
    ]
    return "# Report\n\n" + table(("page", "what it shows", "made by"), rows) + AFTER


@contextmanager
def progress(title: str) -> Iterator[Callable[[str], None]]:
    """step(text) shows the current step on a terminal."""
    from rich.console import Console

    console = Console(stderr=True)
    with console.status(title) as status:
        yield lambda text: status.update(f"{title}: {text}")


def write(out: Path, luts: Path, bench: Path, parts: Iterable[str]) -> list[Path]:
    """Writes the index and the pages of the parts named, of those that __main__ lists."""
    out.mkdir(parents=True, exist_ok=True)
    pages = {
        "speed": _speed,
        "scale": _scale,
        "sizes": _sizes,
        "hard": _hard,
        "study": _study,
        "quasi": _quasi,
        "pictures": _pictures,
    }
    written = [page for part in parts for page in pages[part](out, luts, bench)]
    (out / "README.md").write_text(index())
    return [*written, out / "README.md"]


def _shipped(luts: Path) -> list:
    from hairlut import exr
    from hairlut.lobes import MODELS

    lobes = [lobe for model in MODELS.values() for lobe in model.lobes]
    return [(exr.read(luts / lobe.model / f"{lobe.name}.exr")[0], lobe) for lobe in lobes]


def _speed(out: Path, luts: Path, bench: Path) -> list[Path]:
    from bench import timing

    from report import bake_speed, speed

    with progress("speed") as step, TemporaryDirectory() as folder:
        step("baking every size")
        points = speed.bake_sizes(Path(folder) / "luts")
        step("timing")
        times = timing.measure(bench, Path(folder) / "luts", speed.NAMES, Path(folder) / "times.json")
    first = dict(list(speed.AXES.items())[:1])
    figures = [
        speed.draw(points, times, out / "speed_error.svg", first),
        speed.draw(points, times, out / "speed_error_axes.svg"),
    ]
    page = out / "speed.md"
    page.write_text(speed.page(points, times, bake_speed.section(bake_speed.compare(_shipped(luts)))))
    return [page, *figures]


def _scale(out: Path, luts: Path, bench: Path) -> list[Path]:
    from bench import timing

    from report import scale

    with progress("scale") as step, TemporaryDirectory() as folder:
        step("writing models")
        scale.write_models(Path(folder) / "luts")
        step("timing")
        times = timing.measure(bench, Path(folder) / "luts", scale.NAMES, Path(folder) / "times.json")
    page = out / "scale.md"
    page.write_text(scale.page(times))
    return [page]


def _sizes(out: Path, luts: Path, bench: Path) -> list[Path]:
    from bench import timing

    from report import sizes

    with progress("sizes") as step, TemporaryDirectory() as folder:
        step("baking")
        compared = sizes.sizes()
        for size in compared:
            sizes.write_model(Path(folder) / "luts", size)
        step("timing")
        times = timing.measure(bench, Path(folder) / "luts", sizes.NAMES, Path(folder) / "times.json")
        page = out / "sizes.md"
        page.write_text(sizes.page(compared, times, step))
    return [page]


def _quasi(out: Path, luts: Path, bench: Path) -> list[Path]:
    from report import quasi

    page, figure = out / "quasi.md", out / "quasi.svg"
    with progress("quasi-random numbers") as step:
        page.write_text(quasi.page(luts, figure, step))
    return [page, figure]


def _hard(out: Path, luts: Path, bench: Path) -> list[Path]:
    from report import hard

    with progress("hard cases") as step:
        outcomes = []
        for case in hard.CASES:
            step(case.name)
            outcomes.append(hard.attempt(case))
        draws = [end for baked, lobe in _shipped(luts) for end in hard.ends(baked, lobe)]
    page = out / "hard_cases.md"
    page.write_text(hard.page(outcomes, draws))
    return [page]


def _study(out: Path, luts: Path, bench: Path) -> list[Path]:
    from report import study_page

    with progress("study") as step:
        study_page.write(out, step)
    return [out / "study.md", out / "study_warps.svg", out / "study_sizes.svg"]


def _pictures(out: Path, luts: Path, bench: Path) -> list[Path]:
    from hairlut import exr
    from report import lobe_and_texture

    shown, _ = exr.read(luts / "fitted" / "direct_theta.exr")
    return [lobe_and_texture.draw(shown, out / "lobe_and_texture.png")]

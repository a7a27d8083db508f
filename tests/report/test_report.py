# SPDX-License-Identifier: BSD-3-Clause
"""The report's parts: pages with every row, figures that exist, and the bake's speed as a
ratio."""

import numpy as np
import pytest
from bench.timing import Times

from hairlut import exr
from hairlut.lobes import FITTED, MODELS
from hairlut.warp import Warp
from report import bake_speed, index, markdown, study
from report.places import PAGES, ROOT

matplotlib = pytest.importorskip("matplotlib", reason="figures need pip install 'precompute[report]'")

CURVED = study.RATIONAL


def shipped_tables(luts):
    return [
        (exr.read(luts / model.name / f"{lobe.name}.exr")[0], lobe)
        for model in MODELS.values()
        for lobe in model.lobes
    ]


def test_the_bake_is_fast_and_exact():
    """Six shipped tables within 0.5 s, 34 times faster than scipy's numerical inversion on an idle core."""
    from precompute.conftest import LUTS

    trials = [bake_speed.compare(shipped_tables(LUTS), rows=4) for _ in range(3)]
    ours, polynomial, truncnorm = (
        min(way, key=lambda baking: baking.seconds) for way in zip(*trials, strict=True)
    )
    assert ours.seconds < 0.5
    assert polynomial.seconds > 15 * ours.seconds  # loose: half of what an idle core shows
    assert ours.error <= 1e-12
    assert ours.error <= min(polynomial.error, truncnorm.error)


def test_index_leads_to_every_page():
    assert (PAGES / "README.md").read_text() == index()
    names = {page.name for page in PAGES.iterdir() if page.suffix in (".md", ".html")} - {"README.md"}
    assert all(f"]({name})" in index() for name in names), names


def test_markdown_table():
    assert markdown.table(("a", "b"), [(1, "x")]) == "| a | b |\n| --- | --- |\n| 1 | x |\n"


def test_speed_page_says_who_wins(tmp_path):
    from report import speed

    points = speed.bake_sizes(tmp_path / "sizes", (16,))
    assert (tmp_path / "sizes" / "octaves-16" / "mixture.exr").is_file()
    repeats = {
        "fitted/vertex/hairlut/one": [9.0, 10.0],
        "fitted/vertex/hybrid/one": [15.0, 19.0],
        "fitted/vertex/logistic/one": [3.0, 4.0],
        "fitted/sample_multiple/hybrid/one": [7.0],
        "octaves-16/sample_direct/hairlut/one": [2.5],
        "uniform-16/sample_direct/hairlut/one": [2.0],
        "octaves-16/sample_direct/hairlut/arrays": [1.0],
    }
    times = Times(repeats, "a processor", {"octaves-16": 8192})
    text = speed.page(points, times)
    assert "| hybrid, one at a time | 15.0 ns | hairlut, 1.7 times |" in text
    assert "| logistic, one at a time | 3.0 ns | **the rival, 3.0 times** |" in text
    assert "| octaves, rational quadratic cells | 16 | 2048 | 8192 |" in text
    assert "| 16x16, one at a time | 2.00 | 2.50 | +25% |" in text
    assert speed.draw(points, times, tmp_path / "figure.svg").stat().st_size > 5000


def test_the_page_of_sizes_says_which_is_the_fastest_that_meets_the_limits(monkeypatch):
    from report import quasi, sizes

    table = exr.read(ROOT / "luts" / "fitted" / "direct_theta.exr")[0]
    compared = [sizes.Size(title, title, (table,) * 3) for title in ("coarse", "V <= 2e-05", "fine")]
    errors = {"coarse": 1.3, "V <= 2e-05": 1.0, "fine": 1.0}
    monkeypatch.setattr(sizes.Size, "ratios", lambda size: dict.fromkeys(quasi.LIMITS, errors[size.title]))

    def said(one: dict[str, float]) -> str:
        repeats = {
            f"{title}/vertex/hairlut/{how}": [ns] for title, ns in one.items() for how in ("one", "arrays")
        }
        return sizes.page(compared, Times(repeats, "a processor"))

    assert "it is V <= 2e-05, as shipped." in said({"coarse": 1.0, "V <= 2e-05": 2.0, "fine": 3.0})
    assert "it is fine; V <= 2e-05, as shipped, takes 50% longer." in said(
        {"coarse": 1.0, "V <= 2e-05": 3.0, "fine": 2.0}
    )
    assert said({"coarse": 1.0, "V <= 2e-05": 2.0, "fine": 3.0}).count("| no |") == 1


def test_scale_page_fits_a_line(tmp_path):
    from report import scale

    scale.write_models(tmp_path, lobes=(1, 2), offsets=(1, 5), sides=(16,))
    assert {"lobes-1", "lobes-2", "offsets-5", "columns-16", "rows-16"} <= {
        each.name for each in tmp_path.iterdir()
    }
    repeats = {f"lobes-{k}/vertex/hairlut/one": [10.0 + 5 * k] for k in scale.LOBES}
    repeats |= {"fitted/vertex/hairlut/threads1": [8.0], "fitted/vertex/hairlut/threads2": [4.1]}
    text = scale.page(Times(repeats, "a processor", {f"lobes-{k}": 1000 * k for k in scale.LOBES}))
    assert "10.0 + 5.0 K" in text
    assert "| fitted | 2 | 8.2 | 1.95 |" in text


def test_plot_command_draws_a_file(tmp_path):
    from hairlut.cli import main
    from precompute.conftest import LUTS

    assert main(["plot", str(LUTS / "fitted" / "multiple_theta.exr"), "--out", str(tmp_path)]) == 0
    assert (tmp_path / "fitted_multiple_theta.png").stat().st_size > 20_000


# ---- the study's candidates
# -------------------------------------------------------------------------------------


@pytest.mark.parametrize("family", study.FAMILIES.values(), ids=study.FAMILIES.keys())
@pytest.mark.parametrize("e", [2.0**-10, 2.0**-18])
def test_candidate_warps_invert(family, e):
    warp, width = family(e), 33
    c = np.linspace(0, 16, 101)
    m = warp.unfold(c, width)
    assert m[0] == 0.0
    assert m[-1] == pytest.approx(0.5, rel=1e-12)
    assert (np.diff(m) > 0).all()
    assert warp.fold(m, width) == pytest.approx(c, abs=1e-6)
    i, f = warp.place(m, np.zeros(101, bool), width)
    assert warp.knots(width)[0][i] + f * warp.widths(width)[i] == pytest.approx(m, rel=1e-9)


def test_curved_cells_beat_the_best_warp_with_linear_ones():
    """The decision of the study, on the lobe that decides: one Gaussian in theta, at 64x64."""
    lobe = FITTED.direct_theta
    curved = study.best_of(study.octaves, lobe, 64, 64)[0]
    own = study.own_warp(lobe, 64, study.LINEAR, rounds=1)
    v_curved, v_linear = (
        study.result("", study.tabulate_any(lobe, 64, 64, warp), lobe, cell, False).errors.relative_variance
        for warp, cell in ((curved, CURVED), (own, study.LINEAR))
    )
    assert v_curved < 5e-5
    assert v_linear > 5e-4


def test_the_domains_end_costs_little_and_loses_nothing():
    results = {(r.candidate, r.lobe): r.errors for r in study.ends(32, 32)}
    for lobe in study.LOBES:
        label = f"{lobe.model}/{lobe.name}"
        full, cut = results["domain's end", label], results["2^-25 quantile", label]
        assert full.lost_mass == 0.0
        assert cut.lost_mass > 1e-8
        assert full.relative_variance <= 1.5 * cut.relative_variance + 5e-5


def test_uniform_is_the_worst_and_halves_go_flat():
    lobe = FITTED.direct_theta
    table = study.tabulate_any(lobe, 64, 64, Warp("uniform"))
    assert study.result("", table, lobe, study.LINEAR, False).errors.relative_variance > 0.1
    table = study.tabulate_any(lobe, 64, 64, study.octaves(2.0**-18))
    rounded = study.as_half(table.texels, lobe.domain)
    assert (np.diff(rounded, axis=1) <= 0).any()

# SPDX-License-Identifier: BSD-3-Clause
"""From a file that defines bsdf to textures whose promise an independent quadrature confirms."""

import json
import warnings
from pathlib import Path
from time import perf_counter

import numpy as np
import pytest

from hairlut import cli, exr
from hairlut.fit import effort as efforts
from hairlut.fit import hair, promise, refine

EXAMPLE = "precompute/examples/chiang2016.py"
BRIGHT = 1e-4

NEAR = """
import numpy as np
from shapes import highlight

def bsdf(theta_r, theta_i, phi, offset):
    gamma = np.arcsin(offset)
    share = 0.7 - 0.4 * abs(np.sin(gamma))
    narrow = highlight(theta_r, theta_i, -0.05, 0.12, phi - np.pi + 0.7 * gamma, 8.0)
    broad = highlight(theta_r, theta_i, 0.1, 0.4, phi + 2 * gamma, 8.0)
    return (share * narrow + (1 - share) * broad) / np.cos(theta_i)
"""
SHAPES = """
import numpy as np

def highlight(theta_r, theta_i, shift, sigma, phi, kappa):
    x = (theta_i + theta_r - shift) / sigma
    return 0.1 * np.exp(-0.5 * x * x) / sigma * np.exp(kappa * (np.cos(phi) - 1))
"""
FAR = """
import numpy as np
from shapes import highlight

def bsdf(theta_r, theta_i, phi):
    return (highlight(theta_r, theta_i, 0.0, 0.05, phi - np.pi, 8.0)
            + highlight(theta_r, theta_i, 0.0, 0.3, phi, 3.0)) / np.cos(theta_i)
"""


def fitted(folder, source):
    """The file of a BSDF, beside one that it may import."""
    (folder / "shapes.py").write_text(SHAPES)
    (folder / "hair.py").write_text(source)
    return folder / "hair.py"


def run(path, out, capsys, *options):
    assert cli.main(["fit", str(path), "--out", str(out), "--json", *options]) == cli.OK
    said = capsys.readouterr()
    return exr.read_model(out / path.stem), json.loads(said.out), said.err


def quadrature(model, bsdf, theta_r, offset, count=(720, 512)):
    """(V, largest weight) at one theta_r and offset, by a dense midpoint rule over the sphere."""
    n, m = count
    theta_i = ((np.arange(n) + 0.5) / n - 0.5) * np.pi
    phi = (np.arange(m) + 0.5) / m * 2 * np.pi
    f = bsdf(theta_r, theta_i[:, None], phi, offset)
    p = np.broadcast_to(f * np.cos(theta_i[:, None]) ** 2, (n, m))
    size = np.pi / n * 2 * np.pi / m
    p = p / (p.sum() * size)
    q = model.pdf(theta_r, 0.0, theta_i[:, None], phi, offset)
    assert q.sum() * size == pytest.approx(1, abs=2e-3)
    light = p / np.cos(theta_i[:, None])
    weight = np.where(light > BRIGHT * light.max(), p / q, 0)
    return float((p * p / q).sum() * size - 1), float(weight.max())


def function(path):
    """The bsdf that a file of these tests defines."""
    space = {}
    exec(
        compile(SHAPES + path.read_text().replace("from shapes import highlight", ""), str(path), "exec"),
        space,
    )
    bsdf = space["bsdf"]
    return lambda *at: bsdf(*at[: bsdf.__code__.co_argcount])


def test_a_near_field_hair_keeps_its_promise_between_nodes(tmp_path, capsys):
    path = fitted(tmp_path, NEAR)
    model, reported, err = run(path, tmp_path / "out", capsys)
    assert reported["lobes"] == 2
    assert reported["relative_variance"] < 0.01
    assert reported["largest_weight"] < 10
    assert model.mixture.mirrored
    bsdf = function(path)
    found = [quadrature(model, bsdf, t, h) for t in (-0.93, 0.111, 0.62) for h in (0.13, -0.47, 0.81)]
    variance, weight = np.mean([v for v, _ in found]), max(w for _, w in found)
    assert variance == pytest.approx(reported["relative_variance"], rel=0.25, abs=0.003)
    assert weight < 1.5 * reported["largest_weight"]
    assert "warning" not in err


def test_a_slow_function_is_fitted_within_its_budget(tmp_path, capsys):
    """At full effort its values alone take most of a minute."""
    slow = "import time\n" + NEAR.replace(
        "    return", "    time.sleep(2e-6 * np.size(narrow + broad))\n    return"
    )
    start = perf_counter()
    model, reported, _ = run(fitted(tmp_path, slow), tmp_path / "out", capsys, "--budget", "6")
    assert perf_counter() - start < 1.5 * 6 + 6
    assert reported["relative_variance"] < 0.05
    assert quadrature(model, function(fitted(tmp_path, NEAR)), 0.111, 0.3)[0] < 0.05


def test_textures_take_no_more_memory_than_they_may(tmp_path, capsys):
    """A quarter less than they would take; and what cannot be kept is said."""
    path = fitted(tmp_path, FAR)
    _, free, _ = run(path, tmp_path / "free", capsys)
    _, small, _ = run(path, tmp_path / "small", capsys, "--size", str(0.75 * free["bytes"] / 1024))
    assert small["bytes"] <= 0.75 * free["bytes"]
    assert small["relative_variance"] > free["relative_variance"]
    assert small["limits"] == []
    _, tiny, _ = run(path, tmp_path / "tiny", capsys, "--size", "1")
    assert "size" in tiny["limits"]
    assert not tiny["out_of_time"]


def test_a_fit_without_enough_time_says_what_limits_it(tmp_path, capsys):
    path = fitted(tmp_path, NEAR.replace("8.0", "2000.0"))
    assert cli.main(["fit", str(path), "--out", str(tmp_path / "out"), "--budget", "0.1"]) == cli.OK
    assert "stops short of the tolerance 0.01, for want of time (--budget); what limits it: " in (
        capsys.readouterr().out
    )
    assert exr.read_model(tmp_path / "out" / "hair").errors["mixture"]["relative_variance"] > 0.02


def test_the_less_time_the_coarser_the_first_cells():
    given = hair.of_density(lambda theta_r, theta_i, phi, offset: 1.1 + np.cos(phi + 2 * offset), True)
    paces = [efforts.Pace(10.0**-k, 1e-9) for k in (9, 7, 6, 5, 4)]
    chosen = [efforts.affordable(given, pace, 256, 60.0) for pace in paces]
    assert chosen[0] == efforts.EFFORTS[0]
    assert chosen[-1] == efforts.EFFORTS[-1]
    assert [efforts.EFFORTS.index(one) for one in chosen] == sorted(
        efforts.EFFORTS.index(one) for one in chosen
    )
    for pace, one in zip(paces[:-1], chosen, strict=False):
        assert efforts.seconds(given, pace, one, 256) < 30 or one == efforts.EFFORTS[-1]


def test_losses_are_measured_between_all_offsets(monkeypatch):
    """Lobes of a like shape that cross do so between two offsets, and V is large there alone."""
    seen = []

    def losses(model, density, theta_r, offset, count, random):
        seen.append(offset)
        return promise.Losses(theta_r, offset, np.zeros_like(offset), offset, offset)

    monkeypatch.setattr(promise, "losses", losses)
    given = hair.of_density(lambda theta_r, theta_i, phi, offset: 1.1 + np.cos(phi + 2 * offset), True)
    for count in (4, 11, 41):
        refine._losses(
            given, None, refine.Axes(37, count, 32, 8), efforts.EFFORTS[0], np.random.default_rng(0)
        )
        angle = given.angles(count)
        assert np.unique(seen[-1]) == pytest.approx(np.sin((angle[1:] + angle[:-1]) / 2))


def test_rounds_are_compared_at_the_same_places_and_promised_at_others(monkeypatch):
    given = hair.of_density(
        lambda theta_r, theta_i, phi, offset: np.exp(-8 * (theta_i + theta_r) ** 2 + np.cos(phi)), False
    )
    monkeypatch.setattr(refine, "limits", lambda found, tolerance: ["theta_r"])
    monkeypatch.setattr(refine, "_standing_out", lambda found, tolerance: {"theta_r": 1.5})
    monkeypatch.setitem(refine.LIMITS, "theta_r", 61)
    rounds, once = [], refine._fit_once

    def recorded(*given):
        rounds.append(once(*given))
        return rounds[-1]

    monkeypatch.setattr(refine, "_fit_once", recorded)
    found = refine.fit(given, "hair", 0.01, 1, 60.0, lambda stage, share: None)
    first, *more = [one.promised.theta_r for one in rounds]
    assert more
    assert all((theta_r == first).all() for theta_r in more)
    assert found.repeats > 1
    assert not np.isin(first, found.promised.theta_r).any()


def test_a_far_field_hair_takes_several_lobes_without_turns(tmp_path, capsys):
    path = fitted(tmp_path, FAR)
    model, reported, _ = run(path, tmp_path / "out", capsys)
    assert reported["lobes"] == 2
    assert not model.mixture.turn.any()
    assert len(model.mixture.offset) == 1
    for theta_r in (-1.2, 0.04, 0.7):
        variance, weight = quadrature(model, function(path), theta_r, 0.0)
        assert variance < 0.01
        assert weight < 10


def test_a_function_that_selects_elements_gets_full_arrays(tmp_path, capsys):
    text = FAR.replace(
        "    return (", "    back = phi > np.pi\n    theta_i[back] = theta_i[back]\n    return ("
    )
    _, reported, _ = run(fitted(tmp_path, text), tmp_path / "out", capsys, "--lobes", "2")
    assert reported["relative_variance"] < 0.01


def test_a_function_may_change_its_arguments_in_place(tmp_path, capsys):
    found = []
    for shifted in ("phi = phi - 0.7", "phi -= 0.7"):
        text = FAR.replace("    return (", f"    {shifted}\n    return (")
        found.append(run(fitted(tmp_path, text), tmp_path / "out", capsys, "--lobes", "2")[1])
    assert found[1]["relative_variance"] == pytest.approx(found[0]["relative_variance"])


@pytest.mark.parametrize(
    ("argument", "said"), [("offset", "a BSDF"), ("beta_m", "a BSDF, whose beta_m is the offset at which")]
)
def test_an_offset_of_another_name_is_pointed_out(tmp_path, capsys, argument, said):
    text = f"def bsdf(theta_r, theta_i, phi, {argument}):\n    return 2.0 + {argument} + 0 * theta_i\n"
    _, reported, _ = run(
        fitted(tmp_path, text), tmp_path / "out", capsys, "--tolerance", "0.5", "--lobes", "1"
    )
    assert reported["data"].startswith(said)
    assert ("whose" in reported["data"]) == (argument != "offset")


def test_the_number_of_lobes_can_be_fixed(tmp_path, capsys):
    model, reported, _ = run(fitted(tmp_path, FAR), tmp_path / "out", capsys, "--lobes", "1")
    assert reported["lobes"] == len(model.lobes) == 1
    assert reported["relative_variance"] > 0.2


def test_nothing_turns_where_only_shares_depend_on_the_offset(tmp_path, capsys):
    text = NEAR.replace(" + 0.7 * gamma", "").replace(" + 2 * gamma", "")
    model, reported, _ = run(fitted(tmp_path, text), tmp_path / "out", capsys)
    assert reported["relative_variance"] < 0.01
    assert not model.mixture.turn.any()
    assert np.ptp(model.mixture.share[0, 18]) > 0.2


def test_a_uniform_azimuth_takes_no_table(tmp_path, capsys):
    text = NEAR[: NEAR.index("def bsdf")] + (
        "def bsdf(theta_r, theta_i, phi):\n    return highlight(theta_r, theta_i, 0.0, 0.3, phi, 0.0)\n"
    )
    model, reported, _ = run(fitted(tmp_path, text), tmp_path / "out", capsys)
    assert reported["relative_variance"] < 0.01
    assert [lobe.phi for lobe in model.lobes] == [None]


def test_the_promise_is_in_the_header(tmp_path, capsys):
    model, reported, _ = run(fitted(tmp_path, FAR), tmp_path / "out", capsys)
    assert model.errors["mixture"]["relative_variance"] == pytest.approx(
        reported["relative_variance"], rel=1e-3
    )
    assert model.errors["mixture"]["largest_weight"] == pytest.approx(reported["largest_weight"], rel=1e-3)


@pytest.mark.parametrize(
    ("factor", "warned"),
    [
        ("np.cos(theta_i)", "have the cosine already"),
        ("9 * np.cos(theta_i)**0", "times the light that it receives"),
        ("1e300", "times the light that it receives"),
    ],
)
def test_a_likely_wrong_measure_is_said_and_the_model_still_written(tmp_path, capsys, factor, warned):
    text = f"""
import numpy as np
def bsdf(theta_r, theta_i, phi):
    half = (theta_i + theta_r) / 2
    return np.exp(-0.5 * (half / 0.15) ** 2) * np.exp(np.cos(phi)) / np.cos(half) * {factor}
"""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        _, _, err = run(fitted(tmp_path, text), tmp_path / "out", capsys)
    assert warned in err


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def bsdf(theta_r, theta_i):\n    return 1.0\n", "expected a function bsdf(theta_r, theta_i, phi)"),
        ("f = 1\n", "has no bsdf"),
        ("LOBES = ()\n", "it defines LOBES: hairlut bake --model"),
        ("def bsdf(theta_r, theta_i, phi):\n    pass\n", "bsdf returned None: expected real numbers"),
        ("def bsdf(theta_r, theta_i, phi):\n    return theta_i\n", "expected a finite number, 0 or more"),
        ("def bsdf(theta_r, theta_i, phi):\n    return [1.0, 2.0, 3.0]\n", "returned the shape"),
        ("import sys\nsys.exit()\n", "hair.py:2: calls sys.exit()"),
        ("def bsdf(theta_r, theta_i, phi):\n    return input()\n", "hair.py:2"),
        ("def bsdf(theta_r, theta_i, phi):\n    return 1 / 0\n", "hair.py:2: ZeroDivisionError"),
        ("def bsdf(theta_r, theta_i, phi):\n    return 0.0 * theta_i\n", "hair.py: f is 0 wherever it was"),
        (
            "def bsdf(theta_r, theta_i, phi):\n    return (theta_r < 0.5) + 0 * phi\n",
            "hair.py: f is 0 in all directions tried at theta_r = ",
        ),
        ("import math\ndef bsdf(theta_r, theta_i, phi):\n    return math.cos(phi)\n", "instead of math's"),
        ("def bsdf(theta_r, theta_i, phi):\n    return 1.0 if phi > 1 else 2.0\n", "use np.where, not if"),
    ],
)
def test_a_file_that_is_wrong_is_refused_in_one_line(tmp_path, capsys, text, expected):
    path = fitted(tmp_path, text)
    assert cli.main(["fit", str(path), "--out", str(tmp_path / "out")]) == cli.WRONG_USE
    said = capsys.readouterr().err
    assert expected in said
    assert "Traceback" not in said
    assert not (tmp_path / "out").exists()


def test_a_file_that_asks_shows_no_prompt(tmp_path, capsys):
    for text in (
        "def bsdf(theta_r, theta_i, phi):\n    return input('roughness? ')\n",
        "input('roughness? ')\n",
    ):
        path = fitted(tmp_path, text)
        assert cli.main(["fit", str(path), "--out", str(tmp_path / "out")]) == cli.WRONG_USE
        said = capsys.readouterr()
        assert "reads standard input" in said.err
        assert "roughness?" not in said.err + said.out


@pytest.mark.parametrize(
    "options",
    [
        ("--lobes", "9"),
        ("--lobes", "0"),
        ("--name", "a/b"),
        ("--name", "h\u00e4r"),
        ("--name", "x" * 64),
        ("--plot", "x.exe"),
        ("--tolerance", "0"),
        ("--budget", "nan"),
    ],
)
def test_options_that_make_no_sense_are_refused(tmp_path, capsys, options):
    path = fitted(tmp_path, FAR)
    assert cli.main(["fit", str(path), "--out", str(tmp_path / "out"), *options]) == cli.WRONG_USE
    assert options[0] in capsys.readouterr().err


def test_a_folder_that_cannot_be_written_is_refused_before_the_fit(tmp_path, capsys, monkeypatch):
    path = fitted(tmp_path, FAR)
    monkeypatch.setattr(refine, "fit", lambda *given: pytest.fail("fitted first"))
    for options in (("--out", str(path)), ("--out", str(tmp_path), "--plot", str(path / "a.png"))):
        assert cli.main(["fit", str(path), *options]) == cli.WRONG_USE
        assert f"cannot be written: {path} is not a directory" in capsys.readouterr().err


def test_the_example_from_the_paper_scatters_what_it_says():
    """Its M_p sums to 1 over the hemisphere, and its azimuth to 1 around the fibre."""
    space = {}
    exec(Path(EXAMPLE).read_text(), space)
    theta_i = (np.arange(4000) + 0.5) / 4000 * np.pi - np.pi / 2
    phi = (np.arange(4000) + 0.5) / 4000 * 2 * np.pi
    for v in (0.002, 0.05, 0.3):
        for theta_r in (-1.2, 0.0, 0.9):
            total = (space["longitudinal"](theta_i, theta_r, v) * np.cos(theta_i)).mean() * np.pi
            assert total == pytest.approx(1, abs=1e-3)
    assert space["azimuthal"](phi).mean() * 2 * np.pi == pytest.approx(1, abs=1e-6)

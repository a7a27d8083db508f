# SPDX-License-Identifier: BSD-3-Clause
"""From a file that defines bsdf over named parameters to one model whose textures draw it at all of them."""

import json
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from hairlut import cli, exr
from hairlut.axes import Parameter
from hairlut.fit import hair, lobesfit, turning
from hairlut.fit.strands import box, losses, nodemixture, nodes, nodeshapes, shapes, summary, tied

HAIR = """
import numpy as np

PARAMETERS = {"width": (0.1, 0.4), "mix": (0.0, 1.0, 0.6)}

def lobe(theta_r, theta_i, shift, sigma, phi, kappa):
    x = (theta_i + theta_r - shift) / sigma
    return 0.1 * np.exp(-0.5 * x * x) / sigma * np.exp(kappa * (np.cos(phi) - 1))

def bsdf(theta_r, theta_i, phi, width, mix):
    narrow = lobe(theta_r, theta_i, 0.0, width, phi - np.pi, 8.0)
    broad = lobe(theta_r, theta_i, 0.1, 0.6, phi, 3.0)
    return (mix * narrow + (1 - mix) * broad) / np.cos(theta_i)
"""


@pytest.fixture(scope="module")
def fitted(tmp_path_factory):
    folder = tmp_path_factory.mktemp("parameters")
    path = folder / "hair.py"
    path.write_text(HAIR)
    assert cli.main(["fit", str(path), "--out", str(folder), "--json", "--plot", str(folder / "a.png")]) == 0
    assert (folder / "a.png").stat().st_size > 1000
    return exr.read_model(folder / "hair")


@pytest.fixture(scope="module")
def bsdf():
    space = {}
    exec(HAIR, space)
    return space["bsdf"]


def variance(model, bsdf, theta_r, drawn, true, count=(480, 120)):
    """V of the model at some parameters for the hair at others, by a midpoint rule over the sphere."""
    n, m = count
    theta_i = (((np.arange(n) + 0.5) / n - 0.5) * np.pi)[:, None]
    phi = (np.arange(m) + 0.5) / m * 2 * np.pi
    p = bsdf(theta_r, theta_i, phi, *true) * np.cos(theta_i) ** 2
    q = model.pdf(theta_r, 0.0, theta_i, phi, 0.0, dict(zip(("width", "mix"), drawn, strict=True)))
    size = np.pi / n * 2 * np.pi / m
    assert q.sum() * size == pytest.approx(1, abs=2e-3)
    return float((p * p / q).sum() / p.sum() ** 2 / size - 1)


def test_a_table_has_only_the_axes_on_which_it_depends(fitted):
    assert [p.name for p in fitted.parameters] == ["width", "mix"]
    assert [p.standard for p in fitted.parameters] == [0.25, 0.6]
    axes = {table.name: [axis.name for axis in table.axes] for table in fitted.tables}
    theta = sorted(names for name, names in axes.items() if name.endswith("_theta"))
    assert theta == [[], ["width"]]
    assert all(names == [] for name, names in axes.items() if name.endswith("_phi"))
    assert "mix" in [axis.name for axis in fitted.mixture.axes]


def test_it_draws_the_hair_off_the_nodes(fitted, bsdf):
    random = np.random.default_rng(1)
    found = []
    for theta_r in random.uniform(-1.3, 1.3, 12):
        at = random.uniform(0.1, 0.4), random.uniform(0.0, 1.0)
        found.append(variance(fitted, bsdf, theta_r, at, at))
    assert np.mean(found) < 0.006
    assert max(found) < 0.015


@pytest.mark.parametrize(("drawn", "true"), [((0.2, 0.5), (0.15, 0.5)), ((0.2, 0.75), (0.2, 0.5))])
def test_a_wrong_parameter_costs_samples(fitted, bsdf, drawn, true):
    right, wrong = (variance(fitted, bsdf, 0.4, at, true) for at in (true, drawn))
    assert wrong > 10 * right


def test_the_promise_is_in_the_header(fitted):
    promised = fitted.errors["mixture"]
    assert promised["low"] < promised["relative_variance"] < promised["high"] < 0.006
    assert promised["median_relative_variance"] < promised["percentile99_relative_variance"]


NARROW = """
import numpy as np

PARAMETERS = {"width": (0.006, 0.03), "tilt": (-0.1, 0.1), "bend": (0.0, 0.2)}

def bsdf(theta_r, theta_i, phi, width, tilt, bend):
    x = theta_i + theta_r - 2 * tilt + bend * np.sin(theta_r) ** 3
    return 0.02 * np.exp(-0.5 * (x / width) ** 2) / width * np.exp(3 * (np.cos(phi) - 1)) / np.cos(theta_i)
"""


def test_a_narrow_highlight_keeps_to_the_size_and_is_warned_of(tmp_path, capsys):
    """It moves by many times its width from node to node, and at a corner beyond the pole, where f is 0."""
    (tmp_path / "hair.py").write_text(NARROW)
    fit = ["fit", str(tmp_path / "hair.py"), "--out", str(tmp_path), "--json", "--budget", "1"]
    assert cli.main([*fit, "--size", "17"]) == 0
    captured = capsys.readouterr()
    found = json.loads(captured.out)
    assert found["bytes"] <= 17 * 1024
    assert "size" not in found["limits"]
    place = found["worst_place"]
    assert place["relative_variance"] >= found["worst_edge_relative_variance"] > 0.5
    assert found["largest_weight"] >= place["largest_weight"]
    assert f"V is {place['relative_variance']:.3g} and the largest weight" in captured.err
    assert f"at width = {place['width']:.4g}, tilt = {place['tilt']:.4g}, bend = " in captured.err
    assert any(
        f"the nodes of {axis} are too far" in captured.err for axis in place["relative_variance_by_axis"]
    )


def test_what_limits_a_fit_is_told_from_what_is_met():
    def verdict(v, weight, edge=0.0, **given):
        def places(value):
            value = np.full((50, 1), value)
            at = np.linspace(0, 1, 50)
            return losses.Measured(
                at[:, None], at, value, value, np.where(at > 0.79, weight, 1)[:, None], value
            )

        given = {"too_large": False, "out_of_time": False, "lost": {"a": 0.0}, **given}
        hairs = box.Box(None, (Parameter("a", 0, 1, 0),), None)
        found = SimpleNamespace(measured=places(v), edges=places(edge), box=hairs, reach=0.0, model=None)
        found.__dict__.update(given, lost_at_worst={"a": 0.0, "theta_r": edge})
        found.model = SimpleNamespace(lobes=[1, 2])
        return summary._verdict(found, 0.1)

    assert verdict(0.09, 9) == "meets the tolerance: within 0.1 of what 2 lobes can reach"
    assert verdict(0.2, 9, lost={"a": 0.15}) == "stops short of the tolerance 0.1; what limits it: a"
    but = "V is within the tolerance 0.1, but weights are large, or corners and grazing viewers lose more; "
    assert verdict(0.09, 90, lost={"a": 0.05}, out_of_time=True) == f"{but}what limits it: a, budget"
    assert verdict(0.09, 9, edge=0.6) == f"{but}what limits it: theta_r"
    assert verdict(0.09, 9, too_large=True).endswith("but the textures take more than --size")


def test_a_mixture_of_five_parameters_gets_axes_of_the_four_that_matter_most(tmp_path, capsys):
    (tmp_path / "hair.py").write_text(
        "import numpy as np\n"
        "PARAMETERS = {name: (0.0, 1.0) for name in 'abcde'}\n"
        "def bsdf(theta_r, theta_i, phi, a, b, c, d, e):\n"
        "    mix = 0.1 + 0.18 * (a + b + 0.4 * c + d + e)\n"
        "    narrow, broad = (np.exp(-0.5 * ((theta_i + theta_r) / s) ** 2) / s for s in (0.2, 0.6))\n"
        "    return mix * narrow * (1 + 0.9 * np.cos(phi)) + (1 - mix) * broad * (1 - 0.9 * np.cos(phi))\n"
    )
    fit = [
        "fit",
        str(tmp_path / "hair.py"),
        "--out",
        str(tmp_path),
        "--json",
        "--budget",
        "1",
        "--lobes",
        "2",
    ]
    assert cli.main(fit) == 0
    captured = capsys.readouterr()
    assert list(json.loads(captured.out)["axes"]["mixture"]) == ["a", "b", "d", "e"]
    assert "those of c = 0.5 at all its values" in captured.err


def test_fewer_nodes_where_tables_are_wide_or_time_is_short(monkeypatch):
    def along(box, found, allowed, report):
        count = max(2, round(64 * (0.01 / allowed["a"]) ** 0.25))
        return {0: (np.arange(count), [None] * count)}

    monkeypatch.setattr(nodeshapes, "_chosen", along)
    found, start = SimpleNamespace(theta=(0,), phi=()), SimpleNamespace(theta_r=np.zeros(25), tied=True)

    def count(columns, size, most):
        given = None, found, start, (columns, 12), {"a": 0.01}, size, most
        return len(nodeshapes.chosen(*given, lambda share: None)[0][0])

    assert count(24, np.inf, np.inf) == 64
    assert 8 * 25 * 240 * count(240, 2**20, np.inf) < 0.8 * 2**20
    assert count(240, 2**20, np.inf) > 8
    assert count(24, np.inf, 20) < 20
    assert count(10**6, 1.0, 1.0) <= 6


@pytest.mark.parametrize("count", [2, 8])
def test_corners_of_the_box_and_grazing_viewers_are_measured(count):
    parameters = tuple(Parameter(x, 1, 3, 2) for x in "abcdefgh"[:count])
    given = box.Box(None, parameters, hair.Hair(None, True, False))
    places = losses.edge_places(given, 48, np.random.default_rng(1))
    corners, grazing = places.parameters[:32], abs(places.theta_r[16:])
    assert set(np.unique(corners)) == {1, 3}
    assert (np.count_nonzero(corners == 1, axis=0) == 16).all()
    assert len(np.unique(corners, axis=0)) >= min(2**count, 30)
    assert 0.2 < (np.isin(places.parameters[32:], [1, 3])).mean() < 0.8
    assert grazing.min() > np.radians(79.5)
    assert grazing.max() > np.radians(89.5)
    assert (places.theta_r[16:] > 0).sum() == 16
    assert abs(places.theta_r[:16]).min() < np.radians(20)
    assert places.offset.shape == (48, losses.OFFSETS)


def test_textures_over_parameters_take_no_more_memory_than_they_may(tmp_path, capsys):
    (tmp_path / "hair.py").write_text(HAIR)
    fit = ["fit", str(tmp_path / "hair.py"), "--out", str(tmp_path), "--json", "--budget", "1", "--size"]
    sizes = {}
    for size in ("1000", "16", "1"):
        assert cli.main([*fit, size]) == 0
        sizes[size] = json.loads(capsys.readouterr().out)
    assert sizes["1000"]["bytes"] > 16 * 1024 >= sizes["16"]["bytes"]
    assert "size" not in sizes["16"]["limits"]
    assert "size" in sizes["1"]["limits"]


def test_lobes_that_changed_places_at_some_offsets_are_put_back():
    """Theirs draw the light at each offset, but not between: those of the row before do both."""
    angle = np.linspace(0, 1.2, 9)
    m = 96
    x = (np.arange(m) + 0.5) / m * turning.TWO_PI - np.pi
    bump = np.exp(8 * (np.cos(x) - 1))
    theta = np.full((8, 2), 1 / 8)
    phi = np.tile(bump / bump.sum(), (2, 1))
    share, turn = np.tile([0.7, 0.3], (9, 1)), np.stack([-angle, 2.5 + angle], axis=1)
    good = lobesfit.Row(theta, phi, share, turn)
    swapped = share.copy(), turn.copy()
    for part in swapped:
        part[3:6] = part[3:6, ::-1]
    bad = lobesfit.Row(theta, phi, *swapped)
    mass = good.drawn()
    assert bad.variance(mass) < 1e-6
    fitting = nodemixture.Fitting(None, [], np.zeros(1), angle, True)
    assert fitting._steadier(bad, good, mass).turn == pytest.approx(turn, abs=0.02)
    assert fitting._steadier(good, bad, mass) is good


def test_a_faded_lobe_keeps_the_turn_that_it_has_beside():
    """A lobe of little light would turn to where another's tails are too thin, and between the two places be
    turned away from its own light."""
    angle, m = np.linspace(0, 1.2, 5), 96
    x = (np.arange(m) + 0.5) / m * turning.TWO_PI - np.pi
    bump = np.exp(8 * (np.cos(x) - 1))
    theta, phi = np.full((8, 2), 1 / 8, np.float32), np.tile(bump / bump.sum(), (2, 1)).astype(np.float32)
    turn = np.stack([-angle, 2.5 + angle], axis=1)
    share = np.tile(np.float32([0.5, 0.5]), (5, 1))
    strayed = turn + np.array([0.02, -1.5])
    mass = np.full((5, 8, m), 1 / 8 / m, np.float32)
    fitting = nodemixture.Fitting(None, [], np.zeros(1), angle, True)
    faded = lobesfit.Row(theta, phi, np.tile(np.float32([0.999, 0.001]), (5, 1)), strayed)
    led = fitting._led(faded, [(share, turn)], mass)
    assert led.turn[:, 0] == pytest.approx(strayed[:, 0], abs=1e-3)
    assert led.turn[:, 1] == pytest.approx(turn[:, 1], abs=1e-3)
    assert (led.share != faded.share).any()
    strong = lobesfit.Row(theta, phi, share, strayed)
    assert fitting._led(strong, [(share, turn)], mass).turn == pytest.approx(strayed, abs=0.01)


def test_grazing_viewers_have_more_nodes_that_start_from_what_blending_gives():
    few = np.radians(np.linspace(-89.9, 89.9, 25))
    more = nodemixture.viewers(few)
    assert np.isin(few, more).all()
    assert np.diff(np.degrees(more[abs(more) > np.radians(74)])[:7]).max() < 2.6
    assert (abs(more) < np.radians(70)).sum() == (abs(few) < np.radians(70)).sum()
    theta, phi = np.full((8, 2), 1 / 8), np.full((2, 16), 1 / 16)
    share = np.array([[0.8, 0.2]]), np.array([[0.4, 0.6]])
    turn = np.array([[3.0, 0.0]]), np.array([[-3.0, 1.0]])
    low, high = (lobesfit.Row(theta, phi, s, t) for s, t in zip(share, turn, strict=True))
    between = np.array([False, False, False, True, False])
    fitting = nodemixture.Fitting(None, [], np.array([-1.0, 0.0, 1.2, 1.3, 1.4]), np.zeros(1), True, between)
    assert fitting._order() == [2, 1, 0, 4, 3]
    rows = {0: high, 1: low, 2: low, 4: high}
    assert fitting._before(rows, 2) is None
    assert fitting._before(rows, 4) is low
    assert fitting._before(rows, 0) is low
    blended = fitting._blended(rows, 3)
    assert blended["share"] == pytest.approx(np.array([[0.6, 0.4]]))
    assert np.cos(blended["turn"]) == pytest.approx(np.cos([[np.pi, 0.5]]))
    mass = np.full((1, 8, 16), 1 / 128)
    assert nodemixture._better(low, high, mass) is low
    peak = lobesfit.Row(theta, np.eye(16)[:2] * 0.9 + 0.1 / 16, share[0], turn[0])
    assert nodemixture._better(peak, low, mass) is low


GOOD = "def bsdf(theta_r, theta_i, phi, a):\n    return 1.0 + a\n"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("PARAMETERS = [1]\n" + GOOD, "PARAMETERS is of type list: expected PARAMETERS = {"),
        ("PARAMETERS = {'a': 1}\n" + GOOD, "PARAMETERS has 'a': 1: expected"),
        ("PARAMETERS = {'a': (1,)}\n" + GOOD, "PARAMETERS has 'a': (1,): expected"),
        ("PARAMETERS = {'a': ('x', 'y')}\n" + GOOD, "PARAMETERS has 'a': ('x', 'y'): expected"),
        ("PARAMETERS = {'a': ('0', '1')}\n" + GOOD, "PARAMETERS has 'a': ('0', '1'): expected"),
        ("PARAMETERS = {'a': '01'}\n" + GOOD, "PARAMETERS has 'a': '01': expected"),
        ("PARAMETERS = {'a': (False, True)}\n" + GOOD, "PARAMETERS has 'a': (False, True): expected"),
        ("PARAMETERS = {'a': (0, 10**400)}\n" + GOOD, "PARAMETERS has 'a': (0, 1000"),
        ("parameters = {'a': (0, 1)}\n" + GOOD, "defines parameters: name it PARAMETERS"),
        ("PARAMETERS = {'a': (2, 1)}\n" + GOOD, "parameter a: is 2 1 1.5"),
        ("PARAMETERS = {'a': (0, 1, 2)}\n" + GOOD, "parameter a: is 0 1 2"),
        ("PARAMETERS = {'a': (0, float('nan'))}\n" + GOOD, "parameter a: is 0 nan"),
        ("PARAMETERS = {'A': (0, 1)}\n" + GOOD, "parameter 'A': expected a name"),
        ("PARAMETERS = {'phi': (0, 1)}\n" + GOOD, "parameter phi: expected another name than"),
        ("PARAMETERS = {'b': (0, 1)}\n" + GOOD, "takes no b, which PARAMETERS names"),
        (
            "PARAMETERS = {'a': (0, 1)}\ndef bsdf(theta_r, theta_i, phi, offset, a, b):\n    return 1.0\n",
            "takes b, which PARAMETERS does not name",
        ),
        (
            "PARAMETERS = {'a': (0, 1)}\ndef bsdf(theta_r, theta_i, phi, a, b):\n    return 1.0\n",
            "takes b, which PARAMETERS does not name",
        ),
        (
            "PARAMETERS = {'a': (0, 1)}\ndef bsdf(theta_r, theta_i, phi, a):\n    return 1 / (1 - a)\n",
            "hair.py:3: ZeroDivisionError: float division by zero: at a = 1",
        ),
        (
            "PARAMETERS = {'a': (0, 1)}\n" + GOOD.replace("1.0 + a", "[1.0, 2.0, 3.0]"),
            "as its arguments, a = ",
        ),
        ("PARAMETERS = {'a': (0, 1), 'a': (0, 2)}\n" + GOOD, "PARAMETERS has 'a' twice: expected each"),
        (
            "PARAMETERS = {'a': (0, 1)}\n" + GOOD.replace("a)", "a, /)", 1),
            "takes a by position only, and parameters are passed by name: put it behind",
        ),
        ("PARAMETERS = {'a': (0, 1)}\ndef bsdf(theta_r, a):\n    return 1.0\n", "expected a function bsdf("),
        (
            f"PARAMETERS = {{f'p{{i}}': (0, 1) for i in range(9)}}\n{GOOD.replace('a)', '**a)', 1)}",
            "9 parameters: expected at most 8",
        ),
        (
            "PARAMETERS = {'a': (0, 1)}\ndef bsdf(theta_r, theta_i, phi, a):\n    return 0.5 - a + 0 * phi\n",
            "bsdf is -0.5 at theta_r = ",
        ),
        (
            "PARAMETERS = {'a': (0, 1)}\n" + GOOD.replace("1.0 + a", "max(a - 0.3, 0) * (2 + 0 * phi)"),
            "f is 0 wherever it was evaluated, a = 0: expected some light",
        ),
        (
            "PARAMETERS = {'a': (0, 1)}\n" + GOOD.replace("1.0 + a", "(theta_r < a) + 0 * phi"),
            "f is 0 in all directions tried at theta_r = ",
        ),
    ],
)
def test_wrong_parameters_are_refused_in_one_line(tmp_path, capsys, text, expected):
    (tmp_path / "hair.py").write_text(text)
    assert cli.main(["fit", str(tmp_path / "hair.py"), "--out", str(tmp_path / "out")]) == cli.WRONG_USE
    said = capsys.readouterr().err
    assert "hair.py" in said
    assert expected in said
    assert "Traceback" not in said
    assert not (tmp_path / "out").exists()


def test_the_fewest_nodes_stand_where_a_function_bends():
    x = np.linspace(0, 1, 17)
    y = x**4

    def loss(i, j):
        blend = y[i] + (y[j] - y[i]) * (x[i : j + 1] - x[i]) / (x[j] - x[i])
        return float(abs(blend - y[i : j + 1]).max())

    kept = nodes.fewest(len(x), loss, 0.02)
    assert kept[0] == 0
    assert kept[-1] == len(x) - 1
    assert all(loss(i, j) <= 0.02 for i, j in pairwise(kept))
    assert np.diff(kept)[0] > np.diff(kept)[-1]
    assert nodes.fewest(len(x), lambda i, j: 0.0, 0.02) == [0, len(x) - 1]
    assert nodes.fewest(len(x), lambda i, j: 1.0, 0.02) == list(range(len(x)))


def test_places_together_tell_lobes_apart_that_one_alone_does_not():
    """Two lobes of one azimuth: one place's light does not say which part of it is whose, two do."""

    def density(theta_r, theta_i, phi, offset, mix):
        narrow, broad = (np.exp(-0.5 * ((theta_i + theta_r) / s) ** 2) / s for s in (0.1, 0.4))
        around = 1 + 0.8 * np.cos(phi)
        return (mix * narrow * around + (1 - mix) * broad * (2 - around)) * np.cos(theta_i)

    given = box.of_parameters(density, (Parameter("mix", 0.1, 0.9, 0.5),), False)
    places = ((0.5,), (0.15,), (0.85,))
    first = shapes.at_anchor(given, places[0], 2, False, 13, lambda share: None)
    apart = shapes.joined(given, first, places, first.rows * 3, shapes.BOTH)
    assert apart.variance() < 0.003
    row = apart.rows[6]
    narrow = int(row.theta.max(axis=0).argmax())
    shares = [rows.share[0, narrow] for rows in apart.rows[6::13]]
    assert shares == pytest.approx([0.5, 0.15, 0.85], abs=0.03)
    again = tied.improved(apart.blocks, apart.rows, apart.angle, 1, False, shapes.NEITHER)
    assert again[0].theta is apart.rows[0].theta


def test_steps_are_equal_factors_over_a_wide_range_and_corners_have_both_ends():
    given = box.Box(None, (Parameter("a", 0.1, 10, 1), *(Parameter(x, 0, 1, 0) for x in "bcde")), None)
    values = given.steps(0, 5, 0.1)
    assert values[1:] / values[:-1] == pytest.approx(10**0.5)
    assert given.steps(1, 3, 0.4) == pytest.approx([0, 0.4, 1])
    corners = np.array(given.corners())
    assert len(corners) == given.effort.corners
    assert (corners.min(axis=0) == [0.1, 0, 0, 0, 0]).all()
    assert (corners.max(axis=0) == [10, 1, 1, 1, 1]).all()
    assert json.dumps(given.named(given.standard)) == '{"a": 1, "b": 0, "c": 0, "d": 0, "e": 0}'

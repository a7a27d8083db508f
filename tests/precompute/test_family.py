"""A hair that scatters differently at each offset: its family is found, written, baked and drawn from."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import special, stats

from hairlut import cli, exr, interpolant
from hairlut.fit.family import LOBES, MAX_LOBES, fit_family, nearness
from hairlut.fit.familyfiles import NAME, contents, model_name
from hairlut.fit.model import variance
from hairlut.fit.offsets import even_azimuth, of_data, of_grids
from hairlut.fit.read import read
from hairlut.fit.turning import track, turned

GAMMA = np.linspace(0, np.pi / 2, 13)
THETA_R = np.radians(np.arange(-60.0, 61, 20))
THETA_I, PHI = np.radians(np.arange(-88.0, 89, 4)), np.radians(np.arange(2.5, 360, 5))
WIDTHS = 0.12, 0.4  # of the two highlights along the fibre, rad


def azimuth(phi, centre, kappa=8.0):
    return np.exp(kappa * (np.cos(phi - centre) - 1)) / (2 * np.pi * special.ive(0, kappa))


def share(gamma):
    """Of the narrow highlight's light."""
    return 0.7 - 0.4 * np.sin(gamma)


def hair(gamma, theta_r=THETA_R):
    """(offsets, J, n, m) values: a narrow highlight behind the fibre, a broad one mirrored from it."""
    g, t = gamma[:, None, None, None], theta_r[:, None, None]
    x = THETA_I[:, None]
    narrow = stats.norm.pdf(x, -t, WIDTHS[0]) * azimuth(PHI, np.pi - 0.7 * g)
    broad = stats.norm.pdf(x, 0.1 - t, WIDTHS[1]) * azimuth(PHI, -2 * g)
    return np.cos(t) * (share(g) * narrow + (1 - share(g)) * broad)


@pytest.fixture(scope="module")
def data():
    return of_grids(np.sin(GAMMA), THETA_R, THETA_I, PHI, hair(GAMMA))


@pytest.fixture(scope="module")
def family(data):
    return fit_family(data, 2)


def test_both_highlights_are_told_apart(family):
    middle = family.data.at[0].theta_middles
    row = len(THETA_R) // 2
    for k, width in enumerate(WIDTHS):
        mean = family.theta[row, k] @ middle
        assert np.sqrt(family.theta[row, k] @ (middle - mean) ** 2) == pytest.approx(width, rel=0.1)
    np.testing.assert_allclose(family.weight[:, row, 0], share(GAMMA), atol=0.02)


@pytest.mark.parametrize("row", range(len(THETA_R)))
def test_each_lobe_turns_with_its_highlight(family, row):
    """The fit and the hair may measure turns from different zeros, the same for all offsets."""
    for k, speed in enumerate((-0.7, -2.0)):
        turn = family.turn[:, row, k]
        np.testing.assert_allclose(turn - turn[0], speed * GAMMA, atol=0.01)


def test_highlights_are_followed_from_one_offset_to_one_far_away(data):
    """The broad one is 45 degrees away from where it was."""
    family = fit_family(data.at_offsets(slice(None, None, 3)), 2)
    for k, speed in enumerate((-0.7, -2.0)):
        turn = family.turn[..., k] - family.turn[:1, :, k]
        np.testing.assert_allclose(turn, np.outer(speed * GAMMA[::3], np.ones(len(THETA_R))), atol=0.05)


def test_a_lobe_is_the_same_highlight_for_all_theta_r(family):
    """Theirs are the same; near the poles a little of the broad one's light is cut off."""
    assert abs(np.diff(family.turn, axis=1)).max() < 0.02
    assert abs(np.diff(family.weight, axis=1)).max() < 0.05


def test_azimuths_stand_far_from_where_tables_are_cut(family):
    middle = PHI[abs(family.phi - family.phi.max(axis=-1, keepdims=True)).argmin(axis=-1)]
    np.testing.assert_allclose(middle, np.pi, atol=0.15)


def test_the_masses_are_masses(family):
    for part in (family.theta, family.phi):
        assert (part >= 0).all()
        np.testing.assert_allclose(part.sum(axis=-1), 1.0)
    np.testing.assert_allclose(family.weight.sum(axis=2), 1.0)
    for h in (0.0, 0.3, 1.0):
        np.testing.assert_allclose(family.drawn(h).sum(axis=(1, 2)), 1.0)
    np.testing.assert_allclose(family.data.share.sum(axis=0), 1.0)


def test_a_family_draws_the_data_and_one_lobe_or_another_offset_does_not(family, data):
    assert family.variance().max() < 0.005
    assert fit_family(data, 1).variance().mean() > 0.2
    assert replace(family, turn=family.turn[::-1]).variance().mean() > 1


def test_more_lobes_than_there_are_highlights_do_no_harm(data):
    assert fit_family(data, LOBES).variance().max() < 0.005


def test_offsets_between_those_of_the_data_cost_hardly_more(family):
    between = (GAMMA[1:] + GAMMA[:-1]) / 2
    cost = []
    for gamma in between:
        o, t = nearness(np.sin(GAMMA), np.sin(gamma))
        assert (o, t) == (np.searchsorted(GAMMA, gamma) - 1, pytest.approx(0.5))
        there = of_grids(
            np.sin([gamma - 1e-4, gamma + 1e-4]), THETA_R, THETA_I, PHI, hair(np.full(2, gamma))
        ).at[0]
        cost.append(variance(there, family.drawn(np.sin(gamma))).mean())
    at = family.variance().mean()
    assert at < family.variance_between().mean() < at + 0.002
    assert np.mean(cost) < at + 0.002


def changing(gamma):
    """(offsets, J, n, m) one highlight that stands still and grows broader with the offset."""
    kappa = (20 - 18 * gamma / GAMMA[-1])[:, None, None, None]
    x, t = THETA_I[:, None], THETA_R[:, None, None]
    return stats.norm.pdf(x, -t, 0.3) * azimuth(PHI, 1.0, kappa)


def test_an_azimuth_that_changes_its_shape_takes_several(tmp_path):
    data = of_grids(np.sin(GAMMA), THETA_R, THETA_I, PHI, changing(GAMMA))
    cost = [fit_family(data, 1, shapes).variance().mean() for shapes in (1, 4, len(GAMMA))]
    assert cost[0] > 0.05
    assert cost[1] < 0.3 * cost[0]
    assert cost[2] < 0.01


def test_azimuths_of_uneven_cells_are_made_even(data):
    uneven = np.append(PHI[:40:2], PHI[40:])
    rough = of_grids(np.sin(GAMMA), THETA_R, THETA_I, uneven, hair(GAMMA)[..., np.searchsorted(PHI, uneven)])
    even = even_azimuth(rough)
    np.testing.assert_allclose(np.diff(even.at[0].phi_edges), 2 * np.pi / even.at[0].mass.shape[2])
    mean = [(d.mass @ np.exp(1j * (d.phi_edges[1:] + d.phi_edges[:-1]) / 2)).sum(axis=1) for d in even.at]
    true = [(d.mass @ np.exp(1j * PHI)).sum(axis=1) for d in data.at]
    np.testing.assert_allclose(mean, true, atol=0.02)
    np.testing.assert_allclose([d.mass.sum(axis=(1, 2)) for d in even.at], 1.0)
    assert even_azimuth(even) is even
    assert fit_family(rough, 2).variance().max() < 0.02


# ---- turning


def test_masses_are_turned_by_any_angle():
    mass = azimuth(PHI, 2.0)
    for angle in (-7.0, -0.3, 0.0, np.radians(5), 0.61, 9.0):
        np.testing.assert_allclose(turned(mass, np.array(angle)), azimuth(PHI, 2.0 + angle), atol=2e-3)


def test_a_highlight_is_followed_through_the_dark_and_across_another():
    """Between them they cross: the fainter, which is followed, does not jump onto the other; nor where it has
    no light at all."""
    angle = np.linspace(0, 3, 25)
    mine, other = azimuth(PHI, 1.0 + angle[:, None]), azimuth(PHI, 2.6 - angle[:, None])
    light = np.where(angle > 2.6, 0.0, 0.2)
    mass = np.where(light[:, None] > 0, mine + 0.3 * other, other)
    np.testing.assert_allclose(track(mass, light, azimuth(PHI, 0.0)), 1.0 + angle, atol=0.15)


@pytest.mark.parametrize(
    ("at", "expected"),
    [(0.0, (0, 0.0)), (0.5, (0, 1.0)), (1.0, (1, 1.0)), (-0.3, (0, 0.0)), (0.7071, (1, 0.25))],
)
def test_the_nearer_offset_has_the_greater_weight(at, expected):
    o, t = nearness(np.array([0.0, 0.5, 1.0]), at)
    assert o + t == pytest.approx(sum(expected), abs=1e-4)


# ---- files


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    path = tmp_path_factory.mktemp("grid") / "hair.npz"
    some = GAMMA[::6]
    np.savez(
        path, offset=np.sin(some), theta_r_deg=np.degrees(THETA_R), theta_i=THETA_I, phi=PHI, value=hair(some)
    )
    return path


@pytest.fixture(scope="module")
def baked(grid):
    """The folder of textures, by way of both commands."""
    models, out = grid.parent / "fits", grid.parent / "baked"
    assert cli.main(["fit", str(grid), "--out", str(models)]) == cli.OK
    assert cli.main(["bake", "--model", str(models / "hair"), "--size", "64x19", "--out", str(out)]) == cli.OK
    return out


def test_the_family_file_says_what_the_fit_found(grid, baked):
    family = fit_family(of_data(read(grid)))
    lines = [line.split() for line in (baked / NAME).read_text().splitlines()]
    assert lines[:2] == [["hairlut-family", "2"], ["mirrored", "1"]]
    np.testing.assert_allclose([float(w) for w in lines[2][1:]], THETA_R, rtol=1e-8)
    offsets = [k for k, line in enumerate(lines) if line[0] == "offset"]
    np.testing.assert_allclose([float(lines[k][1]) for k in offsets], family.data.offset, rtol=1e-8)
    for o, k in enumerate(offsets):
        for lobe in range(LOBES):
            weights, turns = lines[k + 1 + 2 * lobe], lines[k + 2 + 2 * lobe]
            assert weights[:2] == ["lobe", model_name(0, lobe)]
            assert turns[0] == "turn"
            for words, found in ((weights[2:], family.weight), (turns[1:], family.turn)):
                np.testing.assert_allclose([float(w) for w in words], found[o, :, lobe], rtol=1e-6)


def test_baked_tables_draw_what_the_fit_says(grid, baked):
    family = fit_family(of_data(read(grid)))
    one = family.data.at[1]
    drawn = np.zeros_like(one.mass)
    for k in range(LOBES):
        cells = []
        turn = family.turn[1, :, k, None]
        for name, edges, by in (("direct_theta", one.theta_edges, 0), ("direct_phi", one.phi_edges, turn)):
            table, _ = exr.read(baked / model_name(0, k) / f"{name}.exr")
            at = np.broadcast_to(edges - by, (len(one.theta_r), edges.size))
            whole = np.floor(at / (2 * np.pi)) if np.ndim(by) else np.zeros_like(at)
            u = [
                interpolant.invert(table, np.full(edges.size, t), x)
                for t, x in zip(one.theta_r, at - whole * 2 * np.pi, strict=True)
            ]
            cells.append(np.diff(u + whole, axis=1))
        drawn += family.weight[1, :, k, None, None] * cells[0][:, :, None] * cells[1][:, None, :]
    np.testing.assert_allclose(drawn.sum(axis=(1, 2)), 1.0, atol=1e-6)
    assert (variance(one, drawn) < variance(one, family.drawn(family.data.offset[1])) + 0.01).all()


def test_offsets_on_both_sides_are_not_mirrored(data):
    both = of_grids([-0.5, 0.5], THETA_R, THETA_I, PHI, hair(np.arcsin([0.5, 0.5])))
    assert data.mirrored
    assert not both.mirrored
    assert contents(fit_family(both)).splitlines()[1] == "mirrored 0"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--lobes", "direct"], "--lobes direct: .* use --lobes-per-offset"),
        (["--lobes-per-offset", "0"], f"0 lobes: expected 1 to {MAX_LOBES}"),
        (["--shapes-per-lobe", "0"], "0 azimuths for each lobe: expected 1 to 3, the number of offsets"),
        (["--shapes-per-lobe", "4"], "4 azimuths for each lobe: expected 1 to 3, the number of offsets"),
        (["--lobes-per-offset", "9"], f"9 lobes: expected 1 to {MAX_LOBES}"),
    ],
    ids=lambda value: value[0] + value[1] if isinstance(value, list) else "",
)
def test_options_that_make_no_family_are_refused(options, said, grid, tmp_path, capsys):
    import re

    assert cli.main(["fit", str(grid), "--out", str(tmp_path), *options]) == cli.WRONG_USE
    assert re.search(said, capsys.readouterr().err)
    assert not list(tmp_path.iterdir())


def test_two_families_do_not_share_a_folder(baked, tmp_path, capsys):
    models = baked.parent / "fits" / "hair"
    other = tmp_path / "other"
    other.mkdir()
    (other / NAME).write_text("")
    (other / "more.npz").write_bytes((models / f"{model_name(0, 0)}.npz").read_bytes())
    command = ["bake", "--model", str(models), "--model", str(other), "--out", str(tmp_path / "out")]
    assert cli.main(command) == cli.WRONG_USE
    assert "bake each family into a directory of its own" in capsys.readouterr().err


def test_a_family_that_does_not_bake_whole_has_no_file(baked, tmp_path):
    models = tmp_path / "models"
    models.mkdir()
    (models / NAME).write_text("hairlut-family 1\n")
    (models / "broken.toml").write_text("")
    assert cli.main(["bake", "--model", str(models), "--out", str(tmp_path / "out")]) == cli.CHECK_FAILED
    assert not (tmp_path / "out" / NAME).exists()

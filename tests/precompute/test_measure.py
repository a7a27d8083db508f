# SPDX-License-Identifier: BSD-3-Clause
"""The measurements of a table's cost: by hand, against an independent quadrature, and on tables known to be
wrong."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from hairlut import analytic, interpolant
from hairlut.lobes import FITTED, PRINTED
from hairlut.measure import flat_cells, inclinations, measure, narrowest_cell
from hairlut.table import Table, bake_table
from hairlut.warp import Warp
from report.cells import LINEAR

QUARTIC = Warp("octaves", 2.0**-19)
ROUNDED_OUT = 2.5e-7  # rad by which an end of the domain may lie within a table's end


@pytest.fixture(scope="module")
def flat_lobe(make_lobe):
    return make_lobe(
        lambda x, theta_r: np.zeros(np.broadcast_shapes(x.shape, theta_r.shape)),
        domain=(0.0, 1.0),
    )


def by_hand(lobe, texels):
    """A table whose two rows are the same texels, with knots uniform in u."""
    rows = np.array([texels, texels], np.float32)
    ones = np.ones_like(rows)
    return Table(
        lobe.model, lobe.name, lobe.angle, lobe.azimuth, lobe.domain, lobe.theta_r_range, lobe.formula,
        Warp("uniform"), rows, ones, np.zeros(2),
    )  # fmt: skip


def test_a_uniform_lobe_by_hand(flat_lobe):
    """Cells of width d_i, each drawn with probability 1/3: q = 1/(3 d_i), f = 1, w = 3 d_i."""
    width = np.array([0.5, 0.25, 0.25])
    errors = measure(by_hand(flat_lobe, [0.0, 0.5, 0.75, 1.0]), flat_lobe, read=LINEAR.read)
    assert errors.relative_variance == pytest.approx(3 * (width**2).sum() - 1, rel=1e-12)
    assert errors.largest_weight == pytest.approx(1.5, rel=1e-12)
    assert errors.total_variation == pytest.approx(abs(width - 1 / 3).sum() / 2, rel=1e-12)
    assert errors.lost_mass == 0.0
    assert errors.heavy_probability == 0.0
    assert errors.quantile_error == pytest.approx(0.5 - 1 / 3, rel=1e-12)


def test_mass_that_a_table_cannot_reach_by_hand(flat_lobe):
    width = np.array([0.5, 0.25, 0.125])
    errors = measure(by_hand(flat_lobe, [0.0, 0.5, 0.75, 0.875]), flat_lobe, read=LINEAR.read)
    assert errors.lost_mass == pytest.approx(0.125, rel=1e-12)
    assert errors.relative_variance == pytest.approx(3 * (width**2).sum() - 1, rel=1e-12)
    assert errors.total_variation == pytest.approx((abs(width - 1 / 3).sum() + 0.125) / 2, rel=1e-12)


def test_heavy_weights_by_hand(make_lobe):
    """f = 5 on the first fifth of the domain, where the table draws uniformly: w = 5 there, 0 elsewhere."""
    step = make_lobe(
        lambda x, theta_r: np.where(x < 0.2, 0.0, -np.inf) + np.zeros_like(theta_r),
        domain=(0.0, 1.0),
        breakpoints=(0.2,),
    )
    errors = measure(by_hand(step, [0.0, 0.25, 0.5, 1.0]), step, read=LINEAR.read)
    inside = 0.2 * (1 / 3) / 0.25  # probability that the table draws x < 0.2
    assert errors.largest_weight == pytest.approx(5 * 0.25 * 3, rel=1e-12)
    assert errors.relative_variance == pytest.approx(5 * 5 * 0.25 * 3 * 0.2 - 1, rel=1e-5)
    assert errors.total_variation == pytest.approx(1 - inside, rel=1e-5)
    assert errors.heavy_probability == 0.0
    errors = measure(by_hand(step, [0.0, 0.5, 0.75, 1.0]), step, read=LINEAR.read)
    assert errors.heavy_probability == pytest.approx(0.2 * (1 / 3) / 0.5, rel=1e-5)


def independent_variance(table, lobe, theta_r):
    """The integral of f^2/q - 1 over the angle, by adaptive quadrature between the blended knots."""
    knots, _ = interpolant.sample(table, np.full(table.width, theta_r), table.warp.u(table.width))

    def integrand(x):
        f = analytic.density(lobe, np.float64(theta_r), np.clip(x, *lobe.domain))
        return float(f * f / interpolant.pdf(table, [theta_r], [x])[0])

    return sum(quad(integrand, a, b, epsabs=1e-14, epsrel=1e-10)[0] for a, b in pairwise(knots)) - 1


@pytest.mark.parametrize("lobe", [PRINTED.direct_theta, FITTED.direct_phi], ids=lambda lobe: lobe.name)
@pytest.mark.parametrize(
    "warp",
    [QUARTIC, Warp("uniform")],
    ids=str,
)
def test_variance_agrees_with_an_adaptive_quadrature(lobe, warp):
    table = bake_table(lobe, 16, 9, warp)
    errors = measure(table, lobe, quantiles=False)
    for n in (0, 9, 14, 32):  # on and between rows
        expected = independent_variance(table, lobe, errors.theta_r[n])
        beyond = 2 * analytic.density(lobe, errors.theta_r[n], np.array(lobe.domain)).max() * ROUNDED_OUT
        assert errors.variance[n] == pytest.approx(expected, rel=1e-5, abs=beyond)


def test_weights_and_total_variation_agree_with_dense_samples():
    lobe = PRINTED.direct_theta
    table = bake_table(lobe, 24, 16, QUARTIC)
    errors = measure(table, lobe, quantiles=False)
    u = (np.arange(200_000) + 0.5) / 200_000
    for n in (0, 7, 30, 60):
        theta_r = errors.theta_r[n]
        x, q = interpolant.sample(table, np.broadcast_to(theta_r, u.shape), u)
        w = analytic.density(lobe, theta_r, np.clip(x, *lobe.domain)) / q
        assert errors.variation[n] == pytest.approx(abs(w - 1).mean() / 2, rel=2e-2)
        assert errors.weight[n] >= 0.99 * w.max()
        assert errors.heavy[n] == pytest.approx((w > 4).mean(), abs=1e-5)


def test_quantile_errors_agree_with_the_closed_form():
    lobe = PRINTED.direct_theta
    table = bake_table(lobe, 32, 16, QUARTIC)
    errors = measure(table, lobe)
    rng = np.random.default_rng(11)
    for n in (0, 5, 33, 60):
        m = np.exp2(rng.uniform(-12, -1, 400))
        upper = rng.random(400) < 0.5
        theta_r = np.full(400, errors.theta_r[n])
        table_x, _ = interpolant.sample_tail(table, theta_r, m, upper)
        seen = abs(table_x - analytic.quantile(lobe, theta_r, m, upper)).max()
        assert (
            seen <= 1.02 * errors.inner[n] + 1e-12
        )  # 1.02: the worst place may lie between the points measured
        assert errors.inner[n] <= errors.quantile[n]
        assert seen >= 0.5 * errors.inner[n]


def test_narrow_lobes_in_wide_cells_are_resolved(make_lobe, normal):
    """A cell 30000 sigma wide: a fixed rule would miss the lobe altogether."""
    lobe = make_lobe(normal(0.3, 1e-4), breakpoints=(0.3,))
    table = by_hand(lobe, [*lobe.domain[:1], 0.0, 0.8, lobe.domain[1]])
    q = 1 / 3 / 0.8
    expected = 1 / (2 * np.sqrt(np.pi) * 1e-4) / q - 1
    assert measure(table, lobe, quantiles=False, read=LINEAR.read).relative_variance == pytest.approx(
        expected, rel=1e-6
    )


def test_between_rows_is_measured_too(make_lobe, normal):
    """A lobe that jumps halfway between two rows: exact on the rows, wrong between them."""

    def jump(x, theta_r):
        return -0.5 * ((x - np.where(theta_r < 0.1, -0.4, 0.4)) / 0.2) ** 2

    lobe = make_lobe(jump)
    table = bake_table(lobe, 64, 2, QUARTIC)
    assert measure(table, lobe, between=0, quantiles=False).relative_variance < 1e-3
    assert measure(table, lobe, quantiles=False).relative_variance > 1.0


def test_inclinations_contain_the_rows():
    angles = inclinations((-1.0, 2.0), 7)
    assert len(angles) == 25
    assert angles[::4] == pytest.approx(np.linspace(-1, 2, 7), abs=1e-15)


def test_a_table_of_another_lobe_is_far_off():
    table = bake_table(PRINTED.direct_theta, 32, 32, QUARTIC)
    assert measure(table, PRINTED.direct_theta, quantiles=False).relative_variance < 2e-3
    assert measure(table, FITTED.direct_theta, quantiles=False).relative_variance > 1.0


def test_flat_and_narrow_cells_are_counted():
    texels = np.float32([[0.0, 1.0, 1.0, 2.0], [0.0, 1.0, 1.5, 2.0]])
    assert flat_cells(texels) == 1
    assert narrowest_cell(texels) == 0.0
    texels[0, 2] = np.nextafter(np.float32(1), np.float32(2))
    assert flat_cells(texels) == 0
    assert narrowest_cell(texels) == 1.0


def test_one_texel_moved_raises_the_error():
    lobe = FITTED.multiple_theta
    table = bake_table(lobe, 32, 32, QUARTIC)
    moved = table.texels.copy()
    moved[10, 12] += 1e-3
    before = measure(table, lobe).variance
    after = measure(replace(table, texels=moved), lobe).variance
    assert after[40] > 1.05 * before[40]
    assert (np.flatnonzero(after != before) == np.arange(37, 44)).all()

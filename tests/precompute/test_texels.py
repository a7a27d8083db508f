# SPDX-License-Identifier: BSD-3-Clause
"""Texels of the shipped tables against 40-digit arithmetic, and the bake against the closed form."""

import numpy as np
import pytest

from hairlut import analytic
from hairlut.table import bake_table, row_angles
from hairlut.warp import Warp
from precompute import truth
from precompute.numerical import quantiles

SAMPLES = 2000
ULPS = 0.51


def chosen_texels(table):
    """At least SAMPLES (j, i), or all: the end columns and rows, the smallest angles, and a random rest."""
    height, width = table.texels.shape
    every = np.arange(height * width).reshape(height, width)
    ends = np.concatenate([every[0], every[-1], every[:, 0], every[:, -1]])
    near_zero = np.argsort(abs(table.texels), axis=None)[:50]
    must = np.union1d(ends, near_zero)
    rest = np.setdiff1d(every, must)
    count = min(max(SAMPLES - len(must), 0), len(rest))
    drawn = np.random.default_rng(7).choice(rest, count, replace=False)
    return np.unravel_index(np.concatenate([must, drawn]), every.shape)


def misplaced(table):
    """(j, i) of the chosen texels that are farther than ULPS from the true quantile."""
    chosen = list(zip(*chosen_texels(table), strict=True))
    rows = {j: truth.Row(table.model, table.name, table.theta_r[j]) for j in {j for j, _ in chosen}}
    knots = [truth.knot(table.warp, table.width, i) for i in range(table.width)]
    wrong = [(j, i) for j, i in chosen if not rows[j].is_quantile(table.texels[j, i], *knots[i], ULPS)]
    return wrong, len(chosen)


def test_texels_are_the_true_quantiles_rounded_once(shipped):
    table, _, _, _ = shipped
    wrong, count = misplaced(table)
    assert count >= min(SAMPLES, table.texels.size)
    assert wrong == []


def test_one_ulp_off_is_noticed(shipped):
    table, _, _, _ = shipped
    j, i = table.height // 3, table.width // 3 + 1
    x = np.nextafter(table.texels[j, i], np.float32(10))
    row = truth.Row(table.model, table.name, table.theta_r[j])
    m, upper = truth.knot(table.warp, table.width, i)
    assert row.is_quantile(table.texels[j, i], m, upper, ULPS)
    assert not row.is_quantile(x, m, upper, ULPS)


def test_end_columns_are_the_domain(shipped):
    table, _, _, _ = shipped
    low, high = np.float32(table.domain)
    assert (table.texels[:, 0] == low).all()
    assert (table.texels[:, -1] == high).all()


def test_shipped_tables_come_out_again(shipped):
    table, _, lobe, _ = shipped
    again = bake_table(lobe, table.width, table.height, table.warp)
    np.testing.assert_array_equal(again.texels, table.texels)


@pytest.mark.parametrize(
    "warp", [Warp("octaves", 2.0**-20), Warp("octaves", 2.0**-14), Warp("uniform")], ids=str
)
@pytest.mark.parametrize("size", [64, 255])
def test_numerical_and_closed_form_agree(lobe, warp, size):
    theta_r = row_angles(lobe.theta_r_range, size)
    m, upper = warp.knots(size)
    numerical, _ = quantiles(lobe, theta_r, m, upper)
    closed = analytic.quantile(lobe, theta_r[:, None], m, upper)
    assert abs(numerical - closed).max() <= 1e-12

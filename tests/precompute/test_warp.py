"""Columns and cumulative probabilities."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hairlut.errors import HairlutError
from hairlut.warp import Warp

warps = st.one_of(
    st.just(Warp("uniform")),
    st.builds(lambda p: Warp("quartic", 2.0**p), st.integers(-39, 0)),
)
widths = st.integers(4, 5000)


@given(warp=warps, width=widths, m=st.floats(0, 0.5))
def test_fold_and_unfold_are_inverse(warp, width, m):
    assume(m == 0 or m > 1e-300)
    c = warp.fold(m, width)
    assert 0 <= c <= (width - 1) / 2 * (1 + 1e-15)
    # a column is resolved to 1e-16 of itself and of what the fourth root adds at the end
    slack = 4e-15 * (m + abs(warp.e))
    assert abs(warp.unfold(c, width) - m) <= slack


@given(warp=warps, width=widths, part=st.floats(0.001, 0.999))
def test_slope_is_the_derivative(warp, width, part):
    c = np.float64(part * (width - 1) / 2)
    h = 1e-3 * min(c, (width - 1) / 2 - c)
    measured = (warp.unfold(c + h, width) - warp.unfold(c - h, width)) / (2 * h)
    assert warp.slope(c, width) == pytest.approx(measured, rel=1e-5)


@given(warp=warps, width=widths)
def test_knots_run_from_zero_to_one_and_are_symmetric(warp, width):
    m, upper = warp.knots(width)
    u = warp.u(width)
    assert m[0] == 0
    assert m[-1] == 0
    assert u[0] == 0
    assert u[-1] == 1
    assert (np.diff(u) > 0).all()
    np.testing.assert_array_equal(m, m[::-1])
    np.testing.assert_array_equal(u[::-1], np.where(upper[::-1], 1 - m, m))
    if width % 2:
        assert u[width // 2] == pytest.approx(0.5, abs=1e-15)


def test_quartic_warp_is_the_fourth_root():
    warp = Warp("quartic", 2.0**-20)
    f0, k = warp.scale(64)
    assert f0 == 2.0**-5
    y = (warp.unfold(np.arange(32.0), 64) + 2.0**-20) ** 0.25
    np.testing.assert_allclose(np.diff(y), k, rtol=1e-12)


@given(warp=warps)
def test_text_round_trip(warp):
    assert Warp.parse(str(warp)) == warp


@pytest.mark.parametrize(
    "text",
    [
        "",
        "cubic",
        "quartic",
        "quartic e=",
        "quartic e=x",
        "quartic e=-1",
        "quartic e=nan",
        "quartic e=2",
        "quartic f=0.1",
        "uniform e=0.1",
        "quartic e=1e-13",
        "quartic e=inf",
    ],
)
def test_wrong_text_is_refused(text):
    with pytest.raises(HairlutError, match=r"warp .*expected"):
        Warp.parse(text)

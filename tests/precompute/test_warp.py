# SPDX-License-Identifier: BSD-3-Clause
"""Columns and cumulative probabilities."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hairlut.errors import HairlutError
from hairlut.warp import Warp

warps = st.one_of(
    st.just(Warp("uniform")),
    st.builds(lambda p: Warp("octaves", 2.0**p), st.integers(-39, 0)),
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


@given(warp=warps, width=widths)
def test_widths_are_what_lies_between_knots(warp, width):
    h = warp.widths(width)
    assert h.shape == (width - 1,)
    assert (h > 0).all()
    np.testing.assert_array_equal(h, h[::-1])
    np.testing.assert_allclose(h, np.diff(warp.u(width)), rtol=0, atol=1e-15)
    assert h.sum() == pytest.approx(1, abs=1e-14)


@given(warp=warps, width=widths, m=st.floats(0, 0.5), upper=st.booleans())
def test_place_is_where_u_lies_between_its_knots(warp, width, m, upper):
    i, f = warp.place(np.array([m]), np.array([upper]), width)
    tail, _ = warp.knots(width)
    h = warp.widths(width)[i]
    nearer = tail[i] + f * h if i[0] < width / 2 - 1 or (i[0] < width / 2 and not upper) else None
    found = nearer if nearer is not None else tail[i + 1] + (1 - f) * h
    assert 0 <= i[0] <= width - 2
    assert -1e-9 <= f[0] <= 1 + 1e-9
    assert found[0] == pytest.approx(m, rel=1e-9, abs=1e-15)


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


def test_octaves_are_even_in_a_float_whose_bits_are_shifted():
    """F(m + e) is the float that the bits of m + e make when shifted right by two, times 2^96."""
    e, width = 2.0**-20, 64
    warp = Warp("octaves", e)
    m = np.concatenate([[0.0], np.geomspace(1e-9, 0.5, 1000)]).astype(np.float32)
    bits = (m + np.float32(e)).view(np.uint32) >> 2
    curve = (bits + (96 << 23)).astype(np.uint32).view(np.float32).astype(float)
    f0, k = warp.scale(width)
    assert f0 == curve[0]
    np.testing.assert_allclose(warp.fold(m.astype(float), width), (curve - f0) / k, rtol=0, atol=2e-5)


def test_octaves_stay_close_to_the_fourth_root():
    e, width = 2.0**-20, 4000
    warp = Warp("octaves", e)
    f0, k = warp.scale(width)
    c = np.arange(width / 2)
    ratio = (f0 + k * c) / (warp.unfold(c, width) + e) ** 0.25
    assert ratio.max() / ratio.min() < 1.07
    s = warp.unfold(c, width) + e
    octave = np.floor(np.log2(s))
    straight = octave[2:] == octave[:-2]  # three knots in a row within one
    bend = abs(np.diff(s, 2)) / np.diff(s)[1:]
    assert bend[straight].max() < 1e-9
    assert np.median(bend[~straight]) > 0.1


@given(warp=warps)
def test_text_round_trip(warp):
    assert Warp.parse(str(warp)) == warp


@pytest.mark.parametrize(
    "text",
    [
        "",
        "cubic",
        "octaves",
        "octaves e=",
        "octaves e=x",
        "octaves e=-1",
        "octaves e=nan",
        "octaves e=2",
        "octaves f=0.1",
        "uniform e=0.1",
        "octaves e=1e-13",
        "octaves e=inf",
    ],
)
def test_wrong_text_is_refused(text):
    with pytest.raises(HairlutError, match=r"warp .*expected"):
        Warp.parse(text)

"""luts/FORMAT.md is enough: a reader written from the page alone, in plain Python, meets the page's worked
example and agrees with the package on every shipped file."""

import math
import re
from itertools import pairwise

import numpy as np
import OpenEXR
import pytest

from hairlut import exr, interpolant


class Reader:
    """The page's rules, step by step, in the page's names."""

    def __init__(self, texels, attributes):
        self.texels = texels
        self.height, self.width = len(texels), len(texels[0])
        self.t0, self.t1 = map(float, attributes["hairlut.theta_r_range"].split())
        warp = attributes["hairlut.warp"].split(" e=")
        self.e = float(warp[1]) if warp[0] == "octaves" else None
        cell = attributes["hairlut.cell"].split(" limit=")
        self.limit = float(cell[1]) if cell[0] == "parabola" else 0.0
        if self.e is not None:
            self.f0 = self.curve(self.e)
            self.k = 2 * (self.curve(self.e + 0.5) - self.f0) / (self.width - 1)
        else:
            self.f0, self.k = 0.0, 1 / (self.width - 1)
        self.u = self.knots()
        h = [b - a for a, b in pairwise(self.u)]
        self.h = [h[min(i, self.width - 2 - i)] for i in range(self.width - 1)]  # 1 - u from the start

    @staticmethod
    def curve(s):
        """F"""
        n = math.floor(math.log2(s))
        q, r = divmod(n + 3, 4)
        return 2.0**q * (1 + (r + s / 2.0**n - 1) / 4)

    @staticmethod
    def curve_back(y):
        """G"""
        q = math.floor(math.log2(y))
        quarters = 4 * (y / 2.0**q - 1)
        r = math.floor(quarters)
        return 2.0 ** (4 * q + r - 3) * (1 + quarters - r)

    def folded(self, m):
        return m / self.k if self.e is None else (self.curve(m + self.e) - self.f0) / self.k

    def unfolded(self, c):
        return self.k * c if self.e is None else self.curve_back(self.f0 + self.k * c) - self.e

    def knots(self):
        lower = [self.unfolded(min(i, self.width - 1 - i)) for i in range(self.width)]
        return [1 - m if 2 * i > self.width - 1 else m for i, m in enumerate(lower)]

    def row(self, theta_r):
        r = (theta_r - self.t0) / (self.t1 - self.t0) * (self.height - 1)
        r = min(max(r, 0), self.height - 1)
        j = min(math.floor(r), self.height - 2)
        return {"r": r, "j": j, "t": r - j}

    def widths(self, j):
        return [b - a for a, b in pairwise(self.texels[j])]

    def slope(self, j, n):
        """S_n"""
        before, after = self.widths(j)[n - 1 : n + 1]
        h_before, h_after = self.h[n - 1 : n + 1]
        return (before + after) / (after * h_before / before + before * h_after / after)

    def free_curvature(self, j, i):
        """Before it is clamped."""
        d, h = self.widths(j), self.h
        if i == 0:
            return d[0] - h[0] * d[1] / h[1]
        if i == self.width - 2:
            return h[i] * d[i - 1] / h[i - 1] - d[i]
        return h[i] * (self.slope(j, i) - self.slope(j, i + 1)) / 2

    def row_cell(self, j, i):
        d = self.widths(j)[i]
        return self.texels[j][i], d, min(max(self.free_curvature(j, i), -self.limit * d), self.limit * d)

    def cell(self, theta_r, i):
        at = self.row(theta_r)
        both = zip(self.row_cell(at["j"], i), self.row_cell(at["j"] + 1, i), strict=True)
        return [(1 - at["t"]) * a + at["t"] * b for a, b in both]

    def sample(self, theta_r, u):
        m = min(u, 1 - u)
        c = self.folded(m)
        column = c if u <= 0.5 else self.width - 1 - c
        i = min(math.floor(column), self.width - 2)
        f = (u - self.u[i]) / self.h[i] if u <= 0.5 else 1 - (m - (1 - self.u[i + 1])) / self.h[i]
        start, d, curvature = self.cell(theta_r, i)
        x = start + f * (d + curvature * (1 - f))
        slope = d + curvature * (1 - 2 * f)
        values = {"u": u, "m": m, "c": c, "column": column, "i": i, "h": self.h[i], "f": f, "x": x}
        values |= {"X": start, "D": d, "C": curvature}
        return values | {"dx/df": slope, "q": self.h[i] / slope}

    def invert(self, theta_r, x):
        i = max(n for n in range(self.width - 1) if self.cell(theta_r, n)[0] <= x or n == 0)
        start, d, curvature = self.cell(theta_r, i)
        distance, s = x - start, d + curvature
        slope = math.sqrt(max(s * s - 4 * curvature * distance, 0))
        f = 2 * distance / (s + slope)
        values = {"d": distance, "S": s, "dx/df": slope, "f": f, "q": self.h[i] / slope}
        return values | {"u": self.u[i] + f * self.h[i]}


@pytest.fixture(scope="module")
def page(luts):
    return (luts / "FORMAT.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def example(page):
    """The page's blocks: table, knots, samples."""
    blocks = re.findall(r"```\n(.*?)```", page[page.index("## Worked example") :], re.DOTALL)
    lines = blocks[0].splitlines()
    attributes = dict(line.split(" = ") for line in lines if " = " in line)
    texels = [[float(word) for word in line.split()] for line in lines if " = " not in line]
    knots = [float(word) for word in blocks[1].split("=")[1].split()]
    samples = {words[0]: [float(w) for w in words[1:]] for words in map(str.split, blocks[2].splitlines())}
    return Reader(texels, attributes), knots, samples


def test_worked_example(example):
    reader, knots, samples = example
    assert (reader.width, reader.height) == (6, 3)
    np.testing.assert_allclose(reader.knots(), knots, atol=5e-9)
    assert len(samples["u"]) == 3
    for n, u in enumerate(samples["u"]):
        found = reader.sample(0.6, u)
        for name, values in samples.items():
            assert found[name] == pytest.approx(values[n], rel=1e-8), name


def test_numbers_in_the_text(example, page):
    reader, _, samples = example
    row = reader.row(0.6)
    assert f"r = {row['r']:.9g}, j = {row['j']}, t = {row['t']:.9g}" in page
    assert f"F0 = {reader.f0:.9g}, F1 = {reader.curve(reader.e + 0.5):.9g}, k = {reader.k:.9g}" in page
    assert row["j"] + 1 == 2
    clamped = [(j, 4) for j in (1, 2) if reader.row_cell(j, 4)[2] != reader.free_curvature(j, 4)]
    assert clamped == [(2, 4)]
    assert f"S_3 = {reader.slope(2, 3):.9g} and S_4 = {reader.slope(2, 4):.9g}" in page
    free, bound = reader.free_curvature(2, 4), reader.row_cell(2, 4)[2]
    assert f"h_4 D_3 / h_3 - D_4 = {free:.9g} lies beyond -0.95 D_4 = {bound:.9g}" in page
    back = reader.invert(0.6, reader.sample(0.6, samples["u"][0])["x"])
    text = page.replace("\n", " ")
    assert (
        "d = {d:.9f}, S = {S:.9f}, dx/df = {dx/df:.9f}, f = {f:.9f}, and so u = {u:.9g}".format(**back)
        in text
    )


def test_the_page_reads_every_shipped_file(shipped):
    table, path, _, _ = shipped
    with OpenEXR.File(str(path)) as file:
        header = dict(file.header())
        reader = Reader(file.channels()["Y"].pixels.astype(float).tolist(), header)
    np.testing.assert_allclose(
        [float(x) for x in header["hairlut.knots"].split()], reader.knots(), atol=1e-15
    )
    rng = np.random.default_rng(5)
    theta_r = np.concatenate([[-2, 2], table.theta_r[[0, -1]], rng.uniform(-1.6, 1.6, 300)])
    u = np.concatenate([[0, 0.5, 1e-6, 1 - 2.0**-24], rng.uniform(size=300)])
    x, q = interpolant.sample(table, theta_r, u)
    found = [reader.sample(*pair) for pair in zip(theta_r, u, strict=True)]
    np.testing.assert_allclose([s["x"] for s in found], x, rtol=0, atol=1e-13)
    np.testing.assert_allclose([s["q"] for s in found], q, rtol=1e-8)
    back = [reader.invert(*pair) for pair in zip(theta_r, x, strict=True)]
    np.testing.assert_allclose([s["u"] for s in back], u, rtol=0, atol=1e-12)


def test_every_attribute_is_explained(shipped, page):
    _, path, _, _ = shipped
    with OpenEXR.File(str(path)) as file:
        names = {name for name in file.header() if name.startswith(("hairlut.", "colorInteropID"))}
    explained = set(re.findall(r"^\| `([\w.]+)` \| (?:string|int) \|", page, re.MULTILINE))
    assert names == explained


def test_the_page_is_of_the_format_that_is_written(page):
    assert page.startswith(f"# The texture format, version {exr.FORMAT}\n")

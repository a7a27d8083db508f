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
        self.e = float(warp[1]) if warp[0] == "quartic" else None
        cell = attributes["hairlut.cell"].split(" limit=")
        self.limit = float(cell[1]) if cell[0] == "quadratic" else 0.0
        if self.e is not None:
            self.f0 = self.e**0.25
            self.k = 2 * ((0.5 + self.e) ** 0.25 - self.f0) / (self.width - 1)
        else:
            self.f0, self.k = 0.0, 1 / (self.width - 1)

    def folded(self, m):
        return m / self.k if self.e is None else ((m + self.e) ** 0.25 - self.f0) / self.k

    def unfolded(self, c):
        return self.k * c if self.e is None else (self.f0 + self.k * c) ** 4 - self.e

    def du_dc(self, c):
        return self.k if self.e is None else 4 * self.k * (self.f0 + self.k * c) ** 3

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

    def free_curvature(self, j, i):
        """Before it is clamped."""
        d = self.widths(j)
        if i == 0:
            return d[0] - d[1]
        return d[i - 1] - d[i] if i == self.width - 2 else (d[i - 1] - d[i + 1]) / 4

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
        f = column - i
        start, d, curvature = self.cell(theta_r, i)
        x = start + f * (d + curvature * (1 - f))
        slope = d + curvature * (1 - 2 * f)
        values = {"u": u, "m": m, "c": c, "column": column, "i": i, "f": f, "x": x}
        values |= {"X": start, "D": d, "C": curvature}
        return values | {"dx/df": slope, "du/dc": self.du_dc(c), "q": self.du_dc(c) / slope}

    def invert(self, theta_r, x):
        i = max(n for n in range(self.width - 1) if self.cell(theta_r, n)[0] <= x or n == 0)
        start, d, curvature = self.cell(theta_r, i)
        distance, s = x - start, d + curvature
        slope = math.sqrt(max(s * s - 4 * curvature * distance, 0))
        f = 2 * distance / (s + slope)
        low, high = i + f, self.width - 1 - (i + f)
        m = self.unfolded(min(low, high))
        return {"d": distance, "S": s, "dx/df": slope, "f": f, "q": self.du_dc(min(low, high)) / slope} | {
            "u": m if low <= high else 1 - m
        }


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
    assert len(samples["u"]) == 2
    for n, u in enumerate(samples["u"]):
        found = reader.sample(0.6, u)
        for name, values in samples.items():
            assert found[name] == pytest.approx(values[n], rel=1e-8), name


def test_numbers_in_the_text(example, page):
    reader, _, samples = example
    row = reader.row(0.6)
    assert f"r = {row['r']:.9g}, j = {row['j']}, t = {row['t']:.9g}" in page
    assert f"F0 = {reader.f0:.9g}, F1 = {(0.5 + reader.e) ** 0.25:.9g}, k = {reader.k:.9g}" in page
    assert row["j"] + 1 == 2
    for i in (0, 3):
        assert reader.row_cell(2, i)[2] != reader.free_curvature(2, i)
    free, clamped = reader.free_curvature(2, 3), reader.row_cell(2, 3)[2]
    assert f"(D_2 - D_4) / 4 = {free:.9g} lies beyond -0.9 D = {clamped:.9g}" in page
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

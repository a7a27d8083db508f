# SPDX-License-Identifier: BSD-3-Clause
"""luts/FORMAT.md is right: its worked examples, computed by the page's rules without hairlut's code."""

import math
import re
import zlib
from dataclasses import fields
from itertools import pairwise

import numpy as np
import OpenEXR
import pytest

from hairlut import exr, exrfile, interpolant, slopes
from hairlut.fit import summary
from hairlut.fit.strands import summary as strands_summary
from precompute.parametric import model as model_over_parameters


class Table:
    """The page's rules for a table, word by word, on Python floats."""

    def __init__(self, angles, slope, attributes):
        self.x, self.d = angles, slope
        self.height, self.width = len(angles), len(angles[0])
        self.t0, self.t1 = map(float, attributes["hairlut.theta_r_range"].split())
        self.low, self.high = (float(np.float32(x)) for x in attributes["hairlut.domain"].split())
        name, _, number = attributes["hairlut.warp"].partition(" e=")
        self.e = float(number) if name == "octaves" else None
        self.f0, f1 = (0.0, 0.0) if self.e is None else (self.curve(self.e), self.curve(self.e + 0.5))
        self.k = 1 / (self.width - 1) if self.e is None else 2 * (f1 - self.f0) / (self.width - 1)
        self.u = self.knots()

    @staticmethod
    def curve(s):
        mantissa, exponent = math.frexp(s)
        q, r = divmod(exponent - 1 + 3, 4)
        return 2.0**q * (1 + (r + 2 * mantissa - 1) / 4)

    @staticmethod
    def curve_back(y):
        mantissa, exponent = math.frexp(y)
        r, g = divmod(4 * (2 * mantissa - 1), 1)
        return 2.0 ** (4 * (exponent - 1) + r - 3) * (1 + g)

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

    def blended(self, rows, theta_r, i):
        at = self.row(theta_r)
        return (1 - at["t"]) * rows[at["j"]][i] + at["t"] * rows[at["j"] + 1][i]

    def cell(self, theta_r, i):
        x0, x1 = (self.blended(self.x, theta_r, n) for n in (i, i + 1))
        d0, d1 = (self.blended(self.d, theta_r, n) for n in (i, i + 1))
        h = self.u[i + 1] - self.u[i]
        return {"x0": x0, "x1": x1, "d0": d0, "d1": d1, "h": h, "s": (x1 - x0) / h}

    def sample(self, theta_r, u):
        m = min(u, 1 - u)
        c = self.folded(m)
        column = c if u <= 0.5 else self.width - 1 - c
        i = min(math.floor(column), self.width - 2)
        cell = self.cell(theta_r, i)
        f = (u - self.u[i]) / cell["h"]
        s, d0, d1, p = cell["s"], cell["d0"], cell["d1"], f * (1 - f)
        g = s * (f**2 + (1 - f) ** 2) + (d0 + d1) * p
        x = cell["x0"] + (cell["x1"] - cell["x0"]) * (s * f**2 + d0 * p) / g
        slope = s**2 * (d1 * f**2 + 2 * s * p + d0 * (1 - f) ** 2) / g**2
        values = {"u": u, "m": m, "c": c, "column": column, "i": i, **cell, "f": f, "G": g, "x": x}
        return values | {"dx/du": slope, "q": 1 / slope}

    def invert(self, theta_r, x):
        if not self.low <= x <= self.high:
            return {"q": 0.0}
        i = max(n for n in range(self.width - 1) if self.blended(self.x, theta_r, n) <= x or n == 0)
        cell = self.cell(theta_r, i)
        h, s, d0, d1 = (cell[name] for name in ("h", "s", "d0", "d1"))
        below, above = max(x - cell["x0"], 0), max(cell["x1"] - x, 0)
        b = d0 * above - d1 * below
        root = math.sqrt(b * b + 4 * s * s * below * above)
        a, b_ = (2 * s * below, root + b) if b >= 0 else (root - b, 2 * s * above)
        f = a / (a + b_)
        g = s * (f**2 + (1 - f) ** 2) + (d0 + d1) * f * (1 - f)
        return {"X": below, "Z": above, "B": b, "R": root, "f": f, "q": h * g / root, "u": self.u[i] + f * h}

    def pdf(self, theta_r, x):
        return self.invert(theta_r, min(max(x, self.low), self.high))["q"]


class Mixture:
    """The page's rules for a mixture."""

    def __init__(self, lobes, theta_r, offset, mirrored, share, turn):
        """share, turn: [lobe][theta_r][offset]"""
        self.lobes, self.theta_r, self.mirrored = lobes, theta_r, mirrored
        self.arcs = [math.asin(h) for h in offset]
        nodes = range(len(theta_r)), range(len(offset))
        sums = [[sum(share[k][j][n] for k in range(len(lobes))) for n in nodes[1]] for j in nodes[0]]
        self.share = [
            [[share[k][j][n] / sums[j][n] for n in nodes[1]] for j in nodes[0]] for k in range(len(lobes))
        ]
        self.turn = turn

    @staticmethod
    def place(nodes, x):
        x = min(max(x, nodes[0]), nodes[-1])
        if len(nodes) == 1:
            return 0, 0, 0.0
        i = max(n for n in range(len(nodes) - 1) if nodes[n] <= x)
        return i, i + 1, (x - nodes[i]) / (nodes[i + 1] - nodes[i])

    @staticmethod
    def arc(a, b, t):
        return a + t * ((b - a + math.pi) % (2 * math.pi) - math.pi)

    def at(self, theta_r, offset):
        h = min(max(offset, -1), 1)
        j, j1, t = self.place(self.theta_r, theta_r)
        n, n1, s = self.place(self.arcs, math.asin(abs(h) if self.mirrored else h))
        share = [
            (1 - s) * ((1 - t) * each[j][n] + t * each[j1][n])
            + s * ((1 - t) * each[j][n1] + t * each[j1][n1])
            for each in self.share
        ]
        turn = [
            self.arc(self.arc(each[j][n], each[j1][n], t), self.arc(each[j][n1], each[j1][n1], t), s)
            for each in self.turn
        ]
        return {"t": t, "s": s, "share": share, "turn": turn, "side": -1 if self.mirrored and h < 0 else 1}


def wrap(angle):
    return (angle + math.pi) % (2 * math.pi) - math.pi


class Model:
    """The page's rules for a whole hair. tables: {lobe: (theta, phi or None, azimuth)}"""

    def __init__(self, mixture, tables):
        self.mixture, self.tables = mixture, tables

    def sample(self, theta_r, phi_r, offset, u_lobe, u_theta, u_phi):
        at = self.mixture.at(theta_r, offset)
        running, k = at["share"][0], 0
        while not u_lobe < running and k < len(at["share"]) - 1:
            k += 1
            running += at["share"][k]
        theta, phi, azimuth = self.tables[self.mixture.lobes[k]]
        theta_i = theta.sample(theta_r, u_theta)["x"]
        if phi is None:
            return k, theta_i, 2 * math.pi * u_phi - math.pi
        relative = at["side"] * (phi.sample(theta_r, u_phi)["x"] + at["turn"][k])
        return k, theta_i, wrap(relative + (phi_r if azimuth == "difference" else -phi_r))

    def pdf(self, theta_r, phi_r, offset, theta_i, phi_i):
        at = self.mixture.at(theta_r, offset)
        density = 0.0
        for k, name in enumerate(self.mixture.lobes):
            theta, phi, azimuth = self.tables[name]
            azimuthal = 1 / (2 * math.pi)
            if phi is not None:
                relative = phi_i - phi_r if azimuth == "difference" else phi_i + phi_r
                azimuthal = phi.pdf(theta_r, (at["side"] * relative - at["turn"][k]) % (2 * math.pi))
            density += at["share"][k] * theta.pdf(theta_r, theta_i) * azimuthal
        return density


def corners(axes, given):
    """The page's corners: (block, part) of each. axes: nodes by parameter."""
    found = [(0, 1.0)]
    for name, nodes in axes.items():
        value = min(max(given[name], nodes[0]), nodes[-1])
        k = max(n for n in range(len(nodes) - 1) if nodes[n] <= value)
        w = (value - nodes[k]) / (nodes[k + 1] - nodes[k])
        found = [(b * len(nodes) + k + n, p * (w if n else 1 - w)) for n in (0, 1) for b, p in found]
    return found


def axes_of(attributes):
    """(nodes of the parameters on which a file depends, nodes of the other axes), by name"""
    names = attributes.get("hairlut.axes", "theta_r").split(" ")
    nodes = {
        name: [float(w) for w in attributes[f"hairlut.axis.{name}"].split(" ")]
        for name in names
        if f"hairlut.axis.{name}" in attributes
    }
    own = {name: nodes.pop(name) for name in ("theta_r", "offset") if name in nodes}
    return {name: values for name, values in nodes.items() if len(values) > 1}, own


def table_at(rows, slope, attributes, given):
    """The page's table at given parameters. rows, slope: (rows, W)"""
    axes, _ = axes_of(attributes)
    nodes = math.prod(len(values) for values in axes.values())
    fixed = []
    for texels in (rows, slope):
        blocks = np.reshape(texels, (nodes, -1, len(texels[0])))
        fixed.append(sum(part * blocks[block] for block, part in corners(axes, given)).tolist())
    return Table(*fixed, attributes)


def mixture_of(share, turn, attributes, given):
    """The page's mixture at given parameters. share, turn: (lobes, rows, offsets)"""
    lobes = attributes["hairlut.lobes"].split(" ")
    axes, own = axes_of(attributes)
    shape = len(lobes), -1, len(own["theta_r"]), len(own["offset"])
    share, turn, at = np.reshape(share, shape), np.reshape(turn, shape), corners(axes, given)
    share = share / share.sum(axis=0)
    a = turn[:, at[0][0]]
    share = sum(part * share[:, block] for block, part in at)
    turn = a + sum(part * wrap(turn[:, block] - a) for block, part in at)
    mirrored = attributes["hairlut.mirrored"] == "1"
    return Mixture(lobes, own["theta_r"], own["offset"], mirrored, share.tolist(), turn.tolist())


# ---- the page


@pytest.fixture(scope="module")
def page(luts):
    return (luts / "FORMAT.md").read_text(encoding="utf-8")


def blocks(page, heading):
    """The fenced blocks of a section."""
    section = page[page.index(heading) :].split("\n## ")[0]
    return re.findall(r"```\n(.*?)```", section, re.DOTALL)


def parsed(block):
    """(attributes, rows of numbers by the word that begins a group)"""
    attributes = dict(line.split(" = ") for line in block.splitlines() if " = " in line)
    groups, name = {}, None
    for line in block.splitlines():
        if line.endswith(":"):
            name = line[:-1]
        elif name and line.strip() and " = " not in line:
            groups.setdefault(name, []).append([float(word) for word in line.split()])
    return attributes, groups


def columns(block):
    """The rows of a block of values, by their first word."""
    return {words[0]: [float(w) for w in words[1:]] for words in map(str.split, block.splitlines())}


TABLE, MIXTURE = "## Worked example: a table", "## Worked example: a mixture"


@pytest.fixture(scope="module")
def table(page):
    attributes, groups = parsed(blocks(page, TABLE)[0])
    return Table(groups["Y"], groups["dxdu"], attributes)


def test_worked_example_of_a_table(page, table):
    _, knots, samples, backwards = blocks(page, TABLE)
    assert (table.width, table.height) == (6, 3)
    np.testing.assert_allclose(table.knots(), [float(w) for w in knots.split("=")[1].split()], atol=5e-9)
    samples = columns(samples)
    assert len(samples["u"]) == 3
    for n, u in enumerate(samples["u"]):
        found = table.sample(0.6, u)
        for name, values in samples.items():
            assert found[name] == pytest.approx(values[n], rel=1e-8), name
    backwards = columns(backwards)
    for n, x in enumerate(backwards["x"]):
        found = table.invert(0.6, x) | {"x": x}
        for name, values in backwards.items():
            assert found[name] == pytest.approx(values[n], rel=2e-8, abs=1e-9), name
    np.testing.assert_allclose(backwards["u"], samples["u"], atol=1e-8)


def test_numbers_in_the_text(page, table):
    row = table.row(0.6)
    assert f"r = {row['r']:.9g}, j = {row['j']}, t = {row['t']:.9g}" in page
    assert f"F0 = {table.f0:.9g}, F1 = {table.curve(table.e + 0.5):.9g}, k = {table.k:.9g}" in page


def test_digest_of_the_example(page):
    attributes, groups = parsed(blocks(page, TABLE)[0])
    texels = np.stack([groups["Y"], groups["dxdu"]], axis=-1).astype("<f4")
    assert attributes["hairlut.digest"] == f"crc32 {zlib.crc32(texels.tobytes()):08x}"


def test_slopes_of_format_1(page, table):
    """The rule for files without slopes, by hand, on the angles of the example."""
    expected = []
    for row in table.x:
        w = [b - a for a, b in pairwise(row)]
        h = [b - a for a, b in pairwise(table.u)]
        inner = [
            (w[n - 1] + w[n]) / (w[n] * h[n - 1] / w[n - 1] + w[n - 1] * h[n] / w[n])
            for n in range(1, len(w))
        ]
        ends = []
        for n, beside in ((0, inner[0]), (len(w) - 1, inner[-1])):
            s = w[n] / h[n]
            ends.append(min(max(2 * s - beside, s / 8), 8 * s))
        expected.append([ends[0], *inner, ends[1]])
    (block,) = blocks(page, "## Format 1")
    np.testing.assert_allclose(columns(block)["1"], expected[1], rtol=1e-8)
    derived = slopes.derived(np.array(table.x), np.diff(table.u))
    np.testing.assert_allclose(derived, expected, rtol=1e-12)


@pytest.fixture(scope="module")
def mixture(page):
    attributes, groups = parsed(blocks(page, MIXTURE)[0])
    lobes = attributes["hairlut.lobes"].split(" ")
    axes = ([float(w) for w in attributes[f"hairlut.axis.{a}"].split()] for a in ("theta_r", "offset"))
    share, turn = ([groups[f"{lobe}.{what}"] for lobe in lobes] for what in ("share", "turn"))
    return Mixture(lobes, *axes, attributes["hairlut.mirrored"] == "1", share, turn)


def test_worked_example_of_a_mixture(page, mixture):
    values = columns(blocks(page, MIXTURE)[1])
    assert len(values["theta_r"]) == 4
    for n, (theta_r, offset) in enumerate(zip(values["theta_r"], values["offset"], strict=True)):
        found = mixture.at(theta_r, offset)
        for k, lobe in enumerate(mixture.lobes):
            assert found["share"][k] == pytest.approx(values[f"{lobe}.share"][n], rel=1e-8)
            assert found["turn"][k] == pytest.approx(values[f"{lobe}.turn"][n], rel=1e-8)
        for name in ("t", "s", "side"):
            assert found[name] == pytest.approx(values[name][n], rel=1e-8, abs=1e-12)


def test_digest_of_the_mixture(page, mixture):
    attributes, groups = parsed(blocks(page, MIXTURE)[0])
    names = [f"{lobe}.{what}" for lobe in mixture.lobes for what in ("share", "turn")]
    texels = np.stack([groups[name] for name in names], axis=-1).astype("<f4")
    assert attributes["hairlut.digest"] == f"crc32 {zlib.crc32(texels.tobytes()):08x}"


def test_worked_example_of_a_hair(page, mixture, table):
    attributes, groups = parsed(blocks(page, MIXTURE)[2])
    attributes["hairlut.theta_r_range"] = "-1.5707963267948966 1.5707963267948966"
    phi = Table(groups["Y"] * 2, groups["dxdu"] * 2, attributes)
    values = columns(blocks(page, MIXTURE)[3])
    model = Model(mixture, {lobe: (table, phi, "difference") for lobe in mixture.lobes})
    for n in range(len(values["u_lobe"])):
        arguments = [values[name][n] for name in ("theta_r", "phi_r", "offset", "u_lobe", "u_theta", "u_phi")]
        k, theta_i, phi_i = model.sample(*arguments)
        assert [k, theta_i, phi_i] == pytest.approx(
            [values[name][n] for name in ("lobe", "theta_i", "phi_i")], rel=1e-8
        )
        density = model.pdf(*arguments[:3], theta_i, phi_i)
        assert density == pytest.approx(values["density"][n], rel=1e-7)


PARAMETERS = "## Worked example: parameters"


def given_at(attributes, values, n):
    """The parameters' values in column n, clamped."""
    found = {}
    for name in attributes["hairlut.axes"].split(" ")[:-2]:
        least, most, _ = map(float, attributes[f"hairlut.parameter.{name}"].split(" "))
        found[name] = min(max(values[name][n], least), most)
    return found


def test_worked_example_of_parameters(page):
    of_mixture, of_table, values = blocks(page, PARAMETERS)
    (attributes, groups), (of_theta, theta), values = parsed(of_mixture), parsed(of_table), columns(values)
    of_phi, phi = parsed(blocks(page, MIXTURE)[2])
    of_phi["hairlut.theta_r_range"] = of_theta["hairlut.theta_r_range"]
    lobes = attributes["hairlut.lobes"].split(" ")
    share, turn = ([groups[f"{lobe}.{what}"] for lobe in lobes] for what in ("share", "turn"))
    assert len(values["beta_m"]) == 3
    for n in range(3):
        given = given_at(attributes, values, n)
        ((_, _), (_, w)), absorption = (
            corners(axes_of(of_theta)[0], given),
            corners(axes_of(attributes)[0], given),
        )
        mixture = mixture_of(share, turn, attributes, given)
        tables = (
            table_at(theta["Y"], theta["dxdu"], of_theta, given),
            Table(phi["Y"] * 2, phi["dxdu"] * 2, of_phi),
            "difference",
        )
        model = Model(mixture, dict.fromkeys(lobes, tables))
        arguments = [values[x][n] for x in ("theta_r", "phi_r", "offset", "u_lobe", "u_theta", "u_phi")]
        lobe, theta_i, phi_i = model.sample(*arguments)
        at = mixture.at(*(values[x][n] for x in ("theta_r", "offset")))
        found = {"w(beta_m)": w, "k(absorption)": absorption[0][0], "w(absorption)": absorption[1][1]}
        found |= {f"{x}.share": at["share"][k] for k, x in enumerate(lobes)}
        found |= {f"{x}.turn": at["turn"][k] for k, x in enumerate(lobes)}
        cell = tables[0].sample(values["theta_r"][n], values["u_theta"][n])
        found |= {x: cell[x] for x in ("x0", "x1", "d0", "d1")} | {"lobe": lobe}
        found |= {"theta_i": theta_i, "phi_i": phi_i, "density": model.pdf(*arguments[:3], theta_i, phi_i)}
        for name, value in found.items():
            assert value == pytest.approx(values[name][n], rel=1e-7, abs=1e-12), name


def test_digests_of_the_parameters_example(page):
    of_mixture, of_table, _ = blocks(page, PARAMETERS)
    (attributes, groups), (of_theta, theta) = parsed(of_mixture), parsed(of_table)
    _, phi = parsed(blocks(page, MIXTURE)[2])

    def digest(*channels):
        return f"{zlib.crc32(np.stack(channels, axis=-1).astype('<f4').tobytes()):08x}"

    names = [f"{lobe}.{what}" for lobe in ("r", "tt") for what in ("share", "turn")]
    first, second = digest(theta["Y"], theta["dxdu"]), digest(phi["Y"] * 2, phi["dxdu"] * 2)
    assert of_theta["hairlut.digest"] == f"crc32 {first}"
    assert attributes["hairlut.digest"] == f"crc32 {digest(*(groups[name] for name in names))}"
    for lobe in ("r", "tt"):
        assert attributes[f"hairlut.lobe.{lobe}"] == f"r_theta {first} r_phi {second}"


# ---- the files


def attributes_of(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return dict(file.header()), {n: np.array(c.pixels).tolist() for n, c in file.channels().items()}


def test_the_page_reads_every_shipped_table(shipped):
    table, path, _, _ = shipped
    header, channels = attributes_of(path)
    reader = Table(channels["Y"], channels["dxdu"], header)
    np.testing.assert_allclose(
        [float(x) for x in header["hairlut.knots"].split()], reader.knots(), atol=1e-15
    )
    rng = np.random.default_rng(5)
    theta_r = np.concatenate([[-2, 2], table.theta_r[[0, -1]], rng.uniform(-1.6, 1.6, 300)])
    u = np.concatenate([[0, 0.5, 1e-6, 1 - 2.0**-24], rng.uniform(size=300)])
    x, q = interpolant.sample(table, theta_r, u)
    found = [reader.sample(*pair) for pair in zip(theta_r, u, strict=True)]
    np.testing.assert_allclose([s["x"] for s in found], x, rtol=0, atol=1e-13)
    np.testing.assert_allclose([s["q"] for s in found], q, rtol=1e-7)
    back = [reader.invert(*pair) for pair in zip(theta_r[1:], x[1:], strict=True)]
    np.testing.assert_allclose([s["u"] for s in back], u[1:], rtol=0, atol=1e-12)


@pytest.fixture(scope="module")
def parametric(tmp_path_factory):
    """The directory of a model over parameters."""
    directory = tmp_path_factory.mktemp("files") / "parametric"
    exr.write_model(directory, model_over_parameters())
    return directory


def model_of(directory, given):
    """The page's model of files, at given parameters."""
    header, channels = attributes_of(directory / "mixture.exr")
    lobes = header["hairlut.lobes"].split(" ")
    share, turn = ([channels[f"{lobe}.{what}"] for lobe in lobes] for what in ("share", "turn"))
    tables = {}
    for lobe in lobes:
        words = header[f"hairlut.lobe.{lobe}"].split(" ")
        parts = []
        for table, digest in zip(words[::2], words[1::2], strict=True):
            attributes, texels = attributes_of(directory / f"{table}.exr")
            assert attributes["hairlut.digest"] == f"crc32 {digest}"
            table = table_at(texels["Y"], texels["dxdu"], attributes, given)
            parts.append((table, attributes["hairlut.azimuth"]))
        tables[lobe] = (parts[0][0], *(parts[1] if len(parts) > 1 else (None, "none")))
    return Model(mixture_of(share, turn, header, given), tables)


def agree(reader, model, given):
    """The page's reading of a model and ours, at 60 random places."""
    rng = np.random.default_rng(6)
    u = rng.uniform(size=(60, 3))
    theta_r, phi_r, offset = rng.uniform(-1.5, 1.5, 60), rng.uniform(-3, 3, 60), rng.uniform(-1, 1, 60)
    theta_i, phi_i, density = model.sample(theta_r, phi_r, u, offset, given)
    for n in range(60):
        _, theta, phi = reader.sample(theta_r[n], phi_r[n], offset[n], *u[n])
        assert theta == pytest.approx(theta_i[n], abs=1e-12)
        assert wrap(phi - phi_i[n]) == pytest.approx(0, abs=1e-11)
        pdf = reader.pdf(theta_r[n], phi_r[n], offset[n], theta_i[n], phi_i[n])
        assert pdf == pytest.approx(density[n], rel=1e-7)


@pytest.mark.parametrize("name", ["printed", "brown"])
def test_the_page_reads_a_whole_model(luts, name):
    agree(model_of(luts / name, {}), exr.read_model(luts / name), {})


@pytest.mark.parametrize(
    "given",
    [
        {"beta_m": 0.2, "absorption": 0.9, "tilt": 3.5},
        {"beta_m": 0.25, "absorption": 0.0, "tilt": 4.0},
        {"beta_m": 0.7, "absorption": 4.0, "tilt": -1.0},
    ],
)
def test_the_page_reads_a_model_at_given_parameters(parametric, given):
    agree(model_of(parametric, given), exr.read_model(parametric), given)


def explained(page):
    return set(re.findall(r"^\| `([\w.<>]+)` \| (?:string|int) \|", page, re.MULTILINE))


def test_every_attribute_is_explained(shipped, luts, page, parametric):
    names = set()
    of_parameters = parametric / "mixture.exr", parametric / "r_theta.exr"
    for path in (shipped[1], luts / "fitted" / "mixture.exr", luts / "brown" / "mixture.exr", *of_parameters):
        header, _ = attributes_of(path)
        names |= {n for n in header if n.startswith(("hairlut.", "colorInteropID"))}
    of_a_name = r"^hairlut\.(lobe|parameter|axis)\.(?!(theta_r|offset)$).*"
    general = {re.sub(of_a_name, r"hairlut.\1.<name>", name) for name in names}
    assert {n for n in general if not n.startswith("hairlut.error.")} <= explained(page)
    assert {n for n in explained(page) if not n.startswith("hairlut.error.")} == {
        n for n in general if not n.startswith("hairlut.error.")
    }


def test_every_measured_error_is_explained(shipped, luts, page):
    for path in (shipped[1], luts / "brown" / "mixture.exr"):
        header, _ = attributes_of(path)
        for name in header:
            assert not name.startswith("hairlut.error.") or f"`{name}`" in page


def test_every_error_that_a_fit_states_is_explained(page):
    for promise in (summary.Promise, strands_summary.Promise):
        for field in fields(promise):
            assert f"`hairlut.error.{field.name}`" in page


def test_the_page_is_of_the_format_that_is_written(page):
    assert page.startswith(f"# The texture format, version {exrfile.FORMAT}\n")

# SPDX-License-Identifier: BSD-3-Clause
"""Scattering data: what is a grid, what are draws, and that a mistake in a file is named where it stands."""

import csv
import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from hairlut.errors import HairlutError
from hairlut.fit.read import LEAST_DRAWS, MOST_BEYOND, Draws, Grid, checked_grid, read

INPUTS = Path(__file__).parents[1] / "data" / "inputs"

THETA_R, THETA_I = np.radians([-30.0, 0, 30]), np.radians(np.arange(-75.0, 76, 30))
PHI = np.radians(np.arange(0.0, 360, 45))
VALUE = np.exp(-4 * (THETA_I[:, None] + THETA_R[:, None, None]) ** 2) * (1.5 + np.cos(PHI))
POINTS = [part.ravel() for part in np.meshgrid(THETA_R, THETA_I, PHI, indexing="ij")]
RADIANS = "theta_r", "theta_i", "phi", "value"
DEGREES = "theta_r_deg", "theta_i_deg", "phi_deg", "value"


def text_of(names, columns, comma=","):
    return "\n".join([comma.join(names), *(comma.join(map(repr, row)) for row in zip(*columns, strict=True))])


def rows_in_degrees():
    return [*(np.degrees(part).tolist() for part in POINTS), VALUE.ravel().tolist()]


GOOD = text_of(DEGREES, rows_in_degrees()) + "\n"


def written(folder, text, name="data.csv"):
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def assert_good(grid):
    for found, expected in zip(
        (grid.theta_r, grid.theta_i, grid.phi, grid.value), (THETA_R, THETA_I, PHI, VALUE), strict=True
    ):
        np.testing.assert_allclose(found, expected, atol=1e-12)


def draws(count=400, seed=3):
    """(theta_r, theta_i, phi), rad."""
    rng = np.random.default_rng(seed)
    theta_r = rng.choice(THETA_R, count)
    return theta_r, np.clip(rng.normal(-theta_r, 0.2), -1.5, 1.5), rng.uniform(0, 2 * np.pi, count)


# ---- a grid


def test_a_grid_in_radians_and_in_degrees_csv_or_npz_is_the_same(tmp_path):
    radians = text_of(RADIANS, [*(part.tolist() for part in POINTS), VALUE.ravel().tolist()])
    np.savez(tmp_path / "a.npz", theta_r=THETA_R, theta_i_deg=np.degrees(THETA_I), phi=PHI, value=VALUE)
    np.savez(tmp_path / "b.npz", **dict(zip(DEGREES, rows_in_degrees(), strict=True)))
    paths = [written(tmp_path, GOOD, "a.csv"), written(tmp_path, radians, "b.csv")]
    for path in [*paths, tmp_path / "a.npz", tmp_path / "b.npz"]:
        assert_good(read(path))
    assert str(read(paths[0])) == "grid of 3 x 6 x 8 (theta_r x theta_i x phi)"


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "﻿" + text,
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("\n", "\r"),
        lambda text: "# measured on a Tuesday\n" + text.replace("\n", "\n\n", 3) + "# end\n",
        lambda text: text.replace(",", " , "),
        lambda text: "\n".join([text.splitlines()[0], *sorted(text.splitlines()[1:])]),
        lambda text: text.replace("theta_r_deg", '"theta_r_deg"'),
    ],
    ids=["byte order mark", "CRLF", "CR", "comments", "spaces", "another order", "quotes"],
)
def test_how_a_file_was_saved_does_not_matter(change, tmp_path):
    assert_good(read(written(tmp_path, change(GOOD))))


def test_coordinates_that_differ_by_rounding_are_one(tmp_path):
    rng = np.random.default_rng(5)
    jitter = rng.uniform(-4e-7, 4e-7, (3, VALUE.size))
    columns = [*(part + by for part, by in zip(POINTS, jitter, strict=True)), VALUE.ravel()]
    grid = read(written(tmp_path, text_of(RADIANS, [column.tolist() for column in columns])))
    np.testing.assert_allclose(grid.theta_i, THETA_I, atol=1e-6)
    np.testing.assert_array_equal(grid.value, VALUE)


def test_a_grid_over_the_offset_is_read_from_both_kinds_of_file(tmp_path):
    offset = np.array([0.0, 0.5, 1.0])
    value = np.stack([VALUE, 2 * VALUE, 3 * VALUE])
    np.savez(tmp_path / "a.npz", offset=offset, theta_r=THETA_R, theta_i=THETA_I, phi=PHI, value=value)
    axes = np.meshgrid(offset, THETA_R, THETA_I, PHI, indexing="ij")
    columns = [*(axis.ravel().tolist() for axis in axes), value.ravel().tolist()]
    text = text_of(("offset", *RADIANS), columns)
    for grid in (read(tmp_path / "a.npz"), read(written(tmp_path, text))):
        np.testing.assert_array_equal(grid.offset, offset)
        np.testing.assert_array_equal(grid.value, value)
        assert str(grid) == "grid of 3 x 3 x 6 x 8 (offset x theta_r x theta_i x phi)"


def test_an_azimuth_may_start_anywhere_and_end_where_it_starts(tmp_path):
    closed = np.append(PHI, 2 * np.pi) - np.pi
    value = np.concatenate([VALUE, VALUE[..., :1]], axis=2)
    grid = checked_grid(THETA_R, THETA_I, closed, value)
    np.testing.assert_allclose(grid.phi, PHI, atol=1e-12)
    np.testing.assert_allclose(grid.value, np.roll(VALUE, 4, axis=2))
    value[1, 2, -1] *= 1.1
    with pytest.raises(HairlutError, match="are one direction, but have different values"):
        checked_grid(THETA_R, THETA_I, closed, value)


# ---- draws


def test_draws_are_weighed_by_value_if_there_is_one(tmp_path):
    columns = [column.tolist() for column in draws()]
    weight = np.linspace(0.1, 2, 400).tolist()
    alike = read(written(tmp_path, text_of(RADIANS[:3], columns)))
    weighed = read(written(tmp_path, text_of(RADIANS, [*columns, weight])))
    assert str(alike) == "400 draws"
    assert str(weighed) == "400 draws weighed by value"
    np.testing.assert_array_equal(alike.weight, 1.0)
    np.testing.assert_array_equal(weighed.weight, weight)
    np.testing.assert_allclose([weighed.theta_r, weighed.theta_i, weighed.phi], columns, atol=1e-12)


def test_many_draws_are_no_grid(tmp_path):
    """Neighbours lie closer than the tolerance within which coordinates are one."""
    rng = np.random.default_rng(1)
    phi = np.sort(rng.uniform(0, 0.02, 60_000))
    np.savez(tmp_path / "a.npz", theta_r=0 * phi, theta_i=np.sort(rng.normal(0, 5e-3, 60_000)), phi=phi)
    assert str(read(tmp_path / "a.npz")) == "60,000 draws"


def test_draws_with_offsets_have_them(tmp_path):
    offset = np.random.default_rng(2).uniform(-1, 1, 400)
    path = written(tmp_path, text_of(("offset", *RADIANS[:3]), [c.tolist() for c in (offset, *draws())]))
    np.testing.assert_array_equal(read(path).offset, offset)


def test_a_few_draws_beyond_the_hemisphere_are_left_out_and_said(tmp_path):
    theta_r, theta_i, phi = (column.copy() for column in draws(1000))
    theta_i[[7, 20]] = 1.6, -1.7
    path = written(tmp_path, text_of(RADIANS[:3], [c.tolist() for c in (theta_r, theta_i, phi)]))
    said = "998 draws, without 2 whose theta_i lies beyond 90 deg, the first on line 9"
    assert str(read(path)) == said
    theta_i[: int(1000 * MOST_BEYOND) + 1] = 1.6
    path = written(tmp_path, text_of(RADIANS[:3], [c.tolist() for c in (theta_r, theta_i, phi)]))
    with pytest.raises(HairlutError, match=r"theta_i is 1\.6 on line 2: expected an angle within"):
        read(path)


# ---- the cases of the reports


CASES = {
    "byte_order_mark.csv": "grid of 1 x 4 x 4 (theta_r x theta_i x phi)",
    "grid_whole.csv": "grid of 1 x 4 x 4 (theta_r x theta_i x phi)",
    "draws_of_two_gaussians.csv": "1,399 draws, without 1 whose theta_i lies beyond 90 deg, the first on "
    "line 174",
}
REFUSED = {
    "grid_one_missing.csv": "needs 16 points, found 15: the first one missing is theta_r_deg = 0, "
    "theta_i_deg = 60, phi_deg = 270",
    "own_range_per_theta_r.csv": "a grid of 3 x 8 x 8 (theta_r x theta_i x phi) needs 192 points, found 160",
    "value_named_bsdf.csv": "column 'bsdf' is not known",
    "one_sample.csv": f"1 draw: expected at least {LEAST_DRAWS}",
    "phi_in_degrees.csv": "phi is 45 on line 3: expected an angle within [-6.28319, 6.28319] rad: if these "
    "are degrees, name the column phi_deg",
    "utf16.csv": "UTF-16, expected UTF-8",
}


@pytest.mark.parametrize("name", sorted(path.name for path in INPUTS.glob("*.csv")))
def test_every_reported_file_is_read_or_refused_for_its_own_reason(name):
    if name in CASES:
        assert str(read(INPUTS / name)) == CASES[name]
        return
    with pytest.raises(HairlutError) as caught:
        read(INPUTS / name)
    assert str(caught.value).startswith(f"{INPUTS / name}: ")
    assert REFUSED[name] in str(caught.value)


# ---- mistakes in text


def without(line):
    lines = GOOD.splitlines()
    del lines[line - 1]
    return "\n".join(lines)


def with_line(line, words):
    lines = GOOD.splitlines()
    lines[line - 1] = words
    return "\n".join(lines)


TWICE = GOOD + GOOD.splitlines()[4] + "\n"
FIVE = "theta_r,theta_i,phi\n" + "0.1,0.2,0.3\n0.2,0.1,0.5\n" * 2 + "0.3,0.3,0.3\n"
MISTAKES = {
    "no column": ("theta_r,theta_i,value\n0,0,1\n", "expected a column phi or phi_deg"),
    "another name": (GOOD.replace("value", "bsdf"), "column 'bsdf' is not known: .*column value"),
    "another column": (GOOD.replace("\n", ",1\n").replace("value,1", "value,time"), "'time' is not known"),
    "upper case": (GOOD.replace("value", "Value"), "'Value' is not known: .*did you mean value"),
    "another unit": (GOOD.replace("_deg", "_rad"), "name it theta_r if it is in radians, theta_r_deg if"),
    "doubled column": (GOOD.replace("phi_deg", "theta_i_deg"), "column theta_i_deg stands there twice"),
    "both units": (GOOD.replace("phi_deg", "theta_i"), "columns theta_i_deg and theta_i are both there"),
    "no name": (GOOD.replace("value", ""), "column '' is not known"),
    "text": (with_line(7, "0,zero,1,2"), "line 7: theta_i_deg is 'zero', expected a number"),
    "underscore": (with_line(7, "0,1_0,1,2"), "line 7: theta_i_deg is '1_0', expected a number"),
    "empty word": (with_line(7, "0,,1,2"), "line 7: theta_i_deg is '', expected a number"),
    "short line": (with_line(7, "0,0,1"), "line 7 has 3 numbers, expected 4"),
    "long line": (with_line(7, "0,0,1,2,3"), "line 7 has 5 numbers, expected 4"),
    "broken quotes": (with_line(7, '0,"0,1,2'), "line 7: .*expected numbers with commas"),
    "NaN": (with_line(7, "0,0,1,nan"), "value is nan on line 7: expected a finite number"),
    "infinite": (with_line(7, "0,0,1,1e999"), "value is inf on line 7: expected a finite number"),
    "negative": (with_line(7, "0,0,1,-2"), "value is -2 on line 7: expected 0 or more"),
    "degrees": (
        "theta_r,theta_i,phi\n30,-30,180\n",
        "theta_r is 30 on line 2: .*name the column theta_r_deg",
    ),
    "radians": (
        text_of(DEGREES, [*(part.tolist() for part in POINTS), VALUE.ravel().tolist()]),
        "theta_r_deg runs from .* the range of radians: name the column theta_r",
    ),
    "beyond the pole": (with_line(7, "0,95,45,1"), "theta_i_deg is 95 on line 7: expected .*deg$"),
    "far beyond": (with_line(7, "0,120,45,1"), "theta_i_deg is 120 on line 7: expected .*deg$"),
    "beyond the circle": (with_line(7, "0,0,400,1"), "phi_deg is 400 on line 7: expected .*deg$"),
    "point missing": (
        without(20),
        r"needs 144 points, found 143: the first one missing is theta_r_deg = -30",
    ),
    "point twice": (TWICE, "the point theta_r_deg = .* 2 times, on line 5 and line 146"),
    "grid without value": (
        "\n".join(line.rpartition(",")[0] for line in GOOD.splitlines()),
        "the points are those of a grid of 3 x 6 x 8 .*no column value",
    ),
    "few theta_i": (
        "\n".join([GOOD.splitlines()[0], *(f"0,{t},{p},1" for t in (0, 30) for p in range(0, 360, 45))]),
        "2 theta_i: expected at least 4",
    ),
    "half a circle": (
        "\n".join(
            [GOOD.splitlines()[0], *(f"0,{t},{p},1" for t in range(-60, 61, 20) for p in range(0, 181, 45))]
        ),
        "phi has no point between 180 and 360 deg",
    ),
    "dark": (
        "\n".join(
            [GOOD.splitlines()[0], *(f"5,{t},{p},0" for t in range(-60, 61, 20) for p in range(0, 360, 45))]
        ),
        "theta_r = 5 deg: value is 0 everywhere",
    ),
    "few draws": (FIVE, f"5 draws: expected at least {LEAST_DRAWS}"),
    "weightless draws": (
        text_of(RADIANS, [*(c.tolist() for c in draws()), [0.0] * 390 + [1.0] * 10]),
        "10 draws of weight above 0: expected at least",
    ),
    "flat draws": (
        text_of(RADIANS[:3], [c.tolist() for c in (*draws()[:2], np.full(400, 0.5))]),
        "all 400 draws have phi = 0.5",
    ),
    "empty": ("", "empty: expected a header line"),
    "comments": ("# nothing\n\n", "empty: expected a header line"),
    "header only": ("theta_r,theta_i,phi\n", "no data below the header"),
    "no header": ("\n".join(GOOD.splitlines()[1:]), "line 1 consists of numbers: expected a header"),
    "semicolons": (GOOD.replace(",", ";"), "separated by semicolons: expected commas"),
    "tabs": (GOOD.replace(",", "\t"), "separated by tabs: expected commas"),
    "blanks": (GOOD.replace(",", " "), "separated by spaces: expected commas"),
    "UTF-16": (GOOD.encode("utf-16"), "UTF-16, expected UTF-8"),
    "UTF-16 without mark": (GOOD.encode("utf-16-le"), "UTF-16, expected UTF-8"),
    "Latin-1": (("# 5°\n" + GOOD).encode("latin-1"), "line 1: byte 0xb0 is not UTF-8"),
    "zero byte": (with_line(7, "0,0,1,\0"), "line 7 contains a zero byte"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_in_a_text_is_named(mistake, tmp_path):
    text, said = MISTAKES[mistake]
    path = written(tmp_path, text)
    with pytest.raises(HairlutError, match=said) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_a_row_of_its_own_range_is_an_incomplete_grid_however_little_they_share(tmp_path):
    """Each viewer has a whole grid of its own: of the whole product that is a third."""
    rows = [
        (t, t * 3 + i, p, 1.0) for t in (-20, 0, 20) for i in (-4, -2, 0, 2, 4) for p in range(0, 360, 45)
    ]
    path = written(tmp_path, text_of(DEGREES, list(zip(*rows, strict=True))))
    with pytest.raises(HairlutError, match="needs 360 points, found 120"):
        read(path)


# ---- mistakes in arrays


def arrays(**changed):
    given = {"theta_r": THETA_R, "theta_i": THETA_I, "phi": PHI, "value": VALUE} | changed
    return {name: values for name, values in given.items() if values is not None}


def four(**changed):
    value = np.stack([VALUE, VALUE])
    return arrays(**({"offset": np.array([0.0, 0.5]), "value": value} | changed))


def altered(place, number):
    value = VALUE.copy()
    value[place] = number
    return value


ARRAYS = {
    "descending": (arrays(theta_r=THETA_R[::-1]), "theta_r falls from .*expected increasing numbers: sort"),
    "equal": (arrays(theta_r=np.array([0, 0.1, 0.1 + 1e-8])), "theta_r has 0.1 twice, at 1 and 2"),
    "negative": (
        arrays(value=altered((1, 2, 3), -1)),
        r"value is -1 on index \[1, 2, 3\].*: expected 0 or more",
    ),
    "NaN": (
        arrays(value=altered((1, 2, 3), np.nan)),
        r"value is nan on index \[1, 2, 3\].*: expected a finite",
    ),
    "degrees": (arrays(theta_i=np.degrees(THETA_I)), "theta_i is -75 on index .*name the column theta_i_deg"),
    "three of four axes": (four(value=VALUE), r"value has shape \(3, 6, 8\), expected \(2, 3, 6, 8\)"),
    "shape": (arrays(value=VALUE[:-1]), r"value has shape \(2, 6, 8\), expected \(3, 6, 8\)"),
    "two axes": (arrays(value=VALUE[0]), r"value has shape \(6, 8\), expected \(3, 6, 8\)"),
    "a number": (arrays(theta_r=np.array(0.5)), r"theta_r has shape \(\), expected one axis"),
    "an axis of two": (arrays(theta_r=THETA_R[None]), r"theta_r has shape \(1, 3\), expected one axis"),
    "no value": (arrays(value=None), "arrays of the shapes .*expected value to have an axis for each"),
    "flat value": (arrays(value=VALUE.ravel()), "arrays of the shapes .*expected value to have an axis"),
    "nothing in it": (arrays(theta_r=np.zeros(0)), "theta_r is empty"),
    "another array": (arrays(time=np.zeros(3)), "column 'time' is not known"),
    "text": (arrays(theta_r=np.array(["a", "b", "c"])), "array theta_r has the type <U1, expected real"),
    "complex": (arrays(theta_r=THETA_R * 1j), "array theta_r has the type complex128, expected real"),
    "objects": (arrays(theta_r=np.array([[1], None, "x"], object)), "consists of Python objects"),
    "one offset": (four(offset=np.zeros(1), value=VALUE[None]), "1 offsets .*at least two"),
    "equal offsets": (four(offset=np.array([0.5, 0.5])), "offset has 0.5 twice"),
    "beyond the rim": (four(offset=np.array([0.5, 1.1])), "offset is 1.1 on index .*within"),
    "dark offset": (four(value=np.stack([VALUE, 0 * VALUE])), "offset 0.5, theta_r = -30 deg: value is 0"),
}


@pytest.mark.parametrize("mistake", ARRAYS)
def test_a_mistake_in_arrays_is_named(mistake, tmp_path):
    given_arrays, said = ARRAYS[mistake]
    path = tmp_path / "data.npz"
    np.savez(path, **given_arrays)
    with pytest.raises(HairlutError, match=said) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_a_descending_axis_is_not_called_degrees(tmp_path):
    np.savez(tmp_path / "a.npz", **arrays(theta_r=THETA_R[::-1]))
    with pytest.raises(HairlutError) as caught:
        read(tmp_path / "a.npz")
    assert "deg" not in str(caught.value)


@pytest.fixture(scope="module")
def whole():
    """The bytes of a good npz file."""
    file = io.BytesIO()
    np.savez_compressed(file, **arrays())
    return file.getvalue()


def saved(array):
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def doubled(data):
    file = io.BytesIO(data)
    with zipfile.ZipFile(file, "a") as archive, pytest.warns(UserWarning, match="Duplicate"):
        archive.writestr("phi.npy", saved(PHI))
    return file.getvalue()


@pytest.mark.parametrize(
    ("name", "change", "said"),
    [
        ("a.npz", lambda data: data[: len(data) // 2], "cut or damaged"),
        ("a.npz", lambda data: data[:300] + b"\x55" * 40 + data[340:], "cut or damaged"),
        ("a.npz", lambda data: b"", "is not an npz file"),
        ("a.npz", lambda data: b"theta_r,theta_i", "is not an npz file"),
        ("a.npz", lambda data: saved(VALUE), r"is a single array \(.npy\)"),
        ("a.npz", doubled, "has two arrays phi"),
        ("a.npy", lambda data: saved(VALUE), "is no text, but arrays or an archive: .*npz"),
        ("a.csv", lambda data: data, "is no text, but arrays or an archive: .*npz"),
    ],
    ids=["cut", "damaged", "empty", "text", "one array", "doubled", "npy", "npz named csv"],
)
def test_a_file_without_arrays_is_named(name, change, said, whole, tmp_path):
    path = written(tmp_path, change(whole), name)
    with pytest.raises(HairlutError, match=said) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_a_missing_file_and_a_directory_are_named(tmp_path):
    with pytest.raises(HairlutError, match=r"none\.csv: no such file: expected a CSV or npz file"):
        read(tmp_path / "none.csv")
    with pytest.raises(HairlutError, match="is a directory: expected a CSV or npz file"):
        read(tmp_path)


# ---- any mutation


def mutated(data):
    """Strategy: the good file after an edit or two, of bytes, words, lines or columns."""

    def bytes_at(at, new, removed):
        at = min(at, len(data))
        return data[:at] + new + data[at + removed :]

    def lines(order):
        split = data.split(b"\n")
        return b"\n".join(split[k % len(split)] for k in order)

    def word(line, column, new):
        split = [row.split(b",") for row in data.split(b"\n")]
        row = split[line % len(split)]
        row[column % len(row)] = new
        return b"\n".join(b",".join(row) for row in split)

    def columns(order):
        rows = [row.split(b",") for row in data.split(b"\n") if row]
        return b"\n".join(b",".join(row[k] for k in order) for row in rows)

    count = data.count(b"\n") + 1
    words = [
        b"",
        b"0",
        b"-1",
        b"nan",
        b"1e999",
        b"45.0",
        b"90",
        b"-75.0",
        b"phi_deg",
        b"Value",
        b"1_0",
        b"0x1",
    ]
    return st.one_of(
        st.builds(bytes_at, st.integers(0, len(data)), st.binary(max_size=4), st.integers(0, 6)),
        st.builds(word, st.integers(0, count), st.integers(0, 3), st.sampled_from(words)),
        st.builds(columns, st.lists(st.integers(0, 3), min_size=1, max_size=5)),
        st.lists(st.integers(0, count), max_size=3).map(lambda extra: lines([*range(count), *extra])),
        st.sets(st.integers(0, count - 1), max_size=3).map(
            lambda gone: lines([k for k in range(count) if k not in gone])
        ),
        st.permutations(range(1, count)).map(lambda order: lines([0, *order])),
    )


def as_table(data):
    """The numbers of a file, read apart from what is tested: by name, and each row by its point."""
    rows = [row for row in csv.reader(io.StringIO(data.decode("utf-8-sig"))) if row and row[0][:1] != "#"]
    names = [name.strip() for name in rows[0]]
    return [dict(zip(names, map(float, row), strict=True)) for row in rows[1:]]


def outcome(path):
    """(data, message): what a file is read as, or the message by which it is refused."""
    try:
        return read(path), ""
    except HairlutError as error:
        return None, str(error)


@settings(max_examples=300, deadline=None)
@given(data=mutated(GOOD.encode()))
@example(data=GOOD.encode())
@example(data=GOOD.replace("-75.0", "-74.0", 1).encode())
def test_a_mutated_file_is_the_grid_that_it_says_or_is_refused(data, tmp_path_factory):
    """Never a traceback, and never draws, or a value at another point than where the file has it."""
    path = tmp_path_factory.mktemp("mutated") / "data.csv"
    path.write_bytes(data)
    grid, error = outcome(path)
    if error:
        assert error.startswith(f"{path}: ")
        assert "\n" not in error
        return
    assert isinstance(grid, Grid)
    points = as_table(data)
    assert grid.value.size == len(points)
    axes = grid.theta_r, grid.theta_i, grid.phi
    for point in points:
        angles = [np.radians(point[name]) for name in DEGREES[:3]]
        place = tuple(int(abs(axis - angle).argmin()) for axis, angle in zip(axes, angles, strict=True))
        off = [axis[k] - angle for axis, k, angle in zip(axes, place, angles, strict=True)]
        assert max(abs(np.mod(np.array(off) + np.pi, 2 * np.pi) - np.pi)) < 2e-6
        assert grid.value[place] == point["value"]


@settings(max_examples=60, deadline=None)
@given(
    at=st.integers(0, 5000), new=st.binary(max_size=8), removed=st.integers(0, 40), cut=st.integers(0, 5000)
)
def test_damaged_arrays_are_the_same_or_refused(at, new, removed, cut, whole, tmp_path_factory):
    path = tmp_path_factory.mktemp("damaged") / "data.npz"
    damaged = whole[: at % len(whole)] + new + whole[at % len(whole) + removed :]
    path.write_bytes(damaged[: len(damaged) - cut % 50])
    grid, error = outcome(path)
    if error:
        assert "\n" not in error
    else:
        assert_good(grid)


def test_the_mutations_include_draws_and_grids():
    """What the property above must tell apart exists."""
    assert isinstance(read(INPUTS / "draws_of_two_gaussians.csv"), Draws)
    assert isinstance(read(INPUTS / "grid_whole.csv"), Grid)

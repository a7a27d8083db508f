# SPDX-License-Identifier: BSD-3-Clause
"""Model files: what they mean, and that a mistake in one is named by file, lobe, theta_r and reason."""

import os
import sys
import warnings

import numpy as np
import pytest

from hairlut import cli, exr, modelfile
from hairlut.errors import HairlutError
from hairlut.lobecheck import find_jump
from hairlut.lobes import TABLES

GOOD = """
import numpy as np
from hairlut.modelfile import density, gaussian

def bend(theta_r):
    return -theta_r - np.radians(3)

LOBES = (
    gaussian("direct_theta", mean=bend, sigma=0.2),
    density("direct_phi", log_density=lambda phi, theta_r: 2 * np.cos(phi - np.pi) + 0 * theta_r),
    density("multiple_theta", density=lambda x, theta_r: np.cos(x) + 0 * theta_r),
)
"""


def written(folder, text, name="hair.py"):
    path = folder / name
    path.write_text(text)
    return path


def test_a_python_file_is_a_model(tmp_path):
    model = modelfile.find(str(written(tmp_path, GOOD)))
    assert model.name == "hair"
    assert [lobe.name for lobe in model.lobes] == [
        "direct_theta",
        "direct_phi",
        "multiple_theta",
    ]
    assert [lobe.azimuth for lobe in model.lobes] == ["none", "difference", "none"]
    x, theta_r = np.array([[-0.4, 0.1]]), np.array([[0.3], [0.5]])
    np.testing.assert_allclose(
        np.diff(model.direct_theta.log_density(x, theta_r)),
        -0.5 * np.diff((x + theta_r + np.radians(3)) ** 2) / 0.04,
    )
    np.testing.assert_allclose(np.exp(model.multiple_theta.log_density(x, theta_r)), np.cos(x) + 0 * theta_r)


def test_the_azimuth_may_be_a_sum(tmp_path):
    model = modelfile.find(str(written(tmp_path, GOOD + 'AZIMUTH = "sum"\n')))
    assert model.direct_phi.azimuth == "sum"
    assert model.direct_theta.azimuth == "none"


def changed(old, new):
    assert old in GOOD
    return GOOD.replace(old, new)


PHI = "2 * np.cos(phi - np.pi) + 0 * theta_r"
MISTAKES = {
    "not vectorised, math": (
        changed(PHI, "__import__('math').cos(phi) + 0 * theta_r"),
        ["direct_phi", "not vectorised", "np.exp"],
    ),
    "not vectorised, if": (
        changed(PHI, "0.0 if phi < 1 else theta_r"),
        ["direct_phi", "not vectorised", "truth value"],
    ),
    "not vectorised, maximum": (
        changed(PHI, "phi - np.max(phi + 0 * theta_r) + 0 * theta_r"),
        ["direct_phi at theta_r = -90 deg", "not vectorised", "its own x"],
    ),
    "not vectorised, shape": (
        changed(PHI, "np.zeros(7)"),
        ["direct_phi", "not vectorised", "shape (7,)"],
    ),
    "NaN": (
        changed(PHI, "np.where((phi > 3) & (theta_r > 0.5), np.nan, 0.0)"),
        ["direct_phi at theta_r = 30 deg (0.523599 rad)", "NaN at x = 3.0"],
    ),
    "infinite": (
        changed(PHI, "np.where((phi > 3) & (theta_r > 0.5), np.inf, 0.0)"),
        ["direct_phi at theta_r = 30 deg", "infinite at x = 3.0"],
    ),
    "negative": (
        changed("np.cos(x) + 0 * theta_r", "np.cos(x) - theta_r"),
        ["multiple_theta at theta_r = 5 deg", "negative density"],
    ),
    "no mass": (
        changed("np.cos(x) + 0 * theta_r", "np.where(abs(theta_r) > 1, 0.0, 1.0) + 0 * x"),
        ["multiple_theta at theta_r = -90 deg", "no mass in the domain"],
    ),
    "fails inside": (
        changed(PHI, "undefined * phi"),
        ["direct_phi", "NameError", "undefined"],
    ),
    "lobe missing": (
        changed('    gaussian("direct_theta", mean=bend, sigma=0.2),\n', ""),
        ["direct_phi has no direct_theta beside it"],
    ),
    "lobe unknown": (
        changed('"direct_phi"', '"direct_fi"'),
        ["hair.py", "'direct_fi' is not known"],
    ),
    "both densities": (
        changed("density=lambda x", "log_density=bend, density=lambda x"),
        ["multiple_theta", "not both"],
    ),
    "azimuth": (GOOD + 'AZIMUTH = "left"\n', ["azimuth 'left'", "difference, sum"]),
    "no lobes": ("x = 1\n", ["expected LOBES"]),
    "a BSDF": (
        "def bsdf(theta_r, theta_i, phi):\n    return 1.0\n",
        ["expected LOBES", "it defines bsdf: hairlut fit"],
    ),
    "syntax": ("LOBES = (\n", ["hair.py:1", "SyntaxError"]),
    "raises": (
        "import numpy as np\nnp.zeros(2) @ np.zeros(3)\n",
        ["hair.py:2", "ValueError"],
    ),
    "raises inside": (changed("-theta_r - np.radians(3)", "[][1]"), ["hair.py:6", "IndexError"]),
    "raises elsewhere": (
        changed(
            "    return -theta_r",
            "    if theta_r.size not in (1, 37): raise ValueError(theta_r.size)\n    return -theta_r",
        ),
        ["hair.py:6: ValueError"],
    ),
    "ends": (GOOD + "import sys\nsys.exit()\n", ["hair.py:14", "calls sys.exit()"]),
    "ends inside": (changed(PHI, "exit()"), ["hair.py:10", "calls sys.exit()"]),
    "asks": (GOOD + "input('sigma? ')\n", ["reads standard input"]),
    "asks below Python": (GOOD + "import os\nassert os.read(0, 1)\n", ["hair.py:14: AssertionError"]),
    "no module": ("import nowhere_to_be_found\n", ["hair.py:1", "ModuleNotFoundError", "beside the file"]),
    "many lines": ("raise ValueError('one\\ntwo')\n", ["hair.py:1: ValueError: one"]),
    "zero byte": ("x = 1\n\0\n", ["line 2 contains a zero byte"]),
    "lower case": (GOOD + 'azimuth = "sum"\n', ["azimuth is no setting: did you mean AZIMUTH"]),
    "misspelt": (GOOD + 'AZIMUT = "sum"\n', ["AZIMUT is no setting: did you mean AZIMUTH"]),
    "both cases": (GOOD + 'AZIMUTH = azimuth = "sum"\n', ["azimuth is no setting"]),
    "lower-case lobes": (changed("LOBES", "lobes"), ["lobes is no setting: did you mean LOBES"]),
    "misspelt inputs": (GOOD + 'INPUT = ("a.csv",)\n', ["INPUT is no setting: did you mean INPUTS"]),
    "azimuth of another type": (GOOD + "AZIMUTH = 1\n", ["AZIMUTH is 1: expected one of"]),
    "one input": (GOOD + 'INPUTS = "a.csv"\n', ["INPUTS is 'a.csv': expected a tuple of file names"]),
    "a lobe alone": (
        "from hairlut.modelfile import gaussian\nLOBES = gaussian('direct_theta', 0.1, 0.2)\n",
        ["LOBES is"],
    ),
    "sigma in degrees": (
        changed("sigma=0.2", "sigma=10"),
        ["direct_theta", "sigma is 10 rad", "in degrees?"],
    ),
    "small sigma in degrees": (changed("sigma=0.2", "sigma=2"), ["sigma is 2 rad", "in degrees?"]),
    "mean in degrees": (changed("np.radians(3)", "np.degrees(3)"), ["mean is", "in degrees?"]),
    "shift in degrees": (
        changed("np.radians(3)", "3"),
        ["at theta_r = 0 deg", "mean is -3 rad", "in degrees?"],
    ),
    "azimuth in degrees": (
        GOOD.replace(
            f'density("direct_phi", log_density=lambda phi, theta_r: {PHI})',
            'gaussian("direct_phi", mean=180, sigma=1)',
        ),
        ["direct_phi", "mean is 180 rad", "in degrees?"],
    ),
    "breakpoints in degrees": (
        changed("np.cos(x) + 0 * theta_r)", "np.cos(x) + 0 * theta_r, breakpoints=(45.0,))"),
        ["a breakpoint at 45 rad", "in degrees?"],
    ),
    "sigma of zero": (changed("sigma=0.2", "sigma=0"), ["sigma is 0 rad: expected a finite number above 0"]),
    "sigma below zero": (changed("sigma=0.2", "sigma=-0.2"), ["sigma is -0.2 rad: expected"]),
    "sigma NaN": (changed("sigma=0.2", "sigma=np.nan"), ["sigma is nan rad: expected"]),
    "sigma as text": (
        changed("sigma=0.2", "sigma='0.2'"),
        ["direct_theta: sigma is '0.2': expected a number"],
    ),
    "cells in degrees": (
        "import numpy as np\nfrom hairlut.modelfile import tabulated\n"
        "EDGES = np.linspace(-np.pi / 2, np.pi / 2, 5)\n"
        "LOBES = (tabulated('direct_theta', EDGES, [-60, 0, 60], np.ones((3, 4))),)\n",
        ["direct_theta: theta_r runs from -60 to 60", "degrees?"],
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda name: name.replace(" ", "-"))
def test_a_mistake_is_one_line_that_names_it(mistake, tmp_path, capsys):
    text, expected = MISTAKES[mistake]
    path = written(tmp_path, text)
    assert cli.main(["bake", "--model", str(path), "--out", str(tmp_path / "out")]) == cli.WRONG_USE
    said = capsys.readouterr().err
    for part in [str(path), *expected]:
        assert part in said
    assert "Traceback" not in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_file_may_import_its_neighbours_which_belong_to_its_inputs(tmp_path, capsys):
    """And another file in another folder has its own neighbour of that name."""
    for folder, sigma in (("a", 0.2), ("b", 0.3)):
        (tmp_path / folder).mkdir()
        written(tmp_path / folder, f"SIGMA = {sigma}\nprint('loud')\n", "widths.py")
        path = written(tmp_path / folder, "from widths import SIGMA\n" + changed("sigma=0.2", "sigma=SIGMA"))
        _, found = modelfile.find(str(path)).direct_theta.moments(np.zeros(1))
        np.testing.assert_array_equal(found, sigma)
        assert modelfile.inputs(path) == [path, tmp_path / folder / "widths.py"]
        assert sorted(file.name for file in (tmp_path / folder).iterdir()) == ["hair.py", "widths.py"]
    assert capsys.readouterr().out == ""


def test_an_environment_below_the_folder_is_no_neighbour(tmp_path, monkeypatch):
    """As where a model stands beside .venv/."""
    (tmp_path / ".venv" / "lib").mkdir(parents=True)
    written(tmp_path / ".venv" / "lib", "SIGMA = 0.3\n", "widths_installed.py")
    monkeypatch.syspath_prepend(tmp_path / ".venv" / "lib")
    path = written(tmp_path, "import widths_installed\n" + GOOD)
    assert modelfile.inputs(path) == [path]
    assert "widths_installed" in sys.modules
    monkeypatch.delitem(sys.modules, "widths_installed")


def test_names_of_the_files_own_are_free(tmp_path):
    """A function or an array is no setting, however it is called."""
    more = "def azimuth(phi):\n    return phi\nlobe = 3\nAZIMUTHS = (1, 2)\n_azimuth = 'sum'\n"
    assert modelfile.find(str(written(tmp_path, GOOD + more))).direct_phi.azimuth == "difference"


def test_a_file_in_its_own_encoding_is_read(tmp_path):
    path = tmp_path / "hair.py"
    path.write_bytes(("# -*- coding: latin-1 -*-\n# 5\xb0\n" + GOOD).encode("latin-1"))
    assert modelfile.find(str(path)).name == "hair"


def test_what_a_file_changes_of_the_process_is_put_back(tmp_path):
    more = "import os, warnings\nos.chdir('/')\nnp.seterr(all='raise')\nwarnings.simplefilter('error')\n"
    before = os.getcwd(), np.geterr(), list(warnings.filters)
    modelfile.find(str(written(tmp_path, GOOD + more)))
    assert (os.getcwd(), np.geterr(), list(warnings.filters)) == before


def test_standard_input_is_there_again_afterwards(tmp_path):
    before = sys.stdin, list(sys.path), os.fstat(0)
    with pytest.raises(HairlutError):
        modelfile.find(str(written(tmp_path, "input()\n")))
    assert (sys.stdin, sys.path) == before[:2]
    assert os.path.samestat(os.fstat(0), before[2])


def test_a_jump_that_the_tolerance_cannot_resolve_is_named(tmp_path, capsys):
    step = "np.where(x > 0.3, 0.0, 1.0) + 0.2 + 0 * theta_r"
    lobe = f'density("direct_theta", density=lambda x, theta_r: {step})'
    path = written(tmp_path, changed('gaussian("direct_theta", mean=bend, sigma=0.2)', lobe))
    arguments = [
        "bake",
        "--model",
        str(path),
        "--tolerance",
        "1e-5",
        "--max-size",
        "32",
        "--out",
        str(tmp_path),
    ]
    assert cli.main(arguments) == 1
    said = capsys.readouterr().err
    assert "hair/direct_theta" in said
    assert "jumps at x = 0.3 rad where theta_r = -90 deg" in said


def test_a_smooth_density_has_no_jump(tmp_path):
    model = modelfile.find(str(written(tmp_path, GOOD)))
    assert all(find_jump(lobe, 0.2) is None for lobe in model.lobes)


@pytest.mark.parametrize("sigma", [1e-2, 1e-4, 1e-6, 1e-8])
def test_a_narrow_density_has_no_jump(sigma, make_lobe, normal):
    assert find_jump(make_lobe(normal(0.00123, sigma)), 0.2) is None


@pytest.mark.parametrize("at", [0.3, 0.0, -1.2])
def test_a_jump_is_where_it_is(at, make_lobe):
    def step(x, theta_r):
        with np.errstate(divide="ignore"):
            return np.log(np.where(x > at, 0.9, 1.0)) + 0 * theta_r

    assert find_jump(make_lobe(step), 0.2) == pytest.approx(at, abs=1e-12)


def test_a_narrow_density_is_called_narrow(tmp_path, capsys):
    path = written(tmp_path, changed("sigma=0.2", "sigma=1e-5"))
    assert cli.main(["bake", "--model", str(path), "--out", str(tmp_path)]) == cli.CHECK_FAILED
    said = capsys.readouterr().err
    assert "half of the light within 1.3" in said
    assert "jump" not in said
    assert "0x33" not in said


TOML = """
azimuth = "difference"
[direct_theta]
theta_r_deg = [-60, 0, 60]
sigma_rad = [0.3, 0.2, 0.25]
shift_deg = [-5, -3, 1]
[direct_phi]
theta_r_deg = 0
sigma_deg = 40
mean_deg = 180
[multiple_theta]
theta_r_rad = [-1, 1]
sigma_rad = 0.5
mean_rad = [0.5, -0.25]
"""


def test_a_toml_file_gives_gaussians_by_numbers(tmp_path):
    model = modelfile.find(str(written(tmp_path, TOML, "hair.toml")))
    theta_r = np.radians([-80.0, -60, 0, 60])
    mean, sigma = model.direct_theta.moments(theta_r)
    np.testing.assert_allclose(np.degrees(mean + theta_r), [-5, -5, -3, 1], atol=1e-12)
    np.testing.assert_allclose(sigma, [0.3, 0.3, 0.2, 0.25])
    mean, sigma = model.direct_phi.moments(theta_r)
    np.testing.assert_allclose(mean, np.pi)
    np.testing.assert_allclose(sigma, np.radians(40))
    mean, _ = model.multiple_theta.moments(np.array([-1.5, -1, 0, 1]))
    np.testing.assert_allclose(mean, [0.5, 0.5, 0.125, -0.25])


TOML_MISTAKES = {
    "sigma of zero": (
        "[0.3, 0.2, 0.25]",
        "[0.3, 0, 0.25]",
        ["direct_theta at theta_r = 0 deg", "above 0"],
    ),
    "too few": (
        "[0.3, 0.2, 0.25]",
        "[0.3, 0.2]",
        ["direct_theta: sigma", "2 numbers for 3 theta_r"],
    ),
    "not rising": (
        "[-60, 0, 60]",
        "[-60, 60, 0]",
        ["direct_theta", "increase strictly"],
    ),
    "no unit": ("sigma_deg = 40", "sigma = 40", ["direct_phi", "_deg or _rad"]),
    "no mean": ("mean_deg = 180", "", ["direct_phi", "mean_deg or shift_deg"]),
    "text": (
        "sigma_deg = 40",
        'sigma_deg = "wide"',
        ["direct_phi", "sigma_deg", "list of numbers"],
    ),
    "broken": ("[direct_phi]", "[direct_phi", ["hair.toml", "line"]),
    "misspelt": ("azimuth", "azimut", ["azimut is not known, did you mean azimuth?"]),
    "upper case": ("azimuth", "Azimuth", ["Azimuth is not known, did you mean azimuth?"]),
    "another table": ("[direct_phi]", "[direct_fi]", ["direct_fi", "not known"]),
    "another key": ("sigma_deg", "sigmas_deg", ["sigmas_deg is not known, did you mean sigma_deg?"]),
    "twice": ("sigma_deg = 40", "sigma_deg = 40\nsigma_deg = 40", ["hair.toml", "line 10"]),
    "both units": (
        "sigma_deg = 40",
        "sigma_deg = 40\nsigma_rad = 1",
        ["sigma_deg and sigma_rad are both there"],
    ),
    "mean and shift": ("mean_deg = 180", "mean_deg = 180\nshift_deg = 0", ["either mean_deg or shift_deg"]),
    "three for one": ("sigma_deg = 40", "sigma_deg = [40, 41]", ["sigma_deg: 2 numbers for 1 theta_r"]),
    "degrees": (
        "theta_r_rad = [-1, 1]",
        "theta_r_rad = [-60, 60]",
        ["theta_r_rad has 60", "name it theta_r_deg"],
    ),
    "sigma in degrees": ("sigma_rad = 0.5", "sigma_rad = 10", ["sigma_rad has 10", "name it sigma_deg"]),
    "small sigma in degrees": ("sigma_rad = 0.5", "sigma_rad = 2", ["sigma_rad has 2", "name it sigma_deg"]),
    "mean in degrees": ("mean_deg", "mean_rad", ["mean_rad has 180", "name it mean_deg"]),
    "radians": ("theta_r_rad = [-1, 1]", "theta_r_deg = [-1, 1]", ["in radians? name it theta_r_rad"]),
    "sigma in radians": ("sigma_deg = 40", "sigma_deg = 0.4", ["in radians? name it sigma_rad"]),
    "azimuth of another type": ('"difference"', "[1]", ["azimuth [1]: expected one of"]),
    "beyond the pole": (
        "[-60, 0, 60]",
        "[-60, 0, 100]",
        ["theta_r_deg has 100: expected at most 90 degrees"],
    ),
    "huge": ("sigma_deg = 40", f"sigma_deg = 1{'0' * 400}", ["sigma_deg: expected a number"]),
    "not finite": ("sigma_deg = 40", "sigma_deg = inf", ["sigma_deg: expected a number"]),
}


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (TOML.encode("utf-16"), "UTF-16, expected UTF-8"),
        (("# 5\xb0" + TOML).encode("latin-1"), "line 1: byte 0xb0 is not UTF-8"),
    ],
)
def test_toml_in_another_encoding_is_named(data, said, tmp_path):
    (tmp_path / "hair.toml").write_bytes(data)
    with pytest.raises(HairlutError, match=said):
        modelfile.find(str(tmp_path / "hair.toml"))


def test_a_flat_lobe_may_be_given_in_degrees(tmp_path):
    path = written(tmp_path, TOML.replace("sigma_deg = 40", "sigma_deg = 573"), "hair.toml")
    _, sigma = modelfile.find(str(path)).direct_phi.moments(np.zeros(1))
    np.testing.assert_allclose(sigma, np.radians(573))


def test_toml_with_a_byte_order_mark_is_read(tmp_path):
    (tmp_path / "hair.toml").write_bytes(TOML.encode("utf-8-sig"))
    assert modelfile.find(str(tmp_path / "hair.toml")).direct_phi.azimuth == "difference"


@pytest.mark.parametrize("mistake", TOML_MISTAKES, ids=lambda name: name.replace(" ", "-"))
def test_a_mistake_in_toml_is_named(mistake, tmp_path):
    old, new, expected = TOML_MISTAKES[mistake]
    path = written(tmp_path, TOML.replace(old, new), "hair.toml")
    with pytest.raises(HairlutError) as caught:
        modelfile.find(str(path))
    for part in [str(path), *expected]:
        assert part in str(caught.value)


def test_an_npz_gives_shares(tmp_path):
    edges = np.linspace(-np.pi / 2, np.pi / 2, 5)
    tables = {"a_theta.edges": edges, "a_theta.theta_r": np.zeros(1), "a_theta.mass": np.ones((1, 4))}
    tables |= {f"b{key[1:]}": values for key, values in tables.items()}
    path = tmp_path / "hair.npz"
    np.savez(path, **tables, **{"a.share": 0.25, "b.share": 0.75})
    assert modelfile.find(str(path)).shares == (0.25, 0.75)
    np.savez(path, **tables, **{"a.share": 0.25})
    with pytest.raises(HairlutError, match="shares of a: expected a number for each of a, b"):
        modelfile.find(str(path))
    np.savez(path, **tables, **{"a.share": np.ones(2), "b.share": 1})
    with pytest.raises(HairlutError, match="a share has several numbers"):
        modelfile.find(str(path))


def test_an_npz_without_an_array_is_refused(tmp_path):
    np.savez(tmp_path / "hair.npz", azimuth="difference")
    with pytest.raises(HairlutError, match=r"hair\.npz: array NAME\.edges is missing"):
        modelfile.find(str(tmp_path / "hair.npz"))


def test_a_missing_model_file_and_data_are_no_models(tmp_path):
    with pytest.raises(HairlutError, match=r"hair\.py: no such file"):
        modelfile.find(str(tmp_path / "hair.py"))
    with pytest.raises(HairlutError, match="hairlut fit makes a model of data"):
        modelfile.find(str(tmp_path / "hair.csv"))


def test_an_unknown_model_lists_what_there_is():
    with pytest.raises(HairlutError, match=r"expected one of printed, fitted, or a file ending in \.py"):
        modelfile.find("fited")


def test_bake_writes_a_model_that_reads_back(tmp_path):
    path = written(tmp_path, GOOD)
    assert (
        cli.main(
            [
                "bake",
                "--model",
                str(path),
                "--size",
                "24x24",
                "--out",
                str(tmp_path / "out"),
            ]
        )
        == cli.OK
    )
    for name in TABLES:
        table, errors = exr.read(tmp_path / "out" / "hair" / f"{name}.exr")
        assert (table.model, table.name, table.width, table.height) == (
            "hair",
            name,
            24,
            24,
        )
        assert errors["relative_variance"] < 0.1

"""Model files: what they mean, and that a mistake in one is named by file, lobe, theta_r and reason."""

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
        ["expected one each of direct_theta, direct_phi, multiple_theta"],
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
    "syntax": ("LOBES = (\n", ["hair.py:1", "SyntaxError"]),
    "raises": (
        "import numpy as np\nnp.zeros(2) @ np.zeros(3)\n",
        ["hair.py:2", "ValueError"],
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
}


@pytest.mark.parametrize("mistake", TOML_MISTAKES, ids=lambda name: name.replace(" ", "-"))
def test_a_mistake_in_toml_is_named(mistake, tmp_path):
    old, new, expected = TOML_MISTAKES[mistake]
    path = written(tmp_path, TOML.replace(old, new), "hair.toml")
    with pytest.raises(HairlutError) as caught:
        modelfile.find(str(path))
    for part in [str(path), *expected]:
        assert part in str(caught.value)


def test_an_npz_without_an_array_is_refused(tmp_path):
    np.savez(tmp_path / "hair.npz", azimuth="difference")
    with pytest.raises(HairlutError, match=r"hair\.npz: array direct_theta\.edges is missing"):
        modelfile.find(str(tmp_path / "hair.npz"))


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

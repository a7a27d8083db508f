# SPDX-License-Identifier: BSD-3-Clause
"""Directories of model files: each in a process of its own, resumable, with one summary and one exit code."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hairlut import batch_bake, exr, manifest, modelfile
from hairlut.errors import HairlutError
from hairlut.lobes import TABLES

HAIR = """
from hairlut.modelfile import gaussian
LOBES = (
    gaussian("direct_theta", mean=lambda theta_r: -theta_r, sigma={sigma}),
    gaussian("direct_phi", mean=3.14159, sigma=0.7),
    gaussian("multiple_theta", mean=0.0, sigma=0.5),
)
"""


def hairlut(*args):
    command = [sys.executable, "-m", "hairlut.cli", *map(str, args)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)


def bake(source, out, *more):
    return hairlut("bake", "--model", source, "--size", "16x8", "--out", out, "--jobs", "2", *more)


@pytest.fixture
def hairs(tmp_path):
    folder = tmp_path / "hairs"
    folder.mkdir()
    for name, sigma in (("brown", 0.3), ("grey", 0.4)):
        (folder / f"{name}.py").write_text(HAIR.format(sigma=sigma))
    (folder / "_shared.py").write_text("not a model")
    (folder / "notes.txt").write_text("not a model either")
    return folder


def test_one_failing_model_does_not_stop_the_others(hairs, tmp_path):
    (hairs / "broken.py").write_text(HAIR.format(sigma="undefined"))
    done = bake(hairs, tmp_path / "out")
    assert done.returncode == 1
    assert "3 models: 2 baked, 0 up to date, 1 failed" in done.stdout
    assert f"failed: {hairs / 'broken.py'}" in done.stdout
    assert "name 'undefined' is not defined" in done.stderr
    assert "Traceback" not in done.stderr
    for name in ("brown", "grey"):
        for table in TABLES:
            assert exr.read(tmp_path / "out" / name / f"{table}.exr")[0].model == name
    assert not (tmp_path / "out" / "broken").exists()


def test_a_second_run_bakes_only_what_changed(hairs, tmp_path):
    out = tmp_path / "out"
    assert bake(hairs, out).returncode == 0
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*.exr")}
    assert "2 models: 0 baked, 2 up to date, 0 failed" in bake(hairs, out).stdout
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*.exr")} == before

    (out / "grey" / "direct_phi.exr").unlink()  # as an interrupted run leaves it
    assert "2 models: 1 baked, 1 up to date, 0 failed" in bake(hairs, out).stdout
    assert (out / "brown" / "direct_phi.exr").stat().st_mtime_ns == before[out / "brown" / "direct_phi.exr"]
    assert (out / "grey" / "direct_phi.exr").exists()


def test_textures_do_not_depend_on_how_they_were_baked(hairs, tmp_path):
    """The job is a function of the model file and the options alone, so a queue may run it anywhere."""
    bake(hairs, tmp_path / "together")
    for source in sorted(hairs.glob("[!_]*.py")):
        hairlut("bake", "--model", source, "--size", "16x8", "--out", tmp_path / "alone")
    files = sorted(path.relative_to(tmp_path / "alone") for path in (tmp_path / "alone").rglob("*.*"))
    assert len(files) == 10
    for file in files:
        assert (tmp_path / "alone" / file).read_bytes() == (tmp_path / "together" / file).read_bytes()


def test_a_process_that_ends_fails_its_model_alone(hairs, tmp_path):
    (hairs / "ends.py").write_text("import os\nos._exit(7)\n")
    out = tmp_path / "out"
    done = hairlut("bake", "--model", hairs, "--size", "16x8", "--out", out, "--jobs", "1")
    assert done.returncode == 1
    assert "3 models: 2 baked, 0 up to date, 1 failed" in done.stdout
    assert "no output, exit code 7" in done.stderr


def test_a_folder_named_hairlut_beside_the_models_is_not_imported(hairs, tmp_path):
    """As where the working directory is the parent of a clone."""
    (tmp_path / "hairlut").mkdir()
    (tmp_path / "hairlut" / "README.md").write_text("a clone")
    (tmp_path / "numpy.py").write_text("raise SystemExit(9)")
    program = Path(sys.executable).with_name("hairlut")
    command = [program, "bake", "--model", "hairs", "--size", "16x8", "--out", "out", "--jobs", "2"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120)
    assert "2 models: 2 baked, 0 up to date, 0 failed" in done.stdout, done.stderr


def test_a_model_that_waits_for_an_answer_fails(hairs, tmp_path):
    (hairs / "asks.py").write_text("input()\n")
    done = bake(hairs, tmp_path / "out")
    assert "3 models: 2 baked, 0 up to date, 1 failed" in done.stdout
    assert "asks.py:1: reads standard input" in done.stderr


LOOPS = {
    "the file": "while True: pass\n",
    "a function": HAIR.format(sigma="lambda t: [0 for _ in iter(int, 1)]"),
}


@pytest.mark.parametrize("where", LOOPS)
def test_a_model_that_loops_fails_in_time(where, hairs, tmp_path):
    (hairs / "loops.py").write_text(LOOPS[where])
    (hairs / "grey.py").unlink()
    done = bake(hairs, tmp_path / "out", "--timeout", "8")
    assert done.returncode == 1
    assert "2 models: 1 baked, 0 up to date, 1 failed" in done.stdout
    assert f"{hairs / 'loops.py'}: not baked after 8 s: does it loop?" in done.stderr


def test_a_file_alone_has_a_timeout_too(hairs, tmp_path):
    (hairs / "loops.py").write_text(LOOPS["the file"])
    done = bake(hairs / "loops.py", tmp_path / "out", "--timeout", "2")
    assert done.returncode == 1
    assert "not baked after 2 s" in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_model_that_quits_fails(hairs, tmp_path):
    (hairs / "quits.py").write_text(HAIR.format(sigma=0.3) + "import sys\nsys.exit()\n")
    done = bake(hairs, tmp_path / "out")
    assert done.returncode == 1
    assert "3 models: 2 baked, 0 up to date, 1 failed" in done.stdout
    assert "quits.py:9: calls sys.exit()" in done.stderr


def test_the_code_of_one_model_changes_no_other(hairs, tmp_path):
    spoils = "import hairlut.size\nhairlut.size.EXPONENTS = ()\n"
    (hairs / "a_spoiler.py").write_text(spoils + HAIR.format(sigma=0.3))
    done = hairlut("bake", "--model", hairs, "--size", "16x8", "--out", tmp_path / "out", "--jobs", "1")
    assert "3 models: 2 baked, 0 up to date, 1 failed" in done.stdout
    assert f"failed: {hairs / 'a_spoiler.py'}" in done.stdout


def test_what_a_model_prints_is_no_answer(hairs, tmp_path):
    prints = 'import os\nos.write(1, b"[0, 1]")\nprint("[2, 3]")\n'
    (hairs / "loud.py").write_text(prints + HAIR.format(sigma=0.3))
    assert "3 models: 3 baked" in bake(hairs, tmp_path / "out").stdout


# ---- lobes that models share


def masses(azimuth):
    """The arrays of an npz file; all of these share their inclinations, and none has a multiple lobe."""
    theta_r, theta_i = np.radians([-60.0, 0.0, 60.0]), np.linspace(-np.pi / 2, np.pi / 2, 25)
    phi = np.linspace(0, 2 * np.pi, 25)
    middle = (phi[1:] + phi[:-1]) / 2
    lobes = {
        "direct_theta": (theta_i, theta_r, np.exp(-8 * (theta_i[1:] + 0.9 * theta_r[:, None]) ** 2)),
        "direct_phi": (phi, theta_r, np.exp(3 * np.cos(middle - azimuth - 0.3 * theta_r[:, None]))),
        "multiple_theta": (theta_i[[0, -1]], np.zeros(1), np.ones((1, 1))),
    }
    arrays = zip(("edges", "theta_r", "mass"), zip(*lobes.values(), strict=True), strict=True)
    return {f"{n}.{part}": a for part, each in arrays for n, a in zip(lobes, each, strict=True)}


@pytest.fixture
def relatives(tmp_path):
    folder = tmp_path / "relatives"
    folder.mkdir()
    for k, azimuth in enumerate((2.0, 3.0, 4.0)):
        np.savez(folder / f"lobe_{k}.npz", azimuth=np.array("difference"), **masses(azimuth))
    return folder


@pytest.mark.parametrize("options", [["--size", "24x19"], ["--tolerance", "1e-2"]], ids=" ".join)
def test_shared_lobes_are_baked_as_if_each_model_were_alone(relatives, tmp_path, options):
    """Byte for byte: alone, one after the other in one process, and shared out between two."""
    for jobs in (1, 2):
        command = ["bake", "--model", relatives, *options, "--jobs", jobs, "--out", tmp_path / f"{jobs}"]
        assert hairlut(*command).returncode == 0
    for source in sorted(relatives.iterdir()):
        hairlut("bake", "--model", source, *options, "--out", tmp_path / "alone")
    files = sorted(path.relative_to(tmp_path / "alone") for path in (tmp_path / "alone").rglob("*.*"))
    assert len(files) == 15
    for file in files:
        alone = (tmp_path / "alone" / file).read_bytes()
        assert (tmp_path / "1" / file).read_bytes() == alone
        assert (tmp_path / "2" / file).read_bytes() == alone
    assert exr.read(tmp_path / "1" / "lobe_2" / "direct_theta.exr")[0].model == "lobe_2"


def test_two_files_of_one_name_are_refused(hairs):
    (hairs / "brown.toml").write_text("")
    with pytest.raises(
        HairlutError, match=r"brown\.py and .*brown\.toml would both bake to brown/: rename one"
    ):
        batch_bake.model_files([hairs])


def test_a_directory_without_models_is_refused(tmp_path):
    (tmp_path / "empty").mkdir()
    done = bake(tmp_path / "empty", tmp_path / "out")
    assert done.returncode == 2
    assert "empty: no model files: expected names ending in .py, .toml, .npz" in done.stderr


@pytest.fixture
def baked(tmp_path):
    source, data = tmp_path / "hair.py", tmp_path / "width.txt"
    data.write_text("0.3")
    source.write_text(
        'INPUTS = ("width.txt",)\nfrom pathlib import Path\n'
        + HAIR.format(sigma='float((Path(__file__).parent / "width.txt").read_text())')
    )
    folder = tmp_path / "out" / "hair"
    folder.mkdir(parents=True)
    (folder / "direct_theta.exr").write_bytes(b"texture")
    manifest.record(folder, modelfile.inputs(source), [folder / "direct_theta.exr"], {"size": "16x8"})
    return source, data, folder


@pytest.mark.parametrize(
    "change",
    [
        lambda source, data, folder: source.write_text(source.read_text() + "# changed\n"),
        lambda source, data, folder: data.write_text("0.4"),
        lambda source, data, folder: data.unlink(),
        lambda source, data, folder: (folder / "direct_theta.exr").write_bytes(b"torn"),
        lambda source, data, folder: (folder / "manifest.json").write_text("{"),
        lambda source, data, folder: (folder / "manifest.json").unlink(),
    ],
    ids=["model", "input", "input gone", "texture", "manifest torn", "manifest gone"],
)
def test_textures_are_out_of_date_when_anything_changed(baked, change):
    source, _, folder = baked
    assert manifest.is_current(folder, source, {"size": "16x8"})
    assert not manifest.is_current(folder, source, {"size": "32x8"})
    change(*baked)
    assert not manifest.is_current(folder, source, {"size": "16x8"})


def test_a_manifest_names_no_place_on_this_machine(baked):
    _, _, folder = baked
    inputs = json.loads((folder / manifest.NAME).read_text())["inputs"]
    assert set(inputs) == {"../../hair.py", "../../width.txt"}
    assert not any(Path(name).is_absolute() for name in inputs)


def test_a_manifest_leads_to_a_model_of_numbers_but_never_runs_code(baked, luts):
    _, _, folder = baked
    assert manifest.source(folder) is None
    found = manifest.source(luts / "measured")
    assert found is not None
    assert found.name == "measured.toml"
    assert manifest.source(folder.parent) is None


def test_the_measured_example_is_what_the_bake_writes_today(luts, tmp_path):
    assert hairlut("bake", "--model", manifest.source(luts / "measured"), "--out", tmp_path).returncode == 0
    for file in sorted((luts / "measured").glob("*_*.exr")):
        (shipped, claimed), (fresh, errors) = exr.read(file), exr.read(tmp_path / "measured" / file.name)
        assert shipped.warp == fresh.warp
        np.testing.assert_array_max_ulp(shipped.texels, fresh.texels)
        np.testing.assert_array_max_ulp(shipped.slopes, fresh.slopes)
        assert claimed == pytest.approx(errors, rel=1e-3)

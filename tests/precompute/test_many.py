"""Directories of model files: each in a process of its own, resumable, with one summary and one exit code."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hairlut import batch_bake, exr, manifest, modelfile
from hairlut.errors import HairlutError

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
        for table in modelfile.LOBE_NAMES:
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
    assert len(files) == 8
    for file in files:
        assert (tmp_path / "alone" / file).read_bytes() == (tmp_path / "together" / file).read_bytes()


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
    for file in sorted((luts / "measured").glob("*.exr")):
        (shipped, claimed), (fresh, errors) = exr.read(file), exr.read(tmp_path / "measured" / file.name)
        assert (shipped.warp, shipped.cell) == (fresh.warp, fresh.cell)
        np.testing.assert_array_max_ulp(shipped.texels, fresh.texels)
        assert claimed == pytest.approx(errors, rel=1e-3)

# SPDX-License-Identifier: BSD-3-Clause
"""Every command's exit code and message: 0 done, 1 a check failed, 2 wrong use, and never a traceback."""

import contextlib
import io
import json
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

from hairlut import cli

INPUTS = Path(__file__).parents[1] / "data" / "inputs"

HAIR = """
import numpy as np
from hairlut.modelfile import density, gaussian
LOBES = (
    gaussian("direct_theta", mean=lambda t: -t - np.radians(3), sigma=0.2),
    density("direct_phi", log_density=lambda phi, t: 2 * np.cos(phi - np.pi) + 0 * t),
    gaussian("multiple_theta", mean=lambda t: -0.4 * t, sigma=0.5),
)
"""
DEGREES = """
from hairlut.modelfile import gaussian
LOBES = (
    gaussian("direct_theta", mean=lambda theta_r: -theta_r, sigma=10),
    gaussian("direct_phi", mean=180, sigma=30),
    gaussian("multiple_theta", mean=lambda theta_r: -theta_r, sigma=0.5),
)
"""
BSDF = """
import numpy as np
def bsdf(theta_r, theta_i, phi):
    return np.exp(-8 * (theta_i + theta_r) ** 2) * (1.2 + np.cos(phi - np.pi)) {more}
"""
JUMP = """
import numpy as np
from hairlut.modelfile import density
LOBES = (density("direct_theta", density=lambda x, t: np.where(x > 0.3, 0.2, 1.2) + 0 * t),)
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with a good model, its tables, and what is wrong with others."""
    folder = tmp_path_factory.mktemp("place")
    for name, text in {
        "hair.py": HAIR,
        "quits.py": HAIR + "import sys; sys.exit()\n",
        "degrees.py": DEGREES,
        "jump.py": JUMP,
        "bsdf.py": BSDF.format(more=""),
        "quits_bsdf.py": BSDF.format(more="+ exit()"),
        "asks_bsdf.py": BSDF.format(more="+ float(input())"),
        "nan_bsdf.py": BSDF.format(more="* np.nan"),
        "two words.py": HAIR,
        "x" * 64 + ".py": HAIR,
        "words.exr": "no image",
    }.items():
        (folder / name).write_text(text)
    for name in ("empty", "hairs", "cut"):
        (folder / name).mkdir()
    (folder / "hairs" / "good.py").write_text(HAIR)
    (folder / "hairs" / "quits.py").write_text("exit()\n")
    shutil.copytree(INPUTS, folder / "inputs")
    assert run(folder, "bake --model fitted --size 16x8 --out luts")[0] == cli.OK
    shutil.copytree(folder / "luts" / "fitted", folder / "broken" / "fitted")
    table = folder / "broken" / "fitted" / "direct_phi.exr"
    table.write_bytes(table.read_bytes()[:-200])
    np.savez(folder / "cut.npz", theta_r=np.zeros(3))
    (folder / "cut.npz").write_bytes((folder / "cut.npz").read_bytes()[:100])
    np.save(folder / "one.npy", np.zeros(3))
    np.savez(folder / "grid.npz", theta_r=np.zeros(1), theta_i=np.zeros(1), phi=np.zeros(1))
    return folder


def run(folder, command):
    """(exit code, stdout, stderr) of a command line, run in the folder."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.chdir(folder), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = cli.main(shlex.split(command))
        except SystemExit as ended:  # argparse
            code = ended.code
    return code, out.getvalue(), err.getvalue()


DONE = {
    "--help": "usage",
    "--version": "hairlut ",
    "bake --model hair.py --size 16x8 --out out": "hair/direct_theta.exr",
    "inspect luts/fitted/direct_phi.exr": "16x8 texels",
    "inspect luts/fitted/direct_phi.exr --json": "hairlut.table",
    "inspect luts/fitted/mixture.exr": "model fitted, 2 lobes",
    "inspect luts/fitted/mixture.exr --json": '"mirrored": false',
    "plot luts --out pictures": "fitted_direct_phi.png",
    "verify luts": "ok ",
    "verify luts --json": '"ok": true',
    "verify luts/fitted/direct_phi.exr": "ok ",
    "export luts/fitted --to c --out tables.c": "tables.c",
    "export luts/fitted --to raw --out raw": "raw",
    "export luts/fitted --to npz --out npz": "npz",
    "fit inputs/grid_whole.csv --out fits": "inputs/grid_whole.csv: grid of 1 x 4 x 4",
    "fit inputs/byte_order_mark.csv --out fits": "inputs/byte_order_mark.csv: grid of 1 x 4 x 4",
    "fit inputs/draws_of_two_gaussians.csv --out fits": "1,399 draws, without 1 whose theta_i lies beyond",
}

FAILED = {
    "bake --model jump.py --tolerance 1e-5 --max-size 32 --out out": "jumps at x = 0.3 rad",
    "bake --model hair.py --tolerance 1e-9 --max-size 16 --out out": "no table of up to 16x16",
    "bake --model hairs --size 8x4 --jobs 2 --out out3": "quits.py:1: calls sys.exit()",
    "verify broken": "direct_phi.exr",
    "verify broken --json": "",
    "verify words.exr": "words.exr",
    "verify missing.exr": "no such file",
}

WRONG = {
    "": "required",
    "boil": "invalid choice",
    "bake --model mine": "model 'mine' is not known: expected one of printed, fitted",
    "bake --model nothing.py": "nothing.py: no such file",
    "bake --model inputs/grid_whole.csv": "hairlut fit makes a model of data",
    "bake --model inputs/unknown_key.toml": "azimut is not known, did you mean azimuth?",
    "bake --model degrees.py": "degrees.py: direct_theta at theta_r = -90 deg (-1.5708 rad): sigma is 10 rad",
    "bake --model quits.py": "quits.py:9: calls sys.exit()",
    "bake --model 'two words.py'": "a model takes its file's name",
    "bake --model cut.npz": "cut.npz: the npz file is cut or damaged",
    "bake --model grid.npz": "a grid of a hair, or draws: hairlut fit grid.npz",
    "bake --model xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx.py": "up to 63 letters",
    "bake --model empty": "empty: no model files",
    "bake --size 64": "expected WIDTHxHEIGHT",
    "bake --size 3x9": "size 3x9: expected a width of 4",
    "bake --size 64x64 --tolerance 1e-3": "not allowed with",
    "bake --size 64x64 --warp cubic": "warp cubic is not known",
    "bake --warp uniform": "give --size too",
    "bake --tolerance nan": "tolerance nan: expected a relative variance above 0",
    "bake --tolerance -1": "tolerance -1.0: expected",
    "bake --tolerance small": "invalid float",
    "bake --max-size 0": "--max-size 0: expected 8 or more",
    "bake --model hairs --jobs 0": "--jobs 0: expected 1 or more",
    "bake --model hairs --timeout 0": "--timeout 0: expected seconds above 0",
    "bake --model hairs --timeout nan": "--timeout nan: expected seconds above 0",
    "bake --size 8x4 --out hair.py": "cannot be written",
    "fit": "required",
    "fit none.csv": "none.csv: no such file: expected a CSV or npz file",
    "fit none.py": "none.py: no such file",
    "fit inputs/unknown_key.toml": "is a model, not data: bake it",
    "fit luts/fitted/mixture.exr": "is no text",
    "fit empty": "empty: is a directory",
    "fit cut.npz": "cut.npz: the npz file is cut or damaged",
    "fit one.npy": "one.npy: is no text, but arrays",
    "fit inputs/grid_one_missing.csv": "inputs/grid_one_missing.csv: a grid of 1 x 4 x 4",
    "fit inputs/own_range_per_theta_r.csv": "needs 192 points, found 160",
    "fit inputs/value_named_bsdf.csv": "column 'bsdf' is not known",
    "fit inputs/one_sample.csv": "1 draw: expected at least 64",
    "fit inputs/phi_in_degrees.csv": "phi is 45 on line 3",
    "fit inputs/utf16.csv": "UTF-16, expected UTF-8",
    "fit inputs/grid_whole.csv --measure both": "invalid choice",
    "fit inputs/grid_whole.csv --lobes 0": "--lobes 0: expected a number from 1 to 8",
    "fit quits_bsdf.py": "quits_bsdf.py:4: calls sys.exit()",
    "fit asks_bsdf.py": "asks_bsdf.py:4: reads standard input",
    "fit nan_bsdf.py": "nan_bsdf.py",
    "fit hair.py": "it defines LOBES: hairlut bake --model hair.py",
    "fit bsdf.py --tolerance 0": "--tolerance 0",
    "fit bsdf.py --budget nan": "--budget nan",
    "fit bsdf.py --size 0": "--size 0.0: expected a finite number above 0",
    "fit bsdf.py --budget inf": "--budget inf: expected a finite number above 0",
    "fit bsdf.py --measure angle": "--measure angle: a BSDF is per steradian: leave it out",
    "fit bsdf.py --lobes 99": "--lobes 99",
    "inspect": "required",
    "inspect nothing.exr": "nothing.exr: no such file: check the path, or bake it again",
    "inspect luts": "luts: is a directory",
    "inspect words.exr": "words.exr: ",
    "inspect words.exr --json": "words.exr: ",
    "verify": "required",
    "verify nothing": "nothing: no such directory",
    "verify empty": "empty: no .exr file",
    "verify luts --model nothing": "model 'nothing' is not known",
    "export nowhere --to c --out a.c": "nowhere: expected a directory",
    "export luts/fitted --to pdf --out a": "pdf",
    "export broken/fitted --to c --out a.c": "direct_phi.exr",
    "export luts/fitted --to exr --out luts": "would replace luts/fitted, which is exported",
    "export luts/fitted --to npz --out hair.py": "cannot be written",
    "view nowhere --out a.html": "nowhere",
    "view luts --out a.html": "name the directory of one model, such as luts/fitted",
    "plot luts/fitted/mixture.exr": "is a mixture, not a table: name luts/fitted or a table in it",
    "plot nothing.exr": "nothing.exr: no such file",
    "plot empty": "empty: no .exr file",
    "plot words.exr": "words.exr: ",
}


@pytest.mark.parametrize("command", DONE)
def test_what_is_done_ends_with_0(command, place):
    code, out, err = run(place, command)
    assert (code, err) == (cli.OK, "")
    assert DONE[command] in out


@pytest.mark.parametrize("command", FAILED)
def test_a_failed_check_ends_with_1(command, place):
    code, out, err = run(place, command)
    assert code == cli.CHECK_FAILED
    assert FAILED[command] in out + err
    assert "Traceback" not in out + err


@pytest.mark.parametrize("command", WRONG)
def test_wrong_use_ends_with_2_and_writes_nothing(command, place):
    before = sorted(place.rglob("*"))
    code, _, err = run(place, command)
    assert code == cli.WRONG_USE
    assert WRONG[command] in err
    assert "Traceback" not in err
    assert err.startswith("usage: ") or err.count("\n") == 1
    assert sorted(place.rglob("*")) == before


@pytest.mark.parametrize("command", [c for c in (*DONE, *FAILED) if "--json" in c])
def test_json_is_all_that_is_printed(command, place):
    _, out, _ = run(place, command)
    assert isinstance(json.loads(out), list)


def test_what_a_fit_wrote_is_a_model(place):
    assert run(place, "fit inputs/grid_whole.csv --out models")[0] == cli.OK
    code, out, err = run(place, "verify models/grid_whole")
    assert (code, err) == (cli.OK, "")
    assert out.count("ok ") == len(list((place / "models" / "grid_whole").iterdir())) == 2


def test_a_bsdf_says_as_json_what_it_made(place):
    code, out, _ = run(place, "fit bsdf.py --lobes 1 --budget 5 --tolerance 0.5 --json --out fitted")
    assert code == cli.OK
    assert json.loads(out)["model"] == "fitted/bsdf"


def test_every_command_is_in_the_tables():
    used = {command.split()[0] for command in (*DONE, *FAILED, *WRONG) if command}
    assert used >= set(cli.COMMANDS)


def test_every_input_of_the_reports_is_in_the_tables():
    used = " ".join((*DONE, *FAILED, *WRONG))
    assert [path.name for path in INPUTS.iterdir() if path.name not in used] == []


def test_a_file_that_may_not_be_read_is_named(place, monkeypatch):
    def refuse(self):
        raise PermissionError(13, "Permission denied", str(self))

    monkeypatch.setattr(Path, "read_bytes", refuse)
    code, _, err = run(place, "fit inputs/grid_whole.csv")
    assert (code, err) == (
        cli.WRONG_USE,
        "hairlut: inputs/grid_whole.csv: cannot be read: Permission denied\n",
    )


@pytest.mark.parametrize(
    ("error", "said"),
    [(OSError(28, "No space left on device", "out"), "out: No space left"), (MemoryError(), "out of memory")],
)
def test_what_the_machine_lacks_is_one_line(error, said, place, monkeypatch):
    def fail(*args):
        raise error

    monkeypatch.setattr("hairlut.cli.inspect.describe", fail)
    code, _, err = run(place, "inspect luts/fitted/direct_phi.exr")
    assert code == cli.WRONG_USE
    assert said in err
    assert err.count("\n") == 1

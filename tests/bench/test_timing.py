# SPDX-License-Identifier: BSD-3-Clause
"""Times parsed as hairlut_bench writes them, and compared with their rivals' and with the targets."""

import json
import stat

import pytest
from bench import summary, timing
from bench.timing import Times

from hairlut.errors import HairlutError


def entry(name: str, ns: float, **more) -> dict:
    return {"run_name": name, "run_type": "iteration", "ns": ns, **more}


def program(folder, document: dict):
    """A program that writes the document where hairlut_bench would."""
    path = folder / "bench"
    path.write_text(
        f"""#!/bin/sh
for word; do case $word in --benchmark_out=*) out="${{word#--benchmark_out=}}";; esac; done
cat > "$out" <<'END'
{json.dumps(document)}
END
"""
    )
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def test_times_are_the_least_of_the_repetitions(tmp_path):
    entries = [entry("fitted/vertex/hairlut/one/repeats:3", ns) for ns in (3.0, 9.0, 4.0)]
    entries.append(entry("fitted/vertex/hairlut/one", 99.0, run_type="aggregate"))
    entries.append(entry("fitted/vertex/hairlut/threads2/real_time/threads:2", 2.0))
    document = {"benchmarks": entries, "context": {"bytes of brown": "4096", "kernels": "avx2"}}
    times = timing.measure(program(tmp_path, document), tmp_path, ".*", tmp_path / "out.json")
    assert times.least("fitted", "vertex", "hairlut", "one") == 3.0
    assert times.least("fitted", "vertex", "hairlut", "threads2") == 2.0
    assert times.least("fitted", "vertex", "hairlut", "arrays") is None
    assert times.memory == {"brown": 4096}
    assert "avx2 kernels" in times.place


def test_a_missing_benchmark_program_is_named(tmp_path):
    with pytest.raises(HairlutError, match="build tests/bench"):
        timing.measure(tmp_path / "nothing", tmp_path, ".*", tmp_path / "out.json")


def test_a_processor_is_described_as_far_as_the_benchmark_says():
    caches = [{"level": 1, "size": 32768}, {"level": 2, "size": 1048576}]
    described = timing.describe("X", {"kernels": "avx2", "caches": caches, "libm": "glibc 2.36"})
    assert described == "X (avx2 kernels, second-level cache of 1024 KiB, libm and libmvec of glibc 2.36)"
    assert timing.describe("X", {"caches": caches[:1]}) == "X"


def test_targets_are_met_or_not():
    repeats = {
        "fitted/vertex/hairlut/one": [10.0, 11.0],
        "fitted/vertex/hybrid/one": [15.0],
        "fitted/vertex/hairlut/arrays": [10.0],
        "fitted/vertex/hybrid/arrays256": [9.5],
        "fitted/vertex/hybrid/arrays512": [9.0],
        "fitted/vertex/floor/one": [8.0],
    }
    text = summary.targets(Times(repeats, ""))
    assert "| fitted, vertex, one at a time | hybrid | 1.50 | 1.88 | 1.5 | met |" in text
    assert "| fitted, vertex, over arrays | hybrid | 0.90 |  | 1.0 | **not met** |" in text


def test_a_faster_rival_is_in_bold():
    repeats = {
        "brown/vertex/hairlut/one": [10.0],
        "brown/vertex/Chiang/one": [31.0],
        "brown/vertex/Chiang/native": [9.0],
    }
    lines = summary.beside(Times(repeats, ""), "brown", "one").splitlines()
    assert "| Chiang 2016, its own sampler | 31.0 (3.10) |" in lines
    assert "| Chiang 2016, its own sampler, fastest flags | **9.0 (0.90)** |" in lines

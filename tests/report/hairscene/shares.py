# SPDX-License-Identifier: BSD-3-Clause
"""A shipped model with other shares, as a directory of textures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from hairlut import exr
from hairlut.mixture import constant
from report.places import ROOT


def with_shares(model: str, shares: Sequence[float], folder: Path) -> Path:
    """Writes luts/<model> to folder with these shares of its lobes, without turns; the new directory."""
    baked = exr.read_model(ROOT / "luts" / model)
    directory = folder / "_".join([model, *(f"{share:g}" for share in shares)])
    exr.write_model(directory, replace(baked, mixture=constant(baked.mixture.lobes, shares)))
    return directory

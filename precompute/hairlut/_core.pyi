# SPDX-License-Identifier: BSD-3-Clause
"""The C library behind hairlut.Model; sampler.py is its only caller."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

_Floats = NDArray[np.float32]
_Axes = Sequence[tuple[int, _Floats]]
_Table = tuple[_Floats, float, float, float, float, bool, float, _Axes]

class Model:
    @property
    def lobes(self) -> list[str]: ...
    def sample(
        self,
        parameters: Sequence[_Floats],
        shares: _Floats | None,
        theta_r: _Floats,
        phi_r: _Floats,
        offset: _Floats,
        u_lobe: _Floats,
        u_theta: _Floats,
        u_phi: _Floats,
        out: Sequence[_Floats],
    ) -> None: ...
    def pdf(
        self,
        parameters: Sequence[_Floats],
        shares: _Floats | None,
        theta_r: _Floats,
        phi_r: _Floats,
        offset: _Floats,
        theta_i: _Floats,
        phi_i: _Floats,
        out: _Floats,
    ) -> None: ...
    def sample_lobe(
        self,
        lobe: int,
        theta_r: _Floats,
        phi_r: _Floats,
        u_theta: _Floats,
        u_phi: _Floats,
        out: Sequence[_Floats],
    ) -> None: ...
    def pdf_lobe(
        self,
        lobe: int,
        theta_r: _Floats,
        phi_r: _Floats,
        theta_i: _Floats,
        phi_i: _Floats,
        out: _Floats,
    ) -> None: ...
    def invert_lobe(
        self,
        lobe: int,
        theta_r: _Floats,
        phi_r: _Floats,
        theta_i: _Floats,
        phi_i: _Floats,
        u_theta: _Floats,
        u_phi: _Floats,
    ) -> None: ...

def create(
    parameters: Sequence[tuple[str, float, float, float]],
    tables: Sequence[_Table],
    lobes: Sequence[tuple[str, int, int, bool]],
    axes: _Axes,
    theta_r: _Floats,
    offset: _Floats,
    share: _Floats,
    turn: _Floats,
    mirrored: bool,
) -> Model: ...
def builtin(name: str) -> Model | None: ...

# SPDX-License-Identifier: BSD-3-Clause
"""Fixtures of the C library's tests."""

import pytest

from runtime import c_library


@pytest.fixture(scope="session", params=c_library.MODELS)
def model(request) -> c_library.Model:
    """Each compiled-in model."""
    return c_library.builtin(request.param)


@pytest.fixture(scope="session")
def loader() -> None:
    """Skips where hairlut_exr was not built."""
    if not c_library.has_exr():
        pytest.skip("hairlut_exr is not built for want of OpenEXR >= 3.1: apt-get install libopenexr-dev")

# SPDX-License-Identifier: BSD-3-Clause
"""The engine with the plugin, or a skip that says which package is missing.

Where the packages are, a plugin that does not build is a failure.
"""

from pathlib import Path

import pytest
from runtime.c_library import alone


@pytest.fixture(scope="session")
def tables():
    """The folder of baked models."""
    folder = Path(__file__).resolve().parents[2] / "luts"
    if not (folder / "fitted" / "direct_theta.exr").exists():
        pytest.skip("luts/ is not baked: make bake")
    return folder


@pytest.fixture(scope="session")
def mi():
    from report.engine import DEFAULT_BUILD, PluginUnavailable, load_engine

    try:
        with alone(DEFAULT_BUILD):
            return load_engine()
    except PluginUnavailable as error:
        pytest.skip(f"the Mitsuba plugin is not tested: {error}")


@pytest.fixture(scope="module")
def llvm(mi):
    """The engine in variant llvm_ad_rgb, which is scalar_rgb again after the tests of this file."""
    from report.engine import lack_of_llvm

    if lack := lack_of_llvm():
        pytest.skip(lack)
    mi.set_variant("llvm_ad_rgb")
    import hairlut.mitsuba  # noqa: F401

    yield mi
    mi.set_variant("scalar_rgb")

# SPDX-License-Identifier: BSD-3-Clause
"""precompute/examples/own_hair.py renders what it promises, here with luts/brown for what it fits first."""

import numpy as np
import pytest

from report.own_hair import example

BATCHES, SIZE = 6, (24, 32)


@pytest.fixture(scope="module")
def own_hair(llvm):
    """The example, its engine started."""
    module = example()
    module.start_engine(module.VARIANT)
    return module


@pytest.fixture(scope="module")
def rendered(own_hair, tables, tmp_path_factory):
    strands = tmp_path_factory.mktemp("lock") / "strands.txt"
    own_hair.write_lock(strands, strands=300)
    bsdfs = own_hair.samplers(tables / "brown")
    return {
        name: own_hair.render(own_hair.scene(strands, bsdf, SIZE), BATCHES) for name, bsdf in bsdfs.items()
    }


def test_all_pictures_are_of_the_same_hair(rendered):
    exact = rendered["own textures"]
    for one in rendered.values():
        assert np.isfinite(one.image).all()
        error = np.hypot(one.mean * one.error, exact.mean * exact.error)
        assert abs(one.mean - exact.mean) < 4 * error


def test_own_textures_have_about_the_variance_of_the_authors_sampler(own_hair, rendered):
    own = rendered["own textures"].variance
    assert own < 1.3 * rendered["authors' sampler"].variance
    assert own < 0.5 * rendered["other hair's textures"].variance
    assert own < 0.2 * rendered["whole sphere"].variance
    assert "own textures" in own_hair.text(rendered)


def test_the_pictures_are_written(own_hair, rendered, tmp_path):
    assert own_hair.picture(rendered, tmp_path / "own_hair.png").stat().st_size > 1000

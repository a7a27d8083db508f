# SPDX-License-Identifier: BSD-3-Clause
"""Small renders: the mean image is the reference's, a wrong density shows, and no pixel is NaN."""

import numpy as np
import pytest

from report.hairscene.luminance import luminance

SIZE = (24, 20)
BATCHES, SPP = 12, 48
SIGMAS = 3.0
ONE_SCATTERING = {"type": "direct", "emitter_samples": 0, "bsdf_samples": 1}
PATH = {"type": "path", "max_depth": 6, "rr_depth": 100}
TILT = 0.1  # of the wrong density, relative, across the fibre


@pytest.fixture(scope="module")
def hair_scene(mi, tmp_path_factory):
    """A scene of few strands that fill the picture, by BSDF, environment map and integrator."""
    from report.hairscene.scene import Hair, scene_dict, strand_points, write_strands

    strands = tmp_path_factory.mktemp("hair") / "strands.txt"
    write_strands(strand_points(Hair(strands=1500, locks=12, radius=0.014)), strands)

    def load(bsdf, radiance, integrator=ONE_SCATTERING):
        description = scene_dict(mi, strands, bsdf, SIZE)
        environment = {"type": "envmap", "bitmap": mi.Bitmap(radiance.astype(np.float32))}
        return mi.load_dict({**description, "environment": environment, "integrator": integrator})

    return load


@pytest.fixture(scope="module")
def nested(mi):
    from report.hairscene.scene import light_hair

    return light_hair()


@pytest.fixture(scope="module")
def wrong_density(mi, nested):
    """A BSDF that draws with the fitted tables and divides by a density that leans to one side by TILT."""

    class Wrong(mi.BSDF):
        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.inner = mi.load_dict({"type": "hairlut", "nested": nested})
            self.m_components = [int(self.inner.flags(0))]
            self.m_flags = int(self.inner.flags(0))

        def sample(self, ctx, si, sample1, sample2, active=True):
            drawn, weight = self.inner.sample(ctx, si, sample1, sample2, active)
            factor = 1.0 + TILT * np.sign(si.to_world(drawn.wo).x)
            drawn.pdf *= factor
            return drawn, weight / factor

        def eval(self, ctx, si, wo, active=True):
            return self.inner.eval(ctx, si, wo, active)

        def pdf(self, ctx, si, wo, active=True):
            return self.inner.pdf(ctx, si, wo, active) * (1.0 + TILT * np.sign(si.to_world(wo).x))

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def to_string(self):
            return "Wrong"

    mi.register_bsdf("hairlut_wrong_density", Wrong)
    return {"type": "hairlut_wrong_density"}


def even_sky():
    return np.ones((16, 32, 3))


def bright_side():
    """Nearly all light from the half of the sphere with world x > 0, the left half of the map."""
    sky = np.full((16, 32, 3), 0.02)
    sky[:, :16] = 2.0
    return sky


def batch_means(mi, scene, first_seed, batches=BATCHES, spp=SPP):
    """Mean luminance of independent renders; every pixel must be finite."""
    images = [np.array(mi.render(scene, spp=spp, seed=first_seed + k)) for k in range(batches)]
    assert np.all(np.isfinite(images))
    return luminance(images).mean(axis=(1, 2))


def deviation(means, reference):
    """The difference of two means in standard errors, and that error relative to the reference."""
    error = np.sqrt(means.var(ddof=1) / means.size + reference.var(ddof=1) / reference.size)
    return (means.mean() - reference.mean()) / error, error / reference.mean()


@pytest.fixture(scope="module")
def reference(mi, hair_scene, nested):
    """Means by uniform sampling of the sphere, which no table and no density of the plugin can bias."""
    uniform = {"type": "hairlut", "uniform": True, "nested": nested}
    return {
        sky: batch_means(mi, hair_scene(uniform, radiance), 900, spp=2 * SPP)
        for sky, radiance in (("even", even_sky()), ("bright side", bright_side()))
    }


@pytest.mark.parametrize("sky", ["even", "bright side"])
@pytest.mark.parametrize(
    "parameters",
    [
        {"model": "printed"},
        {"model": "fitted"},
        {"model": "brown"},
        {"mix": 0.5},
        {"light_sampling": False},
    ],
    ids=str,
)
def test_mean_image_is_the_reference(mi, hair_scene, nested, reference, parameters, sky):
    radiance = even_sky() if sky == "even" else bright_side()
    scene = hair_scene({"type": "hairlut", "nested": nested, **parameters}, radiance)
    sigmas, error = deviation(batch_means(mi, scene, 100), reference[sky])
    assert error < 0.02
    assert abs(sigmas) < SIGMAS


def test_a_wrong_density_darkens_the_image_under_a_bright_side(mi, hair_scene, wrong_density, reference):
    scene = hair_scene(wrong_density, bright_side())
    sigmas, _ = deviation(batch_means(mi, scene, 300), reference["bright side"])
    assert abs(sigmas) > SIGMAS


@pytest.mark.parametrize(
    "parameters",
    [
        {"uniform": True},
        {"model": "printed"},
        {"model": "fitted"},
        {"model": "brown"},
        {"mix": 0.5},
    ],
    ids=str,
)
def test_no_pixel_is_nan_after_many_scatterings(mi, hair_scene, nested, parameters):
    scene = hair_scene({"type": "hairlut", "nested": nested, **parameters}, bright_side(), PATH)
    assert np.all(batch_means(mi, scene, 500, batches=1, spp=16) > 0.0)

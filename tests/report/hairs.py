# SPDX-License-Identifier: BSD-3-Clause
"""Hairs from papers and a few made up: densities of light per rad^2, and the authors' own sampler where
there is one.

Near field: Chiang et al. 2016, as precompute/examples/chiang2016.py has it. Far field: Huang et al. 2022, as
precompute/examples/huang2022.py has it; Karis 2016; Chiang's hair averaged over the offset; a dual-scattering
mix whose multiple scattering steps from forward to backward at 90 degrees; and two separable highlights."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from report.places import ROOT

EXAMPLES = ROOT / "precompute" / "examples"
BETA_M, BETA_N = (0.05, 0.1, 0.3, 0.6), (0.1, 0.3, 0.6)
ABSORPTIONS = 0.1, 0.6, 3.0  # times the fibre's radius: blond, brown, black
AVERAGED = 24  # offsets on each side of the fibre


@dataclass(frozen=True)
class Subject:
    """density(theta_r, theta_i, phi, offset) per rad^2; own: that of the authors' sampler, or None. parts: of
    a hair that is an average over offsets, (density, own) at each of those, for the same arguments. draws: of
    authors whose sampler knows no density, (theta_i, phi, weight) for theta_r and u (n, 8); points: of the
    quadrature that measures it, if its density is slow."""

    name: str
    density: Callable
    offsets: bool
    own: Callable | None = None
    parts: Callable | None = None
    draws: Callable | None = None
    points: tuple[int, int] = 432, 384


def example(name: str, settings: dict[str, str]) -> dict:
    """The names that an example defines, with lines of it changed to those of settings."""
    path = EXAMPLES / name
    text = path.read_text()
    for old, new in settings.items():
        if text.count(old) != 1:
            raise RuntimeError(f"{path}: expected one line {old}")
        text = text.replace(old, new)
    space: dict = {"__name__": path.stem}
    exec(compile(text, str(path), "exec"), space)
    return space


class Chiang:
    """The example, with other settings, and the sampler of the paper: a lobe by its attenuation, then both
    of its angles exactly."""

    def __init__(self, beta_m: float, beta_n: float, absorption: float):
        self._space = example(
            "chiang2016.py",
            {
                "BETA_M, BETA_N = 0.3, 0.3": f"BETA_M, BETA_N = {beta_m}, {beta_n}",
                "ABSORPTION = 0.6": f"ABSORPTION = {absorption}",
            },
        )

    def density(self, theta_r, theta_i, phi, offset):
        return self._space["bsdf"](theta_r, theta_i, phi, offset) * np.cos(theta_i) ** 2

    def own(self, theta_r, theta_i, phi, offset):
        """Density of sample(), per rad^2."""
        space = self._space
        strength, around = space["attenuations"](theta_r, offset), space["around"](theta_r, phi, offset)
        total = sum(
            a * space["longitudinal"](theta_i, theta_r - t, v) * n
            for a, n, t, v in zip(strength, around, space["TILTS"], space["VARIANCES"], strict=True)
        )
        return total * np.cos(theta_i) / sum(strength)

    def sample(self, theta_r, offset, u):
        """(theta_i, phi) for u (..., 4): the lobe's number, two of M_p (d'Eon et al. 2013), one of the
        azimuth."""
        space = self._space
        *strength, _ = np.broadcast_arrays(*space["attenuations"](theta_r, offset), u[..., 0])
        strength = np.stack(strength)
        below = np.cumsum(strength, axis=0) / strength.sum(axis=0)
        p = np.minimum((u[..., 0] > below).sum(axis=0), 3)
        v, seen = np.array(space["VARIANCES"])[p], theta_r - np.array(space["TILTS"])[p]
        cosine = 1 + v * np.log(np.maximum(u[..., 1], 1e-12) + (1 - u[..., 1]) * np.exp(-2 / v))
        sine = np.sqrt(np.maximum(1 - cosine**2, 0))
        theta_i = np.arcsin(-cosine * np.sin(seen) + sine * np.cos(2 * np.pi * u[..., 2]) * np.cos(seen))
        s, edge = space["S"], 1 / (1 + np.exp(np.pi / space["S"]))
        logistic = -s * np.log(1 / (edge + u[..., 3] * (1 - 2 * edge)) - 1)
        turn = 2 * p * space["refracted_angle"](theta_r, offset) - 2 * np.arcsin(offset) + p * np.pi
        phi = np.where(p == 3, 2 * np.pi * u[..., 3], logistic + turn)
        return theta_i, np.mod(phi, 2 * np.pi)


class Huang:
    """The example, with another roughness, and the sampler of the paper: a path through the fibre of drawn
    facets, then R, TT or TRT by what each keeps of the light. It returns a weight and knows no density."""

    def __init__(self, roughness: float, absorption: float, paths: int = 256):
        self._space = example(
            "huang2022.py",
            {
                "ROUGHNESS = 0.3": f"ROUGHNESS = {roughness}",
                "ABSORPTION = 0.3": f"ABSORPTION = {absorption}",
                "PATHS, REFLECTIONS = 256": f"PATHS, REFLECTIONS = {paths}",
            },
        )

    def density(self, theta_r, theta_i, phi, offset):
        return self._space["bsdf"](theta_r, theta_i, phi) * np.cos(theta_i) ** 2

    def draws(self, theta_r, u):
        """(theta_i, phi, weight) for u (n, 8): the lobe's, the place on the fibre's, and two for each of
        three facets."""
        space = self._space
        first = space["first_hits"](theta_r, u[:, 1])
        second = space["enter"](first, u[:, 2:4])
        third = space["reflect_inside"](second, u[:, 4:6])
        ends = self._reflected(first, u[:, 2:4]), self._left(second, u[:, 4:6]), self._left(third, u[:, 6:8])
        light = np.stack([weight for _, weight in ends])
        below = np.cumsum(light, axis=0) / np.maximum(light.sum(axis=0), 1e-300)
        lobe = np.minimum((u[:, 0] > below).sum(axis=0), 2)
        out = np.take_along_axis(np.stack([out for out, _ in ends]), lobe[None, :, None], axis=0)[0]
        theta_i, phi = np.arcsin(np.clip(out[:, 2], -1, 1)), np.arctan2(out[:, 1], out[:, 0])
        return theta_i, phi % (2 * np.pi), light.sum(axis=0)

    def _reflected(self, hits, u):
        space = self._space
        dot, scales = space["dot"], space["tilted"](hits.normal)
        facet = space["visible_facet"](hits.back, scales, u)
        cosine = dot(hits.back, facet)
        out = 2 * cosine[:, None] * facet - hits.back
        passes = (dot(out, scales) > 0) & (dot(out, hits.normal) > 0)
        masked = space["shadowed"](dot(scales, hits.back), dot(scales, out))
        return out, hits.weight * space["fresnel"](cosine, space["ETA"])[0] * masked * passes

    def _left(self, hits, u):
        space = self._space
        dot, scales = space["dot"], -space["tilted"](hits.normal)
        facet = space["visible_facet"](hits.back, scales, u)
        reflectance = space["fresnel"](dot(hits.back, facet), 1 / space["ETA"])[0]
        out = space["refract"](hits.back, facet, 1 / space["ETA"])
        passes = (dot(hits.back, scales) > 0) & (dot(out, scales) < 0) & (dot(out, hits.normal) > 0)
        masked = space["shadowed"](dot(scales, hits.back), -dot(scales, out))
        return out, hits.weight * (1 - reflectance) * masked * passes


def near_field() -> list[Subject]:
    """Chiang's hair at 4 x 3 roughnesses and three absorptions."""
    found = []
    for beta_m in BETA_M:
        for beta_n in BETA_N:
            for absorption in ABSORPTIONS:
                hair = Chiang(beta_m, beta_n, absorption)
                found.append(Subject(f"chiang {beta_m} {beta_n} {absorption}", hair.density, True, hair.own))
    return found


def far_field() -> list[Subject]:
    """Hairs without offsets."""
    subjects = [Subject(f"karis {rough}", karis(rough), False) for rough in (0.3, 0.5)]
    subjects += [averaged(m, n, 0.6) for m, n in ((0.3, 0.3), (0.1, 0.3))]
    subjects += [huang(0.3, 0.3)]
    return [
        *subjects,
        Subject("dual scattering", dual_scattering, False),
        Subject("two highlights", two, False),
    ]


def karis(rough: float) -> Callable:
    """Karis 2016, Physically Based Hair Shading in Unreal: R, TT and TRT with approximate azimuths, one
    colour."""
    base, shift = rough**2, 0.035
    f0 = (0.55 / 2.55) ** 2

    def fresnel(cosine):
        return f0 + (1 - f0) * (1 - cosine) ** 5

    def gaussian(x, sigma):
        return np.exp(-0.5 * (x / sigma) ** 2) / (np.sqrt(2 * np.pi) * sigma)

    def density(theta_r, theta_i, phi, offset):
        x, cos_phi = np.sin(theta_r) + np.sin(theta_i), np.cos(phi)
        cos_d = np.cos(abs(theta_i - theta_r) / 2)
        half = np.sqrt(np.clip(0.5 + 0.5 * cos_phi, 0, 1))
        between = np.cos(theta_r) * np.cos(theta_i) * cos_phi + np.sin(theta_r) * np.sin(theta_i)
        reflected = fresnel(np.sqrt(np.clip(0.5 + 0.5 * between, 0, 1)))
        r = gaussian(x + 2 * shift, base) * 0.25 * half * reflected
        a = 1 / (1.19 / cos_d + 0.36 * cos_d)
        h = half * (1 + a * (0.6 - 0.8 * cos_phi))
        passed = (1 - fresnel(cos_d * np.sqrt(np.clip(1 - h * h, 0, 1)))) ** 2
        left = np.exp(-0.5 * np.sqrt(np.clip(1 - (h * a) ** 2, 0, 1)) / cos_d)
        tt = gaussian(x - shift, base / 2) * np.exp(-3.65 * cos_phi - 3.98) * passed * left
        f = fresnel(cos_d * 0.5)
        trt = (
            gaussian(x - 4 * shift, 2 * base)
            * np.exp(17 * cos_phi - 16.78)
            * (1 - f) ** 2
            * f
            * np.exp(-0.8 / cos_d)
        )
        return (r + tt + trt) * np.cos(theta_i) ** 2

    return density


def huang(roughness: float, absorption: float) -> Subject:
    """Huang's hair, seen from afar."""
    hair = Huang(roughness, absorption)
    name = f"huang {roughness} {absorption}"
    return Subject(name, hair.density, False, draws=hair.draws, points=(144, 128))


def averaged(beta_m: float, beta_n: float, absorption: float) -> Subject:
    """Chiang's hair, the mean over the offsets of the whole fibre, even over its width."""
    hair = Chiang(beta_m, beta_n, absorption)
    offsets = (np.arange(AVERAGED) + 0.5) / AVERAGED

    def parts(theta_r, theta_i, phi):
        for h in offsets:
            for side in (1, -1):
                at = theta_r, theta_i, side * phi, h
                yield hair.density(*at), hair.own(*at)

    def density(theta_r, theta_i, phi, offset):
        return sum(p for p, _ in parts(theta_r, theta_i, phi)) / (2 * AVERAGED)

    return Subject(f"averaged chiang {beta_m} {beta_n}", density, False, parts=parts)


def dual_scattering(theta_r, theta_i, phi, offset):
    """Single scattering, and multiple scattering that steps where forward turns into backward."""
    x = theta_i + theta_r

    def gaussian(shift, sigma):
        return np.exp(-0.5 * ((x - shift) / sigma) ** 2) / sigma

    multiple = np.where(np.cos(phi) > 0, 0.8 * gaussian(-0.05, 0.35), 0.3 * gaussian(0.1, 0.5))
    single = gaussian(-0.07, 0.12) * np.exp(2 * (np.cos(phi) - 1))
    single = single + gaussian(0.03, 0.08) * np.exp(10 * (np.cos(phi - np.pi) - 1))
    return (multiple + single) * np.cos(theta_i)


def two(theta_r, theta_i, phi, offset):
    """Two separable highlights."""
    x = theta_i + theta_r
    narrow = np.exp(-0.5 * (x / 0.05) ** 2) / 0.05 * np.exp(8 * (np.cos(phi - np.pi) - 1))
    return narrow + np.exp(-0.5 * (x / 0.3) ** 2) / 0.3 * np.exp(3 * (np.cos(phi) - 1))

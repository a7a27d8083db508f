# SPDX-License-Identifier: BSD-3-Clause
"""Hair after Huang, Hullin and Hanika 2022, A Microfacet-based Hair Scattering Model: a cylinder with a rough
dielectric surface (GGX), seen from so far that a pixel is wider than the fibre; R, TT and TRT, circular
cross-section, one wavelength, without the paper's energy compensation: hairlut fit
precompute/examples/huang2022.py

f is an expectation over paths through the fibre: all interfaces but the last are drawn, from fixed
quasi-random numbers, and the last one is evaluated. Directions are (n, 3) arrays in a frame whose third axis
is the fibre; the viewer's azimuth is 0."""

from typing import NamedTuple

import numpy as np
from scipy.stats import qmc

ROUGHNESS = 0.3  # GGX's alpha
ABSORPTION = 0.3  # sigma_a times the fibre's radius
ETA, TILT = 1.55, np.radians(2.0)  # index of refraction; angle of the cuticle's scales
PATHS, REFLECTIONS = 256, 64  # through the fibre; rays of R. f is then within 2 % of the whole light, in L1
FARTHEST = np.radians(87.5)  # viewers beyond it, who see scales from behind and no light, get f of this one
BLOCK = 128  # directions at once: their arrays fit in a cache


class Hits(NamedTuple):
    """Where rays meet the surface: the direction back along each ray and the surface's outer normal, (n, 3)
    each, and the part of the light that is left, (n,)."""

    back: np.ndarray
    normal: np.ndarray
    weight: np.ndarray


def direction(theta, phi):
    theta, phi = np.broadcast_arrays(theta, phi)
    return np.stack([np.cos(theta) * np.cos(phi), np.cos(theta) * np.sin(phi), np.sin(theta)], axis=-1)


def dot(a, b):
    return np.sum(a * b, axis=-1)


def tilted(normal):
    """The scales' normal, on the outer side."""
    return normal * np.cos(TILT) + np.array([0.0, 0.0, np.sin(TILT)])


def smith(cosine):
    """Lambda of GGX (Heitz 2014, eq. 72)."""
    cosine = np.clip(cosine, 1e-6, 1)
    return (np.sqrt(1 + ROUGHNESS**2 * (1 / cosine**2 - 1)) - 1) / 2


def shadowed(cos_in, cos_out):
    """G2 / G1 of heights that are correlated (Heitz 2014, eq. 99): what masking leaves of a drawn facet."""
    return (1 + smith(cos_in)) / (1 + smith(cos_in) + smith(cos_out))


def visible_density(cos_facet, cos_in, facet_in):
    """Density of the facets that a direction sees (Heitz 2018, eq. 3), per steradian."""
    d = ROUGHNESS**2 / (np.pi * (1 + (ROUGHNESS**2 - 1) * cos_facet**2) ** 2)
    return d * np.maximum(facet_in, 0) / (np.clip(cos_in, 1e-6, 1) * (1 + smith(cos_in)))


def visible_facet(back, normal, u):
    """A facet that `back` sees, (n, 3), for u (n, 2): Dupuy and Benyoub 2023, spherical caps."""
    across = np.cross([0.0, 0.0, 1.0], normal)
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    along = np.cross(normal, across)
    stretch = np.array([ROUGHNESS, ROUGHNESS, 1.0])
    local = np.stack([dot(back, across), dot(back, along), dot(back, normal)], axis=-1) * stretch
    local /= np.linalg.norm(local, axis=-1, keepdims=True)
    z = (1 - u[:, 1]) * (1 + local[:, 2]) - local[:, 2]
    ring = np.sqrt(np.maximum(1 - z**2, 0))
    phi = 2 * np.pi * u[:, 0]
    facet = (np.stack([ring * np.cos(phi), ring * np.sin(phi), z], axis=-1) + local) * stretch
    facet /= np.linalg.norm(facet, axis=-1, keepdims=True)
    return facet[:, :1] * across + facet[:, 1:2] * along + facet[:, 2:] * normal


def fresnel(cosine, eta):
    """Reflectance, and the cosine behind the surface, 0 in total reflection; eta: index behind / before."""
    refracted = np.sqrt(np.maximum(1 - (1 - cosine**2) / eta**2, 0))
    parallel = (eta * cosine - refracted) / (eta * cosine + refracted)
    across = (cosine - eta * refracted) / (cosine + eta * refracted)
    return (parallel**2 + across**2) / 2, refracted


def refract(back, facet, eta):
    """The direction behind a facet of a ray that comes from `back`."""
    cosine = dot(back, facet)
    _, refracted = fresnel(cosine, eta)
    return (cosine / eta - refracted)[:, None] * facet - back / eta


def next_hits(normal, forward, weight):
    """Where rays that start inside at `normal` meet the surface again, with what absorption leaves."""
    across = forward * np.array([1.0, 1.0, 0.0])
    chord = dot(normal, across)
    square = np.maximum(dot(across, across), 1e-12)
    there = normal - (2 * chord / square)[:, None] * across
    return Hits(-forward, there, weight * np.exp(-ABSORPTION * 2 * abs(chord) / square))


def first_hits(theta_r, u):
    """The viewer's rays on the fibre, for u (n,), even over its width."""
    normal = direction(0.0, np.arcsin(2 * u - 1))
    back = np.broadcast_to(direction(theta_r, 0.0), normal.shape)
    return Hits(back, normal, (dot(tilted(normal), back) > 0) / 1.0)


def enter(hits, u):
    """Refracted by a drawn facet, to the next hits; u (n, 2)."""
    scales = tilted(hits.normal)
    facet = visible_facet(hits.back, scales, u)
    reflectance, _ = fresnel(dot(hits.back, facet), ETA)
    forward = refract(hits.back, facet, ETA)
    passes = (dot(forward, scales) < 0) & (dot(forward, hits.normal) < 0)
    masked = shadowed(dot(scales, hits.back), -dot(scales, forward))
    return next_hits(hits.normal, forward, hits.weight * (1 - reflectance) * masked * passes)


def reflect_inside(hits, u):
    """Reflected inside by a drawn facet, to the next hits; u (n, 2)."""
    scales = -tilted(hits.normal)
    facet = visible_facet(hits.back, scales, u)
    reflectance, _ = fresnel(dot(hits.back, facet), 1 / ETA)
    forward = 2 * dot(hits.back, facet)[:, None] * facet - hits.back
    stays = (dot(scales, hits.back) > 0) & (dot(forward, scales) > 0) & (dot(forward, hits.normal) < 0)
    masked = shadowed(dot(scales, hits.back), dot(scales, forward))
    return next_hits(hits.normal, forward, hits.weight * reflectance * masked * stays)


def reflected(hits, out):
    """(m,) light per steradian that is reflected to out (m, 3), the mean over the hits."""
    scales = tilted(hits.normal)
    cos_in, cos_out = dot(scales, hits.back)[:, None], scales @ out.T
    length = np.sqrt(np.maximum(2 + 2 * (hits.back @ out.T), 1e-12))
    facet_in, cos_facet = length / 2, (cos_in + cos_out) / length
    density = visible_density(cos_facet, cos_in, facet_in) / (4 * facet_in)
    light = fresnel(facet_in, ETA)[0] * shadowed(cos_in, cos_out) * density
    return np.mean(
        np.where((cos_out > 0) & (hits.normal @ out.T > 0), light, 0) * hits.weight[:, None], axis=0
    )


def left(hits, out):
    """(m,) light per steradian that leaves the fibre to out (m, 3), the mean over the hits. The facet is the
    half vector of Walter et al. 2007, eq. 16; its Jacobian is eq. 17."""
    scales = -tilted(hits.normal)
    cos_in, cos_out = dot(scales, hits.back)[:, None], scales @ out.T
    between = hits.back @ out.T
    square = ETA**2 + 1 + 2 * ETA * between
    length = np.sqrt(square)
    facet_in, facet_out = (ETA + between) / length, (ETA * between + 1) / length
    cos_facet = (ETA * cos_in + cos_out) / length
    density = visible_density(cos_facet, cos_in, facet_in) * abs(facet_out) / square
    light = (1 - fresnel(facet_in, 1 / ETA)[0]) * shadowed(cos_in, -cos_out) * density
    passes = (cos_in > 0) & (cos_out < 0) & (hits.normal @ out.T > 0) & (facet_out < 0) & (cos_facet > 0)
    return np.mean(np.where(passes, light, 0) * hits.weight[:, None], axis=0)


def random_numbers():
    """(PATHS, 5) quasi-random numbers, a Sobol sequence in the middle of its cells."""
    return qmc.Sobol(5, scramble=False).random(PATHS) + 0.5 / PATHS


def scattered(theta_r, out, u):
    """(m,) light per steradian that a fibre scatters to out (m, 3), by paths of u (n, 5)."""
    rays = first_hits(theta_r, u[:REFLECTIONS, 0])
    second = enter(first_hits(theta_r, u[:, 0]), u[:, 1:3])
    third = reflect_inside(second, u[:, 3:5])
    blocks = np.array_split(out, max(1, len(out) // BLOCK))
    return np.concatenate([reflected(rays, b) + left(second, b) + left(third, b) for b in blocks])


def bsdf(theta_r, theta_i, phi):
    """The mean of both sides, which differ by the quasi-random numbers alone."""
    theta_r, theta_i, phi = np.broadcast_arrays(np.clip(theta_r, -FARTHEST, FARTHEST), theta_i, phi)
    u, light = random_numbers(), np.empty(theta_r.shape)
    for viewer in np.unique(theta_r):
        here = theta_r == viewer
        sides = [scattered(viewer, direction(theta_i[here], side * phi[here]), u) for side in (1, -1)]
        light[here] = (sides[0] + sides[1]) / (2 * np.cos(theta_i[here]))
    return light

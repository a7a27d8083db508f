# SPDX-License-Identifier: BSD-3-Clause
"""Models over parameters for the tests: random ones, and arrays of their strands."""

import ctypes
import dataclasses
from functools import cache

import numpy as np
from runtime.c_library import ROOT, Model, core
from runtime.models import from_baked
from runtime.test_hair import Samples, pointers

from hairlut import exr
from hairlut.axes import Axis, Parameter
from hairlut.mixture import Mixture
from hairlut.model import BakedLobe, BakedModel
from hairlut.table import Table

PARAMETERS = (
    Parameter("beta_m", 0.05, 0.6, 0.3),
    Parameter("beta_n", 0.1, 0.7, 0.4),
    Parameter("absorption", -2.0, 5.0, 5.0),
    Parameter("unused", 0.0, 1.0, 0.5),
)


def axis_of(name: str, count: int, random: np.random.Generator) -> Axis:
    """Uneven nodes over a parameter's range."""
    (p,) = (p for p in PARAMETERS if p.name == name)
    steps = np.append(0, np.cumsum(random.uniform(0.4, 1.6, count - 1)))
    nodes = np.float32(p.least + (p.most - p.least) * steps / steps[-1])
    nodes[[0, -1]] = p.least, p.most
    return Axis(name, nodes.astype(float))


def over(table: Table, axes: tuple[Axis, ...], random: np.random.Generator) -> Table:
    """The table at nodes of which each is another blend of it with evenly spread angles."""
    nodes = int(np.prod([len(axis.nodes) for axis in axes]))
    part = random.uniform(0, 1, (nodes, 1, 1)) ** 2
    low, high = table.domain
    u, h = table.warp.u(table.width), high - low
    texels = (1 - part) * table.texels + part * (low + h * u)
    texels[..., [0, -1]] = table.domain
    slopes = (1 - part) * table.slopes + part * h
    flat = (nodes * table.height, table.width)
    texels, slopes = (np.float32(a).reshape(flat) for a in (texels, slopes))
    return dataclasses.replace(
        table, texels=texels, slopes=slopes, log_mass=np.tile(table.log_mass, nodes), axes=axes
    )


@cache
def baked(
    theta: tuple[str, ...] = ("beta_m",),
    phi: tuple[str, ...] = ("beta_n",),
    mixture: tuple[str, ...] = ("beta_m", "beta_n", "absorption"),
    lobes: int = 3,
    turned: bool = True,
    seed: int = 0,
    apart: bool = False,
) -> BakedModel:
    """The tables of `brown` over parameters: turns anywhere, a fifth of the shares 0. apart: each table has
    nodes of its own."""
    random = np.random.default_rng(seed)
    plain = exr.read_model(ROOT / "luts" / "brown")
    theta_axes = tuple(axis_of(name, 3 + k, random) for k, name in enumerate(theta))
    phi_axes = tuple(axis_of(name, 7 - 2 * k, random) for k, name in enumerate(phi))
    made = []
    for k in range(lobes):
        lobe = plain.lobes[k % len(plain.lobes)]
        if apart:
            theta_axes = tuple(axis_of(name, 3 + k, random) for name in theta)
            phi_axes = tuple(axis_of(name, 4 + k, random) for name in phi)
        tables = [
            dataclasses.replace(over(t, axes, random), name=f"l{k}_{angle}")
            for t, axes, angle in ((lobe.theta, theta_axes, "theta"), (lobe.phi, phi_axes, "phi"))
        ]
        made.append(BakedLobe(f"l{k}", tables[0], None if k == 3 else tables[1]))
    axes = tuple(axis_of(name, 2 + k, random) for k, name in enumerate(mixture))
    m = plain.mixture
    theta_r, offset = m.theta_r[::6], m.offset[::3]
    shape = lobes, *(len(axis.nodes) for axis in axes), len(theta_r), len(offset)
    share = np.where(random.random(shape) < 0.2, 0, random.random(shape))
    share[0] += 0.01
    turn = random.uniform(-7, 7, shape) if turned else np.zeros(shape)
    names = tuple(lobe.name for lobe in made)
    numbers = (np.float32(a).astype(float) for a in (share, turn))
    mix = Mixture(names, theta_r, offset, *numbers, m.mirrored, axes)
    return BakedModel("random", tuple(made), mix, parameters=PARAMETERS)


@cache
def model(**shape) -> Model:
    """The C library's model of `baked`."""
    return from_baked(baked(**shape))


def strands(n: int, seed: int = 1) -> np.ndarray:
    """(n, parameters): most in their ranges, some beyond."""
    random = np.random.default_rng(seed)
    least, most = (np.array([getattr(p, end) for p in PARAMETERS]) for end in ("least", "most"))
    return np.float32(least + (most - least) * random.uniform(-0.1, 1.1, (n, len(PARAMETERS))))


def sample_strand_n(model: Model, parameters, shares, offset, *inputs) -> list[np.ndarray]:
    """hairlut_sample_strand_n, as test_hair.sample_hair_n. parameters: None, or (parameters, n)."""
    theta_r, phi_r, *u = (np.ascontiguousarray(a, np.float32) for a in inputs)
    given = [None if a is None else np.ascontiguousarray(a, np.float32) for a in (parameters, shares, offset)]
    out = [np.empty_like(theta_r) for _ in range(4)]
    first = pointers(*given[:2], theta_r, phi_r, given[2], *u)
    core().hairlut_sample_strand_n(
        model.pointer, ctypes.c_size_t(theta_r.size), *first, Samples(*pointers(*out))
    )
    return out


def pdf_strand_n(model: Model, parameters, shares, offset, *inputs) -> np.ndarray:
    """hairlut_pdf_strand_n."""
    arrays = [np.ascontiguousarray(a, np.float32) for a in np.broadcast_arrays(*inputs)]
    given = [None if a is None else np.ascontiguousarray(a, np.float32) for a in (parameters, shares, offset)]
    out = np.empty_like(arrays[0])
    first = pointers(*given[:2], *arrays[:2], given[2], *arrays[2:], out)
    core().hairlut_pdf_strand_n(model.pointer, ctypes.c_size_t(out.size), *first)
    return out

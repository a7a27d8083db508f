# SPDX-License-Identifier: BSD-3-Clause
"""The normalising integral of any log-density on an interval, and its running integral from both ends.

One-dimensional Gauss-Legendre panels, bisected until the integral over a panel and over its two halves agree.
Nothing is assumed about the density but that it is given as a logarithm: subtracting a row's maximum before
exponentiating keeps a lobe whose mass underflows, and running sums from both ends keep the relative precision
of both tails, which a difference from 1 would lose. All rows are worked on at once.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .errors import HairlutError
from .lobes import Array, Lobe, LogDensity

ORDER = 10
FIRST_PANELS = 128  # with 3 * ORDER points each: what is wider than 1/2000 of the domain is not missed
PORTION = 512  # panels evaluated at once
MAX_PANELS = 4096
MAX_ROUNDS = 100
TOLERANCE = 1e-14  # of a panel's integral, relative to the smaller of the masses up to its ends
EPS = np.finfo(float).eps

_nodes, _weights = np.polynomial.legendre.leggauss(ORDER)
NODES, WEIGHTS = (_nodes + 1) / 2, _weights / 2
HALVES, HALF_WEIGHTS = np.concatenate([NODES / 2, 0.5 + NODES / 2]), np.concatenate([WEIGHTS, WEIGHTS]) / 2
NEGLIGIBLE = 750.0  # exp(-750) is zero in double precision
PROBES = np.array([1e-6, 1 - 1e-6])  # just inside a panel's ends, where a spike at a breakpoint shows


@dataclass(frozen=True)
class Rows:
    """R densities, one for each row.

    log_density(x, row)   of x (n, k) in the rows row (n,); shape (n, k)
    low, high             (R,) the interval of each row
    breakpoints           (R, B) points inside it that panels must not straddle
    label                 label(row): how to name a row in an error
    """

    log_density: Callable[[Array, Array], Array]
    low: Array
    high: Array
    breakpoints: Array
    label: Callable[[int], str]


@dataclass(frozen=True)
class Integral:
    """The running integrals of R rows over at most P panels; unused panels are empty and lie at the high end.

    edges       (R, P+1) panel p of row r covers [edges[r, p], edges[r, p+1]]
    below       (R, P+1) mass from the low end to an edge, divided by exp(log_scale)
    above       (R, P+1) mass from an edge to the high end, likewise
    log_scale   (R,) the largest log-density seen in a row
    """

    rows: Rows
    edges: Array
    below: Array
    above: Array
    log_scale: Array

    @property
    def mantissa(self) -> Array:
        """(R,) normalising mass divided by exp(log_scale)."""
        return self.below[:, -1]

    @property
    def log_mass(self) -> Array:
        """(R,) logarithm of the normalising mass; finite also where the mass itself underflows."""
        return self.log_scale + np.log(self.mantissa)


@dataclass
class _Panels:
    """Panels in order of row, then of position. The integral over one is fine * exp(top), off by about
    error * exp(top); noise is the part that rounding leaves undecided, edge the log-density at its ends."""

    row: Array
    a: Array
    b: Array
    top: Array
    fine: Array
    error: Array
    noise: Array
    edge: Array


def rows_of_lobe(lobe: Lobe, theta_r: Array) -> Rows:
    """The lobe at each theta_r (R,)."""
    theta_r = np.asarray(theta_r, float)
    count = len(theta_r)
    given = lobe.breakpoints
    given = given(theta_r) if callable(given) else np.tile(given, (count, 1))
    return Rows(
        log_density=_at_rows(lobe.log_density, theta_r),
        low=np.full(count, lobe.domain[0], float),
        high=np.full(count, lobe.domain[1], float),
        breakpoints=np.clip(given, *lobe.domain),
        label=lambda row: f"{lobe.model}/{lobe.name} at theta_r = {theta_r[row]:.9g} rad",
    )


def _at_rows(log_density: LogDensity, theta_r: Array) -> Callable[[Array, Array], Array]:
    def at_rows(x: Array, row: Array) -> Array:
        with np.errstate(divide="ignore"):  # log(0) is a density of zero
            return np.broadcast_to(log_density(x, theta_r[row][:, None]), x.shape)

    return at_rows


def integrate(rows: Rows) -> Integral:
    """Integrates every row to about 1e-14 relative, in both tails.

    HairlutError where a density is zero everywhere, not a number, or cannot be resolved.
    """
    panels = _evaluate(rows, *_first_panels(rows))
    for _ in range(MAX_ROUNDS):
        scale = _row_maximum(rows, panels)
        split = _unresolved(rows, panels, scale)
        if not split.any():
            return _accumulate(rows, panels, scale)
        panels = _bisect(rows, panels, split)
    raise HairlutError(_complaint(rows, panels, int(np.argmax(split))))


def _first_panels(rows: Rows) -> tuple[Array, Array, Array]:
    count = len(rows.low)
    even = rows.low[:, None] + (rows.high - rows.low)[:, None] * np.arange(FIRST_PANELS + 1) / FIRST_PANELS
    even[:, -1] = rows.high
    given = np.sort(rows.breakpoints.reshape(count, -1), axis=1)
    edges = np.sort(np.concatenate([_give_way(even, given), given], axis=1), axis=1)
    row = np.repeat(np.arange(count), edges.shape[1] - 1)
    a, b = edges[:, :-1].ravel(), edges[:, 1:].ravel()
    wide = b > a
    return row[wide], a[wide], b[wide]


def _give_way(even: Array, given: Array) -> Array:
    """Moves an edge that almost is a breakpoint onto it: a sliver would drag others down to its width."""
    if not given.shape[1]:
        return even
    near = (even[:, 1:2] - even[:, :1]) / 64
    for r, (edges, points) in enumerate(zip(even, given, strict=True)):
        k = (
            np.clip(np.searchsorted(points, edges), 1, len(points) - 1)
            if len(points) > 1
            else np.zeros(len(edges), int)
        )
        k = np.where(abs(points[k - 1] - edges) < abs(points[k] - edges), k - 1, k)
        moved = abs(points[k] - edges) < near[r]
        moved[[0, -1]] = False
        edges[moved] = points[k][moved]
    return even


def _log_density(rows: Rows, x: Array, row: Array) -> Array:
    values = rows.log_density(x, row)
    if not values.max(initial=-np.inf) < np.inf:  # also if one of them is NaN
        n, k = np.argwhere(np.isnan(values) | (values == np.inf))[0]
        raise HairlutError(
            f"{rows.label(row[n])}: the log-density is {values[n, k]} at x = {x[n, k]:.9g}: "
            "expected a finite number, or -inf where the density is zero"
        )
    return values


def _evaluate(rows: Rows, row: Array, a: Array, b: Array) -> _Panels:
    """The panels [a, b] (P,) of the rows row (P,), in portions that stay in the processor's cache."""
    portions = [slice(n, n + PORTION) for n in range(0, len(row), PORTION)]
    parts = [_evaluate_portion(rows, row[p], a[p], b[p]) for p in portions]
    return _Panels(
        *(np.concatenate([getattr(part, f) for part in parts]) for f in _Panels.__dataclass_fields__)
    )


def _evaluate_portion(rows: Rows, row: Array, a: Array, b: Array) -> _Panels:
    h = b - a
    x = a[:, None] + h[:, None] * np.concatenate([NODES, HALVES, PROBES])
    values, probes = np.split(_log_density(rows, x, row), [3 * ORDER], axis=1)
    top = values.max(axis=1)
    drop = values - np.where(np.isfinite(top), top, 0.0)[:, None]
    density = np.exp(drop)
    coarse = h * (density[:, :ORDER] @ WEIGHTS)
    fine = h * (density[:, ORDER:] @ HALF_WEIGHTS)
    # what rounding leaves undecided: of the logarithm itself, and of x where the logarithm is steep
    steepness = -np.maximum(drop.min(axis=1), -40.0) * np.maximum(abs(a), abs(b)) / h
    noise = 4 * EPS * (1 + abs(np.where(np.isfinite(top), top, 0.0)) + steepness)
    return _Panels(row, a, b, top, fine, abs(fine - coarse), noise, probes.max(axis=1))


def _row_maximum(rows: Rows, panels: _Panels) -> Array:
    scale = np.full(len(rows.low), -np.inf)
    np.maximum.at(scale, panels.row, np.maximum(panels.top, panels.edge))
    if not np.isfinite(scale).all():
        row = int(np.argmin(np.isfinite(scale)))
        raise HairlutError(
            f"{rows.label(row)}: the density is zero over the whole domain: check its domain and formula"
        )
    return scale


def _spread(panels: _Panels, values: Array, count: int) -> Array:
    """(R, P) values of the panels, one row per row, zero where a row has fewer panels than another."""
    table = np.zeros((count, np.bincount(panels.row).max()))
    table[panels.row, _place(panels.row)] = values
    return table


def _place(row: Array) -> Array:
    """Index of each panel within its row."""
    return np.arange(len(row)) - np.searchsorted(row, row)


def _unresolved(rows: Rows, panels: _Panels, scale: Array) -> Array:
    factor = np.exp(panels.top - scale[panels.row])
    error = panels.error * factor
    mass = _spread(panels, panels.fine * factor, len(rows.low))
    nearer = np.minimum(np.cumsum(mass, axis=1), np.cumsum(mass[:, ::-1], axis=1)[:, ::-1])
    nearer = nearer[panels.row, _place(panels.row)]
    split = error > np.maximum(TOLERANCE * nearer, panels.noise * panels.fine * factor)
    split |= panels.edge > np.maximum(panels.top + 1, scale[panels.row] - NEGLIGIBLE)
    # A jump, or an end where the density is unbounded, is not bisected below the spacing of floats.
    h = panels.b - panels.a
    narrow = h <= EPS * (rows.high - rows.low)[panels.row]
    harmless = narrow & (error <= TOLERANCE * mass.sum(axis=1)[panels.row])
    return split & ~harmless & (h > 4 * EPS * np.maximum(abs(panels.a), abs(panels.b)))


def _bisect(rows: Rows, panels: _Panels, split: Array) -> _Panels:
    middle = (panels.a[split] + panels.b[split]) / 2
    row = np.concatenate([panels.row[split]] * 2)
    a, b = np.concatenate([panels.a[split], middle]), np.concatenate([middle, panels.b[split]])
    old, new = vars(panels), vars(_evaluate(rows, row, a, b))
    merged = [np.concatenate([old[name][~split], new[name]]) for name in old]
    order = np.lexsort((merged[1], merged[0]))
    result = _Panels(*(values[order] for values in merged))
    if np.bincount(result.row).max() > MAX_PANELS:
        raise HairlutError(_complaint(rows, panels, int(np.argmax(split))))
    return result


def _complaint(rows: Rows, panels: _Panels, p: int) -> str:
    return (
        f"{rows.label(panels.row[p])}: the integral does not converge between x = {panels.a[p]:.9g} and "
        f"{panels.b[p]:.9g}: the density is noisy or unbounded there; smooth it, or name its breakpoints"
    )


def _accumulate(rows: Rows, panels: _Panels, scale: Array) -> Integral:
    count = len(rows.low)
    mass = _spread(panels, panels.fine * np.exp(panels.top - scale[panels.row]), count)
    zero = np.zeros((count, 1))
    edges = np.tile(rows.high[:, None], (1, mass.shape[1] + 1))
    edges[panels.row, _place(panels.row)] = panels.a
    return Integral(
        rows=rows,
        edges=edges,
        below=np.concatenate([zero, np.cumsum(mass, axis=1)], axis=1),
        above=np.concatenate([np.cumsum(mass[:, ::-1], axis=1)[:, ::-1], zero], axis=1),
        log_scale=scale,
    )

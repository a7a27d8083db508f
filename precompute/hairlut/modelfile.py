# SPDX-License-Identifier: BSD-3-Clause
"""A model from a file: a hair's own lobes, written in Python or TOML, or as masses of cells.

A **Python file** defines `LOBES`: for each lobe a density named <lobe>_theta, and where the azimuth is not
uniform one named <lobe>_phi:

    import numpy as np
    from hairlut.modelfile import density, gaussian

    LOBES = (
        gaussian("direct_theta", mean=lambda theta_r: -theta_r - np.radians(3), sigma=0.2),
        density("direct_phi", log_density=lambda phi, theta_r: 2 * np.cos(phi - np.pi) + 0 * theta_r),
        gaussian("multiple_theta", mean=lambda theta_r: -0.4 * theta_r, sigma=0.5),
    )
    AZIMUTH = "difference"     # or "sum": whether phi is phi_i - phi_r (the default) or phi_i + phi_r
    SHARES = {"direct": 0.7, "multiple": 0.3}    # of the samples, in any unit (default: equal)
    INPUTS = ("table.csv",)    # files beside it that it reads: when they change, the textures are out of date

Angles are in radians. Every function gets NumPy arrays that broadcast against each other and works element
by element. A <lobe>_theta is a density of theta_i in [-pi/2, pi/2], a <lobe>_phi of the relative azimuth in
[0, 2 pi). None has to be normalised. Settings are upper case; one that is misspelt is refused. The file may
import its neighbours; userfile.py says how it runs. precompute/examples/ contains such files.

A **TOML file** gives Gaussians as numbers: tomlmodel.py.

An **npz file** holds masses of cells: for each lobe NAME the arrays NAME.edges,
NAME.theta_r and NAME.mass of tabulated.TabulatedDensity, the string `azimuth`, and the number LOBE.share of
each lobe, if the shares are not equal.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path

import numpy as np

from . import lobes
from .errors import HairlutError
from .lobecheck import check_lobe, check_units
from .lobes import AZIMUTHS, DIFFERENCE, HALF_PI, MAX_LOBES, MODELS, NO_AZIMUTH, Lobe, Model, space
from .npz import read_npz
from .tabulated import TabulatedDensity
from .tomlmodel import ROUNDED, curves, read_document
from .userfile import guarded, run_file, user_code

SUFFIXES = (".py", ".toml", ".npz")
SETTINGS = {
    "LOBES": ((tuple, list), "a tuple of gaussian(), density() or tabulated()"),
    "AZIMUTH": (str, f"one of {', '.join(AZIMUTHS)}"),
    "SHARES": (dict, "a number for each lobe"),
    "INPUTS": ((tuple, list), "a tuple of file names"),
}
"""Settings of a Python file: the type of each, and a description for errors."""

KEPT = 16  # tabulated lobes: more than a model has


def _space(name: str) -> dict:
    """What a lobe's name says; its model and azimuth are filled in when the file has been read."""
    return {"model": "", "name": name, "azimuth": NO_AZIMUTH, **space(name)}


def gaussian(name: str, mean, sigma, formula: str = "") -> Lobe:
    """A Gaussian cut to the lobe's domain; mean and sigma: numbers (rad) or functions of theta_r."""
    mean_of, sigma_of = _function(f"{name}: mean", mean), _function(f"{name}: sigma", sigma)
    return lobes.gaussian(
        lambda theta_r: (mean_of(theta_r), sigma_of(theta_r)),
        formula=formula or f"Gaussian of {space(name)['angle']}, from a model file",
        **_space(name),
    )


def density(
    name: str,
    log_density: Callable | None = None,
    density: Callable | None = None,
    formula: str = "",
    breakpoints: Sequence[float] | Callable = (),
) -> Lobe:
    """Any lobe, as log_density(x, theta_r) or density(x, theta_r), rad.

    breakpoints: where it jumps, bends sharply or has a spike narrower than 1/2000 of the domain; numbers,
    or a function that returns those at theta_r (R,) as (R, B).
    """
    if (log_density is None) == (density is None):
        raise HairlutError(f"{name}: give either log_density or density, not both or neither")
    return Lobe(
        log_density=log_density or _logarithm(density),
        formula=formula or "a density from a model file",
        breakpoints=breakpoints if callable(breakpoints) else tuple(breakpoints),
        **_space(name),
    )


def tabulated(name: str, edges, theta_r, mass, formula: str = "") -> Lobe:
    """A lobe given as masses of cells (tabulated.TabulatedDensity); the edges must span the domain."""
    table = _of_masses(name, *(_as_bytes(values) for values in (edges, theta_r, mass)))
    low, high = space(name)["domain"]
    if abs(table.edges[0] - low) > 1e-9 or abs(table.edges[-1] - high) > 1e-9:
        raise HairlutError(
            f"{name}: the cells' edges run from {table.edges[0]:.6g} to {table.edges[-1]:.6g}, "
            f"expected the domain's {low:.6g} to {high:.6g} rad"
        )
    if abs(table.theta_r).max() > HALF_PI + ROUNDED:
        raise HairlutError(
            f"{name}: theta_r runs from {table.theta_r[0]:.6g} to {table.theta_r[-1]:.6g}, expected radians "
            "within [-pi/2, pi/2]: are they degrees?"
        )
    cells, rows = len(table.edges) - 1, len(table.theta_r)
    text = f"{cells} measured cells at {rows} theta_r, quantiles blended between them"
    lobe = density(name, log_density=table, formula=formula or text, breakpoints=table.breakpoints)
    return replace(lobe, own_height=table.own_height, exact=table.exact)


@lru_cache(maxsize=KEPT)
def _of_masses(name: str, *arrays: tuple[tuple[int, ...], bytes]) -> TabulatedDensity:
    """The same object for the same numbers: lobes of it are equal, and baked once."""
    return TabulatedDensity(*(np.frombuffer(data).reshape(shape) for shape, data in arrays), name)


def _as_bytes(values) -> tuple[tuple[int, ...], bytes]:
    values = np.asarray(values, float)
    return values.shape, values.tobytes()


def _function(what: str, value) -> Callable:
    if callable(value):
        return lambda theta_r: value(theta_r) + np.zeros_like(theta_r)
    if isinstance(value, bool) or not isinstance(value, (int, float, np.number)):
        raise HairlutError(f"{what} is {value!r}: expected a number (rad) or a function of theta_r")
    return lambda theta_r: np.full_like(theta_r, value, dtype=float)


def _logarithm(density: Callable) -> Callable:
    def log_density(x, theta_r):
        value = np.asarray(density(x, theta_r), float)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(value < 0, np.nan, np.log(np.where(value < 0, np.nan, value)))

    log_density.density = density
    return log_density


def find(text: str) -> Model:
    """The built-in model of that name, or the checked model in that file; HairlutError if there is none."""
    if text in MODELS:
        return MODELS[text]
    path = Path(text)
    if path.suffix not in SUFFIXES:
        remedy = ": hairlut fit makes a model of data" if path.suffix == ".csv" else ""
        raise HairlutError(
            f"model {text!r} is not known: expected one of {', '.join(MODELS)}, "
            f"or a file ending in {', '.join(SUFFIXES)}{remedy}"
        )
    if not path.is_file():
        raise HairlutError(f"model {text}: no such file")
    return load(path)


def load(path: Path) -> Model:
    """Reads a model file and checks its lobes; the model takes the file's name."""
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,62}", path.stem):
        raise HairlutError(
            f"{path}: a model takes its file's name: expected up to 63 letters, digits, '_', '-', '.'"
        )
    reader = {".py": _from_python, ".toml": _from_toml, ".npz": _from_npz}[path.suffix]
    model = assemble(path.stem, reader(path), str(path))
    with user_code(path):
        for lobe in model.lobes:
            if path.suffix == ".py":  # TOML says the unit
                check_units(lobe, str(path))
            if not lobe.exact:  # a lobe with a closed form was made from data that were checked
                check_lobe(lobe, str(path))
    return replace(model, lobes=tuple(_guarded(lobe, path) for lobe in model.lobes))


def _guarded(lobe: Lobe, path: Path) -> Lobe:
    """The lobe, whose functions name the file where they fail: at places that the check did not see."""
    if path.suffix != ".py" or lobe.exact:
        return lobe
    names = ("log_density", "breakpoints", "moments")
    functions = {name: getattr(lobe, name) for name in names if callable(getattr(lobe, name))}
    return replace(lobe, **{name: guarded(function, path) for name, function in functions.items()})


def inputs(path: Path) -> list[Path]:
    """The model file, the files that it names in INPUTS, and those beside it that it imports; HairlutError if
    one of these is missing."""
    if path.suffix != ".py":
        return [path]
    run = run_file(path)
    named = [path.parent / name for name in getattr(run.module, "INPUTS", ())]
    for file in named:
        if not file.is_file():
            raise HairlutError(f"{path}: INPUTS names {file}, which is missing")
    return list(dict.fromkeys([path, *named, *run.neighbours]))


@dataclass(frozen=True)
class Given:
    """What a model file says. lobes: densities; shares: a number for each lobe by name, or none at all."""

    lobes: Sequence[Lobe]
    azimuth: object = DIFFERENCE
    shares: Mapping[str, object] | None = None


def assemble(name: str, given: Given, where: str) -> Model:
    """A model of these densities; HairlutError if one is missing or there twice, or a setting is wrong."""
    names = [lobe.name for lobe in given.lobes]
    lobes = [name.removesuffix("_theta") for name in names if name.endswith("_theta")]
    if not 1 <= len(lobes) <= MAX_LOBES:
        raise HairlutError(
            f"{where}: densities {', '.join(names) or 'none'}: expected <lobe>_theta for 1 to {MAX_LOBES} "
            "lobes, and <lobe>_phi where the azimuth is not uniform"
        )
    for one in names:
        if names.count(one) > 1:
            raise HairlutError(f"{where}: {one} is there {names.count(one)} times, expected once")
        if one.endswith("_phi") and one.removesuffix("_phi") not in lobes:
            raise HairlutError(f"{where}: {one} has no {one.removesuffix('_phi')}_theta beside it")
    if not isinstance(given.azimuth, str) or given.azimuth not in AZIMUTHS:
        raise HairlutError(f"{where}: azimuth {given.azimuth!r}: expected one of {', '.join(AZIMUTHS)}")
    azimuths = {"phi": given.azimuth, "theta_i": NO_AZIMUTH}
    densities = tuple(replace(one, model=name, azimuth=azimuths[one.angle]) for one in given.lobes)
    return Model(name, densities, _shares(lobes, given.shares, where))


def _shares(lobes: list[str], shares: object, where: str) -> tuple[float, ...] | None:
    """The shares in the order of the lobes."""
    if shares is None:
        return None
    expected = f"expected a number for each of {', '.join(lobes)}, 0 or more, and not all 0"
    if not isinstance(shares, Mapping) or sorted(shares) != sorted(lobes):
        found = ", ".join(map(str, shares)) if isinstance(shares, Mapping) else repr(shares)
        raise HairlutError(f"{where}: shares of {found or 'nothing'}: {expected}")
    for lobe, share in shares.items():
        if isinstance(share, bool) or not isinstance(share, (int, float)) or not 0 <= share < np.inf:
            raise HairlutError(f"{where}: share of {lobe} is {share!r}: {expected}")
    if not sum(shares.values()) > 0:
        raise HairlutError(f"{where}: every share is 0: {expected}")
    return tuple(float(shares[lobe]) for lobe in lobes)


# ---- Python


def _from_python(path: Path) -> Given:
    module = run_file(path).module
    _check_settings(path, vars(module))
    given = getattr(module, "LOBES", None)
    if given is None or not all(isinstance(lobe, Lobe) for lobe in given):
        remedy = f"; it defines bsdf: hairlut fit {path}" if hasattr(module, "bsdf") else ""
        raise HairlutError(f"{path}: expected LOBES, {SETTINGS['LOBES'][1]}{remedy}")
    return Given(given, getattr(module, "AZIMUTH", DIFFERENCE), getattr(module, "SHARES", None))


def _check_settings(path: Path, names: dict) -> None:
    """HairlutError for a setting of another type, or a name that is almost a setting and has a value for it;
    other names are the file's own."""
    for name, value in names.items():
        if name in SETTINGS:
            kind, expected = SETTINGS[name]
            if not isinstance(value, kind):
                raise HairlutError(f"{path}: {name} is {value!r}: expected {expected}")
        elif near := get_close_matches(name.upper(), SETTINGS, n=1, cutoff=0.8):
            kind, expected = SETTINGS[near[0]]
            if isinstance(value, kind) and not name.startswith("_"):
                raise HairlutError(f"{path}: {name} is no setting: did you mean {near[0]}, {expected}?")
    if not all(isinstance(name, str) for name in names.get("INPUTS", ())):
        raise HairlutError(f"{path}: INPUTS is {names['INPUTS']!r}: expected {SETTINGS['INPUTS'][1]}")


# ---- TOML


def _from_toml(path: Path) -> Given:
    tables, azimuth, shares = read_document(path)
    given = []
    for name, table in tables.items():
        mean, sigma, formula = curves(f"{path}: {name}", name, table)
        given.append(gaussian(name, mean, sigma, formula))
    return Given(given, azimuth, shares)


# ---- npz


def _from_npz(path: Path) -> Given:
    arrays = read_npz(path, text=("azimuth",))
    azimuth = str(arrays.pop("azimuth", DIFFERENCE))
    shares = {key.removesuffix(".share"): arrays.pop(key) for key in list(arrays) if key.endswith(".share")}
    if any(share.size != 1 for share in shares.values()):
        raise HairlutError(f"{path}: a share has several numbers: expected one for each lobe")
    names = [key.removesuffix(".edges") for key in arrays if key.endswith(".edges")]
    expected = {f"{name}.{key}" for name in names for key in ("edges", "theta_r", "mass")}
    missing, unknown = sorted(expected - {*arrays}), sorted({*arrays} - expected)
    if missing or unknown or not names:
        problem = f"array {(missing or unknown or ['NAME.edges'])[0]} is "
        problem += "not known" if unknown and not missing else "missing"
        other = f"; a grid of a hair, or draws: hairlut fit {path}" if "theta_i" in arrays else ""
        raise HairlutError(
            f"{path}: {problem}: expected NAME.edges, NAME.theta_r and NAME.mass for each NAME, "
            f"<lobe>_theta or <lobe>_phi, and azimuth{other}"
        )
    try:
        given = [
            tabulated(name, *(arrays[f"{name}.{key}"] for key in ("edges", "theta_r", "mass")))
            for name in names
        ]
    except HairlutError as error:
        raise HairlutError(f"{path}: {error}") from None
    return Given(given, azimuth, {lobe: float(share.item()) for lobe, share in shares.items()} or None)

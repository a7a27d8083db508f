# SPDX-License-Identifier: BSD-3-Clause
"""A model's files, good ones, and what can be done to one of them."""

import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import OpenEXR

from hairlut import exr
from hairlut.mixture import Mixture
from hairlut.model import BakedLobe, BakedModel
from hairlut.slopes import derived
from hairlut.table import Table
from precompute import parametric
from precompute.conftest import LUTS

Channels = dict[str, np.ndarray]
FORMAT_1_CELL = "parabola limit=0.9"


@dataclass(frozen=True)
class Edit:
    """What is done to a file: attributes set and dropped, channels mapped, the digest made to fit again; or
    `whole`, which does it all to the path.

    text     maps a text attribute; header sets attributes of any type, or maps the header to what it sets
    """

    header: Mapping[str, object] | Callable[[dict], dict] = field(default_factory=dict)
    drop: tuple[str, ...] = ()
    text: Mapping[str, Callable[[str], str]] = field(default_factory=dict)
    channels: Callable[[Channels], Channels] | None = None
    digest: bool = False
    whole: Callable[[Path], None] | None = None

    def apply(self, path: Path) -> None:
        """Does it to the file."""
        if self.whole:
            self.whole(path)
            return
        header, channels = read(path)
        changed = self.channels(channels) if self.channels else channels
        set_to = self.header(header) if callable(self.header) else self.header
        header |= {name: edit(header[name]) for name, edit in self.text.items()} | dict(set_to)
        if self.digest:
            header["hairlut.digest"] = digest(changed)
        if {c.shape for c in channels.values()} != {c.shape for c in changed.values()}:
            header = {name: value for name, value in header.items() if not name.endswith("Window")}
        write(path, {name: value for name, value in header.items() if name not in self.drop}, changed)


def read(path: Path) -> tuple[dict, Channels]:
    """(header without its channels, pixels by channel) of a file."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {name: np.array(channel.pixels) for name, channel in file.channels().items()}
        return {name: value for name, value in file.header().items() if name != "channels"}, channels


def write(path: Path, header: dict, channels: Channels) -> None:
    with OpenEXR.File(header, {name: np.ascontiguousarray(c) for name, c in channels.items()}) as file:
        file.write(str(path))


def digest(channels: Channels) -> str:
    """luts/FORMAT.md's, of a table or of a mixture of lobes direct and multiple."""
    order = [name for name in ORDER if name in channels]
    texels = np.stack([channels[name] for name in order], axis=-1)
    return f"crc32 {zlib.crc32(np.ascontiguousarray(texels, '<f4').tobytes()):08x}"


ORDER = ["Y", "dxdu", "direct.share", "direct.turn", "multiple.share", "multiple.turn"]


def model(source: Path, name: str = "fitted") -> BakedModel:
    """The model of a directory with shares and turns that depend on everything."""
    given = exr.read_model(source)
    theta_r, offset = np.array([-1.5, 0.0, 0.25, 1.5]), np.array([0.0, 0.5, 1.0])
    random = np.random.default_rng(7)
    share = random.uniform(0.1, 1.0, (2, len(theta_r), len(offset))).astype(np.float32)
    turn = random.uniform(-4.0, 4.0, share.shape).astype(np.float32)
    mixture = Mixture(("direct", "multiple"), theta_r, offset, share.astype(float), turn.astype(float), True)
    lobes = tuple(BakedLobe(lobe.name, lobe.theta, lobe.phi) for lobe in given.lobes)
    return BakedModel(given.name, lobes, mixture)


def write_format_2(directory: Path, source: Path) -> Path:
    """The model's files."""
    directory.mkdir()
    exr.write_model(directory, model(source))
    return directory


def over_parameters() -> BakedModel:
    """A model of the same files that depends on parameters: each table on others, and the mixture on two."""
    random, depends = np.random.default_rng(8), parametric.axes("beta_m", "absorption")
    given = model(LUTS / "fitted").mixture
    shape = 2, *(len(axis.nodes) for axis in depends), *given.share.shape[1:]
    share = random.uniform(0.1, 1.0, shape).astype(np.float32).astype(float)
    turn = random.uniform(-4.0, 4.0, shape).astype(np.float32).astype(float)
    mixture = replace(given, share=share, turn=turn, axes=depends)
    theta = parametric.table("direct_theta", parametric.axes("beta_m"), random)
    phi = parametric.table("direct_phi", parametric.axes("tilt", "absorption"), random)
    lobes = (
        BakedLobe("direct", theta, phi),
        BakedLobe("multiple", parametric.table("multiple_theta", (), random), None),
    )
    return BakedModel("parametric", lobes, mixture, {}, parametric.PARAMETERS)


def write_over_parameters(directory: Path) -> Path:
    """Its files."""
    exr.write_model(directory, over_parameters())
    return directory


def write_format_1(directory: Path, source: Path) -> Path:
    """The same tables without slopes and without a mixture."""
    write_format_2(directory, source)
    (directory / "mixture.exr").unlink()
    for path in directory.glob("*.exr"):
        to_format_1(path)
    return directory


def to_format_1(path: Path) -> None:
    """A table's file of format 2, as format 1 wrote it."""
    edit = Edit(
        header={"hairlut.format": 1, "hairlut.cell": FORMAT_1_CELL},
        drop=("hairlut.digest",),
        channels=lambda channels: {"Y": channels["Y"]},
    )
    edit.apply(path)


def small_table(table: Table) -> Table:
    """A table of the same kind in a few columns and rows."""
    width, height = 6, 3
    row = np.linspace(*table.domain, width, dtype=np.float32)
    row[[0, -1]] = table.domain
    texels = np.tile(row, (height, 1))
    slopes = derived(texels, table.warp.widths(width)).astype(np.float32)
    return replace(table, texels=texels, slopes=slopes, log_mass=np.zeros(height))


def write_small(directory: Path, source: Path) -> Path:
    """Files of format 2 that are mostly header."""
    given = model(source)
    lobes = (BakedLobe(x.name, small_table(x.theta), x.phi and small_table(x.phi)) for x in given.lobes)
    exr.write_model(directory, replace(given, lobes=tuple(lobes)))
    return directory

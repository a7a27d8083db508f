# SPDX-License-Identifier: BSD-3-Clause
"""Files that were saved again without harm, and malformed ones: each with what both readers must say.

A case is (name, file, edit, said): said is None where the model loads, else what stands in both refusals.
"""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import OpenEXR
from conformance.files import Channels, Edit, read

Case = tuple[str, str, Edit, str | None]

THETA, PHI, MULTIPLE, MIXTURE = "direct_theta.exr", "direct_phi.exr", "multiple_theta.exr", "mixture.exr"
KEPT = ("NO", "RLE", "ZIPS", "ZIP")
REFUSED = ("PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB", "HTJ2K256", "HTJ2K32", "ZSTD")
INFORMATION = ("colorInteropID", "hairlut.generator", "hairlut.parameters", "hairlut.log_mass")
COMMON = ("format", "model", "table", "unit")
OF_TABLE = ("angle", "azimuth", "theta_r_range", "domain", "warp", "cell", "knots")
OF_MIXTURE = ("lobes", "lobe.direct", "lobe.multiple", "axes", "axis.theta_r", "axis.offset", "mirrored")
OF_PARAMETERS = ("axes", "axis.beta_m", "axis.absorption", "axis.tilt", "parameter.beta_m", "parameter.tilt")
NO_MIXTURE_AXES = (
    "theta_r offset",
    "beta_m absorption theta_r offset",
    "beta_m absorption tilt tilt theta_r offset",
    "beta_m absorption tilt",
    "beta_m absorption tilt offset theta_r",
    "theta_r offset beta_m absorption tilt",
    "beta_m absorption tilt theta_r  offset",
    "beta_m  absorption tilt theta_r offset",
    "beta_m,absorption,tilt theta_r offset",
    "beta_m absorption tilt phi theta_r offset",
    "beta_m absorption tilt lobe theta_r offset",
    "beta_m absorption tilt theta_r theta_r offset",
    "beta_m absorption tilt 2nd theta_r offset",
    "beta_m absorption tilt Gloss theta_r offset",
    f"beta_m absorption tilt {'g' * 32} theta_r offset",
    "beta_m absorption tilt a b c d e f theta_r offset",
)
NO_TABLE_AXES = (
    "theta_r",
    "beta_m",
    "theta_r beta_m",
    "beta_m beta_m theta_r",
    "offset theta_r",
    "beta_m  theta_r",
    "beta_m theta_r offset",
    "a b c d e theta_r",
)
PARAMETER_NUMBERS = (
    ("parameter.beta_m", "0.9 0.1 0.3", {}),
    ("parameter.beta_m", "0.1 0.1 0.1", {}),
    ("parameter.beta_m", "0.1 0.9 0.05", {}),
    ("parameter.beta_m", "0.1 0.9 0.95", {}),
    ("parameter.beta_m", "0.1 0.9 nan", {}),
    ("parameter.beta_m", "0.1 0.9", {}),
    ("parameter.beta_m", "0.1 1e31 0.3", {}),
    ("parameter.beta_m", "-1e31 0.9 0.3", {}),
    ("parameter.tilt", "-4 -4.00000001 -4", {}),
    ("parameter.tilt", "0 1e-31 0", {}),
    ("axis.tilt", "-0.5", {}),
    ("axis.tilt", "-4", {}),
    ("axis.tilt", "-4 3", {}),
    ("axis.tilt", "-1 -1", {}),
)
NO_NODES = (
    "0.1",
    "0.3 0.9",
    "0.1 0.3 0.8",
    "0.1 0.25 0.25 0.9",
    "0.1 0.25 0.25000000001 0.9",
    "0.9 0.25 0.1",
    "0.1 nan 0.9",
    "0.1 1e99 0.9",
    "",
    " ".join(f"{0.1 + 0.8 * k / 64:.9g}" for k in range(65)),
)
# what is no number, or no space between two
NO_NUMBERS = (
    "1_0",
    "1e25",
    "9e300",
    "1e99999",
    "\uff11",
    "inf",
    "nan",
    "0x1p3",
    "1e",
    "1.2.3",
    "1,5",
    "",
    "--1",
    "1e999",
    "0" * 101,
)
NUMBERS = ("1.5", "+1.5", "1.5e0", "15E-1", "1.5000000000000000000000", "0015e-1", "1.50e+00")
# a stray byte, a cut character, an overlong one, a surrogate, one beyond the last
NO_TEXT = (b"a\x80b", b"\xc2", b"\xc2a", b"\xe2\x82a", b"\xe0\x80\x80", b"\xed\xa0\x80", b"\xf4\x90\x80\x80")
NO_TEXT += (b"\xf1\x80\x80a", b"\xe2\x82\xc0", b"\xe2\x82", b"\xc0\x80", b"\xff\xff", b"\xf0\x80\x80\x80")
NO_WARPS = ("cubic", "octaves", "octaves e=", "octaves e=1e-5 ", "octaves e=nan", "octaves e=1e-13")
NO_WARPS += ("octaves e=2", "octaves e=-1", "octaves  e=0.1", "octaves f=0.1", "uniform e=0")
NO_LOBES = ("direct direct", "direct  multiple", "direct Multiple", "direct 2nd", "direct,multiple")
NO_LOBES += ("direct m-", "direct m{", f"direct {'m' * 32}", " ".join(f"l{k}" for k in range(17)))
NO_TABLES = (
    "multiple_theta",
    "multiple_theta 0123456",
    "multiple_theta  01234567",
    "multiple_theta 0123456G",
)
NO_TABLES += ("multiple_phi 01234567", "theta 01234567", "../x_theta 01234567", "_theta 01234567")
NO_TABLES += ("direct_theta 01234567 direct_phi", "multiple_theta 01234567 direct_theta 01234567")
NO_TABLES += ("Multiple_theta 01234567", f"{'m' * 32}_theta 01234567")


def compression(name: str) -> Edit:
    return Edit(header={"compression": getattr(OpenEXR, f"{name}_COMPRESSION")})


def put(channel: str, place: tuple, value: float, digest: bool = True) -> Edit:
    """One texel, or several, of a channel set."""

    def change(channels: Channels) -> Channels:
        channels[channel][place] = value
        return channels

    return Edit(channels=change, digest=digest)


def each(change: Callable[[np.ndarray], np.ndarray], digest: bool = False) -> Edit:
    """Every channel mapped alike."""
    return Edit(channels=lambda channels: {n: change(c) for n, c in channels.items()}, digest=digest)


def moved(window: str, axis: int) -> Edit:
    """A window moved by one texel to the right or down."""
    step = np.eye(2, dtype=np.int32)[axis]
    return Edit(header=lambda h: {window: tuple(corner + step for corner in h[window])})


def larger_display(header: dict) -> dict:
    low, high = header["displayWindow"]
    return {"displayWindow": (low, high + np.array([0, 5], np.int32))}


def two_parts(path: Path) -> None:
    header, channels = read(path)
    parts = [OpenEXR.Part({**header, "name": name}, channels) for name in ("one", "two")]
    OpenEXR.File(parts).write(str(path))


def cut(share: float) -> Edit:
    def whole(path: Path) -> None:
        data = path.read_bytes()
        path.write_bytes(data[: int(len(data) * share)])

    return Edit(whole=whole)


def bytes_of(data: bytes) -> Edit:
    return Edit(whole=lambda path: path.write_bytes(data))


def patched(at: bytes, by: int, value: int) -> Edit:
    """A byte of the header set: the one `by` bytes behind where `at` begins."""

    def whole(path: Path) -> None:
        data = bytearray(path.read_bytes())
        data[data.index(at) + by] = value
        path.write_bytes(data)

    return Edit(whole=whole)


def inserted(at: int, data: bytes) -> Edit:
    """Bytes put into a file."""

    def whole(path: Path) -> None:
        old = path.read_bytes()
        path.write_bytes(old[:at] + data + old[at:])

    return Edit(whole=whole)


def named_bytes(attribute: str, value: bytes) -> Edit:
    """A text attribute of any bytes."""

    def whole(path: Path) -> None:
        mark = b"?" * len(value)
        Edit(header={attribute: mark.decode()}).apply(path)
        path.write_bytes(path.read_bytes().replace(mark, value, 1))

    return Edit(whole=whole)


def gone(path: Path) -> None:
    path.unlink()


def all_gone(path: Path) -> None:
    for file in path.parent.iterdir():
        file.unlink()


def layouts(file: str, channel: str) -> Iterator[Case]:
    """What can be wrong with any OpenEXR file."""
    for name in KEPT:
        yield f"compression {name}", file, compression(name), None
    for name in REFUSED:
        yield f"compression {name}", file, compression(name), "write it with ZIP"
    yield "rows from the last to the first", file, Edit(header={"lineOrder": OpenEXR.DECREASING_Y}), None
    yield "attributes of others", file, Edit(header={"owner": "x" * 5000, "hairlut.comment": "x"}), None
    yield "pixels that are not square", file, Edit(header={"pixelAspectRatio": 2.0}), None
    for name in INFORMATION:
        yield f"without {name}", file, Edit(drop=(name,)), None
        yield f"{name} of another kind", file, Edit(header={name: 3}), None
        yield f"{name} that says something else", file, Edit(header={name: "x  1,2"}), None
    error = "hairlut.error.relative_variance"
    yield "without an error", file, Edit(drop=(error,)), None
    yield "an error that is no number", file, Edit(header={error: "small"}), None
    tiles = {"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}
    yield "tiled", file, Edit(header=tiles), "expected scanlines"
    yield "two parts", file, Edit(whole=two_parts), "2 parts"
    for axis in (0, 1):
        yield f"data window {axis}", file, moved("dataWindow", axis), "dataWindow"
        yield f"display window {axis}", file, moved("displayWindow", axis), "displayWindow"
    yield "larger display window", file, Edit(header=larger_display), "displayWindow"
    yield "half", file, each(lambda c: c.astype(np.float16)), "32-bit float"
    yield "uint", file, each(lambda c: c.astype(np.uint32)), "32-bit float"
    yield "a channel more", file, Edit(channels=lambda c: c | {"A": c[channel]}), "channels"
    other = Edit(channels=lambda c: {"R" if n == channel else n: p for n, p in c.items()})
    yield "a channel renamed", file, other, "channels"
    name = channel.encode() + b"\0"
    even = "sampled 2" if file == THETA else ".exr"  # an odd width makes it no image at all
    yield "every second column alone", file, patched(name, len(name) + 8, 2), even
    yield "every second row alone", file, patched(name, len(name) + 12, 2), "sampled 1"
    magic = b"\x76\x2f\x31\x01"
    yield "flag of deep data", file, patched(magic, 5, 8), ".exr"
    yield "flag of tiles", file, patched(magic, 5, 2), ".exr"
    yield "another magic number", file, patched(magic, 0, 0), "OpenEXR image"
    for text in ("caf\u00e9", "\u20ac \u4e2d\uffff\ud7ff", "\U0001f600\U0010ffff\U00040000"):
        yield f"text {text!r}", file, Edit(header={"hairlut.parameters": text}), None
    for text in NO_TEXT:
        edit = named_bytes("hairlut.parameters", text)
        yield f"text that is not UTF-8: {text!r}", file, edit, "OpenEXR image"
    name = inserted(8, b"x\xff\0int\0\4\0\0\0\0\0\0\0")
    yield "a name that is not UTF-8", file, name, "OpenEXR image"
    yield "no compression", file, patched(b"compression\0", 10, ord("X")), ".exr"
    for text in (b"x" * 300 + b"\0int\0", b"x\0" + b"t" * 300 + b"\0", b"x\0int"):
        attribute = inserted(8, text + b"\4\0\0\0\0\0\0\0")
        yield f"an attribute {text[:4]!r} of {len(text)} bytes", file, attribute, ".exr"
    yield "another version", file, patched(magic, 4, 3), ".exr"
    fewer = Edit(channels=lambda c: {n: p for n, p in c.items() if n != channel} or {"A": c[channel]})
    yield "a channel less", file, fewer, "channels"
    for share in (0.0, 0.1, 0.5, 0.99):
        yield f"cut at {share}", file, cut(share), "OpenEXR image"
    yield "another kind of file", file, bytes_of(b"P6 4 4 255\n"), "OpenEXR image"


def attributes(file: str, names: tuple[str, ...]) -> Iterator[Case]:
    """Each missing, of another type, with another value."""
    for name in names:
        attribute = f"hairlut.{name}"
        yield f"without {name}", file, Edit(drop=(attribute,)), f"{attribute} is missing"
        other = "2" if name == "format" else 3
        yield f"{name} of another type", file, Edit(header={attribute: other}), attribute
        if name != "format":
            yield f"{name} empty", file, Edit(header={attribute: ""}), attribute
        if name not in ("format", "model"):
            yield f"{name} with a space behind", file, Edit(text={attribute: lambda x: x + " "}), attribute
            yield f"{name} with a space before", file, Edit(text={attribute: lambda x: " " + x}), attribute
            yield f"{name} with a line end", file, Edit(text={attribute: lambda x: x + "\n"}), attribute
    yield "a newer format", file, Edit(header={"hairlut.format": 3}), "hairlut.format is 3"
    yield "no format", file, Edit(header={"hairlut.format": 0}), "hairlut.format is 0"
    yield "degrees as unit", file, Edit(header={"hairlut.unit": "deg"}), "hairlut.unit is 'deg'"
    yield "a control character", file, Edit(header={"hairlut.unit": "rad\x7f"}), "hairlut.unit is"
    yield "a model with one", file, Edit(header={"hairlut.model": "fitted\x7f"}), "hairlut.model is"
    yield "a long model", file, Edit(header={"hairlut.model": "m" * 64}), "hairlut.model is 'mmm"
    yield "a model beyond ASCII", file, Edit(header={"hairlut.model": "caf\u00e9"}), "hairlut.model is"
    yield "renamed", file, Edit(header={"hairlut.table": "grey_theta"}), "hairlut.table is 'grey_theta'"


def separators(file: str, attribute: str) -> Iterator[Case]:
    """What may stand between numbers: one space."""
    for what, between in (("two spaces", "  "), ("a tab", "\t"), ("a comma", ","), ("a line end", "\n")):
        edit = Edit(text={attribute: lambda x, between=between: x.replace(" ", between, 1)})
        yield f"{what} in {attribute}", file, edit, attribute
    fewer = Edit(text={attribute: lambda x: x.rpartition(" ")[0]})
    yield f"a number less in {attribute}", file, fewer, attribute
    yield f"a number more in {attribute}", file, Edit(text={attribute: lambda x: f"{x} 9.0"}), attribute


def numbers() -> Iterator[Case]:
    """How numbers are written."""
    attribute = "hairlut.theta_r_range"
    for number in NUMBERS:
        edit = Edit(header={attribute: f"-1.5 {number}"})
        yield f"number {number}", THETA, edit, None
    yield "a number next to 0", THETA, Edit(header={attribute: "1e-500 1.5"}), None
    for number in NO_NUMBERS:
        for text in (f"{number} 1.5", f"-1.5 {number}"):
            yield f"no number: {text!r}", THETA, Edit(header={attribute: text}), attribute
    for knots in ("hairlut.knots", "hairlut.theta_r_range", "hairlut.domain"):
        yield from separators(THETA, knots)
    for axis in ("hairlut.axis.theta_r", "hairlut.axis.offset"):
        yield from separators(MIXTURE, axis)


def tables(format_2: bool) -> Iterator[Case]:
    """What a table's attributes and texels may be."""
    name = "hairlut.theta_r_range"
    for text in ("-90 90", "-5 5", "1.5 -1.5", "1 1", "0 1e-7", "-1.58 1.5"):
        yield f"{name} {text}", THETA, Edit(header={name: text}), name
    yield f"{name} a little more than pi/2", THETA, Edit(header={name: "-1.5708 1.5708"}), None
    for text in ("-90 90", "-1.6 1.6", "0 6.3"):
        yield f"domain {text}", THETA, Edit(header={"hairlut.domain": text}), "hairlut.domain"
    yield "domain of phi", PHI, Edit(header={"hairlut.domain": "0 360"}), "hairlut.domain"
    yield "not the whole domain", THETA, Edit(header={"hairlut.domain": "-1.5 1.5"}), "row 0 runs from"
    for text in NO_WARPS:
        yield f"warp {text!r}", THETA, Edit(header={"hairlut.warp": text}), "hairlut.warp"
    yield "another warp", THETA, Edit(header={"hairlut.warp": "octaves e=0.5"}), "hairlut.knots"
    yield "uniform warp", THETA, Edit(header={"hairlut.warp": "uniform"}), "hairlut.knots"
    for digits, said in ((12, None), (9, "hairlut.knots")):
        edit = Edit(text={"hairlut.knots": lambda x, n=digits: rounded(x, n)})
        yield f"knots of {digits} digits", THETA, edit, said
    for azimuth in ("sum", "difference"):
        yield f"azimuth {azimuth}", PHI, Edit(header={"hairlut.azimuth": azimuth}), None
    for azimuth in ("none", "wrapped", "Sum"):
        edit = Edit(header={"hairlut.azimuth": azimuth})
        yield f"azimuth {azimuth}", PHI, edit, f"hairlut.azimuth is '{azimuth}'"
    yield "azimuth of theta", THETA, Edit(header={"hairlut.azimuth": "sum"}), "hairlut.azimuth is 'sum'"
    yield "another angle", THETA, Edit(header={"hairlut.angle": "phi"}), "hairlut.angle is 'phi'"
    yield "swapped", THETA, Edit(whole=lambda p: shutil.copy(p.parent / MULTIPLE, p)), "hairlut.table is"
    fits = format_2
    for value in (np.nan, np.inf, -np.inf):
        yield f"an angle of {value}", THETA, put("Y", (3, 4), value, fits), "row 3, column"
    yield "not increasing", THETA, Edit(channels=lambda c: flat(c), digest=fits), "row 5, columns 6 and 7"
    yield "short of the domain", THETA, put("Y", (2, -1), 1.57079, fits), "row 2 runs from"
    yield "three columns", THETA, each(lambda c: c[:, :3], fits), "size"
    yield "one row", THETA, each(lambda c: c[:1], fits), "size"
    yield "too wide", THETA, each(lambda c: np.zeros((2, 4097), np.float32), fits), "4096"
    yield "too high", THETA, each(lambda c: np.zeros((4097, 4), np.float32), fits), "4096"
    yield "mirrored", THETA, each(lambda c: c[:, ::-1], fits), "row 0, columns 0 and 1"
    yield "missing", MULTIPLE, Edit(whole=gone), MULTIPLE
    yield "another model", MULTIPLE, Edit(header={"hairlut.model": "other"}), "hairlut.model is 'other'"


def rounded(text: str, digits: int) -> str:
    return " ".join(f"{float(word):.{digits}g}" for word in text.split())


def flat(channels: Channels) -> Channels:
    channels["Y"][5, 7] = channels["Y"][5, 6]
    return channels


def format_2() -> Iterator[Case]:
    """Slopes and digests."""
    cell = "hairlut.cell"
    yield "the old cell", THETA, Edit(header={cell: "parabola limit=0.9"}), cell
    for value in (0.0, -1.0, np.nan, np.inf, 1e13, 1e-10):
        yield f"a slope of {value}", THETA, put("dxdu", (3, 4), value), "row 3, column 4"
    for value in (1e-9, 1e12):
        yield f"a slope of {value}", THETA, put("dxdu", (3, 4), value), "direct_theta.exr"  # of another bake
    for file in (THETA, MIXTURE):
        yield "upside down", file, each(lambda c: c[::-1]), "hairlut.digest"
        yield "mirrored as an image", file, each(lambda c: c[:, ::-1]), "hairlut.digest"
        yield "without a digest", file, Edit(drop=("hairlut.digest",)), "hairlut.digest is missing"
        for text in (
            "",
            "crc32",
            "crc32 0123456",
            "crc32  01234567",
            "CRC32 01234567",
            "crc32 0123456G",
            "crc32 0123456g",
            "crc32 0123456!",
            "01234567",
        ):
            yield f"digest {text!r}", file, Edit(header={"hairlut.digest": text}), "hairlut.digest"
        upper = Edit(text={"hairlut.digest": lambda x: x.upper()})
        yield "digest in capitals", file, upper, "hairlut.digest"
    yield "one texel changed", THETA, put("Y", (3, 4), 0.1, digest=False), "hairlut.digest"
    yield "a table of another bake", THETA, put("dxdu", (3, 4), 0.5), "digest"
    yield "without a mixture", MIXTURE, Edit(whole=gone), "hairlut.format is 2"
    yield "a table of format 1", THETA, old_table(), "hairlut.format is 1"
    yield "an empty directory", MIXTURE, Edit(whole=all_gone), MIXTURE


def old_table() -> Edit:
    return Edit(
        header={"hairlut.format": 1, "hairlut.cell": "linear"},
        drop=("hairlut.digest",),
        channels=lambda channels: {"Y": channels["Y"]},
    )


def format_1() -> Iterator[Case]:
    """Cells of the past."""
    cell = "hairlut.cell"
    for text in ("linear", "parabola limit=0", "parabola limit=0.95"):
        yield f"cell {text}", THETA, Edit(header={cell: text}), None
    for text in (
        "cubic",
        "parabola",
        "parabola limit=0.96",
        "parabola limit=-0.1",
        "parabola limit=x",
        "linear limit=0",
    ):
        yield f"cell {text}", THETA, Edit(header={cell: text}), cell
    yield "a digest", THETA, Edit(header={"hairlut.digest": "crc32 00000000"}), None
    for value in (1e30, -1e30, -1.6):
        yield f"a second angle of {value}", THETA, put("Y", (0, 1), value, digest=False), "row 0, columns"
    yield "slopes", THETA, Edit(channels=lambda c: c | {"dxdu": c["Y"]}), "channels"
    yield "format 2", THETA, Edit(header={"hairlut.format": 2}), "hairlut.format is 2"
    yield "an empty directory", THETA, Edit(whole=all_gone), MIXTURE


def mixtures() -> Iterator[Case]:
    """What mixture.exr may say."""
    share, turn = "direct.share", "multiple.turn"
    yield "shares in another unit", MIXTURE, Edit(channels=scaled_shares, digest=True), None
    yield "a share of 0", MIXTURE, put(share, (1, 2), 0.0), None
    yield "a large turn", MIXTURE, put(turn, (1, 2), 25.0), None
    for value in (-1.0, -1e-30, np.nan, np.inf):
        yield f"a share of {value}", MIXTURE, put(share, (1, 2), value), "share"
    for value in (25.2, -1e9, np.nan, np.inf):
        yield f"a turn of {value}", MIXTURE, put(turn, (1, 2), value), "turn"
    yield "no share at a node", MIXTURE, Edit(channels=no_share, digest=True), "share"
    yield "another lobe's tables", MIXTURE, Edit(header={"hairlut.lobe.grey": "?"}), None
    for text in ("direct", "direct multiple grey", "direct a_1"):
        yield f"lobes {text!r}", MIXTURE, Edit(header={"hairlut.lobes": text}), "channels"
    for text in NO_LOBES:
        yield f"lobes {text!r}", MIXTURE, Edit(header={"hairlut.lobes": text}), "hairlut.lobes is"
    lobe = "hairlut.lobe.multiple"
    for text in NO_TABLES:
        yield f"lobe {text!r}", MIXTURE, Edit(header={lobe: text}), lobe
    three = Edit(text={lobe: lambda x: f"{x} direct_phi 01234567 direct_phi 01234567"})
    yield "lobe of three tables", MIXTURE, three, lobe
    again = Edit(header={lobe: "direct_theta 01234567"})
    phi = Edit(text={lobe: lambda x: f"{x} direct_phi 01234567"})
    yield "one azimuth table with two digests", MIXTURE, phi, lobe
    yield "one table with two digests", MIXTURE, again, lobe
    absent = Edit(header={lobe: "absent_theta 01234567"})
    yield "a table that is not there", MIXTURE, absent, "absent_theta.exr"
    other = Edit(header={lobe: "multiple_theta 01234567"})
    yield "a digest of another bake", MIXTURE, other, "multiple_theta.exr"
    yield "lobes that share a table", MIXTURE, Edit(header=shared_table), None
    for text in ("offset theta_r", "theta_r", "theta_r offset roughness", "theta_r  offset"):
        yield f"axes {text!r}", MIXTURE, Edit(header={"hairlut.axes": text}), "hairlut.axes"
    name = "hairlut.axis.theta_r"
    for text in ("1.5 0.25 0 -1.5", "-1.5 0 0 1.5", "-90 0 10 90", "-1.58 0 0.25 1.5", "-1.5 0 0.25 nan",
                 "-1.5 1 1.00000001 1.5"):  # fmt: skip
        yield f"{name} {text}", MIXTURE, Edit(header={name: text}), name
    name = "hairlut.axis.offset"
    for text in ("0 0.5 1.1", "-0.5 0.5 1", "1 0.5 0", "0 0.5 0.5"):
        yield f"{name} {text}", MIXTURE, Edit(header={name: text}), name
    both_sides = {"hairlut.axis.offset": "-1 0 1", "hairlut.mirrored": "0"}
    yield "offsets of both signs", MIXTURE, Edit(header=both_sides), None
    for text in ("2", "true", "00"):
        yield f"mirrored {text}", MIXTURE, Edit(header={"hairlut.mirrored": text}), "hairlut.mirrored"
    yield "another model", MIXTURE, Edit(header={"hairlut.model": "other"}), "direct_theta.exr"
    yield "format 1", MIXTURE, Edit(header={"hairlut.format": 1}), "hairlut.format is 1"
    yield "a row less", MIXTURE, each(lambda c: c[:-1], digest=True), "hairlut.axis.theta_r"
    yield "a column more", MIXTURE, each(lambda c: np.hstack([c, c]), digest=True), "hairlut.axis.offset"
    yield "too wide", MIXTURE, each(lambda c: np.ones((4, 4097), np.float32), digest=True), "4096"
    yield "too many nodes", MIXTURE, each(lambda c: np.ones((513, 512), np.float32), digest=True), "size"
    yield "one node", MIXTURE, one_node(), None


def parameters() -> Iterator[Case]:
    """What files of a model over parameters say of them. The mixture depends on beta_m and absorption, not on
    tilt; direct_theta on beta_m, direct_phi on tilt and absorption."""
    yield from attributes(MIXTURE, OF_PARAMETERS)
    yield from attributes(THETA, ("axis.beta_m",))
    for name in ("axis.beta_m", "axis.absorption", "parameter.beta_m", "parameter.tilt"):
        yield from separators(MIXTURE, f"hairlut.{name}")
    for name, _, edit, _ in separators(THETA, "hairlut.axis.beta_m"):
        yield name, THETA, edit, THETA
    axes = "hairlut.axes"
    for text in NO_MIXTURE_AXES:
        yield f"axes of a mixture {text!r}", MIXTURE, Edit(header={axes: text}), axes
    more = "beta_m absorption tilt gloss theta_r offset"
    yield "a name more", MIXTURE, Edit(header={axes: more}), "hairlut.parameter.gloss is missing"
    for text in NO_TABLE_AXES:
        yield f"axes of a table {text!r}", THETA, Edit(header={axes: text}), axes
    yield "an unknown name in a table", THETA, Edit(header={axes: "beta_m gloss theta_r"}), "gloss"
    yield "a table without axes", THETA, Edit(drop=(axes,)), axes
    plain = Edit(
        drop=(axes, "hairlut.axis.beta_m"), channels=lambda c: {n: p[:5] for n, p in c.items()}, digest=True
    )
    yield "a table with other texels", THETA, plain, THETA
    yield "axes that are theta_r", MULTIPLE, Edit(header={axes: "theta_r"}), None
    yield (
        "an axis that nothing names",
        MULTIPLE,
        Edit(header={"hairlut.axis.beta_m": "0.1 0.9"}),
        "hairlut.axes",
    )
    yield "another axis", THETA, Edit(header={"hairlut.axis.tilt": "-4 4"}), "hairlut.axes"
    yield "an axis of no parameter", MIXTURE, Edit(header={"hairlut.axis.gloss": "0 1"}), "hairlut.axes"
    yield (
        "a parameter without axes",
        MIXTURE,
        Edit(header={"hairlut.parameter.gloss": "0 1 0"}),
        "hairlut.axes",
    )
    yield "information on parameters", MIXTURE, Edit(header={"hairlut.parameters": "tilt"}), None
    for name, nodes, of_range in PARAMETER_NUMBERS:
        attribute = f"hairlut.{name}"
        yield f"{name} {nodes}", MIXTURE, Edit(header={attribute: nodes} | of_range), attribute
    for nodes in NO_NODES:
        yield (
            f"nodes of a mixture {nodes}",
            MIXTURE,
            Edit(header={"hairlut.axis.beta_m": nodes}),
            "hairlut.axis.beta_m",
        )
        yield f"nodes of a table {nodes}", THETA, Edit(header={"hairlut.axis.beta_m": nodes}), "beta_m"
    yield (
        "the standard value of a table",
        THETA,
        Edit(header={"hairlut.axis.beta_m": "0.3"}),
        "hairlut.axis.beta_m",
    )
    yield "another range", MIXTURE, Edit(header=wider), THETA
    same_floats = {"hairlut.axis.beta_m": "0.1000000000001 0.25 0.9"}
    yield "nodes that are the ends as floats", THETA, Edit(header=same_floats), None
    yield "another standard value", MIXTURE, Edit(header={"hairlut.parameter.beta_m": "0.1 0.9 0.1"}), None
    for file, rows in ((MIXTURE, 47), (THETA, 14)):
        fewer = each(lambda c, rows=rows: c[:rows], digest=True)
        yield f"{file} with {rows} rows", file, fewer, "rows"
    short = each(lambda c: c[:36], digest=True)
    yield "three rows of theta_r a node", MIXTURE, short, "hairlut.axis.theta_r"
    yield "one row of theta_r a node", THETA, each(lambda c: c[:3], digest=True), "size"
    yield "two nodes fewer", THETA, Edit(header={"hairlut.axis.beta_m": "0.1 0.9"}), "rows"
    many = np.zeros((12291, 4), np.float32)
    yield "4097 rows of theta_r a node", THETA, each(lambda c: many, digest=True), "4096"
    yield "65537 rows", THETA, each(lambda c: np.zeros((65537, 4), np.float32)), "65536"
    yield "too many texels", THETA, each(lambda c: np.zeros((8193, 2049), np.float32)), "16777216"
    yield (
        "too many nodes with parameters",
        MIXTURE,
        each(lambda c: np.ones((48 * 43, 128), np.float32)),
        "size",
    )
    yield "five axes of a mixture", MIXTURE, Edit(header=five), "hairlut.axes"
    yield "no share at a node", MIXTURE, Edit(channels=no_share_at_a_node, digest=True), MIXTURE
    yield "rows turned over", MIXTURE, each(lambda c: c[::-1]), "hairlut.digest"
    yield "without a mixture", MIXTURE, Edit(whole=gone), "hairlut.format is 2"


def wider(header: dict) -> dict:
    """A range that a table's nodes do not span."""
    return {"hairlut.parameter.beta_m": "0.1 1.0 0.3", "hairlut.axis.beta_m": "0.1 0.25 1.0"}


def five(header: dict) -> dict:
    """A mixture over five parameters."""
    names = [f"p{k}" for k in range(5)]
    return {
        "hairlut.axes": " ".join([*header["hairlut.axes"].split()[:3], *names, "theta_r offset"]),
        **{f"hairlut.parameter.{name}": "0 1 0" for name in names},
        **{f"hairlut.axis.{name}": "0 1" for name in names},
    }


def no_share_at_a_node(channels: Channels) -> Channels:
    for name in ("direct.share", "multiple.share"):
        channels[name][-1, -1] = 0
    return channels


def scaled_shares(channels: Channels) -> Channels:
    return {n: c * np.float32(1024) if n.endswith("share") else c for n, c in channels.items()}


def no_share(channels: Channels) -> Channels:
    for name in ("direct.share", "multiple.share"):
        channels[name][1, 2] = 0
    return channels


def shared_table(header: dict) -> dict:
    theta = " ".join(header["hairlut.lobe.direct"].split()[:2])
    return {"hairlut.lobe.multiple": theta}


def one_node() -> Edit:
    return Edit(
        header={"hairlut.axis.theta_r": "0.0", "hairlut.axis.offset": "0.0"},
        channels=lambda channels: {n: c[:1, :1] for n, c in channels.items()},
        digest=True,
    )


def of_format_2() -> list[Case]:
    """Every case of a directory of format 2."""
    return [
        *layouts(THETA, "dxdu"), *layouts(MIXTURE, "direct.turn"),
        *attributes(THETA, COMMON + OF_TABLE), *attributes(MIXTURE, COMMON + OF_MIXTURE),
        *numbers(), *tables(format_2=True), *format_2(), *mixtures(),
    ]  # fmt: skip


def of_parameters() -> list[Case]:
    """Every case of a directory of a model over parameters."""
    return list(parameters())


def of_format_1() -> list[Case]:
    """Every case of a directory of format 1."""
    return [
        *layouts(THETA, "Y"), *attributes(THETA, COMMON + OF_TABLE), *tables(format_2=False), *format_1(),
    ]  # fmt: skip

# SPDX-License-Identifier: BSD-3-Clause
"""hairlut inspect: prints a file's header."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from .. import exr, mixturefile
from ..axes import Axis
from ..table import Table
from . import OK, add_command

EXAMPLES = """examples:
  hairlut inspect luts/fitted/direct_theta.exr
  hairlut inspect luts/brown/mixture.exr
  hairlut inspect luts/fitted/*.exr --json | jq '.[].errors'"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = add_command(
        subparsers,
        "inspect",
        help="print what a texture's header says",
        description="Prints a texture's header and measured errors: of a table, for each row the mass of the "
        "lobe inside its domain and the width of the narrowest cell; of mixture.exr, each lobe's tables and "
        "the range of its shares and turns.",
        epilog=EXAMPLES,
    )
    parser.add_argument("file", type=Path, nargs="+", help="a table or mixture.exr")
    parser.add_argument("--json", action="store_true", help="print JSON, one array of files")
    return parser


def run(args: argparse.Namespace) -> int:
    reports = [
        describe_mixture(path, mixturefile.read(path))
        if path.name == mixturefile.FILE
        else describe(path, *exr.read(path))
        for path in args.file
    ]
    if args.json:
        print(json.dumps(reports, indent=1))
        return OK
    print("\n\n".join(_mixture_text(r) if "lobes" in r else _text(r) for r in reports))
    return OK


def describe_mixture(path: Path, file: mixturefile.MixtureFile) -> dict:
    """A mixture as plain data; share and turn: nested lists over the axes, theta_r and the offset."""
    mixture = file.mixture
    return {
        "file": str(path),
        "model": file.model,
        "parameters": [asdict(parameter) for parameter in file.parameters],
        "axes": _nodes(mixture.axes),
        "theta_r": mixture.theta_r.tolist(),
        "offset": mixture.offset.tolist(),
        "mirrored": mixture.mirrored,
        "errors": file.errors,
        "lobes": [
            {"name": name, "tables": [table for table in file.tables[name] if table]}
            | {"share": mixture.share[k].tolist(), "turn": mixture.turn[k].tolist()}
            for k, name in enumerate(mixture.lobes)
        ],
    }


def _nodes(axes: tuple[Axis, ...]) -> dict[str, list[float]]:
    """Nodes of parameters of the hair, by name."""
    return {axis.name: axis.nodes.tolist() for axis in axes}


def _mixture_text(report: dict) -> str:
    rows, columns = len(report["theta_r"]), len(report["offset"])
    lines = [f"{report['file']}: model {report['model']}, {_count(len(report['lobes']), 'lobe')}"]
    for parameter in report["parameters"]:
        name, nodes = parameter["name"], len(report["axes"].get(parameter["name"], []))
        here = _count(nodes, "node") if nodes else "no axis"
        least, most, standard = (f"{parameter[key]:.6g}" for key in ("least", "most", "standard"))
        lines.append(f"  {name:12}from {least} to {most}, standard {standard}; {here} here")
    lines += [
        f"  {name:12}{len(values)} from {values[0]:.6g} to {values[-1]:.6g}"
        for name, values in (("theta_r", report["theta_r"]), ("offset", report["offset"]))
    ]
    lines += [f"  {'mirrored':12}{'yes' if report['mirrored'] else 'no'}"]
    lines += [f"  error.{name:18} {value:.3e}" for name, value in report["errors"].items()]
    over = "".join(f"{len(nodes)} {name}, " for name, nodes in report["axes"].items())
    lines += ["", f"  over {over}{rows} theta_r and {_count(columns, 'offset')}: share, turn [deg], tables"]
    for lobe in report["lobes"]:
        share, turn = np.array(lobe["share"]), np.degrees(lobe["turn"])
        ranges = f"{share.min():.3f} to {share.max():.3f}  {turn.min():9.2f} to {turn.max():.2f}"
        lines.append(f"  {lobe['name']:12}{ranges}  {', '.join(lobe['tables'])}")
    return "\n".join(lines)


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'s' * (number != 1)}"


def describe(path: Path, table: Table, errors: dict[str, float]) -> dict:
    """A file as plain data."""
    widths = np.diff(table.texels.astype(float), axis=1).min(axis=1)
    theta_r = np.tile(table.theta_r, len(widths) // table.height).tolist()
    rows = zip(theta_r, table.log_mass.tolist(), widths.tolist(), strict=True)
    return {
        "file": str(path),
        "width": table.width,
        "height": table.height,
        "axes": _nodes(table.axes),
        "bytes_of_texels": table.nbytes,
        "bytes_of_file": path.stat().st_size,
        "header": exr.attributes(table),
        "errors": errors,
        "rows": [
            {"theta_r": theta, "log_mass": log_mass, "mass": float(np.exp(log_mass)), "narrowest_cell": width}
            for theta, log_mass, width in rows
        ],
    }


LONG = ("hairlut.knots", "hairlut.log_mass")


def _text(report: dict) -> str:
    nodes = " x ".join(f"{len(each)} {name}" for name, each in report["axes"].items())
    size = f"{report['width']}x{report['height']} texels" + f" for each of {nodes}" * bool(nodes)
    lines = [
        f"{report['file']}: {size}, {report['bytes_of_texels']} bytes ({report['bytes_of_file']} in the file)"
    ]
    lines += [f"  {name:24}{value}" for name, value in report["header"].items() if name not in LONG]
    lines += [f"  error.{name:18} {value:.3e}" for name, value in report["errors"].items()]
    if not report["errors"]:
        lines += ["  errors                  not measured"]
    lines += [
        "",
        f"  {'row':>5}  {'theta_r [deg]':>13}  {'mass in domain':>14}  {'narrowest cell [rad]':>20}",
    ]
    for j, row in enumerate(report["rows"]):
        mass = f"{row['mass']:.6e}" if row["mass"] else f"e^{row['log_mass']:.1f}"
        lines.append(
            f"  {j:5}  {np.degrees(row['theta_r']):13.4f}  {mass:>14}  {row['narrowest_cell']:20.3e}"
        )
    return "\n".join(lines)

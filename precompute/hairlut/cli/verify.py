# SPDX-License-Identifier: BSD-3-Clause
"""hairlut verify: every table measured again from its file alone."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from ..verify import Report, verify
from . import CHECK_FAILED, OK, add_command

EXAMPLES = """examples:
  hairlut verify luts
  hairlut verify luts/fitted/direct_phi.exr --json
exit code: 0 if every file is good, 1 if one is not"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = add_command(
        subparsers,
        "verify",
        help="measure every table again from its file alone",
        description="Of tables that were baked from formulas: computes each lobe again, compares every texel "
        "with its quantile, measures the table's errors, and compares them with those in its header. Fitted "
        "tables have no formula: their form and their digest are checked. The files of a model must belong "
        "together.",
        epilog=EXAMPLES,
    )
    parser.add_argument("path", type=Path, nargs="+", help="a file, or a directory with .exr files below it")
    parser.add_argument("--model", metavar="FILE", help="the model file that the tables were baked from")
    parser.add_argument("--json", action="store_true", help="print JSON, one array of files")
    return parser


def run(args: argparse.Namespace) -> int:
    from ..modelfile import find

    model = find(args.model) if args.model else None
    reports = [report for path in args.path for report in verify(path, model)]
    if args.json:
        print(json.dumps([_plain(report) for report in reports], indent=1))
    else:
        print("\n".join(_text(report) for report in reports))
    return OK if all(report.ok for report in reports) else CHECK_FAILED


def _plain(report: Report) -> dict:
    return {"ok": report.ok} | asdict(report) | {"path": str(report.path)}


def _text(report: Report) -> str:
    errors = report.measured
    numbers = f"  {report.size}" * bool(report.size)
    numbers += (
        f", V {errors['relative_variance']:.2e}, weight {errors['largest_weight']:.2f}, "
        f"quantile error {errors['quantile_inner']:.1e} rad"
        if errors
        else ""
    )
    numbers += f" ({report.note})" * bool(report.note)
    head = f"{'ok    ' if report.ok else 'FAILED'} {report.path}{numbers}"
    return "\n".join([head, *(f"       {problem}" for problem in report.problems)])

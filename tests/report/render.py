# SPDX-License-Identifier: BSD-3-Clause
"""Renders the hair scene with every sampler; writes the page that compares them, pages/render.md.

PYTHONPATH=tests .venv/bin/python -m report.render
"""

from __future__ import annotations

import argparse
import sys

import numpy as np

from report.engine import DEFAULT_BUILD, PluginBroken, PluginUnavailable, load_engine
from report.hairscene.batches import BATCH, Quality, render_all
from report.places import PAGES

RESULTS = DEFAULT_BUILD / "render.npz"


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="80x60", help="WxH in pixels (default %(default)s)")
    parser.add_argument("--spp", type=int, default=512, help="per sampler, in all its batches: 512 or more")
    parser.add_argument(
        "--reference-spp", type=int, default=1024, help="of the reference (default %(default)s)"
    )
    parser.add_argument("--strands", type=int, default=12_000, help="default %(default)s")
    parser.add_argument("--page-only", action="store_true", help="write the page again from the last renders")
    arguments = parser.parse_args()
    if arguments.spp < 512:
        parser.error("--spp: expected 512 or more, two images of 256 samples per pixel")
    return arguments


def quality_of(arguments: argparse.Namespace) -> Quality:
    width, height = (int(side) for side in arguments.size.split("x"))
    return Quality(width, height, arguments.spp // BATCH, arguments.reference_spp // BATCH, arguments.strands)


def save(images: dict[str, np.ndarray], seconds: dict[str, float]) -> None:
    np.savez(RESULTS, **images, **{f"seconds/{key}": np.array(value) for key, value in seconds.items()})


def load() -> tuple[dict[str, np.ndarray], dict[str, float]]:
    with np.load(RESULTS) as file:
        images = {key: file[key] for key in file.files if not key.startswith("seconds/")}
        seconds = {key.removeprefix("seconds/"): float(file[key]) for key in file.files if key not in images}
    return images, seconds


def main() -> int:
    arguments = parse()
    try:
        mi = load_engine()
    except PluginUnavailable as error:
        print(f"SKIPPED: nothing is rendered. {error}", file=sys.stderr)
        return 0
    except PluginBroken as error:
        print(error, file=sys.stderr)
        return 1
    if not arguments.page_only:
        save(*render_all(mi, quality_of(arguments), DEFAULT_BUILD))
    from report.hairscene.page import write_page

    print(write_page(mi, *load(), DEFAULT_BUILD / "strands.txt", PAGES))
    return 0


if __name__ == "__main__":
    sys.exit(main())

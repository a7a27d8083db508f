# SPDX-License-Identifier: BSD-3-Clause
"""Prints where the wheels mitsuba;drjit;nanobind lie that the plugin is built against, or what is missing."""

import importlib.metadata
import importlib.util
import sys

OLDEST = (3, 9)  # the plugin interface of earlier engines differs


def main() -> int:
    specs = [importlib.util.find_spec(name) for name in ("mitsuba", "drjit", "nanobind")]
    if None in specs:
        print(f"Its wheels are missing: {sys.executable} -m pip install mitsuba nanobind", file=sys.stderr)
        return 1
    version = importlib.metadata.version("mitsuba")
    if tuple(int(part) for part in version.split(".")[:2]) < OLDEST:
        print(
            f"Mitsuba {version} is older than 3.9: {sys.executable} -m pip install -U mitsuba",
            file=sys.stderr,
        )
        return 1
    print(";".join(spec.submodule_search_locations[0] for spec in specs))
    return 0


if __name__ == "__main__":
    sys.exit(main())

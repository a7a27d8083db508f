# SPDX-License-Identifier: BSD-3-Clause
"""The engine with the plugin: builds it where its wheel allows, and makes it known to Mitsuba."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

PLUGIN_SOURCE = Path(__file__).resolve().parent
DEFAULT_BUILD = PLUGIN_SOURCE.parents[1] / "build" / "mitsuba"


class PluginUnavailable(RuntimeError):
    """A package is missing without which nothing can be built; the message says what brings it."""


class PluginBroken(RuntimeError):
    """Everything is there, but the plugin does not build; the message has what the compiler said."""


def _run(command: list[str]) -> None:
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise PluginBroken(f"{' '.join(command)} failed:\n{result.stdout}{result.stderr}")


def _check_wheels() -> None:
    wheels = [sys.executable, str(PLUGIN_SOURCE / "wheels.py")]
    result = subprocess.run(wheels, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise PluginUnavailable(result.stderr.strip())


def _cmake() -> str:
    beside = Path(sys.executable).with_name("cmake")
    found = str(beside) if beside.exists() else shutil.which("cmake")
    if found is None:
        raise PluginUnavailable(f"cmake is missing: {sys.executable} -m pip install cmake")
    return found


def build_plugin(build: Path = DEFAULT_BUILD) -> Path:
    """Builds what is out of date; returns the folder to append to the engine's file resolver.

    PluginUnavailable if a package is missing, PluginBroken if the sources do not build.
    """
    _check_wheels()
    cmake = _cmake()
    _run([cmake, "-S", str(PLUGIN_SOURCE), "-B", str(build), f"-DPython_EXECUTABLE={sys.executable}"])
    _run([cmake, "--build", str(build), "--parallel", "2"])
    return build


def load_engine(build: Path = DEFAULT_BUILD) -> Any:
    """The module mitsuba in variant scalar_rgb, which knows the BSDF `hairlut`; raises as build_plugin."""
    folder = build_plugin(build)
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    mitsuba.set_log_level(mitsuba.LogLevel.Warn)
    mitsuba.file_resolver().append(str(folder))
    return mitsuba


def main() -> int:
    """Prints the folder that holds plugins/, or says on stderr why there is none; 1 if it does not build."""
    try:
        print(build_plugin())
    except PluginUnavailable as error:
        print(f"SKIPPED: the Mitsuba plugin is not built. {error}", file=sys.stderr)
    except PluginBroken as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

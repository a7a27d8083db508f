# SPDX-License-Identifier: BSD-3-Clause
"""Packages that only some commands need."""

import importlib.util

from .errors import HairlutError


def needed_for_plots() -> None:
    """HairlutError with the command that installs matplotlib, if it is missing."""
    if importlib.util.find_spec("matplotlib") is None:
        raise HairlutError("matplotlib is not installed: .venv/bin/pip install 'precompute[report]'")

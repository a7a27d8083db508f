# SPDX-License-Identifier: BSD-3-Clause
"""The fixtures of the shipped tables."""

from precompute.conftest import shipped

__all__ = ["shipped"]

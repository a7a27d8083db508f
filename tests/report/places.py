# SPDX-License-Identifier: BSD-3-Clause
"""Paths of what the report reads, and of its pages."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = ROOT / "tests" / "report" / "pages"

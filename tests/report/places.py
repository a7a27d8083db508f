# SPDX-License-Identifier: BSD-3-Clause
"""Where the report finds things, and where its pages go."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = ROOT / "tests" / "report" / "pages"

# SPDX-License-Identifier: BSD-3-Clause
"""runtime/README.md and SECURITY.md speak of what there is."""

import re
from pathlib import Path

import pytest
from runtime.c_library import ROOT, RUNTIME

PAGES = [RUNTIME / "README.md", ROOT / "SECURITY.md"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_and_files_exist(page):
    text = page.read_text()
    for link in re.findall(r"\]\(([^)#]+)\)", text):
        assert (page.parent / link).exists(), link
    for path in re.findall(r"`((?:tests|runtime)/[\w/.]+)`", text):
        assert (ROOT / path).exists(), path


def test_options_and_targets_exist():
    text = PAGES[0].read_text()
    build = "".join(p.read_text() for p in [RUNTIME / "CMakeLists.txt", *Path(RUNTIME / "cmake").iterdir()])
    for option in set(re.findall(r"`(HAIRLUT_[A-Z_]+|BUILD_SHARED_LIBS)`", text)):
        assert option in build, option
    for module in re.findall(r"^\| pkg-config \| `(\w+)` \| `(\w+)` \|", text, re.MULTILINE)[0]:
        assert (RUNTIME / "cmake" / f"{module}.pc.in").is_file()

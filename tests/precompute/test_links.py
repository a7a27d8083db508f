# SPDX-License-Identifier: BSD-3-Clause
"""Every relative link of every Markdown page leads to a file, and to a heading where it names one."""

import re
import subprocess
from pathlib import Path

import pytest

from precompute.conftest import ROOT

LINK = re.compile(r"\]\(([^)\s]+)\)")
TEMPLATE = re.compile(r"tests/report/(?!pages/)")
CODE = re.compile(r"```.*?```|`[^`\n]*`", re.DOTALL)


def pages() -> list[Path]:
    """The Markdown files of the repository, without those that git ignores and the report's templates."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=ROOT, text=True,
                            capture_output=True, check=False)  # fmt: skip
    if listed.returncode != 0:
        pytest.skip("not a git checkout")
    names = [name for name in listed.stdout.splitlines() if not TEMPLATE.match(name)]
    return [path for path in map(ROOT.joinpath, sorted(names)) if path.exists()]


def anchors(text: str) -> set[str]:
    """The names of a page's headings in links, as GitHub makes them."""
    headings = re.findall(r"^#+ +(.+)$", CODE.sub("", text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in headings}


def broken(page: Path) -> list[str]:
    """The links of a page that lead nowhere."""
    wrong = []
    for link in LINK.findall(CODE.sub("", page.read_text())):
        if re.match(r"[a-z]+:", link):
            continue
        name, _, heading = link.partition("#")
        target = page.parent / name if name else page
        if not target.exists() or (heading and heading not in anchors(target.read_text())):
            wrong.append(f"{page}: {link}")
    return wrong


def test_relative_links_resolve():
    assert [link for page in pages() for link in broken(page)] == []


def test_a_broken_link_is_noticed(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(
        "# A heading, long\n[a](page.md) [b](#a-heading-long) [c](gone.md) [d](#gone) [e](https://x.org)\n"
    )
    assert broken(page) == [f"{page}: gone.md", f"{page}: #gone"]

# SPDX-License-Identifier: BSD-3-Clause
"""The API page is what the docstrings say today."""

from report import api


def test_page_is_made_from_todays_docstrings() -> None:
    assert api.PAGE.read_text() == api.page(), "run: PYTHONPATH=tests .venv/bin/python -m report.api"


def test_every_public_name_is_on_the_page() -> None:
    text = api.PAGE.read_text()
    for heading in (
        "### class Model",
        "#### Model.sample(",
        "#### Model.invert(",
        "#### Model.lobes",
        "### load(",
    ):
        assert heading in text

# SPDX-License-Identifier: BSD-3-Clause
"""Writes precompute/API.md, the page of the Python API, from its docstrings.

PYTHONPATH=tests .venv/bin/python -m report.api
"""

import inspect
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import hairlut
from hairlut import modelfile, sampler
from report.places import ROOT

PAGE = ROOT / "precompute" / "API.md"
HEAD = """\
# Python API

Made from the docstrings by `python -m report.api`; a test runs their examples. What is not on this page is
not public.
"""
MODEL_FILES = "gaussian", "density", "tabulated"


def page() -> str:
    """The page as text."""
    parts = [HEAD, "## hairlut\n", _text(hairlut), _text(sampler)]
    for name in sampler.__all__:
        parts += _documented(getattr(sampler, name), name)
    parts += ["### HairlutError\n", _text(hairlut.HairlutError), "## hairlut.modelfile\n", _text(modelfile)]
    for name in MODEL_FILES:
        parts += _documented(getattr(modelfile, name), name)
    return "\n".join(parts)


def _documented(item: object, name: str) -> Iterator[str]:
    """Heading and docstring of a function, or of a class and its public members."""
    if not inspect.isclass(item):
        yield f"### {name}{_signature(item)}\n"
        yield _text(item)
        return
    yield f"### class {name}\n"
    yield _text(item)
    for member, value in vars(item).items():
        if member.startswith("_") or not (isinstance(value, property) or inspect.isfunction(value)):
            continue
        call = "" if isinstance(value, property) else _signature(value)
        yield f"#### {name}.{member}{call}\n"
        yield _text(value)


def _signature(item: object) -> str:
    """Names and defaults of the arguments."""
    parameters = inspect.signature(item).parameters.values()
    bare = [p.replace(annotation=inspect.Parameter.empty) for p in parameters if p.name != "self"]
    return str(inspect.Signature(bare))


def _text(item: ModuleType | object) -> str:
    """The docstring, preformatted: its tables and examples stay as they are in the source."""
    return f"```text\n{inspect.getdoc(item)}\n```\n"


def main() -> int:
    Path(PAGE).write_text(page())
    print(PAGE.relative_to(ROOT))
    return 0


if __name__ == "__main__":
    sys.exit(main())

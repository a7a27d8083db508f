# SPDX-License-Identifier: BSD-3-Clause
"""The null device in place of one of the process's own streams, for code that works below Python's."""

import os
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def null_device(descriptor: int) -> Iterator[None]:
    """Within the context, reads of the file descriptor return nothing and writes to it are discarded."""
    try:
        kept = os.dup(descriptor)
    except OSError:  # it is closed
        yield
        return
    null = os.open(os.devnull, os.O_RDWR)
    try:
        os.dup2(null, descriptor)
        yield
    finally:
        os.dup2(kept, descriptor)
        os.close(null)
        os.close(kept)

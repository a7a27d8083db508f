# SPDX-License-Identifier: BSD-3-Clause
"""The error that a user can do something about."""


class HairlutError(Exception):
    """A wrong input. The message names the file or argument, what is wrong, what was expected, the remedy."""

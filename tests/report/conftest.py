"""The fixtures of the shipped tables."""

from precompute.conftest import shipped

__all__ = ["shipped"]

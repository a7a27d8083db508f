"""The curve inside a cell of a table (interpolant.py has its equations)."""

from dataclasses import dataclass

from . import parameter
from .errors import HairlutError

MAX_LIMIT = 0.95


@dataclass(frozen=True)
class Cell:
    """name: "parabola" or "linear"; limit: bound of the curvature, relative to the width; 0 for linear."""

    name: str
    limit: float = 0.0

    def __post_init__(self) -> None:
        if self.name == "linear" and self.limit == 0.0:
            return
        if self.name != "parabola":
            raise HairlutError(f"cell {self} is not known: expected 'parabola limit=NUMBER' or 'linear'")
        if not 0.0 < self.limit <= MAX_LIMIT:
            raise HairlutError(f"cell {self}: expected a limit above 0, up to {MAX_LIMIT}")

    def __str__(self) -> str:
        return f"{self.name} limit={self.limit!r}" if self.name == "parabola" else self.name

    @classmethod
    def parse(cls, text: str) -> "Cell":
        """From "linear" or "parabola limit=NUMBER", as in a file's header."""
        return cls(*parameter.parse(text, "cell", "limit", "'parabola limit=NUMBER' or 'linear'"))

"""Files that appear whole or not at all."""

import os
from pathlib import Path

from .errors import HairlutError


def write_whole(path: Path, data: bytes) -> Path:
    """Writes data to path in one step, with the folders it lies in; HairlutError if that cannot be done."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            temporary.write_bytes(data)
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise HairlutError(f"{path}: cannot be written: {error.strerror}") from error
    return path

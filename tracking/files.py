"""Writing of whole files."""

import os
from pathlib import Path

from cubeling.tracking.errors import TrackingError


def write_whole(path: str | Path, content: bytes, what: str) -> None:
    """Write a file completely or not at all; a `TrackingError` names it by `what` and its path."""
    target = Path(path)
    partial = target.with_name(target.name + ".partial")
    try:
        partial.write_bytes(content)
        os.replace(partial, target)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise TrackingError(f"cannot write the {what} '{path}': {error.strerror}") from error

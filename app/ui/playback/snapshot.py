"""Keeping the picture that is shown as a file."""

from datetime import datetime
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.errors import AppError
from cubeling.app.output_path import dated_file, short_path
from cubeling.files import write_whole


def keep_snapshot(folder: Path, scenario: str, picture: NDArray[np.uint8], now: datetime) -> str:
    """Write a picture, (H, W, 3) BGR, as a PNG file in a folder; return what to tell the player."""
    try:
        path = dated_file(folder, scenario or "cubeling", ".png", now)
        write_whole(path, cv2.imencode(".png", picture)[1].tobytes(), AppError)
    except (AppError, OSError) as error:
        return f"No snapshot was kept: {error}"
    return f"Snapshot: {short_path(path)}"

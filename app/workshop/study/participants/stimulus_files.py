"""Where the stimuli of a study are."""

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.errors import AppError
from cubeling.app.ui.canvas import Canvas
from cubeling.app.ui.cards.faces import draw_face
from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.protocol import Protocol, StimulusSet, pair_members
from cubeling.app.workshop.study.protocols.questionnaires import FACES, Item
from cubeling.files import FileKind

Picture = NDArray[np.uint8]

MEDIA_TYPES = {
    ".png": "image/png",
    ".jpg": "image/jpeg",
    ".gif": "image/gif",
    ".mp4": "video/mp4",
    ".webm": "video/webm",
}
"""What can be shown, by suffix. A name without a suffix is that of the first that is there."""


MAX_STIMULUS_BYTES = 1 << 30

STIMULUS_FILE = FileKind(
    "stimulus",
    tuple(MEDIA_TYPES),
    AppError,
    MAX_STIMULUS_BYTES,
    "cubeling.app.workshop.study.participants.stimulus_files:read_picture",
)
"""A picture or a film that is shown."""

FACE_PX = 192
"""Side of the picture of a face [px]."""


def names_of(stimuli: StimulusSet, step: PlannedStep) -> list[str]:
    """Return the names of what is shown: from left to right for a pair; none without files."""
    if not stimuli.file:
        return []
    members: tuple[str, ...] = ("",)
    if stimuli.pair:
        members = pair_members(step.stimulus[stimuli.pair], step.first_left)
    return [stimuli.file.format_map({**step.stimulus, "member": each}) for each in members]


def files_of(protocol: Protocol, step: PlannedStep, folder: Path) -> tuple[Path, ...]:
    """Return the files of what is shown, from left to right; raises AppError if one is missing."""
    if not step.stimulus:
        return ()
    return needed_files(names_of(protocol.stimuli[step.part], step), folder)


def needed_files(names: Sequence[str], folder: Path) -> tuple[Path, ...]:
    """Return the files of some names; raises AppError if one is missing."""
    found = [(name, find_file(name, folder)) for name in names]
    for name, file in found:
        if file is None:
            raise AppError(f"there is no stimulus '{name}' in '{folder}'")
    return tuple(file for _, file in found if file is not None)


def pictures_of(item: Item, folder: Path) -> list[Picture]:
    """Return a picture for each answer, (height, width, 3) BGR; none for words alone.

    Raises AppError if one is missing or none.
    """
    if item.pictures == (FACES,):
        return [_face(float(mood)) for mood in np.linspace(-1.0, 1.0, len(item.answers))]
    return [read_picture(file) for file in needed_files(item.pictures, folder)]


def read_picture(file: Path) -> Picture:
    """Read a picture, (height, width, 3) BGR; raises AppError."""
    data = np.frombuffer(STIMULUS_FILE.read(file), np.uint8)
    picture = cv2.imdecode(data, cv2.IMREAD_COLOR) if len(data) else None
    if picture is None:
        raise AppError(f"'{file}' is no picture that can be shown")
    return np.asarray(picture, np.uint8)


def captions_of(files: Sequence[Path]) -> tuple[str, ...]:
    """Return what stands below each file that is shown.

    >>> captions_of([Path("a.png"), Path("b.png")])
    ('left', 'right')
    """
    return ("left", "right") if len(files) == 2 else ("",) * len(files)


def is_film(file: Path) -> bool:
    """Return whether a file moves."""
    return MEDIA_TYPES[file.suffix.lower()].startswith("video/")


def _face(mood: float) -> Picture:
    canvas = Canvas(FACE_PX, FACE_PX, 1.0)
    draw_face(canvas, FACE_PX / 2, FACE_PX / 2, FACE_PX / 2 - 2, mood, crest=False)
    return canvas.color


def find_file(name: str, folder: Path) -> Path | None:
    """Return the file of a stimulus; None if it is not there, or nothing that can be shown."""
    path = folder / name
    if path.suffix.lower() in MEDIA_TYPES:
        return path if path.is_file() else None
    found = (path.with_name(path.name + suffix) for suffix in MEDIA_TYPES)
    return next((each for each in found if each.is_file()), None)

"""Sheets of pictures of a character: from all sides, its clips frame by frame, its faces."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from app.errors import AppError
from app.ui.canvas import Canvas, text_width
from app.ui.palette import INK, QUIET
from characters import Character, Clip, Pose
from characters.rendering.portrait import PAPER_BGR, PortraitRenderer, side_by_side

Image = NDArray[np.uint8]

TURNS, FRAMES, FACES = 8, 8, 5
"""Pictures in a row: of a turntable, of a clip, of faces."""

_BORDER, _TITLE = 16, 46  # [px]
_LABEL = 170  # columns of the labels [px]
_AIR = 10  # rows of paper that are left above and below a picture [px]


class Album:
    """Draws sheets, one character after the other.

    Parameters
    ----------
    context
        From `create_context`; the album does not release it.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._large = PortraitRenderer(context, (240, 280))
        self._small = PortraitRenderer(context, (150, 200))
        self._faces = PortraitRenderer(context, (230, 230))

    def turntable(self, character: Character) -> Image:
        """Return a character from all sides, standing as it idles, or at rest."""
        picture = self._large.turntable(character, standing(character), TURNS)
        return _sheet(character.name, "from the front, to its left", [trimmed(picture)])

    def clips(self, character: Character, clips: Sequence[Clip]) -> Image:
        """Return frames of clips, a clip a row."""
        rows = []
        for clip in clips:
            strip = trimmed(self._small.strip(character, clip, FRAMES))
            loops = "loop" if clip.loop else "once"
            rows.append(_labelled(strip, clip.name, f"{clip.duration:.2f} s, {loops}"))
        return _sheet(character.name, f"{FRAMES} frames of each clip", rows)

    def faces(self, character: Character) -> Image:
        """Return the face of a character at rest, and with each of its morphs on."""
        pose = standing(character)
        names = character.morphs
        shapes = np.concatenate([np.zeros((1, len(names))), np.eye(len(names))])
        poses = [replace(pose, morphs=morphs if len(names) else None) for morphs in shapes]
        pictures = []
        for name, shown in zip(("at rest", *names), poses, strict=True):
            face = self._faces.portrait(
                character, shown, azimuth=0.3, elevation=0.05, focus="face", extent=poses
            )
            pictures.append(_captioned(face, name))
        return _sheet(character.name, "its face", [side_by_side(pictures, FACES)])

    def moods(self, character: Character, poses: Mapping[str, Pose]) -> Image:
        """Return how a character looks in some moods: whole, and its face below, a column each."""
        columns, reach = [], list(poses.values())
        for name, pose in poses.items():
            whole = self._large.portrait(character, pose, azimuth=0.5, elevation=0.1, extent=reach)
            face = self._faces.portrait(character, pose, azimuth=0.3, elevation=0.05, focus="face")
            columns.append(_captioned(stacked(whole, face), name))
        return _sheet(character.name, "its moods", [side_by_side(columns, len(columns))])

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        for studio in (self._large, self._small, self._faces):
            studio.release()


def standing(character: Character) -> Pose:
    """Return the first pose of the clip in which a character idles, or its rest pose.

    Motion capture may rest with its hips on the ground; then it is its first pose.
    """
    idle = next((c for name, c in character.clips.items() if name.lower().endswith("idle")), None)
    if idle is None and character.bounds[0, 1] < -0.2 * character.height:
        idle = next(iter(character.clips.values()), None)
    return character.skeleton.rest if idle is None else idle.sample(0.0)


def trimmed(picture: Image) -> Image:
    """Return a picture without the rows of paper above and below what is on it."""
    there = (np.abs(picture.astype(int) - PAPER_BGR).max(axis=2) > 6).any(axis=1)
    rows = np.flatnonzero(there)
    if not rows.size:
        return picture
    return picture[max(rows[0] - _AIR, 0) : rows[-1] + 1 + _AIR]


def stacked(*pictures: Image) -> Image:
    """Return pictures on top of each other, on paper as wide as the widest."""
    width = max(picture.shape[1] for picture in pictures)
    return np.concatenate([_widened(picture, width) for picture in pictures])


def save(picture: Image, path: Path, most: int | None = None) -> None:
    """Write a picture in the format that its suffix names; a .jpg of at most so many bytes.

    Raises
    ------
    AppError
        If it cannot be written.
    """
    quality = 90
    while True:
        settings = (cv2.IMWRITE_JPEG_QUALITY, quality) if path.suffix == ".jpg" else ()
        done, data = cv2.imencode(path.suffix, picture, settings)
        if not done or most is None or len(data) <= most or quality <= 40:
            break
        quality -= 5
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data.tobytes())
    except OSError as error:
        raise AppError(f"cannot write {path}: {error.strerror}; name another folder") from error


def _blank(width: int, height: int) -> Canvas:
    canvas = Canvas(width, height, 1.0)
    canvas.color[:] = PAPER_BGR
    return canvas


def _labelled(picture: Image, name: str, below: str) -> Image:
    """Return a picture with a name and a smaller line left of it."""
    canvas = _blank(_LABEL, picture.shape[0])
    middle = picture.shape[0] / 2
    name = name.rsplit("|", 1)[-1]  # "Armature|Walk", as Blender writes it
    size = min(17.0, 17.0 * (_LABEL - 12) / max(text_width(name, 17.0), 1.0))
    canvas.text(0, middle, name, size, INK)
    canvas.text(0, middle + 20, below, 13, QUIET)
    return np.concatenate([canvas.color, picture], axis=1)


def _captioned(picture: Image, name: str) -> Image:
    """Return a picture with a name below it."""
    canvas = _blank(picture.shape[1], 26)
    canvas.text(picture.shape[1] / 2, 14, name, 15, INK, "middle")
    return np.concatenate([picture, canvas.color], axis=0)


def _sheet(title: str, below: str, rows: Sequence[Image]) -> Image:
    """Return rows of pictures under a title."""
    width = max(row.shape[1] for row in rows)
    canvas = _blank(width, _TITLE)
    canvas.text(0, 24, title, 25, INK)
    canvas.text(text_width(title, 25) + 14, 24, below, 15, QUIET)
    wide = [_widened(row, width) for row in rows]
    return _bordered(np.concatenate([canvas.color, *wide]), _BORDER, _BORDER, _BORDER, _BORDER)


def _widened(row: Image, width: int) -> Image:
    return _bordered(row, 0, 0, 0, width - row.shape[1])


def _bordered(picture: Image, top: int, foot: int, left: int, right: int) -> Image:
    """Return a picture with so many pixels of paper more on each side."""
    wide = cv2.copyMakeBorder(picture, top, foot, left, right, cv2.BORDER_CONSTANT, value=PAPER_BGR)
    return np.asarray(wide, np.uint8)

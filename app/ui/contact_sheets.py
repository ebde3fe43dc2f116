"""Contact sheets of a character: from all sides, its clips frame by frame, its faces."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.ui.canvas import Canvas, text_width
from cubeling.app.ui.palette import INK, QUIET
from cubeling.characters import Character, Clip, Pose
from cubeling.characters.rendering import PAPER_BGR, PortraitRenderer, side_by_side, standing_pose
from cubeling.files import whole_file

Image = NDArray[np.uint8]

TURNTABLE_COLUMNS, CLIP_COLUMNS, FACE_COLUMNS, FRAME_COLUMNS = 8, 8, 5, 4
"""Pictures in a row: of a turntable, of a clip, of faces, of a session."""

BORDER_PX, TITLE_HEIGHT_PX, LABEL_WIDTH_PX = 16, 46, 170
"""Border of a sheet, height of its title, and width of the labels of its rows [px]."""

TRIM_MARGIN_PX = 10
"""Rows of paper that stay above and below a trimmed picture [px]."""


class ContactSheets:
    """Draws the contact sheets of characters; it does not release the context.

    `drawn` is called after each picture on a sheet, to show progress.
    """

    def __init__(self, context: moderngl.Context, drawn: Callable[[], None] | None = None) -> None:
        self._large = PortraitRenderer(context, (240, 280), drawn, levels=False)
        self._small = PortraitRenderer(context, (150, 200), drawn, levels=False)
        self._faces = PortraitRenderer(context, (230, 230), drawn, levels=False)

    def turntable(self, character: Character) -> Image:
        """Return a character from all sides, in its idle pose."""
        picture = self._large.turntable(character, standing_pose(character), TURNTABLE_COLUMNS)
        return _sheet(character.name, "from the front, to its left", [trim(picture)])

    def clips(self, character: Character, clips: Sequence[Clip]) -> Image:
        """Return frames of clips, one row for each clip."""
        rows = []
        for clip in clips:
            strip = trim(self._small.strip(character, clip, CLIP_COLUMNS))
            loops = "loop" if clip.loop else "once"
            rows.append(_with_label(strip, clip.name, f"{clip.duration:.2f} s, {loops}"))
        return _sheet(character.name, f"{CLIP_COLUMNS} frames of each clip", rows)

    def faces(self, character: Character) -> Image:
        """Return the face of a character at rest, and with each of its morphs."""
        pose = standing_pose(character)
        names = character.morphs
        shapes = np.concatenate([np.zeros((1, len(names))), np.eye(len(names))])
        poses = [replace(pose, morphs=morphs if len(names) else None) for morphs in shapes]
        faces = self._faces.portraits(character, poses, azimuth=0.3, elevation=0.05, focus="face")
        captioned = zip(faces, ("at rest", *names), strict=True)
        pictures = [_with_caption(face, name) for face, name in captioned]
        return _sheet(character.name, "its face", [side_by_side(pictures, FACE_COLUMNS)])

    def moods(self, character: Character, poses: Mapping[str, Pose]) -> Image:
        """Return a character in several moods, one column each: body, and face below."""
        columns = []
        bodies = self._large.portraits(character, list(poses.values()), azimuth=0.5, elevation=0.1)
        for (name, pose), whole in zip(poses.items(), bodies, strict=True):
            face = self._faces.portrait(character, pose, azimuth=0.3, elevation=0.05, focus="face")
            columns.append(_with_caption(stack(whole, face), name))
        return _sheet(character.name, "its moods", [side_by_side(columns, len(columns))])

    def postures(self, character: Character, poses: Mapping[str, Pose]) -> Image:
        """Return a character in several postures, one column each, from ahead and from its left."""
        views = [
            self._small.portraits(character, list(poses.values()), azimuth=azimuth)
            for azimuth in (0.25, math.pi / 2)
        ]
        columns = [
            _with_caption(stack(*both), name) for name, *both in zip(poses, *views, strict=True)
        ]
        sheet = trim(side_by_side(columns, len(columns)))
        return _sheet(character.name, "how it stands in nine moods, without its face", [sheet])

    def release(self) -> None:
        """Release the buffers; a second call does nothing."""
        for renderer in (self._large, self._small, self._faces):
            renderer.release()


def frame_sheet(title: str, frames: Sequence[tuple[str, Image]]) -> Image:
    """Return pictures of a session in rows, each with its caption."""
    pictures = [_with_caption(picture, caption) for caption, picture in frames]
    rows = side_by_side(pictures, min(FRAME_COLUMNS, len(pictures)))
    return _sheet(title, quantity(len(frames), "picture"), [rows])


def trim(picture: Image) -> Image:
    """Return a picture without the empty rows of paper at its top and bottom."""
    drawn = (np.abs(picture.astype(int) - PAPER_BGR).max(axis=2) > 6).any(axis=1)
    rows = np.flatnonzero(drawn)
    if not rows.size:
        return picture
    return picture[max(rows[0] - TRIM_MARGIN_PX, 0) : rows[-1] + 1 + TRIM_MARGIN_PX]


def stack(*pictures: Image) -> Image:
    """Return pictures below each other, on paper as wide as the widest."""
    width = max(picture.shape[1] for picture in pictures)
    return np.concatenate([_widen(picture, width) for picture in pictures])


def save(picture: Image, path: Path, max_bytes: int | None = None) -> None:
    """Write a picture in the format of its suffix; a .jpg has at most `max_bytes`, if possible.

    Raises
    ------
    AppError
        The file cannot be written.
    """
    quality = 90
    while True:
        settings = (cv2.IMWRITE_JPEG_QUALITY, quality) if path.suffix.lower() == ".jpg" else ()
        done, data = cv2.imencode(path.suffix, picture, settings)
        if not done or max_bytes is None or len(data) <= max_bytes or quality <= 40:
            break
        quality -= 5
    with whole_file(path, AppError) as partial:
        path.parent.mkdir(parents=True, exist_ok=True)
        partial.write_bytes(data.tobytes())


def _blank(width: int, height: int) -> Canvas:
    canvas = Canvas(width, height, 1.0)
    canvas.color[:] = PAPER_BGR
    return canvas


def _with_label(picture: Image, name: str, below: str) -> Image:
    """Return a picture with a name and a smaller line to its left."""
    canvas = _blank(LABEL_WIDTH_PX, picture.shape[0])
    middle = picture.shape[0] / 2
    name = name.rsplit("|", 1)[-1]  # "Armature|Walk", as Blender writes it
    size = min(17.0, 17.0 * (LABEL_WIDTH_PX - 12) / max(text_width(name, 17.0), 1.0))
    canvas.text(0, middle, name, size, INK)
    canvas.text(0, middle + 20, below, 13, QUIET)
    return np.concatenate([canvas.color, picture], axis=1)


def _with_caption(picture: Image, name: str) -> Image:
    """Return a picture with a name below it."""
    canvas = _blank(picture.shape[1], 26)
    canvas.text(picture.shape[1] / 2, 14, name, 15, INK, "middle")
    return np.concatenate([picture, canvas.color], axis=0)


def _sheet(title: str, below: str, rows: Sequence[Image]) -> Image:
    """Return rows of pictures under a title."""
    width = max(row.shape[1] for row in rows)
    canvas = _blank(width, TITLE_HEIGHT_PX)
    canvas.text(0, 24, title, 25, INK)
    canvas.text(text_width(title, 25) + 14, 24, below, 15, QUIET)
    wide = [_widen(row, width) for row in rows]
    return _with_border(np.concatenate([canvas.color, *wide]), *[BORDER_PX] * 4)


def _widen(row: Image, width: int) -> Image:
    return _with_border(row, 0, 0, 0, width - row.shape[1])


def _with_border(picture: Image, top: int, bottom: int, left: int, right: int) -> Image:
    """Return a picture with a border of paper [px]."""
    wide = cv2.copyMakeBorder(
        picture, top, bottom, left, right, cv2.BORDER_CONSTANT, value=PAPER_BGR
    )
    return np.asarray(wide, np.uint8)

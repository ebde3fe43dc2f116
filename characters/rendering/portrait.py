"""Characters alone in a picture: a portrait, a turntable, a strip of frames side by side."""

import math
from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.character import Character
from characters.command import PosedCharacter
from characters.pose import Array, Pose
from characters.rendering.stage import Stage
from characters.rendering.view import Actor, View

Image = NDArray[np.uint8]

_FIELD = math.radians(24.0)  # of view: long lenses flatter
_TALL = 0.17  # height on the table [m], which light and shadow are made for
_PAPER = 236, 240, 242  # backdrop, BGR


class Studio:
    """Takes portraits of one character after the other.

    Parameters
    ----------
    context
        From `create_context`; the studio does not release it.
    size
        Of one picture, (width, height) [px].
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int] = (360, 420)) -> None:
        self.size = size
        self._stage = Stage(context, size)

    def portrait(
        self,
        character: Character,
        pose: Pose | None = None,
        *,
        around: float = 0.4,
        above: float = 0.16,
        focus: "tuple[Array, float] | None" = None,
    ) -> Image:
        """Return a picture of a character, (height, width, 3) BGR.

        Parameters
        ----------
        character, pose
            Who, and how; at rest without.
        around, above
            Where the camera stands, to the character's left of straight in front and upwards [rad].
        focus
            Centre (3,) and radius of what fills the picture, in the character frame [m]; the whole
            character without.
        """
        scale = _TALL / max(character.height, 1e-6)
        centre, radius = focus or whole(character)
        distance = radius * scale / math.sin(_FIELD / 2)
        view = _view(centre * scale, distance, around, above, self.size)
        place = np.diag([scale, scale, scale, 1.0])
        pose = character.skeleton.rest if pose is None else pose
        posed = PosedCharacter(pose, place, True, "", 0.0, 0.0, 0.0, 0.0)
        return self._stage.draw(view, [Actor(character, posed)])

    def turntable(self, character: Character, pose: Pose | None = None, count: int = 8) -> Image:
        """Return a character from `count` sides, side by side."""
        turns = np.arange(count) * (2 * math.pi / count)
        return side_by_side([self.portrait(character, pose, around=turn) for turn in turns])

    def strip(
        self, character: Character, name: str, count: int = 8, *, around: float = 0.7
    ) -> Image:
        """Return `count` frames of one of the character's clips, side by side, root in place."""
        clip = character.clips[name]
        times = np.linspace(0.0, clip.duration, count, endpoint=not clip.loop)
        poses = [clip.sample(float(time)) for time in times]
        return side_by_side([self.portrait(character, pose, around=around) for pose in poses])

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        self._stage.release()


def whole(character: Character) -> tuple[Array, float]:
    """Return the centre (3,) and the radius of a ball around the character at rest [m]."""
    low, high = character.bounds
    return (low + high) / 2, float(np.linalg.norm(high - low)) / 2 * 0.82


def side_by_side(pictures: Sequence[Image], columns: int = 8) -> Image:
    """Return pictures of one size in rows of at most `columns`; empty places stay paper."""
    blank = np.full_like(pictures[0], _PAPER)
    rows = [list(pictures[at : at + columns]) for at in range(0, len(pictures), columns)]
    if len(rows) > 1:
        rows[-1] += [blank] * (columns - len(rows[-1]))
    return np.concatenate([np.concatenate(row, axis=1) for row in rows], axis=0)


def _view(
    centre: Array, distance: float, around: float, above: float, size: tuple[int, int]
) -> View:
    """Return the view of a camera that looks at a point from a direction."""
    toward = np.array(
        [
            math.sin(around) * math.cos(above),
            math.sin(above),
            math.cos(around) * math.cos(above),
        ]
    )
    eye = centre + distance * toward
    right = np.cross([0.0, 1.0, 0.0], toward)
    right /= np.linalg.norm(right)
    turn = np.stack([right, np.cross(right, toward), -toward])
    camera_from_table = np.eye(4)
    camera_from_table[:3, :3], camera_from_table[:3, 3] = turn, -turn @ eye
    width, height = size
    focal = min(size) / 2 / math.tan(_FIELD / 2)
    matrix = np.array(
        [[focal, 0.0, (width - 1) / 2], [0.0, focal, (height - 1) / 2], [0.0, 0.0, 1.0]]
    )
    image = np.full((height, width, 3), _PAPER, np.uint8)
    return View(image, matrix, np.zeros(0), camera_from_table)

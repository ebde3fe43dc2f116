"""What the cube's part of a window shows: its print, or something in front of that."""

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from cubeling.tracking.appearance.hand.colour_model import MIN_SHOWN_PX
from cubeling.tracking.appearance.hand.on_cube.face_check import FaceCheck
from cubeling.tracking.appearance.hand.on_cube.face_pattern import FacePattern
from cubeling.tracking.appearance.hand.structuring_elements import SQUARE_3
from cubeling.tracking.appearance.hand.window import HandWindow
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Flags, Floats, Image

DOUBTFUL_ODDS = 1.6
"""What the colour of print must speak for a hand, as logarithm of odds, so that it may be one: a
dark finger on ink."""


@dataclass(frozen=True)
class CubePart:
    """What the cube's part of a window shows."""

    outline: Image
    """The whole cube, (h, w) of the window's `cube_box`."""

    outside: Flags
    """Pixels beyond the cube and its edge, (h, w) of the whole window."""

    inner: Flags
    """Pixels inside of a face that tells something, (h, w) as `outline`."""

    slanted: Flags
    """Pixels of the cube whose face tells nothing, (h, w)."""

    evidence: Flags
    """Pixels that do not look like their print, (h, w)."""

    doubtful: Flags
    """Pixels that look like print, and like the hand, and are not told by their chroma, (h, w)."""

    told: Flags
    """Pixels that look like print, but have the chroma of the hand, (h, w)."""

    behind: Array
    """As in `HandMask`, (3,) [m]."""

    @cached_property
    def shows_hand(self) -> bool:
        """Whether there is enough evidence to learn the colours of the hand."""
        return bool(np.count_nonzero(self.evidence) > MIN_SHOWN_PX)


class CubeCheck:
    """Looks for what is in front of one cube, and remembers how near that must be."""

    def __init__(self, cube: CubeModel, pattern: FacePattern) -> None:
        self._half, self._pattern, self._faces = cube.edge / 2, pattern, FaceCheck()
        self._hidden = np.zeros(3)  # the point behind the hand, in the cube's frame [m]

    def part(
        self, window: HandWindow, pose: Array, lab: Floats, by_colour: Floats, nearest_is_due: bool
    ) -> CubePart:
        """Compare the cube in a window with its print.

        Parameters
        ----------
        window
            Where the cube is.
        pose
            That of the cube, `camera_from_cube`, (4, 4) [m].
        lab
            L + 16, a and b of CIELab of the window, in bytes, (3, h, w).
        by_colour
            What the colours of the window speak for a hand, (h, w).
        nearest_is_due
            Whether to look again for the nearest point that is hidden; else it stays on the cube.
        """
        rows, columns = window.cube_box
        quads, size = window.cube_quads(), (columns.stop - columns.start, rows.stop - rows.start)
        outline = _outline(quads, size)
        outside = np.ones(by_colour.shape, bool)
        outside[rows, columns] = cv2.dilate(outline, SQUARE_3) == 0
        like_hand = by_colour[rows, columns] > DOUBTFUL_ODDS
        seen = self._pattern.draw(pose, quads, size)
        part = lab[:, rows, columns]
        evidence = self._faces.disagreement(part, seen, like_hand, window.edge)
        if not evidence.any():
            self._hidden = np.zeros(3)
        elif nearest_is_due or not self._hidden.any():
            corner = np.array([window.left + columns.start, window.top + rows.start], np.float64)
            scale = window.scale
            nearest = self._pattern.nearest(pose, seen.face * evidence, corner * scale, scale)
            hidden = (nearest - pose[:3, 3]) @ pose[:3, :3]
            self._hidden = np.clip(hidden, -self._half, self._half)  # a pixel may be beyond an edge
        behind = pose[:3, :3] @ self._hidden + pose[:3, 3]
        inner = cv2.erode(seen.face, SQUARE_3) > 0
        slanted = (seen.face == 0) & outline.view(bool)
        doubtful = inner & ~evidence & like_hand
        told, bare = self._faces.split_by_chroma(part, seen, evidence, doubtful)
        doubtful &= ~(told | bare)
        return CubePart(outline, outside, inner, slanted, evidence, doubtful, told, behind)


def _outline(quads: Array, size: tuple[int, int]) -> Image:
    """Return the convex hull of the faces' prints, (h, w) 0 or 1, in a part of that size."""
    outline = np.zeros(size[::-1], np.uint8)
    hull = cv2.convexHull(np.rint(quads.reshape(-1, 2) * 16).astype(np.int32))
    cv2.fillConvexPoly(outline, hull, 1, shift=4)
    return outline

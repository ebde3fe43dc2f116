"""Which frames become views: still ones that show something new."""

from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.calibration import lens, start
from tracking.calibration.coach import Coach, Look
from tracking.calibration.finders import Finder, Found
from tracking.calibration.view import View
from tracking.geometry import se3
from tracking.geometry.frame import Frame
from tracking.geometry.intrinsics import Intrinsics

Array = NDArray[np.float64]

STILL = 0.09
"""A target that moves faster than this is too blurred to measure [picture widths a second]."""

NEW = (0.10, np.deg2rad(12), 0.18)
"""A view is new if it differs from every other by so much: place [picture widths], attitude [rad],
or distance [share]."""

MOST = 90
"""More views than this add nothing."""

Verdict = Literal["unseen", "moving", "known", "unclear", "taken", "full"]


@dataclass(frozen=True)
class Glance:
    """What came of one frame."""

    verdict: Verdict
    """Whether it became a view, or why not."""

    outlines: tuple[Array, ...]
    """Outlines of what was seen, each (4, 2) [px]."""

    look: Look | None
    """How the target was seen; None where it was not."""


class Collector:
    """Chooses views from the frames of one camera, and tells the coach of them.

    Parameters
    ----------
    finder
        Finds the target.
    size
        Width and height of the frames [px].
    """

    def __init__(self, finder: Finder, size: tuple[int, int]) -> None:
        self._finder = finder
        self.size = size
        """Width and height of the frames [px]."""
        # Any camera will do to tell tilts and turns apart.
        self._camera = lens.vector(Intrinsics.guess(size))
        self._last: Found | None = None
        self._poses: list[tuple[Array, tuple[int, ...]]] = []
        self.coach = Coach(finder.names)
        """Keeps account of the views."""
        self.views: list[View] = []
        """The views so far."""
        self.outlines: list[Array] = []
        """Where plates were seen in them, each (4, 2) [px]."""

    def update(self, frame: Frame) -> Glance:
        """Look at the next frame."""
        grey = np.asarray(cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY), np.uint8)
        found = self._finder.find(grey, frame.timestamp)
        before, self._last = self._last, found
        pose = None if found is None else start.best_pose(found.corners, self._camera)
        if found is None or pose is None:
            return Glance("unseen", (), None)
        look = self._look(found, pose)
        verdict = self._judged(found, pose, before)
        if verdict == "taken":
            view = self._finder.measure(grey, found)
            if view is None:
                return Glance("unclear", found.outlines, look)
            self.views.append(view)
            self.outlines += found.outlines
            self._poses.append((pose, tuple(sorted(found.plates))))
            self.coach.add(look)
        return Glance(verdict, found.outlines, look)

    def _judged(self, found: Found, pose: Array, before: Found | None) -> Verdict:
        if len(self.views) >= MOST:
            return "full"
        if not self._new(pose, tuple(sorted(found.plates))):
            return "known"
        return "taken" if self._speed(found, before) <= STILL * self.size[0] else "moving"

    def _new(self, pose: Array, plates: tuple[int, ...]) -> bool:
        """Whether no view shows the same plates in nearly the same place and attitude."""
        for other, others in self._poses:
            step = se3.motion(other, pose)
            distance = max(float(pose[2, 3]), 1e-3)
            beside = float(np.linalg.norm(step[:2])) * self._camera[0] / distance / self.size[0]
            nearer = abs(float(np.log(distance / max(float(other[2, 3]), 1e-3))))
            turned = float(np.linalg.norm(step[3:]))
            alike = beside < NEW[0] and turned < NEW[1] and nearer < NEW[2]
            if alike and plates == others:
                return False
        return True

    def _speed(self, found: Found, before: Found | None) -> float:
        """How fast the plates move in the picture [px/s]; infinite where that cannot be told."""
        if before is None:
            return np.inf
        last = dict(zip(before.plates, before.outlines, strict=True))
        shared = [
            np.linalg.norm(outline - last[plate], axis=1).max()
            for plate, outline in zip(found.plates, found.outlines, strict=True)
            if plate in last
        ]
        elapsed = found.corners.timestamp - before.corners.timestamp
        return float(max(shared)) / elapsed if shared and elapsed > 0 else np.inf

    def _look(self, found: Found, pose: Array) -> Look:
        pixels = np.concatenate(found.outlines)
        sides = [
            np.linalg.norm(outline - np.roll(outline, 1, axis=0), axis=1).mean()
            for outline in found.outlines
        ]
        x, y = pixels.mean(axis=0) / self.size
        return Look(
            (float(x), float(y)),
            float(max(sides)) / self.size[1],
            self._tilt(found, pose),
            found.plates,
        )

    def _tilt(self, found: Found, pose: Array) -> tuple[float, float]:
        """Where the plate that is met most squarely looks, beside its line of sight."""
        best, least = np.zeros(2), np.inf
        view = found.corners
        for plate in found.plates:
            points = np.unique(view.points[view.plates == plate], axis=0)
            seen = points @ pose[:3, :3].T + pose[:3, 3]
            centre = seen.mean(axis=0)
            sight = centre / np.linalg.norm(centre)
            normal = np.linalg.svd(seen - centre)[2][2]
            normal = normal if normal @ sight < 0 else -normal
            beside = normal + sight
            angle = float(np.arccos(np.clip(-normal @ sight, -1, 1)))
            if angle < least:
                least = angle
                best = beside[:2] * angle / max(float(np.linalg.norm(beside[:2])), 1e-9)
        return float(best[0]), float(best[1])

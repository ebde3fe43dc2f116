"""The markers of one frame, which several cubes share."""

from collections.abc import Mapping
from functools import cached_property
from typing import Literal

import cv2
import numpy as np

from cubeling.tracking.detection.markers import Marker, MarkerDetector
from cubeling.tracking.geometry.arrays import Image
from cubeling.tracking.geometry.frame import Frame

SAME_CORNER_PX = 8.0
"""Corners of one marker that two passes found are this close to each other."""

Pass = Literal["half size", "first window", "other windows"]
"""The passes of OpenCV's detector over an image."""


class FrameMarkers:
    """The markers of one frame, read when they are asked for, and once for all cubes."""

    def __init__(self, frame: Frame, detectors: Mapping[str, MarkerDetector]) -> None:
        self.frame = frame
        """The frame."""
        self._detectors = detectors
        self._read: dict[tuple[str, Pass], list[Marker]] = {}

    @cached_property
    def grey(self) -> Image:
        """The image in grey, (H, W)."""
        return np.asarray(cv2.cvtColor(self.frame.image, cv2.COLOR_BGR2GRAY), np.uint8)

    def read(self, dictionary: str, by: Pass) -> list[Marker]:
        """Read all markers of a dictionary in one pass; the last two add to each other."""
        key = (dictionary, by)
        if key not in self._read:
            self._read[key] = self._detect(dictionary, by)
        return self._read[key]

    def _detect(self, dictionary: str, by: Pass) -> list[Marker]:
        detector = self._detectors[dictionary]
        if by == "first window":
            return detector.detect(self.grey)
        if by == "other windows":
            known = self.read(dictionary, "first window")
            others = detector.detect_others(self.grey)
            return [*known, *(new for new in others if not any(_same(new, old) for old in known))]
        height, width = self.grey.shape
        small = cv2.resize(self.grey, (width // 2, height // 2), interpolation=cv2.INTER_AREA)
        # Pixel centres lie at whole numbers: the first small one is at 0.5 of the large ones.
        return [
            Marker(each.marker_id, each.corners * 2 + 0.5)
            for each in detector.detect(np.asarray(small, np.uint8))
        ]


def _same(new: Marker, old: Marker) -> bool:
    apart = np.abs(new.corners - old.corners).max()
    return new.marker_id == old.marker_id and bool(apart < SAME_CORNER_PX)

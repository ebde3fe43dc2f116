"""The search for a cube anywhere in an image: cheap methods first, thorough ones last."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Literal

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.markers import Marker, MarkerDetector, Observation, markers_of
from cubeling.tracking.detection.partly_hidden_markers import PartlyHiddenMarkerDetector
from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.image_region import Region
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.blur_search import BlurSearch
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.cell_search import CellSearch
from cubeling.tracking.refinement.edge_search import EdgeSearch
from cubeling.tracking.refinement.footprint import Footprint
from cubeling.tracking.tracker.marker_poses import MarkerPoses
from cubeling.tracking.tracker.verdict import is_unambiguous

MIN_HALVED_HEIGHT_PX = 600
"""Images of at least this height are searched at half their size first."""

MIN_SINGLE_HEIGHT_PX = 400
"""Lower images are searched for partly hidden markers at twice their size."""

MAX_NEIGHBOURS, NEIGHBOURHOOD_SIDES = 3, 2.0
"""Around so many markers, the last ones, those of the same cube are searched, within so many of
their sides."""

SAME_CORNER_PX = 8.0
"""Corners of one marker that two passes found are this close to each other."""

Pass = Literal["half size", "first window", "other windows"]
"""The passes of OpenCV's detector over an image."""


class FrameMarkers:
    """The markers of one frame, read when they are asked for, and once for all cubes."""

    def __init__(self, frame: Frame, detectors: Mapping[str, MarkerDetector]) -> None:
        self._image = frame.image
        self._detectors = detectors
        self._read: dict[tuple[str, Pass], list[Marker]] = {}

    @cached_property
    def grey(self) -> Image:
        """The image in grey, (H, W)."""
        return np.asarray(cv2.cvtColor(self._image, cv2.COLOR_BGR2GRAY), np.uint8)

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


class GlobalDetector:
    """Finds one cube without a past: by its markers and `edges`, or by its blurred image."""

    def __init__(
        self,
        cube: CubeModel,
        projection: Projection,
        edges: EdgeSearch,
        cells: CellSearch,
        blur: BlurSearch,
    ) -> None:
        self._cube = cube
        self._footprint = Footprint(cube, projection)
        self._poses = MarkerPoses(cube, projection, edges, cells)
        self._hidden = PartlyHiddenMarkerDetector(cube)
        self._blur = blur

    def detect(
        self,
        image: Image,
        markers: FrameMarkers,
        expected: Array | None,
        tone: Floats,
        thorough: bool,
    ) -> list[Candidate]:
        """Propose up to two poses for an image, (H, W, 3) BGR, with its markers.

        These are the first that are proved and that leave no choice, else those of the last
        search; `thorough` looks for partly hidden markers too. `expected` is the predicted pose.
        """
        found: list[Candidate] = []
        for observations in self._observations(markers, thorough):
            if observations:
                poses = self._poses.find(markers.grey, observations, expected, tone)
                found = _merge(found, poses)
                if is_unambiguous(found):
                    return found
        if any(each.certain for each in found):
            return found
        return self._align_blurred(image, tone, found)

    def _observations(self, markers: FrameMarkers, thorough: bool) -> Iterator[list[Observation]]:
        """Read markers in ever more costly passes; `thorough` ends with partly hidden ones.

        Else others that OpenCV finds with more effort are the last: each frame has one of the two.
        """
        passes: tuple[Pass, ...] = ("half size", "first window")
        seen: list[Observation] = []
        # A bool as an index: small images skip the pass at half size.
        for by in passes[len(markers.grey) < MIN_HALVED_HEIGHT_PX :]:
            found = markers_of(self._cube, markers.read(self._cube.dictionary, by))
            seen += found
            yield found
        if not thorough:
            yield markers_of(self._cube, markers.read(self._cube.dictionary, "other windows"))
            return
        # In a low image the print of a hidden marker has too few pixels a cell, so it is enlarged
        # at once.
        small = len(markers.grey) < MIN_SINGLE_HEIGHT_PX
        found = self._hidden.detect(markers.grey, doubled=small)
        seen += found
        yield found
        if seen and not small:
            yield self._hidden.detect(markers.grey, _around(seen, markers.grey), doubled=True)

    def _align_blurred(
        self, image: Image, tone: Floats, candidates: list[Candidate]
    ) -> list[Candidate]:
        """Align the blurred image at poses that rest on corners alone, where it shows the cube."""
        found = []
        for each in candidates:
            patch = self._footprint.crop(image, each.camera_from_cube, tone)
            aligned = patch and self._blur.align_unknown_motion(patch, each.camera_from_cube)
            if patch and aligned:
                found.append(self._blur.candidate(patch, aligned))
        # Where no blur explains the image, the corners are still the best guess.
        return [each for each in found if each] or candidates


def _around(seen: Sequence[Observation], grey: Image) -> Region:
    """Return the region around the latest markers in which their cube lies."""
    corners = np.concatenate([each.corners for each in seen[-MAX_NEIGHBOURS:]])
    reach = NEIGHBOURHOOD_SIDES * max(each.size for each in seen[-MAX_NEIGHBOURS:])
    left, top = np.maximum(corners.min(axis=0) - reach, 0).astype(int).tolist()
    right, bottom = np.minimum(corners.max(axis=0) + reach, grey.shape[::-1]).astype(int).tolist()
    return left, top, right, bottom


def _merge(one: list[Candidate], other: list[Candidate]) -> list[Candidate]:
    """Join two lists; of poses that are the same, keep the better one. The best comes first."""
    kept: list[Candidate] = []
    for each in sorted([*one, *other], key=lambda each: each.rank):
        if not any(each.same_pose(better) for better in kept):
            kept.append(each)
    return kept

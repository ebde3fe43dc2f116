"""The search for a cube anywhere in an image: cheap methods first, thorough ones last."""

from collections.abc import Iterator, Mapping
from functools import cached_property

import cv2
import numpy as np

from tracking.cube.model import CubeModel
from tracking.detection.markers import Marker, MarkerDetector, Observation, markers_of
from tracking.detection.partly_hidden_markers import PartlyHiddenMarkerDetector
from tracking.geometry.arrays import Array, Floats, Image
from tracking.geometry.frame import Frame
from tracking.geometry.image_region import Patch
from tracking.geometry.projection import Projection
from tracking.refinement.blur_search import BlurSearch
from tracking.refinement.candidate import Candidate
from tracking.refinement.edge_search import EdgeSearch
from tracking.refinement.footprint import Footprint
from tracking.tracker.marker_poses import MarkerPoses

MIN_HALVED_HEIGHT_PX = 480
"""Images of at least this height are searched at half their size first."""


class FrameMarkers:
    """The markers of one frame, read when they are asked for, and once for all cubes."""

    def __init__(self, frame: Frame, detectors: Mapping[str, MarkerDetector]) -> None:
        self._image = frame.image
        self._detectors = detectors
        self._read: dict[tuple[str, bool], list[Marker]] = {}

    @cached_property
    def grey(self) -> Image:
        """The image in grey, (H, W)."""
        return np.asarray(cv2.cvtColor(self._image, cv2.COLOR_BGR2GRAY), np.uint8)

    def read(self, dictionary: str, halved: bool) -> list[Marker]:
        """Read all markers of a dictionary, in the image or in one of half its size."""
        key = (dictionary, halved)
        if key not in self._read:
            self._read[key] = self._detect(self._detectors[dictionary], halved)
        return self._read[key]

    def _detect(self, detector: MarkerDetector, halved: bool) -> list[Marker]:
        if not halved:
            return detector.detect(self.grey)
        height, width = self.grey.shape
        small = cv2.resize(self.grey, (width // 2, height // 2), interpolation=cv2.INTER_AREA)
        # Pixel centres lie at whole numbers: the first small one is at 0.5 of the large ones.
        return [
            Marker(each.marker_id, each.corners * 2 + 0.5)
            for each in detector.detect(np.asarray(small, np.uint8))
        ]


class GlobalDetector:
    """Finds one cube without a past: by its markers and `edges`, or by its blurred image."""

    def __init__(
        self, cube: CubeModel, projection: Projection, edges: EdgeSearch, blur: BlurSearch
    ) -> None:
        self._cube = cube
        self._footprint = Footprint(cube, projection)
        self._poses = MarkerPoses(cube, projection, edges)
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

        These are the first that edges prove and that leave no choice, else those of the last
        search; `thorough` looks for partly hidden markers too. `expected` is the predicted pose.
        """
        patch = Patch.crop(markers.grey, None, tone)
        found: list[Candidate] = []
        for observations in self._observations(markers, thorough):
            candidates = self._poses.find(patch, observations, expected) if observations else []
            if any(each.certain for each in candidates):
                if _is_unambiguous(candidates):
                    return candidates
                found = candidates
            elif not any(each.certain for each in found):
                found = candidates or found
        if any(each.certain for each in found):
            return found
        return self._align_blurred(image, tone, found)

    def _observations(self, markers: FrameMarkers, thorough: bool) -> Iterator[list[Observation]]:
        """Read markers at half the size, at full size, and then partly hidden ones."""
        dictionary = self._cube.dictionary
        if len(markers.grey) >= MIN_HALVED_HEIGHT_PX:
            yield markers_of(self._cube, markers.read(dictionary, halved=True))
        yield markers_of(self._cube, markers.read(dictionary, halved=False))
        if thorough:
            yield self._hidden.detect(markers.grey)

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
        return [each for each in found if each] or candidates


def _is_unambiguous(candidates: list[Candidate]) -> bool:
    """Whether there is one pose, or one that is clearly better than the others."""
    best, *others = sorted(candidates, key=lambda each: each.residual)
    return all(best.same_pose(other) or best.clearly_better_than(other) for other in others)

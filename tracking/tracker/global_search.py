"""Finding a cube anywhere in a picture: first what is cheap, then what is thorough."""

from collections.abc import Iterator

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.cube.model import CubeModel
from tracking.detection.markers import Marker, MarkerDetector, Observation, observed
from tracking.detection.partly_hidden_markers import CoveredMarkerDetector
from tracking.geometry.frame import Frame
from tracking.geometry.image_region import Patch
from tracking.geometry.projection import Projection
from tracking.tracker.candidate import Candidate, close, decisive
from tracking.tracker.local_search import Follower
from tracking.tracker.marker_poses import CandidateFinder

Array = NDArray[np.float64]

HALVED = 480
"""Pictures with at least so many rows are searched at half their size first [px]."""


class Search:
    """The markers of one picture, read once for all cubes that are sought in it.

    Parameters
    ----------
    frame
        The frame.
    detectors
        One for each dictionary, by its name.
    """

    def __init__(self, frame: Frame, detectors: dict[str, MarkerDetector]) -> None:
        self.image = frame.image
        self.grey = np.asarray(cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY), np.uint8)
        """The picture in grey, (H, W)."""
        self._detectors = detectors
        self._read: dict[tuple[str, bool], list[Marker]] = {}

    def markers(self, dictionary: str, halved: bool) -> list[Marker]:
        """Read all markers of a dictionary, in the picture or in one of half its size."""
        key = (dictionary, halved)
        if key not in self._read:
            self._read[key] = self._detected(dictionary, halved)
        return self._read[key]

    def _detected(self, dictionary: str, halved: bool) -> list[Marker]:
        detector = self._detectors[dictionary]
        if not halved:
            return detector.detect(self.grey)
        height, width = self.grey.shape
        small = cv2.resize(self.grey, (width // 2, height // 2), interpolation=cv2.INTER_AREA)
        # Pixel centres lie at whole numbers: the first small one is at 0.5 of the large ones.
        return [
            Marker(each.number, each.corners * 2 + 0.5)
            for each in detector.detect(np.asarray(small, np.uint8))
        ]


class Acquirer:
    """Finds one cube without a past.

    Parameters
    ----------
    cube
        The cube, as printed.
    projection
        The camera.
    follower
        What refines poses, and knows the camera's response.
    """

    def __init__(self, cube: CubeModel, projection: Projection, follower: Follower) -> None:
        self._cube = cube
        self._follower = follower
        self._finder = CandidateFinder(cube, projection, follower)
        self._covered = CoveredMarkerDetector(cube)

    def find(self, search: Search, expected: Array | None, thorough: bool) -> list[Candidate]:
        """Propose up to two poses.

        Parameters
        ----------
        search
            The picture.
        expected
            Where the cube should be by its past, (4, 4), if that is known.
        thorough
            Whether to look for markers with covered corners too, where no others prove the cube.

        Returns
        -------
        The first that edges prove and that leave no choice, else those of the most thorough search.
        """
        patch = Patch.of(search.grey, None, self._follower.camera.tone)
        found: list[Candidate] = []
        for observations in self._observations(search, thorough):
            candidates = self._finder.find(patch, observations, expected) if observations else []
            if any(each.certain for each in candidates):
                if _clear(candidates):
                    return candidates
                found = candidates
            elif not any(each.certain for each in found):
                found = candidates or found
        if any(each.certain for each in found):
            return found
        return self._unblurred(search, found)

    def _observations(self, search: Search, thorough: bool) -> Iterator[list[Observation]]:
        dictionary = self._cube.dictionary
        if len(search.grey) >= HALVED:
            yield observed(self._cube, search.markers(dictionary, halved=True))
        yield observed(self._cube, search.markers(dictionary, halved=False))
        if thorough:
            yield self._covered.detect(search.grey)

    def _unblurred(self, search: Search, candidates: list[Candidate]) -> list[Candidate]:
        """Align the picture round poses that corners alone vouch for, where it shows the cube."""
        found = []
        for each in candidates:
            region = self._follower.region(each.camera_from_cube)
            if region is not None:
                patch = Patch.of(search.image, region, self._follower.camera.tone)
                found.append(self._follower.unblurred(patch, each.camera_from_cube))
        return [each for each in found if each] or candidates


def _clear(candidates: list[Candidate]) -> bool:
    """Whether there is one pose, or one that is clearly better than the other."""
    best, *others = sorted(candidates, key=lambda each: each.residual)
    return all(close(best, other) or decisive(best, other) for other in others)

"""The time that a cube costs which is not in the picture."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.bench.photographs import dodecahedron
from tests.bench.photographs.boards import load_lens
from tests.bench.photographs.marker_corners import Picture, opencv_corners, opencv_detector
from tests.bench.photographs.scoring import high, timed
from tests.tracking.showing import show_until_decided

CUBE = "locomotion"


@dataclass(frozen=True)
class EmptyScore:
    """Our tracker on photographs without its cube."""

    pictures: str
    """Which photographs."""

    frames: int
    """How many."""

    seen: int
    """In how many the cube is said to be."""

    milliseconds: float
    """Median time of a new tracker until a picture is decided."""

    opencv: float
    """Median time of cv2's detection for the same dictionary [ms]."""

    ratio: float
    """Median of the quotients of both."""

    high_ratio: float
    """95th percentile of the same."""

    longest_call: float
    """The longest call ÷ cv2's detection."""


def score_empty(numbers: Sequence[int]) -> list[EmptyScore]:
    """Search a bundled cube in the dodecahedron's photographs and those of a chessboard."""
    own = ((dodecahedron.photograph(number), dodecahedron.camera()) for number in numbers)
    return [_score("dodecahedron", own), _score("chessboard", _chessboards())]


def _chessboards() -> Iterator[tuple[Picture, Intrinsics]]:
    folder = dodecahedron.PHOTOGRAPHS / "chessboard"
    for path in sorted(folder.glob("*.jpg")):
        picture = np.asarray(cv2.imread(str(path)), np.uint8)
        size = (picture.shape[1], picture.shape[0])
        yield picture, load_lens(folder / "left_intrinsics.yml", size)


def _score(name: str, pictures: Iterator[tuple[Picture, Intrinsics]]) -> EmptyScore:
    cube, seen, times, longest = CubeModel.load(CUBE), 0, [], 0.0
    detector = opencv_detector(cube.dictionary)
    for picture, lens in pictures:
        state, calls = show_until_decided(CubeTracker(cube, lens), picture)
        ours = sum(calls)
        theirs = timed(opencv_corners, detector, picture)[1]
        seen += state.visible
        times.append((1e3 * ours, 1e3 * theirs, ours / theirs))
        longest = max(longest, max(calls) / theirs)
    medians = np.median(times, axis=0) if times else np.full(3, np.nan)
    ratios = [ratio for _, _, ratio in times]
    ours, theirs, ratio = medians.tolist()
    return EmptyScore(name, len(times), seen, ours, theirs, ratio, high(ratios), longest)

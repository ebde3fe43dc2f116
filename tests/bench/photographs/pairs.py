"""Every marker as a cube with one face: two of them lie alike in all photographs."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.bench.photographs.dodecahedron import (
    DICTIONARY,
    MARKERS,
    SIDE,
    all_corners,
    camera,
    marker_poses,
    one_marker,
    photograph,
    reference,
)
from tests.bench.photographs.marker_corners import Picture, opencv_corners, opencv_detector
from tests.bench.photographs.scoring import (
    StatedPose,
    are_wrong,
    deltas_from_consensus,
    medians,
    share,
)
from tests.bench.tracking.scoring import CHI2_95_PERCENT
from tests.bench.tracking.table import OURS
from tests.tracking.showing import show_until_decided

MIN_PICTURES = 5
"""A pair needs as many pictures for a consensus."""

Pairs = dict[tuple[int, int], list[StatedPose]]


@dataclass(frozen=True)
class PairScore:
    """One tracker on all pairs of markers. NaN where there is no measurement."""

    tracker: str
    """Title of the tracker."""

    markers: int
    """Markers that OpenCV detects with a fine window."""

    given: float
    """Share of them with a pose; of ours, a trusted one."""

    verdicts: dict[str, int]
    """How many markers had each of our verdicts."""

    pairs: int
    """Pairs of poses in one picture."""

    wrong: int
    """How many of them are more than 20 mm or 10° from the reference's relative pose."""

    from_reference: tuple[float, float]
    """Median distance from the reference [m, rad], which has its own error."""

    judged: int
    """Pairs of poses of two markers that have `MIN_PICTURES` pictures."""

    from_consensus: tuple[float, float]
    """Their median distance from the consensus of the same pair over all its pictures [m, rad]."""

    between_pictures: tuple[float, float]
    """Median difference of a pair's relative poses in two pictures [m, rad]."""

    inside: float
    """Share whose distance from the consensus the stated 95 % regions of both markers hold."""


def score_pairs(numbers: Sequence[int]) -> list[PairScore]:
    """Track each marker by itself in each photograph, by ours and by OpenCV."""
    verdicts: Counter[str] = Counter()
    ours, theirs = [], []
    detector = opencv_detector(DICTIONARY)
    for number in numbers:
        picture, found = photograph(number), {}
        for marker in all_corners()[number]:
            verdict, pose = tracked_marker(picture, camera(), marker, SIDE)
            verdicts[verdict] += 1
            if pose is not None:
                found[marker] = pose
        ours.append(found)
        squares = opencv_corners(detector, picture).items()
        poses = {each: marker_poses(square, camera())[0] for each, square in squares}
        theirs.append(
            {each: StatedPose(poses[each]) for each in poses if each in all_corners()[number]}
        )
    count = verdicts.total()
    return [
        _score(OURS, count, dict(verdicts), ours),
        _score("cv2 IPPE", count, {}, theirs),
    ]


def tracked_marker(
    picture: Picture, lens: Intrinsics, marker: int, side: float
) -> tuple[str, StatedPose | None]:
    """Our verdict on a marker with a side [m] without a past, and its pose if it is trusted."""
    cube = one_marker(marker, side)
    state, _ = show_until_decided(CubeTracker(cube, lens), picture)
    if not state.visible or state.camera_from_cube is None:
        return state.verdict, None
    cube_from_marker = se3.pose(np.eye(3), cube.faces[0].corners.mean(axis=0))
    return state.verdict, StatedPose(state.camera_from_cube, state.covariance).at(cube_from_marker)


def relative_poses(found: list[dict[int, StatedPose]]) -> Pairs:
    """Relative poses of each two markers, one for each picture that shows both."""
    pairs: Pairs = {}
    for poses in found:
        for one, other in combinations(sorted(poses), 2):
            pairs.setdefault((one, other), []).append(poses[one].relative(poses[other]))
    return pairs


def _score(
    tracker: str, markers: int, verdicts: dict[str, int], found: list[dict[int, StatedPose]]
) -> PairScore:
    pairs, from_reference, between = relative_poses(found), [], []
    deltas, chi2 = [np.zeros((0, 6))], []
    for (one, other), stated in pairs.items():
        start, end = (reference().body_from_marker[MARKERS.index(each)] for each in (one, other))
        truth = se3.inverse(start) @ end
        from_reference += [se3.delta(truth, each.pose) for each in stated]
        between += [se3.delta(a.pose, b.pose) for a, b in combinations(stated, 2)]
        if len(stated) >= MIN_PICTURES:
            each_delta, each_chi2 = deltas_from_consensus(stated)
            deltas.append(each_delta)
            chi2 += each_chi2
    judged, off = np.concatenate(deltas), np.array(from_reference)
    return PairScore(
        tracker,
        markers,
        sum(len(poses) for poses in found) / markers if markers else np.nan,
        verdicts,
        len(from_reference),
        int(np.count_nonzero(are_wrong(off))),
        medians(off),
        len(judged),
        medians(judged),
        medians(np.array(between)),
        share(np.array(chi2) <= CHI2_95_PERCENT),
    )

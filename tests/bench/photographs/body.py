"""The dodecahedron as one body: found in a single photograph, and followed."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.state import CubeState
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.bench.photographs.dodecahedron import DICTIONARY, body_model, photograph, reference
from tests.bench.photographs.marker_corners import Array, opencv_corners, opencv_detector
from tests.bench.photographs.scoring import (
    are_right,
    are_wrong,
    chi_square,
    high,
    medians,
    share,
    timed,
)
from tests.bench.photographs.variants import VARIANTS, View
from tests.bench.tracking.scoring import CHI2_95_PERCENT
from tests.bench.tracking.table import OURS, REFERENCE
from tests.tracking.showing import show_until_decided

FOLLOWED = "followed"
"""Name of the frames 2 to 6 of a photograph that is shown again and again."""

FOLLOWED_FRAMES = 5


@dataclass(frozen=True)
class BodyScore:
    """One tracker on all photographs in one variant. NaN where there is no measurement."""

    variant: str
    """Of `VARIANTS`, or `FOLLOWED`."""

    tracker: str
    """Title of the tracker."""

    frames: int
    """How many pictures were shown."""

    right: float
    """Share of the frames with a pose within 10 mm and 5° of the reference."""

    wrong: int
    """Frames with a pose more than 20 mm or 10° off."""

    given: float
    """Share of the frames with a pose; of ours, a trusted one."""

    shift: float
    """Median distance of the body's middle from the reference [m], of the poses given."""

    turn: float
    """The same of the angle [rad]."""

    inside: float
    """Share of the poses whose stated 95 % region holds the reference, which has its own error."""

    milliseconds: float
    """Median time of a picture, in all calls until it is decided."""

    ratio: float
    """Median of this time ÷ that of cv2's detection in the same picture."""

    high_ratio: float
    """95th percentile of the same."""

    call: float
    """Median time of a single call ÷ that of cv2's detection."""

    longest_call: float
    """The longest one ÷ that of cv2's detection."""


def score_body(variant: str, numbers: Sequence[int]) -> list[BodyScore]:
    """Find the body in each photograph without a past, by ours and by OpenCV."""
    cube, ours, theirs = body_model()[0], [], []
    for number in numbers:
        view, truth = VARIANTS[variant](photograph(number), number), _truth(number)
        state, calls = show_until_decided(CubeTracker(cube, view.lens), view.picture)
        pose, detection, whole = _opencv_pose(view)
        ours.append(_Answer.ours(state, truth, calls, detection))
        theirs.append(_Answer(_error(pose, truth), np.nan, whole, (whole / detection,)))
    return [_score(variant, OURS, ours), _score(variant, REFERENCE, theirs)]


def score_followed(numbers: Sequence[int]) -> BodyScore:
    """Show each photograph again after its body was found in it."""
    cube, answers = body_model()[0], []
    for number in numbers:
        view, truth = VARIANTS["as it is"](photograph(number), number), _truth(number)
        tracker = CubeTracker(cube, view.lens)
        if not tracker.update(Frame(view.picture, 0.0, 0)).visible:
            continue
        detection = _opencv_pose(view)[1]
        for index in range(1, FOLLOWED_FRAMES + 1):
            frame = Frame(view.picture, index / 30, index)
            state, seconds = timed(tracker.update, frame)
            answers.append(_Answer.ours(state, truth, [seconds], detection))
    return _score(FOLLOWED, OURS, answers)


@dataclass(frozen=True, eq=False)
class _Answer:
    """What one tracker said of one picture."""

    error: Array | None
    """Pose delta to the reference, (6,); None where no pose was given."""

    chi2: float
    """Its square in units of the stated standard deviations; NaN where none are stated."""

    seconds: float
    """Time taken, in all calls [s]."""

    calls: tuple[float, ...]
    """Time of each call ÷ that of cv2's detection."""

    @property
    def ratio(self) -> float:
        """Time of all calls ÷ that of cv2's detection."""
        return sum(self.calls)

    @classmethod
    def ours(
        cls, state: CubeState, truth: Array, calls: Sequence[float], detection: float
    ) -> "_Answer":
        error = _error(state.camera_from_cube if state.visible else None, truth)
        chi2 = np.nan if error is None else chi_square(error, state.covariance)
        return cls(error, chi2, sum(calls), tuple(each / detection for each in calls))


def _truth(number: int) -> Array:
    return np.asarray(reference().camera_from_body[number] @ body_model()[1], np.float64)


def _error(pose: Array | None, truth: Array) -> Array | None:
    return None if pose is None else se3.delta(pose, truth)


def _opencv_pose(view: View) -> tuple[Array | None, float, float]:
    """The pose by SUBPIX corners, SQPNP and Levenberg-Marquardt; time to detect, and in all [s]."""
    corners_of = {face.marker_id: face.corners for face in body_model()[0].faces}
    detector, lens = opencv_detector(DICTIONARY), view.lens
    seen, detection = timed(opencv_corners, detector, view.picture)
    known = {marker: square for marker, square in seen.items() if marker in corners_of}
    if not known:
        return None, detection, detection

    def solve() -> Array:
        points = np.concatenate([corners_of[marker] for marker in known])
        pixels, given = np.concatenate(list(known.values())), (lens.matrix, lens.distortion)
        _, turn, shift = cv2.solvePnP(points, pixels, *given, flags=cv2.SOLVEPNP_SQPNP)
        turn, shift = cv2.solvePnPRefineLM(points, pixels, *given, turn, shift)
        return se3.pose(se3.rotation(np.ravel(turn)), np.ravel(shift))

    pose, seconds = timed(solve)
    return pose, detection, detection + seconds


def _score(variant: str, tracker: str, answers: list[_Answer]) -> BodyScore:
    errors = np.array([each.error for each in answers if each.error is not None])
    calls = [call for each in answers for call in each.calls]
    frames, chi2 = len(answers), np.array([each.chi2 for each in answers])
    return BodyScore(
        variant,
        tracker,
        frames,
        np.count_nonzero(are_right(errors)) / frames if frames else np.nan,
        int(np.count_nonzero(are_wrong(errors))),
        len(errors) / frames if frames else np.nan,
        *medians(errors),
        share(chi2[~np.isnan(chi2)] <= CHI2_95_PERCENT),
        float(np.median([1e3 * each.seconds for each in answers])) if frames else np.nan,
        float(np.median([each.ratio for each in answers])) if frames else np.nan,
        high([each.ratio for each in answers]),
        float(np.median(calls)) if calls else np.nan,
        max(calls, default=np.nan),
    )

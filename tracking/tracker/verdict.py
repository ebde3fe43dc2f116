"""Which of the poses that one frame proposes is trusted, and why the others are not."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.cell_search import CellSearch
from cubeling.tracking.refinement.edge_search import EdgeSearch
from cubeling.tracking.refinement.footprint import Footprint
from cubeling.tracking.tracker.prediction import MAX_PREDICTION_S, Prediction, Track, TrackedPose

MIN_DISTINCT_ANGLE, MIN_HARMFUL_ANGLE, MIN_LASTING_ANGLE = np.deg2rad((3, 7, 10))
"""Angle between the two poses of one face [rad]: below the first they need not be told apart, below
the second both are accurate enough, below the third one can become the other unnoticed."""

MAX_POSE_SPREAD = (0.006, np.deg2rad(4.5))
"""A pose with a greater standard deviation than this is not trusted [m, rad]. A crisp marker of
20 mm that is 117 px wide has up to 4.2° square on, where its lean hardly shows and is small."""

MAX_LONE_FACE_SPEED = 0.65
"""A single face that moves faster than this [m/s] is too blurred to tell its distance."""

MAX_CHOICE_AGE_S, MAX_CHOICE_ANGLE = 0.07, np.deg2rad(15)
"""The track tells two poses of a face apart for so long after its last pose, and only where one of
them is as close as this to the predicted one [rad]."""

MAX_JUMP_CHECK_AGE_S = 1.0
"""After this time out of sight the cube may appear anywhere without confirmation."""


@dataclass(frozen=True)
class Past:
    """What the tracker remembers from one frame to the next."""

    track: Track = field(default_factory=Track)
    """The last trusted poses."""

    jump: TrackedPose | None = None
    """The last pose that was refused as a jump, until a pose is trusted again."""

    tilt_settled: bool = False
    """Whether it is known which way a single face tilts."""

    frames_lost: int = 0
    """How many frames were searched as a whole since a pose was trusted."""


@dataclass(frozen=True)
class Verdict:
    """The pose of one frame, or why there is none."""

    candidate: Candidate | None
    """The best pose; None where none was found."""

    refused: str
    """Why it is not trusted, as in `CubeState.refused`; "" where it is."""

    past: Past
    """What the tracker remembers, without this pose."""


class FollowedPoseJudge:
    """Judges poses found near the predicted one: a single face may tilt to the camera or away."""

    def __init__(
        self, cube: CubeModel, projection: Projection, edges: EdgeSearch, cells: CellSearch
    ) -> None:
        self._footprint = Footprint(cube, projection)
        self._edges = edges
        self._cells = cells

    def judge(self, candidate: Candidate, image: Image, tone: Floats, past: Past) -> Verdict:
        """Tell which way a face tilts: by its edges, else by its past, else not at all.

        Once the tilt is known it stays known until the face comes square to the camera, where one
        pose can become the other. `image` is (H, W, 3) BGR, `tone` the light for each grey value.
        """
        settled = replace(past, tilt_settled=True)
        if not candidate.lone:
            return Verdict(candidate, "", settled)
        unsettled = replace(past, tilt_settled=False)
        ambiguous = Verdict(candidate, "ambiguous", past)
        mirrored = self._edges.mirrored_pose(candidate)
        planar_ambiguity_angle = se3.angle_between(candidate.camera_from_cube, mirrored)
        if candidate.blur_motion is not None:
            if not past.tilt_settled:
                return ambiguous
            lasting = planar_ambiguity_angle > MIN_LASTING_ANGLE
            return Verdict(candidate, "", past if lasting else unsettled)
        if planar_ambiguity_angle < MIN_DISTINCT_ANGLE:
            return Verdict(candidate, "", unsettled)
        if past.tilt_settled and planar_ambiguity_angle > MIN_LASTING_ANGLE:
            return Verdict(candidate, "", past)
        patch = self._footprint.crop(image, candidate.camera_from_cube, tone)
        other = self._edges.search(patch, mirrored) if patch else None
        if other is None:
            return Verdict(candidate, "", past)
        if candidate.same_pose(other):
            return Verdict(candidate, "", unsettled)
        better = _better(candidate, other)
        if better is None:
            better = _better(*self._weigh(candidate, other, image, tone))
        if better:
            return Verdict(better, "", settled)
        if planar_ambiguity_angle < MIN_HARMFUL_ANGLE:
            return Verdict(candidate.widen_to(other), "", past)
        return ambiguous

    def _weigh(
        self, one: Candidate, other: Candidate, image: Image, tone: Floats
    ) -> tuple[Candidate, Candidate]:
        """Weigh two poses by all cells in view."""
        matches = [
            self._cells.search(image, each.camera_from_cube, tone, each.faces)
            for each in (one, other)
        ]
        first, second = (match.evidence if match else None for match in matches)
        return replace(one, evidence=first), replace(other, evidence=second)


def _better(one: Candidate, other: Candidate) -> Candidate | None:
    """Return the pose that is clearly better, if any."""
    if one.clearly_better_than(other):
        return one
    return other if other.clearly_better_than(one) else None


def is_uncertain(covariance: Array) -> bool:
    """Whether a pose may be off by more than a person would accept."""
    allowed = np.square(MAX_POSE_SPREAD)
    variances = covariance.diagonal().reshape(2, 3).sum(axis=1)
    if (variances <= allowed).all():  # no eigenvalue is more than their sum
        return False
    largest = np.linalg.eigvalsh([covariance[:3, :3], covariance[3:, 3:]])[:, -1]
    return bool((largest > allowed).any())


def is_unambiguous(candidates: Sequence[Candidate]) -> bool:
    """Whether the first pose is proved and no other comes close to it."""
    if not candidates:
        return False
    best, *others = candidates
    return best.certain and not any(best.is_ambiguous_with(other) for other in others)


def judge_detected(
    candidates: Sequence[Candidate], prediction: Prediction | None, past: Past, now: float
) -> Verdict:
    """Choose between poses found anywhere at a time [s], and refuse those that cannot be."""
    fitting = [each for each in candidates if _fits(each, prediction)]
    if not fitting:
        return Verdict(None, "", past)
    best, refused = _choose(fitting, prediction, past.track, now)
    if refused:
        return Verdict(best, refused, past)
    track = _continued_track(best, past, now)
    if track is None:
        jump = TrackedPose(best.camera_from_cube, np.zeros(6), best.covariance, now)
        return Verdict(best, "jump", replace(past, jump=jump))
    return Verdict(best, "", replace(past, track=track))


def _fits(candidate: Candidate, prediction: Prediction | None) -> bool:
    """Whether a pose that rests on a single marker is where the cube should be."""
    return (
        prediction is None
        or candidate.certain
        or not candidate.lone
        or prediction.covers(candidate.camera_from_cube)
    )


def _choose(
    candidates: Sequence[Candidate], prediction: Prediction | None, track: Track, now: float
) -> tuple[Candidate, str]:
    """Choose a pose; say why it is not trusted where the image does not prove it."""
    best, *others = sorted(candidates, key=lambda each: each.rank)
    if not best.certain:
        return best, "blurred" if best.blurred else "unproved"
    if best.lone:
        velocity = track.motion(best.camera_from_cube, best.covariance, now)[0]
        if np.linalg.norm(velocity[:3]) > MAX_LONE_FACE_SPEED:
            return best, "blurred"
    others = [each for each in others if best.is_ambiguous_with(each)]
    if not others:
        return best, ""
    if prediction is not None and now - track.poses[-1].timestamp < MAX_CHOICE_AGE_S:
        both = best, others[0]
        nearest = choose_nearest(
            prediction.camera_from_cube, [each.camera_from_cube for each in both]
        )
        if nearest is not None:
            return both[nearest], ""
    return best, "ambiguous"


def choose_nearest(expected: Array, poses: Sequence[Array]) -> int | None:
    """Return which of the poses of a face, (4, 4), continues the expected one; None if unclear."""
    near, *others = sorted(
        (se3.angle_between(expected, pose), number) for number, pose in enumerate(poses)
    )
    # Twice as far: with both about as near, the last pose would decide by its noise.
    clear = near[0] < MAX_CHOICE_ANGLE and all(far[0] > 2 * near[0] for far in others)
    return near[1] if clear else None


def _continued_track(candidate: Candidate, past: Past, now: float) -> Track | None:
    """Return the track that a pose continues, or that of the jump it confirms; None for a jump."""
    if not past.track.poses:
        return past.track
    pose, last, jump = candidate.camera_from_cube, past.track.poses[-1], past.jump
    if now - last.timestamp > MAX_JUMP_CHECK_AGE_S:
        return past.track
    # A leap is believed at its second sight: a wrong pose seldom comes twice at one place.
    if jump and now - jump.timestamp <= MAX_PREDICTION_S and jump.reaches(pose, now):
        return Track((jump,))
    return past.track if last.reaches(pose, now) else None

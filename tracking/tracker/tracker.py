"""From camera frames to where the cube is: what one frame proposes, weighed against the past."""

import numpy as np
from numpy.typing import NDArray

from tracking.cube.model import CubeModel
from tracking.detection.markers import MarkerDetector
from tracking.errors import TrackingError
from tracking.geometry import se3
from tracking.geometry.frame import Frame
from tracking.geometry.image_region import Patch
from tracking.geometry.intrinsics import Intrinsics
from tracking.geometry.projection import Projection
from tracking.geometry.state import CubeState
from tracking.tracker import prediction
from tracking.tracker.candidate import Candidate, close, decisive, doubled
from tracking.tracker.global_search import Acquirer, Search
from tracking.tracker.local_search import Follower
from tracking.tracker.prediction import MEMORY, Sighting, Track

Array = NDArray[np.float64]

PATIENT, RARELY = 30, 5
"""Frames without the cube in which it is sought by covered markers too, and how rarely then."""

SQUARE, HARMLESS, ALIKE = np.deg2rad(10), np.deg2rad(7), np.deg2rad(3)
"""Two poses of one face that differ by less than the first may be taken for each other by time,
those that differ by less than the second are both right enough, and those that differ by less than
the third need not be told apart."""

UNSURE = (0.006, np.deg2rad(3.0))
"""A pose with a greater standard deviation than this is not given out [m, rad]."""

LONE_SPEED = 0.65
"""A single face that moves faster than this [m/s] is too blurred to tell how far away it is."""

FRESH = 0.07
"""The past tells two poses of a face apart no longer than this [s]."""

FORGOTTEN = 1.0
"""After this time out of sight [s] the cube may appear anywhere without confirmation."""


class CubeTracker:
    """Follows one cube through the frames of one camera.

    Parameters
    ----------
    cube
        The cube, as printed.
    intrinsics
        The camera; every frame must have its size.

    Notes
    -----
    There is no smoothing filter: a pose rests on its own frame alone, so it has no lag.
    The past is used to look in the right place, to choose between the two poses of a single face,
    and to distrust jumps.
    """

    def __init__(self, cube: CubeModel, intrinsics: Intrinsics) -> None:
        self.cube = cube
        self.intrinsics = intrinsics
        projection = Projection(intrinsics)
        self._detectors = {cube.dictionary: MarkerDetector(cube.dictionary)}
        self._follower = Follower(cube, projection)
        self._acquirer = Acquirer(cube, projection, self._follower)
        self._track = Track()
        self._jump: Sighting | None = None
        self._settled = False
        self._missed = 0

    def update(self, frame: Frame) -> CubeState:
        """Find the cube in the next frame.

        Raises
        ------
        TrackingError
            The frame has not the size that the intrinsics hold for.
        """
        self.check(frame)
        followed = self.follow(frame)
        if followed is not None:
            return followed
        return self.acquire(frame, Search(frame, self._detectors))

    def predict(self, timestamp: float) -> CubeState:
        """Say where the cube will be, or was, at a time near that of the last frame.

        The velocity is carried on; see `tracking/README.md` for how far off that is.
        """
        return self._unseen(timestamp, "")

    def follow(self, frame: Frame) -> CubeState | None:
        """Find the cube near where it should be; None where it is not found there."""
        now = frame.timestamp
        found = self._follower.follow(frame.image, self._track, now)
        if found is None:
            return None
        if len(found.faces) != 1:
            self._settled = True
            return self._seen(found, now)
        found, refused = self._settle(frame, found)
        return self._unseen(now, refused) if refused else self._seen(found, now)

    def _settle(self, frame: Frame, found: Candidate) -> tuple[Candidate, str]:
        """Tell which way a single face leans: by its edges, else by time, else not at all.

        Once that is settled it stays so until the face comes square to the camera, where it can
        pass from one to the other.
        """
        if found.sweep is not None:
            return found, "" if self._settled else "ambiguous"
        lean = se3.angle_between(found.camera_from_cube, self._follower.other(found))
        if lean < ALIKE:
            self._settled = False
            return found, ""
        if self._settled and lean > SQUARE:
            return found, ""
        region = self._follower.region(found.camera_from_cube)
        patch = Patch.of(frame.image, region, self._follower.camera.tone) if region else None
        other = self._follower.mirrored(patch, found) if patch else None
        if other is None or close(found, other):
            self._settled &= other is None
            return found, ""
        best, worse = sorted((found, other), key=lambda each: each.residual)
        if decisive(best, worse):
            self._settled = True
            return best, ""
        if lean < HARMLESS:
            return doubled(found, other), ""
        return found, "ambiguous"

    def acquire(self, frame: Frame, search: Search) -> CubeState:
        """Find the cube anywhere in a frame.

        Parameters
        ----------
        frame
            The frame, of the right size.
        search
            The markers in it.
        """
        now = frame.timestamp
        recent = self._track.recent(now)
        expected = prediction.predicted(recent, now) if recent else None
        self._missed += 1
        thorough = self._missed <= PATIENT or self._missed % RARELY == 0
        candidates = self._acquirer.find(search, expected, thorough)
        if recent is not None:
            candidates = [each for each in candidates if _fits(each, recent, now)]
        if not candidates:
            return self._unseen(now, "")
        candidate, refused = self._chosen(candidates, recent, now)
        if not refused and not self._confirmed(candidate, now):
            refused = "jump"
        return self._unseen(now, refused) if refused else self._seen(candidate, now)

    def check(self, frame: Frame) -> None:
        """Raise a `TrackingError` where a frame has not the intrinsics' size."""
        height, width = frame.image.shape[:2]
        if (width, height) != self.intrinsics.size:
            wanted = "×".join(str(n) for n in self.intrinsics.size)
            raise TrackingError(
                f"frame {frame.index} is {width}×{height} but the intrinsics hold for {wanted}; "
                "scale them or calibrate at this size"
            )

    def _chosen(
        self, candidates: list[Candidate], recent: Sighting | None, now: float
    ) -> tuple[Candidate, str]:
        """Choose between the poses that explain the same markers, or say why none is trusted."""
        best, *others = sorted(candidates, key=lambda candidate: candidate.residual)
        if not best.certain:
            return best, "blurred" if best.blurred else "unproved"
        if len(best.faces) == 1 and self._speed(best, now) > LONE_SPEED:
            return best, "blurred"
        if not others or close(best, others[0]):
            return best, ""
        other = others[0]
        if decisive(best, other):
            return best, ""
        if recent is not None and now - recent.timestamp < FRESH:
            expected = prediction.predicted(recent, now)
            near, far = sorted(
                (se3.angle_between(expected, each.camera_from_cube), number)
                for number, each in enumerate((best, other))
            )
            if near[0] < np.deg2rad(15) and far[0] > 2 * near[0]:
                return (best, other)[near[1]], ""
        return best, "ambiguous"

    def _speed(self, candidate: Candidate, now: float) -> float:
        """Speed at which the cube must have come from where it was last seen [m/s]."""
        velocity = self._track.motion(candidate.camera_from_cube, candidate.covariance, now)[0]
        return float(np.linalg.norm(velocity[:3]))

    def _confirmed(self, candidate: Candidate, now: float) -> bool:
        """Whether a hand can have brought the cube there, or a second frame says so too."""
        pose, jump, last = candidate.camera_from_cube, self._jump, self._track.last
        if last is None or now - last.timestamp > FORGOTTEN:
            return True
        if jump and now - jump.timestamp <= MEMORY and prediction.plausible(jump, pose, now):
            # It stayed where it jumped to: that is its past now.
            self._track.restart(jump)
            return True
        if prediction.plausible(last, pose, now):
            return True
        self._jump = Sighting(pose, np.zeros(6), candidate.covariance, now)
        return False

    def _seen(self, candidate: Candidate, now: float) -> CubeState:
        pose = candidate.camera_from_cube
        velocity, change = self._track.motion(pose, candidate.covariance, now)
        if _unsure(candidate.covariance):
            # What the poses before say of now is better than this.
            return self._unseen(now, "unsure")
        self._track.add(Sighting(pose, velocity, candidate.covariance, now, change))
        self._jump = None
        self._missed = 0
        return CubeState(
            visible=True,
            camera_from_cube=pose,
            velocity=velocity,
            covariance=candidate.covariance,
            source=candidate.source,
            faces=candidate.faces,
            reprojection_error=candidate.error,
            timestamp=now,
        )

    def _unseen(self, now: float, refused: str) -> CubeState:
        """Carry the last pose on for a moment, ever less sure of it."""
        recent = self._track.recent(now)
        unknown = np.full((6, 6), np.nan)
        return CubeState(
            visible=False,
            camera_from_cube=prediction.predicted(recent, now) if recent else None,
            velocity=prediction.velocity_at(recent, now) if recent else np.zeros(6),
            covariance=prediction.predicted_covariance(recent, now) if recent else unknown,
            source="predicted",
            faces=(),
            reprojection_error=np.nan,
            timestamp=now,
            refused=refused,
        )


def _fits(candidate: Candidate, last: Sighting, timestamp: float) -> bool:
    """Whether a pose that rests on a single marker is where the cube should be."""
    return (
        candidate.certain
        or len(candidate.faces) > 1
        or prediction.near(last, candidate.camera_from_cube, timestamp)
    )


def _unsure(covariance: Array) -> bool:
    """Whether a pose may well be off by more than a person would forgive."""
    shift = np.linalg.eigvalsh(covariance[:3, :3])[-1]
    turn = np.linalg.eigvalsh(covariance[3:, 3:])[-1]
    return bool(shift > UNSURE[0] ** 2 or turn > UNSURE[1] ** 2)

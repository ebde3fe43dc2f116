"""The tracker of one cube: stages that hand on values, from a camera frame to the cube's state."""

from dataclasses import replace

import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.markers import MarkerDetector, markers_of
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.geometry.state import CubeState
from cubeling.tracking.refinement.blur_search import BlurSearch
from cubeling.tracking.refinement.camera_model import CameraModel
from cubeling.tracking.refinement.cell_search import CellSearch
from cubeling.tracking.refinement.edge_search import EdgeSearch
from cubeling.tracking.refinement.lens_estimate import LensEstimate
from cubeling.tracking.refinement.systematic_error import SystematicError
from cubeling.tracking.single_thread import on_one_thread
from cubeling.tracking.tracker.frame_markers import FrameMarkers
from cubeling.tracking.tracker.global_search import GlobalDetector, Search
from cubeling.tracking.tracker.learned_camera import LearnedCamera
from cubeling.tracking.tracker.local_search import LocalMatch, LocalTracker
from cubeling.tracking.tracker.measured_lens import track_through
from cubeling.tracking.tracker.prediction import Prediction, Track, TrackedPose
from cubeling.tracking.tracker.rest import Rest
from cubeling.tracking.tracker.verdict import (
    MAX_CHOICE_AGE_S,
    FollowedPoseJudge,
    Past,
    Verdict,
    is_uncertain,
    judge_detected,
)

MAX_THOROUGH_FRAMES, THOROUGH_INTERVAL = 30, 5
"""Frames without the cube in which partly hidden markers are detected, then the interval."""


class CubeTracker:
    """Tracks one cube through the frames of one camera.

    Parameters
    ----------
    cube
        The cube, as printed.
    intrinsics
        The camera; every frame must have its size.
    camera
        What is learned of that camera, where several trackers share it.

    Notes
    -----
    There is no smoothing filter: the pose of a cube that moves rests on its own frame alone, so it
    has no lag. While nothing but noise tells its poses apart, the cube is at rest, and its pose is
    their mean. The past says where to look, chooses between the two poses of a single face, and
    refuses jumps.
    """

    def __init__(
        self, cube: CubeModel, intrinsics: Intrinsics, camera: LearnedCamera | None = None
    ) -> None:
        self.cube = cube
        self._detectors = {cube.dictionary: MarkerDetector(cube.dictionary)}
        self._camera = camera or LearnedCamera(intrinsics)
        self._number = self._camera.add(cube)
        self._past = Past()
        self._look_through(intrinsics)

    def reprint(self, cube: CubeModel) -> None:
        """Take the cube as it is printed, not as was thought; what is known of the camera stays.

        `cube` has the same dictionary and faces of the same names.
        """
        self.cube = cube
        self._past = Past()
        self._camera.reprint(self._number, cube)
        self._look_through(self.intrinsics)

    def _look_through(self, intrinsics: Intrinsics) -> None:
        """Take another lens; what depends on none, and the track, is kept."""
        cube = self.cube
        self.intrinsics = intrinsics
        """The camera; its focal length is measured in play where it was guessed."""
        projection = Projection(intrinsics)
        edges = EdgeSearch(cube, projection)
        blur = BlurSearch(cube, projection, edges)
        cells = CellSearch(cube, projection)
        self._local_tracker = LocalTracker(cube, projection, edges, cells, blur)
        self._followed_pose_judge = FollowedPoseJudge(cube, projection, edges, cells)
        self._global_detector = GlobalDetector(cube, projection, edges, cells, blur)
        self._systematic_error = SystematicError(cube, projection)
        self._rest = Rest()
        self._search: Search | None = None

    @property
    def measured_intrinsics(self) -> Intrinsics:
        """The camera, with its focal length as well as it is known after this frame."""
        return self._camera.measured.best

    @property
    def lens(self) -> LensEstimate:
        """What the poses so far tell of the lens, besides what the intrinsics claim."""
        return self._camera.lens.estimate

    @property
    def searching(self) -> bool:
        """Whether the search of a picture goes on in the next call."""
        return self._search is not None

    @property
    def readout(self) -> float:
        """Time that a rolling shutter takes from the first row to the last [s]; 0 if not known."""
        return self._camera.estimator.model.readout

    @on_one_thread
    def update(self, frame: Frame, markers: FrameMarkers | None = None) -> CubeState:
        """Find the cube in the next frame, whose `markers` several trackers may share.

        Raises
        ------
        TrackingError
            The size of the frame is not that of the intrinsics.
        """
        self._check_size(frame)
        self._camera.begin(frame)
        self._take_lens(self._camera.intrinsics)
        image, now, past = frame.image, frame.timestamp, self._past

        # Predict where the cube should be, by its last poses.
        prediction = past.track.predict(now)

        # Search there, by the edges or else by the blurred image; both help to estimate the camera.
        match, camera = LocalMatch(), self._camera.estimator
        if prediction is not None:
            match = self._local_tracker.search(image, past.track, prediction, camera.model)
            if match.candidate is None:
                # A marker may show where the cube has gone from there.
                markers = markers or FrameMarkers(frame, self._detectors)
                match = self._search_at_marker(markers, prediction, camera.model) or match
            camera.learn(match.blur, match.studied)
        tone = camera.model.tone

        if match.candidate is not None:
            self._search = None
            if not self._camera.measured.trusts_edges:
                self._learn_lens(markers or FrameMarkers(frame, self._detectors))
            # Judge the pose: a single face may tilt either way.
            verdict = self._followed_pose_judge.judge(match.candidate, image, tone, past)
        else:
            # Search the whole image: detect markers, and refine the poses that they propose.
            past = replace(past, frames_lost=past.frames_lost + 1)
            thorough = past.frames_lost <= MAX_THOROUGH_FRAMES
            thorough |= past.frames_lost % THOROUGH_INTERVAL == 0
            markers = markers or FrameMarkers(frame, self._detectors)
            expected = prediction.camera_from_cube if prediction else None
            search = self._global_detector.search(markers, expected, tone, thorough, self._search)
            self._search = None if search.decided else search
            if not search.flat:
                self._learn_lens(markers)
            if search.flat or not search.decided:
                self._past = past
                return self._predict(now, "flat" if search.flat else "searching")
            # Judge the poses: which one is it, and can a hand have moved the cube there?
            verdict = judge_detected(search.found, prediction, past, now)
            if search.frame is not frame and not self._global_detector.holds(search, frame):
                return self._await(verdict, search, markers)

        # Add a trusted pose to the track, with its velocity; else keep predicting.
        self._past = verdict.past
        found, track = verdict.candidate, verdict.past.track
        if found is None or verdict.refused:
            return self._predict(now, verdict.refused)
        pose, noise = found.camera_from_cube, found.covariance
        by_corners, lens_shifts = self._systematic_error.covariance(
            pose, found.faces, self._camera.lens.k1_error, found.blur, found.lone_residual
        )
        if is_uncertain(noise + by_corners):
            return self._predict(now, "unsure")
        if found.edges is not None:
            self._camera.learn_edges(self._number, pose, found.faces, found.edges)
        velocity, acceleration = track.motion(pose, noise, now)
        if found.edges is not None:
            camera.readout.learn(found.edges, velocity, self.intrinsics.size[1])
        systematic = by_corners + lens_shifts @ lens_shifts.T
        track = track.add(TrackedPose(pose, velocity, noise, now, acceleration, systematic))
        self._past = replace(verdict.past, track=track, jump=None, frames_lost=0)
        # State the mean of the poses while the cube rests.
        self._rest = self._rest.add(pose, noise, now)
        mean, mean_noise = self._rest.pose()
        return CubeState(
            visible=True,
            camera_from_cube=mean,
            velocity=velocity,
            covariance=mean_noise + systematic,
            source=found.source,
            faces=found.faces,
            reprojection_error=found.error,
            timestamp=now,
            focal_scale=self._camera.measured.scale,
            focal_shift=lens_shifts[:, 1],
        )

    def _learn_lens(self, markers: FrameMarkers) -> None:
        """Learn the focal length from the corners of markers, unless it is known.

        Whether or not a pose is trusted: a wrong lens is a reason why none is.
        """
        if self._camera.measured.learns:
            seen = markers.read(self.cube.dictionary, "first window")
            self._camera.learn_corners(self._number, markers_of(self.cube, seen))

    def _take_lens(self, intrinsics: Intrinsics) -> None:
        """Look through the lens that play has measured, if it differs from the one in use."""
        before = self.intrinsics
        if intrinsics is not before:
            self._look_through(intrinsics)
            track = track_through(self._past.track, self.cube, before, intrinsics)
            self._past = replace(self._past, track=track, jump=None)

    def _predict(self, now: float, refused: str) -> CubeState:
        """Return the state of a cube that is not seen, with a covariance that grows."""
        prediction = self._past.track.predict(now)
        covariance = np.full((6, 6), np.nan)
        if prediction:
            covariance = prediction.covariance + prediction.systematic
        return CubeState(
            visible=False,
            camera_from_cube=prediction.camera_from_cube if prediction else None,
            velocity=prediction.velocity if prediction else np.zeros(6),
            covariance=covariance,
            source="predicted",
            faces=(),
            reprojection_error=np.nan,
            timestamp=now,
            refused=refused,
            focal_scale=self._camera.measured.scale,
        )

    def _search_at_marker(
        self, markers: FrameMarkers, prediction: Prediction, camera: CameraModel
    ) -> LocalMatch | None:
        """Search where a marker shows a cube that has left its predicted pose; None if none does.

        The track tells its lean: it must be as young as for `judge_detected`.
        """
        track, frame = self._past.track, markers.frame
        last = track.poses[-1]
        if frame.timestamp - last.timestamp >= MAX_CHOICE_AGE_S:
            return None
        start = self._global_detector.carry(prediction.camera_from_cube, markers)
        if start is None or not last.reaches(start, frame.timestamp):
            return None
        there = replace(prediction, camera_from_cube=start)
        match = self._local_tracker.search(frame.image, track, there, camera, crisp=True)
        return match if match.candidate else None

    def _await(self, verdict: Verdict, search: Search, markers: FrameMarkers) -> CubeState:
        """Look from the next frame on near a pose that was found in an earlier picture.

        Something has moved there since: the cube has to be found again to be trusted. Where the
        newest frame shows a marker, that is where the cube is by now.
        """
        found, past, now = verdict.candidate, verdict.past, markers.frame.timestamp
        if found is None or verdict.refused:
            self._past = past
            return self._predict(now, verdict.refused)
        pose, still = found.camera_from_cube, np.zeros(6)
        before = TrackedPose(pose, still, found.covariance, search.frame.timestamp)
        carried = self._global_detector.carry(pose, markers)
        if carried is not None and before.reaches(carried, now):
            pose = carried
        awaited = TrackedPose(pose, still, found.covariance, now)
        # Both leans of a single face were weighed.
        self._past = replace(past, track=Track((awaited,)), jump=None, tilt_settled=True)
        return self._predict(now, "searching")

    def give_up(self, timestamp: float) -> CubeState:
        """Return the state of a frame in which `update` raised an error, refused as "failed".

        The track is forgotten, as it may be what led to the error: the next frame is searched as
        the first one is. What is known of camera and lens is kept.
        """
        self._past, self._rest, self._search = Past(), Rest(), None
        return self._predict(timestamp, "failed")

    def predict(self, timestamp: float) -> CubeState:
        """Return where the cube will be shortly after the last frame, by extrapolation."""
        return self._predict(timestamp, "")

    def _check_size(self, frame: Frame) -> None:
        height, width = frame.image.shape[:2]
        if (width, height) != self.intrinsics.size:
            wanted = "×".join(str(n) for n in self.intrinsics.size)
            raise TrackingError(
                f"frame {frame.index} is {width}×{height} but the intrinsics hold for {wanted}; "
                "scale them or calibrate at this size"
            )

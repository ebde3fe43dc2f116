"""The focal length of a camera that nobody calibrated, measured in play from the cube's faces.

A longer lens shows a cube that is farther away nearly alike: only the perspective differs, by which
the near side of a marker is larger than its far side, and one face than another. So a picture tells
little, and pictures from other sides add to it. The pose of each picture, the growth of white over
black, the folds of the cube and a little distortion are unknown as well. All are solved together in
a bundle adjustment, which eliminates what is of one picture alone by the Schur complement (Triggs
et al., 2000, section 6.1).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array, Indices
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import MIN_DEPTH
from cubeling.tracking.geometry.robust_statistics import quantile
from cubeling.tracking.refinement.face_corners import FaceCorners
from cubeling.tracking.refinement.lens_estimate import FOLD_SPREAD, FocalLength

K1_SPREAD, BLOOM_PX = 0.15, 0.5
"""Standard deviations before anything is measured: of the radial distortion, and of how far white
grows over black [px]."""

PRINT_SPREAD_M, BEND_SPREAD_M = 0.00012, 0.0002
"""The same of a marker's corner on its paper, and of how far bent paper lifts it [m]. All pictures
have these and `FOLD_SPREAD` in common, so many pictures do not make them small."""

NOISE_M = 0.00005
"""What differs of them from picture to picture, as a hand presses on the paper [m]."""

NEW_PLACE, NEW_ANGLE = 0.05, np.deg2rad(4)
"""Only a pose that differs by so much from all that were counted tells anything new: in place, as a
share of the distance, or in rotation [rad]."""

MIN_BETTER = 1.5
"""A view replaces those from the same side whose corners have errors this many times its own."""

MIN_FACE_PX = 15.0
"""The perspective of narrower markers is lost in the errors of their corners."""

MAX_VIEWS = 100
"""Pictures that are counted at most: those of some twenty seconds of play."""

MAX_STEPS, MAX_CHANGE = 8, 0.4
"""Steps of Gauss and Newton's method, and the largest change of the logarithm of the focal length
in one of them."""

MAX_RESIDUAL_PX, MAX_RESIDUAL_SHARE = 1.0, 0.02
"""Corners of the cube lie within this of their places in the median, or within this share of a
marker's side, whichever is more: those of a flat sheet do not."""

MAX_SCALE = 3.0
"""No camera's focal length differs by such a factor from a guess."""

LEAST_DEVIATION = 0.006
"""Smallest standard deviation that is stated, as a share: all pictures show the same folded
cube."""


@dataclass(frozen=True, eq=False)
class _Views:
    """The pictures that are counted, as arrays with room for all faces in each of V pictures."""

    poses: Array
    """Pose of the cube in each, (V, 4, 4)."""

    blooms: Array
    """How far white grows over black in each, (V,) [px]."""

    pixels: Array
    """Corners in the image, (V, F, 4, 2) [px]."""

    inward: Array
    """How white that grows by a pixel moves them, (V, F, 4, 2)."""

    errors: Array
    """Error of the corners of each face [px], infinite where it is not seen, (V, F)."""

    @classmethod
    def none(cls, faces: int) -> "_Views":
        """Return no views yet, of a cube with so many faces."""
        pixels = np.empty((0, faces, 4, 2))
        return cls(np.empty((0, 4, 4)), np.empty(0), pixels, pixels, np.empty((0, faces)))

    def add(self, pose: Array, seen: Sequence[tuple[int, FaceCorners]]) -> "_Views":
        """Return the views with one more."""
        faces = self.errors.shape[1]
        pixels, inward = np.zeros((2, faces, 4, 2))
        errors = np.full(faces, np.inf)
        for number, each in seen:
            pixels[number], inward[number] = each.corners, _inward(each.corners)
            errors[number] = each.error_px
        return _Views(
            np.concatenate([self.poses, pose[None]]),
            np.append(self.blooms, 0.0),
            np.concatenate([self.pixels, pixels[None]]),
            np.concatenate([self.inward, inward[None]]),
            np.concatenate([self.errors, errors[None]]),
        )

    @property
    def worst(self) -> Array:
        """Largest error of a corner in each, (V,) [px]."""
        return np.asarray(np.where(np.isfinite(self.errors), self.errors, 0.0).max(axis=1))

    def without(self, numbers: Indices) -> "_Views":
        """Return the views without some of them."""
        all_of_them = (self.poses, self.blooms, self.pixels, self.inward, self.errors)
        return _Views(*(np.delete(each, numbers, axis=0) for each in all_of_them))

    def least_depth(self, corners: Array) -> float:
        """Return the least depth of the corners of the cube, (F, 4, 3), in any of them [m]."""
        depths = (self.poses[:, 2:3, :3] @ corners.reshape(-1, 3).T)[:, 0]
        return float((depths + self.poses[:, 2, 3:]).min())

    def move(self, changes: Array) -> "_Views":
        """Return the views with poses and blooms that differ by (V, 7)."""
        poses = [
            se3.apply_delta(pose, change)
            for pose, change in zip(self.poses, changes[:, :6], strict=True)
        ]
        return replace(self, poses=np.stack(poses), blooms=self.blooms + changes[:, 6])


@dataclass(frozen=True, eq=False)
class _Body:
    """One of the cubes."""

    numbers: dict[str, int]
    """Number of each face by its name."""

    corners: Array
    """Corners of its markers where they should be, (F, 4, 3) [m]."""

    unknowns: Indices
    """Which of the shared unknowns bear on its pictures, (4 + 12 F,)."""


@dataclass(frozen=True, eq=False)
class _Equations:
    """Those of the pictures of one cube, without what is of one picture alone."""

    information: Array
    """Of the K unknowns that bear on the cube, (K, K)."""

    score: Array
    """Their right side, (K,)."""

    solved: Array
    """How a picture's own unknowns follow those, and what they are without them, (V, 7, K + 1)."""

    residual: Array
    """Residuals [px], (V, 8 F)."""

    weights: Array
    """Their weights, (V, 8 F)."""

    def own_changes(self, step: Array) -> Array:
        """Return how the own unknowns of each change, (V, 7), by a step of the others, (K,)."""
        return np.asarray(self.solved[..., -1] - self.solved[..., :-1] @ step, np.float64)


class FocalLengthEstimator:
    """Collects what the faces of cubes say of the focal length of one camera.

    Parameters
    ----------
    cubes
        The cubes, as printed; each picture that is learned from shows one of them.
    intrinsics
        The camera, whose `focal_deviation` is the doubt before anything is measured.
    """

    def __init__(self, cubes: Sequence[CubeModel], intrinsics: Intrinsics) -> None:
        self._matrix, self._distortion = intrinsics.matrix, intrinsics.distortion
        assert intrinsics.focal_deviation is not None, "a stated focal length is not measured"
        centre = [max(intrinsics.centre_deviation, 1.0)] * 2
        blocks = [
            np.diag(1 / np.square([intrinsics.focal_deviation, K1_SPREAD, *centre])),
            *(np.linalg.inv(_shape_covariance(face)) for cube in cubes for face in cube.faces),
        ]
        self._prior = np.zeros((sum(map(len, blocks)),) * 2)
        start = 0
        for block in blocks:
            end = start + len(block)
            self._prior[start:end, start:end] = block
            start = end
        self._shared = np.zeros(len(self._prior))
        """Logarithm of the scale, k1, how far the principal point is from where it is said to be
        [px], and each corner from its place [m], (4 + 12 F,) with the faces F of all cubes."""
        ends = np.cumsum([4, *(12 * len(cube.faces) for cube in cubes)])
        self._bodies = tuple(
            _Body(
                {face.name: number for number, face in enumerate(cube.faces)},
                np.stack([face.corners for face in cube.faces]),
                np.append(np.arange(4), np.arange(start, end)),
            )
            for cube, start, end in zip(cubes, ends[:-1], ends[1:], strict=True)
        )
        self._views = tuple(_Views.none(len(cube.faces)) for cube in cubes)
        self.estimate = FocalLength(1.0, intrinsics.focal_deviation)
        """The best estimate."""

    @property
    def done(self) -> bool:
        """Whether nothing more is learned."""
        return self.estimate.known or sum(len(each.poses) for each in self._views) >= MAX_VIEWS

    def learn(self, faces: Sequence[FaceCorners], cube: int = 0) -> None:
        """Learn from the faces of a cube in one picture, if they show anything new.

        `cube` is its number; each face is given at most once.
        """
        large = [each for each in faces if each.width > MIN_FACE_PX]
        if self.done or len(large) < 2:
            return
        body, views = self._bodies[cube], list(self._views)
        pose = self._pose(large, body)
        if pose is None or not self.wants(pose, max(each.error_px for each in large), cube):
            return
        # What was detected before the lens was known is replaced by what edges show more exactly.
        seen = [(body.numbers[each.face], each) for each in large]
        views[cube] = views[cube].without(self._near(pose, cube)).add(pose, seen)
        self._solve(views, cube)

    def wants(self, camera_from_cube: Array, error_px: float, cube: int = 0) -> bool:
        """Whether a picture of a cube at a pose, (4, 4), can tell anything new.

        `error_px` is the error of its corners.
        """
        near = self._near(camera_from_cube, cube)
        worst = self._views[cube].worst[near]
        return not len(near) or bool((worst > MIN_BETTER * error_px).all())

    def _camera(self, shared: Array) -> Array:
        scale = np.exp(shared[0])
        camera = self._matrix * [[scale, 1, 1], [1, scale, 1], [1, 1, 1]]
        camera[:2, 2] += shared[2:4]
        return np.asarray(camera, np.float64)

    def _pose(self, faces: Sequence[FaceCorners], body: _Body) -> Array | None:
        """Find the pose of a cube at the present focal length; None where there is none."""
        points = np.concatenate([body.corners[body.numbers[each.face]] for each in faces])
        pixels = np.concatenate([each.corners for each in faces])
        lens = self._camera(self._shared), self._distortion
        found, turn, shift = cv2.solvePnP(points, pixels, *lens, flags=cv2.SOLVEPNP_SQPNP)
        if not found:
            return None
        turn, shift = cv2.solvePnPRefineLM(points, pixels, *lens, turn, shift)
        if not (np.isfinite(turn).all() and np.isfinite(shift).all()):
            return None
        return se3.pose(se3.rotation(np.ravel(turn)), np.ravel(shift))

    def _near(self, pose: Array, cube: int) -> Indices:
        """Numbers of the views that show a cube from nearly the same side."""
        if not len(self._views[cube].poses):
            return np.empty(0, np.intp)
        deltas = se3.deltas(pose, self._views[cube].poses)
        places, angles = np.linalg.norm(deltas.reshape(-1, 2, 3), axis=2).T
        near = (places < NEW_PLACE * abs(pose[2, 3])) & (angles < NEW_ANGLE)
        return np.flatnonzero(near)

    def _solve(self, views: list[_Views], newest: int) -> None:
        """Adjust all views of all cubes together.

        They are kept unless the last one, of the `newest` cube, is not of the whole cube.
        """
        shared = self._shared
        for _ in range(MAX_STEPS):
            information, score = self._prior.copy(), -self._prior @ shared
            equations = {
                number: self._equations(each, self._bodies[number], shared)
                for number, each in enumerate(views)
                if len(each.poses)
            }
            for number, found in equations.items():
                unknowns = self._bodies[number].unknowns
                information[np.ix_(unknowns, unknowns)] += found.information
                score[unknowns] += found.score
            inverse = np.asarray(np.linalg.inv(information), np.float64)
            step = inverse @ score
            step *= min(1.0, MAX_CHANGE / max(abs(float(step[0])), 1e-9))
            shared = shared + step
            for number, found in equations.items():
                body = self._bodies[number]
                views[number] = views[number].move(found.own_changes(step[body.unknowns]))
                if views[number].least_depth(body.corners) < MIN_DEPTH:
                    return
            if abs(step[0]) < 0.1 * np.sqrt(inverse[0, 0]):
                break
        last = equations[newest]
        if abs(shared[0]) > np.log(MAX_SCALE):
            return
        if not _fits(last.residual[-1], last.weights[-1], views[newest]):
            return
        square = sum(float((each.weights * each.residual**2).sum()) for each in equations.values())
        numbers = sum(np.count_nonzero(each.weights) for each in equations.values())
        freedom = 2.0 * numbers - 14 * sum(len(each.poses) for each in views)
        chi = square / max(freedom / 2, 1.0)
        deviation = float(np.sqrt(inverse[0, 0] * max(chi, 1.0)))
        self._views, self._shared = tuple(views), shared
        self.estimate = FocalLength(float(np.exp(shared[0])), max(deviation, LEAST_DEVIATION))

    def _equations(self, views: _Views, body: _Body, shared: Array) -> "_Equations":
        """Return the equations of the pictures of one cube, by the unknowns that bear on it."""
        shared = shared[body.unknowns]
        residual, own, common, weights = self._linearise(views, body, shared)
        weighted = own * weights[..., None]
        normal = np.swapaxes(weighted, 1, 2) @ own
        normal[:, range(6), range(6)] += 1e-3  # keeps it solvable
        normal[:, 6, 6] += 1 / BLOOM_PX**2
        right = (weighted * residual[..., None]).sum(axis=1)
        right[:, 6] -= views.blooms / BLOOM_PX**2
        cross = np.swapaxes(weighted, 1, 2) @ common
        solved = np.linalg.solve(normal, np.concatenate([cross, right[..., None]], axis=2))
        flat, unknowns = common.reshape(-1, len(shared)), len(shared)
        information = flat.T @ (flat * weights.reshape(-1, 1))
        information -= cross.reshape(-1, unknowns).T @ solved[..., :-1].reshape(-1, unknowns)
        score = flat.T @ (weights * residual).ravel()
        score -= np.einsum("vij,vi->j", cross, solved[..., -1])
        return _Equations(information, score, solved, residual, weights)

    def _linearise(
        self, views: _Views, body: _Body, shared: Array
    ) -> tuple[Array, Array, Array, Array]:
        """Return residuals [px], their two Jacobians, and their weights, each for (V, 8 F) numbers.

        The Jacobians are those by a view's own unknowns, (V, 8 F, 7), and by the shared ones that
        bear on the cube, (V, 8 F, 4 + 12 F).
        """
        count, faces = views.errors.shape
        points = body.corners.reshape(-1, 3) + shared[4:].reshape(-1, 3)
        rotations = views.poses[:, :3, :3]
        arms = points @ np.swapaxes(rotations, 1, 2)
        camera, zero = self._camera(shared), np.zeros(3)
        distortion = self._distortion + shared[1] * np.eye(len(self._distortion))[0]
        placed = (arms + views.poses[:, None, :3, 3]).reshape(-1, 3)
        pixels, by_all = cv2.projectPoints(placed, zero, zero, camera, distortion)
        # OpenCV's columns: turn (3), shift (3), fx, fy, cx, cy, k1 …
        by_point = by_all[:, 3:6].reshape(count, -1, 2, 3)
        by_focal = by_all[:, 6] * camera[0, 0] + by_all[:, 7] * camera[1, 1]
        inward = views.inward.reshape(count, -1, 2)
        residual = views.pixels.reshape(count, -1, 2) - pixels.reshape(count, -1, 2)
        residual = residual - views.blooms[:, None, None] * inward
        own = np.concatenate(
            [by_point, -by_point @ se3.hat(arms), inward[..., None]], axis=3
        ).reshape(count, -1, 7)
        common = np.zeros((count, 4 * faces, 2, 4 + 12 * faces))
        common[..., 0] = by_focal.reshape(count, -1, 2)
        common[..., 1] = by_all[:, 10].reshape(count, -1, 2)
        common[..., 2:4] = np.eye(2)
        in_cube = by_point @ rotations[:, None]
        for corner in range(4 * faces):
            common[:, corner, :, 4 + 3 * corner : 7 + 3 * corner] = in_cube[:, corner]
        paper = NOISE_M * camera[0, 0] / views.poses[:, 2, 3:]
        sigmas = np.repeat(np.hypot(views.errors, paper), 8, axis=1)
        flat = residual.reshape(count, -1)
        # Huber's weights: a corner under a finger counts less.
        weights = 1 / (sigmas**2 * np.maximum(1.0, np.abs(flat) / (2 * sigmas)))
        flat = np.where(np.isfinite(sigmas), flat, 0.0)
        weights = np.where(np.isfinite(sigmas), weights, 0.0)
        return flat, own, common.reshape(count, 8 * faces, -1), weights


def _fits(residual: Array, weights: Array, views: _Views) -> bool:
    """Whether the corners of the last view lie as those of a cube; both arguments (8 F,)."""
    seen = np.isfinite(views.errors[-1])
    corners = views.pixels[-1][seen]
    side = float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())
    off = quantile(np.abs(residual[weights > 0]), 0.5)
    return off < max(MAX_RESIDUAL_PX, MAX_RESIDUAL_SHARE * side)


def _shape_covariance(face: Face) -> Array:
    """Covariance of how far the corners of a face are from their places, (12, 12) [m²]."""
    arms = face.corners - face.corners.mean(axis=0)
    by_fold = np.concatenate([np.tile(np.eye(3), (4, 1)), -se3.hat(arms).reshape(12, 3)], axis=1)
    along = PRINT_SPREAD_M**2 * np.eye(3)
    out = (BEND_SPREAD_M**2 - PRINT_SPREAD_M**2) * np.outer(face.normal, face.normal)
    fold = by_fold * np.repeat(FOLD_SPREAD, 3)
    return np.asarray(fold @ fold.T + np.kron(np.eye(4), along + out), np.float64)


def _inward(corners: Array) -> Array:
    """How corners move where white grows by a pixel at both of their sides, (4, 2) [px]."""
    after, before = np.roll(corners, -1, axis=0) - corners, np.roll(corners, 1, axis=0) - corners
    after /= np.linalg.norm(after, axis=1, keepdims=True)
    before /= np.linalg.norm(before, axis=1, keepdims=True)
    sine = np.abs(after[:, 0] * before[:, 1] - after[:, 1] * before[:, 0])
    return np.asarray((after + before) / np.maximum(sine, 0.2)[:, None], np.float64)

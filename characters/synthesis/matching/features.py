"""What frames of motions are compared by: the pose of the body, and where it will go.

All features are in the frame of the root: its place on the ground and its heading.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Skeleton

ROW_RATE_HZ = 30.0
"""Rate at which the frames of a motion are compared [Hz]; motions play at any rate."""

HORIZONS_S = (1 / 3, 2 / 3, 1.0)
"""Times ahead at which the path is compared [s]."""

_EXTRAPOLATED_FROM_S = 0.4  # a motion that ends goes on as in its last part


@dataclass(frozen=True)
class FeatureJoints:
    """The joints of a skeleton that features are taken from."""

    hips: int
    """Index of the joint that carries the body."""

    feet: tuple[int, ...]
    """Left and right ankle."""

    hands: tuple[int, ...]
    """Left and right hand; empty without hands."""


def clip_features(clip: Clip, skeleton: Skeleton, joints: FeatureJoints) -> dict[str, Array]:
    """Return the features of a clip with root motion by name, (rows, …), at `ROW_RATE_HZ`.

    Positions are in metres, velocities in metres a second over the ground. "path" is (x, z) and
    "facing" the direction (x, z) of the root at each of `HORIZONS_S`. A clip that ends goes on as
    in its last part; a loop repeats.
    """
    local = clip.in_place.globals(skeleton)[..., :3, 3]
    path = _RootPath.of(clip)
    velocities = _rate_of_change(local, clip) + path.velocity_at(local)
    feet, hands, hips = list(joints.feet), list(joints.hands), [joints.hips]
    by_frame = {
        "feet": local[:, feet],
        "foot velocities": velocities[:, feet],
        "hips velocity": velocities[:, hips],
        "hands": local[:, hands],
        "hand velocities": velocities[:, hands],
    }
    rows = row_times(clip) * clip.rate
    features = {name: _at(each.reshape(len(clip), -1), rows) for name, each in by_frame.items()}
    return features | path.ahead(rows)


def row_times(clip: Clip) -> Array:
    """Return the times of a clip at which its frames are compared, (rows,) [s].

    >>> from cubeling.characters.skeleton.pose import Pose
    >>> clip = Clip("c", 60.0, Pose(np.zeros((7, 1, 3)), np.zeros((7, 1, 4))), loop=False)
    >>> row_times(clip).round(3).tolist()
    [0.0, 0.033, 0.067, 0.1]
    """
    count = math.floor(clip.duration * ROW_RATE_HZ + 1e-6) + 1
    if clip.loop and count > 1:
        count = math.ceil(clip.duration * ROW_RATE_HZ - 1e-6)  # the end is the start
    times: Array = np.arange(count) / ROW_RATE_HZ
    return times


@dataclass(frozen=True)
class _RootPath:
    """How the root of a clip moves, and goes on after the end."""

    steps: Array  # from each frame to the next, (frames − 1, 3): x, z [m] halfway turned, yaw [rad]
    rate: float  # [Hz]
    loop: bool

    @staticmethod
    def of(clip: Clip) -> "_RootPath":
        steps = np.diff(clip.track, axis=0)
        halfway = (clip.track[1:, 2] + clip.track[:-1, 2]) / 2
        steps[:, :2] = _turn(steps[:, :2], -halfway)
        return _RootPath(steps, clip.rate, clip.loop)

    def velocity_at(self, positions: Array) -> Array:
        """Return the velocities of points fixed to the root, (frames, joints, 3) [m/s]."""
        first, last = (-1, 0) if self.loop else (0, -1)
        before = np.concatenate([self.steps[[first]], self.steps])
        after = np.concatenate([self.steps, self.steps[[last]]])
        x, z, yaw = ((before + after) / 2 * self.rate).T[:, :, None]
        velocities = np.zeros_like(positions)
        velocities[..., 0] = x + yaw * positions[..., 2]
        velocities[..., 2] = z - yaw * positions[..., 0]
        return velocities

    def ahead(self, frames: Array) -> dict[str, Array]:
        """Return the path and the facing ahead of frames (rows,), each (rows, 2 per horizon)."""
        count = math.ceil(max(HORIZONS_S) * self.rate) + 1
        if self.loop:
            more = np.resize(self.steps, (count, 3))
        else:
            last = self.steps[-max(round(_EXTRAPOLATED_FROM_S * self.rate), 1) :]
            more = np.tile(last.mean(0), (count, 1))
        steps = np.concatenate([self.steps, more])
        yaw = np.concatenate([[0.0], np.cumsum(steps[:, 2])])
        walked = np.cumsum(_turn(steps[:, :2], (yaw[1:] + yaw[:-1]) / 2), axis=0)
        place = np.concatenate([np.zeros((1, 2)), walked])
        here, heading = _at(place, frames), _at(yaw[:, None], frames)[:, 0]
        path, facing = [], []
        for horizon in HORIZONS_S:
            later = frames + horizon * self.rate
            path.append(_turn(_at(place, later) - here, -heading))
            turn = _at(yaw[:, None], later)[:, 0] - heading
            facing.append(np.stack([np.sin(turn), np.cos(turn)], axis=-1))
        return {"path": np.concatenate(path, 1), "facing": np.concatenate(facing, 1)}


def _rate_of_change(values: Array, clip: Clip) -> Array:
    """Return the derivative of values (frames, …) [1/s]."""
    if clip.loop:
        values = np.concatenate([values[-2:-1], values, values[1:2]])
        change: Array = (values[2:] - values[:-2]) * (clip.rate / 2)
        return change
    slopes: Array = np.gradient(values, axis=0) * clip.rate
    return slopes


def _turn(vectors: Array, yaw: Array) -> Array:
    """Return vectors (n, 2) of x and z, turned about +y by angles (n,)."""
    flat = np.zeros((len(vectors), 3))
    flat[:, [0, 2]] = vectors
    return rotations.rotate(rotations.about("y", yaw), flat)[:, [0, 2]]


def _at(values: Array, frames: Array) -> Array:
    """Return values (frames, n), interpolated at fractional frames."""
    before = np.minimum(frames.astype(int), len(values) - 2)
    u = (frames - before)[:, None]
    mixed: Array = values[before] * (1 - u) + values[before + 1] * u
    return mixed


@dataclass(frozen=True)
class FeatureSpace:
    """Features of many frames, scaled so that squared distances compare them."""

    columns: Mapping[str, slice]
    """Columns of each feature."""

    mean: Array
    """Mean of each column, (columns,)."""

    scale: Array
    """What each column is multiplied with, (columns,)."""

    values: Array
    """The scaled features, (rows, columns)."""

    @staticmethod
    def of(features: Sequence[Mapping[str, Array]], weights: Mapping[str, float]) -> "FeatureSpace":
        """Return the space of the features of clips, each weighted and scaled to unit variance.

        The columns of one feature have one scale, so that its directions stay comparable.
        """
        columns: dict[str, slice] = {}
        parts: list[Array] = []
        scales: list[Array] = []
        for name, weight in weights.items():
            part = np.concatenate([each[name] for each in features])
            begin = sum(map(len, scales))
            columns[name] = slice(begin, begin + part.shape[1])
            spread = float(np.sqrt(part.var(0).mean()))
            scales.append(np.full(part.shape[1], weight / spread if spread > 1e-6 else 0.0))
            parts.append(part)
        raw, scale = np.concatenate(parts, 1), np.concatenate(scales)
        mean: Array = raw.mean(0)
        return FeatureSpace(columns, mean, scale, (raw - mean) * scale)

    def scale_feature(self, name: str, feature: Array) -> Array:
        """Return one feature, scaled as the columns of that name."""
        own = self.columns[name]
        scaled: Array = (feature - self.mean[own]) * self.scale[own]
        return scaled

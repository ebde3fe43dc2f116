"""Fingers that hold the benchmark's cube: capsules that lie on its faces."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tests.bench.tracking.light import UP, Light
from tests.bench.tracking.paper import BenchmarkCube, Side
from tests.bench.tracking.paths import minimum_jerk

SKIN_ALBEDO_BGR = np.array([0.30, 0.42, 0.66], np.float32)
"""Share of the light that skin throws back (BGR)."""


@dataclass(frozen=True, eq=False)
class Finger:
    """A capsule in the cube frame, from the hand to the tip, on one face."""

    side: str
    """Name of the face that it lies on; it is seen where that face is."""

    normal: NDArray[np.float64]
    """Normal of that face, (3,)."""

    root: NDArray[np.float64]
    """Middle of the capsule's end outside the face [m], (3,)."""

    tip: NDArray[np.float64]
    """Middle of the capsule's other end [m], (3,)."""

    radius: float
    """Radius [m]."""

    @property
    def around(self) -> NDArray[np.float64]:
        """Corners of boxes that hold both ends, (16, 3)."""
        signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, 8).T
        return np.concatenate([end + signs * self.radius for end in (self.root, self.tip)])

    def in_view(self, pose: NDArray[np.float64]) -> bool:
        """Whether its face looks at the camera when the cube is at `pose` (4, 4)."""
        tip = pose[:3, :3] @ self.tip + pose[:3, 3]
        return bool(tip @ pose[:3, :3] @ self.normal < 0)


def lay_fingers(
    cube: BenchmarkCube, hand: NDArray[np.float64], random: np.random.Generator
) -> tuple[Finger, ...]:
    """Lay one finger on every face, over the corner of the marker that is nearest to the hand.

    Parameters
    ----------
    cube
        What is held.
    hand
        Direction from the cube to the hand in the cube frame, (3,).
    random
        How far each finger reaches in, and how thick it is.
    """
    return tuple(_finger(cube, side, hand, random) for side in cube.sides)


def _finger(
    cube: BenchmarkCube, side: Side, hand: NDArray[np.float64], random: np.random.Generator
) -> Finger:
    # A small cube is held by the tips of fingers: they reach less far in, and are thinner there.
    size = cube.edge / 0.06
    radius = random.uniform(0.0075, 0.0095) * (0.6 + 0.4 * size)
    flat = hand - (hand @ side.normal) * side.normal
    away = flat / np.linalg.norm(flat)
    corner = side.corners[np.argmax(side.corners @ hand)]
    lift = side.normal * radius * 0.9
    # The tip reaches past the corner, so that skin covers the corner and some of the cells by it.
    tip = corner - away * random.uniform(0.002, 0.010) * size + lift
    root = corner + away * (cube.edge * 0.9) + lift - side.normal * 0.35 * cube.edge
    knuckle = corner + away * (cube.edge / 3) + lift
    return Finger(side.name, side.normal, 0.4 * root + 0.6 * knuckle, tip, radius)


@dataclass(frozen=True, eq=False)
class FingerMotion:
    """Fingers that lie on the cube from the start, or come within the first ten frames."""

    fingers: tuple[Finger, ...] = ()
    """Where they lie in the end."""

    hand: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    """Direction from the cube to the hand in the cube frame, (3,)."""

    start: bool = True
    """Whether they lie there from the start."""

    def __call__(self, time: float) -> tuple[Finger, ...]:
        """Fingers at `time` [s]."""
        if self.start:
            return self.fingers
        way = 0.09 * (1 - float(minimum_jerk(np.array([time]), 0.03, 0.27)[0]))
        return tuple(pulled_back(finger, self.hand, way) for finger in self.fingers)


def pulled_back(finger: Finger, hand: NDArray[np.float64], way: float) -> Finger:
    """Return the finger pulled back by `way` [m] towards the hand."""
    flat = hand - (hand @ finger.normal) * finger.normal
    shift = way * flat / np.linalg.norm(flat)
    return Finger(
        finger.side, finger.normal, finger.root + shift, finger.tip + shift, finger.radius
    )


def draw_fingers(
    fingers: tuple[Finger, ...],
    pose: NDArray[np.float64],
    aim: NDArray[np.float32],
    light: Light,
    box_of: Callable[[NDArray[np.float64]], tuple[slice, slice]],
) -> NDArray[np.float32]:
    """Light on the skin that rays `aim` (h, w, 2) meet, (h, w); 0 where they meet none.

    A capsule is drawn as the tapered stripe that it is on the plane at depth 1, nearest last.
    `box_of` tells the rows and columns of `aim` that hold points of the camera frame.
    """
    skin = np.zeros(aim.shape[:2], np.float32)
    ends = {
        finger.side: np.stack([finger.root, finger.tip]) @ pose[:3, :3].T + pose[:3, 3]
        for finger in fingers
    }
    for finger in sorted(fingers, key=lambda finger: -float(ends[finger.side][1, 2])):
        if finger.in_view(pose):
            box = box_of(finger.around @ pose[:3, :3].T + pose[:3, 3])
            _draw_capsule(ends[finger.side], finger.radius, aim[box], light, skin[box])
    return skin


def _draw_capsule(
    ends: NDArray[np.float64],
    radius: float,
    aim: NDArray[np.float32],
    light: Light,
    skin: NDArray[np.float32],
) -> None:
    flat = (ends[:, :2] / ends[:, 2:]).astype(np.float32)
    wide = (radius / ends[:, 2]).astype(np.float32)
    along = flat[1] - flat[0]
    x, y = aim[..., 0] - flat[0, 0], aim[..., 1] - flat[0, 1]
    share = np.clip((x * along[0] + y * along[1]) / max(float(along @ along), 1e-12), 0, 1)
    x -= share * along[0]
    y -= share * along[1]
    width = wide[0] + share * (wide[1] - wide[0])
    x /= width
    y /= width
    height = 1 - x * x - y * y
    met = height > 0
    facing = np.sqrt(height[met])
    # Normals of a round surface that looks at the camera.
    lamp = np.clip(x[met] * light.lamp[0] + y[met] * light.lamp[1] - facing * light.lamp[2], 0, 1)
    sky = 0.5 + 0.5 * (x[met] * UP[0] + y[met] * UP[1] - facing * UP[2])
    skin[met] = light.bounce + light.power * lamp + light.sky * sky

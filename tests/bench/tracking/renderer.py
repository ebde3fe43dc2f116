"""Renders the benchmark's images by ray casting, with motion blur over the exposure.

Each sub-pixel casts one ray in each of many passes. Each pass has its own time within the exposure,
so motion blur follows the actual path, rotation included; there is no rolling shutter. Light is
linear up to the sensor.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from tests.bench.tracking.hand import SKIN_ALBEDO_BGR, Finger, draw_fingers
from tests.bench.tracking.light import Light
from tests.bench.tracking.optics import SUBPIXELS, LensModel, sampled
from tests.bench.tracking.paper import BenchmarkCube, Side
from tests.bench.tracking.paths import Poses

PAPER_TINT_BGR = np.array([0.97, 1.0, 1.0], np.float32)
"""Colour of the paper (BGR): a little warm."""

WHITE_LEVEL = 0.75
"""Linear light in the picture of a perfectly white surface under light 1."""

MIN_PASSES, MAX_PASSES = 24, 56
"""Passes for a cube at rest, and maximum for a moving one.

With 10, the random rays alone moved the tracked pose at rest by 0.065 mm (a frontal face, one
standard deviation), nearly as much as the sensor noise; with 24, by 0.02 mm.
"""

MARGIN_PX = 6
"""Pixels rendered round the cube: reach of the lens blur, and of distorted edges."""


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything a frame shows, except noise."""

    lens: LensModel
    """The camera."""

    cube: BenchmarkCube
    """What it looks at."""

    light: Light
    """What falls on the cube."""

    background: Callable[[], NDArray[np.float32]]
    """Linear light of all that does not move, blurred by the lens, (height, width, 3) BGR."""

    poses: Poses
    """Where the cube is at any time."""

    fingers: Callable[[float], tuple[Finger, ...]]
    """The fingers at a time [s], in the cube frame."""

    brightness: float = 1.0
    """How bright the picture is: gain and light together."""

    skin: NDArray[np.float32] = field(default_factory=lambda: SKIN_ALBEDO_BGR)
    """Share of the light that the fingers and patches on the cube throw back, (3,) BGR."""


@dataclass(frozen=True)
class ImageWindow:
    """The region of the image that is rendered for each frame."""

    left: int
    top: int
    right: int
    bottom: int

    @property
    def pixels(self) -> tuple[slice, slice]:
        """Rows and columns of the picture."""
        return slice(self.top, self.bottom), slice(self.left, self.right)

    @property
    def fine(self) -> tuple[slice, slice]:
        """Rows and columns of the sub-pixels."""
        return (
            slice(self.top * SUBPIXELS, self.bottom * SUBPIXELS),
            slice(self.left * SUBPIXELS, self.right * SUBPIXELS),
        )


def expose(
    scene: Scene, middle: float, exposure: float, random: np.random.Generator
) -> NDArray[np.float32]:
    """Linear light (H, W, 3) that falls on the sensor; 1 is white.

    Parameters
    ----------
    scene
        What there is to see.
    middle, exposure
        Middle and length of the exposure [s].
    random
        Where the rays of a pixel lie is drawn from it.
    """
    picture = scene.background().copy()
    ends = scene.poses(middle + np.array([-0.5, 0.0, 0.5]) * exposure)
    passes = _passes(scene, ends)
    times = middle + exposure * ((np.arange(passes) + 0.5) / passes - 0.5)
    poses = scene.poses(times)
    fingers = tuple(
        finger for finger in scene.fingers(middle) if any(finger.in_view(pose) for pose in ends)
    )
    solids = scene.cube.vertices
    reach = [solids, *(finger.around for finger in fingers)]
    window = _window(scene.lens, np.concatenate(reach), np.concatenate([poses, ends]))
    if window is None:
        return picture * np.float32(scene.brightness)
    layers = _gather(scene, window, poses, fingers, random)
    spread = scene.lens.spread(float(ends[1, 2, 3]))
    blurred = cv2.filter2D(layers, cv2.CV_32F, spread, borderType=cv2.BORDER_REPLICATE)
    share, paper, hand, skin = cv2.split(
        cv2.resize(blurred, None, fx=1 / SUBPIXELS, fy=1 / SUBPIXELS, interpolation=cv2.INTER_AREA)
    )
    fall = scene.lens.vignette[window.pixels] * np.float32(WHITE_LEVEL)
    part = picture[window.pixels]
    part *= (1 - share - hand)[..., None]
    part += (paper * fall)[..., None] * PAPER_TINT_BGR + (skin * fall)[..., None] * scene.skin
    return picture * np.float32(scene.brightness)


def _passes(scene: Scene, ends: NDArray[np.float64]) -> int:
    """Number of passes for at most 0.7 pixels between two of them."""
    corners = np.einsum("nij,kj->nki", ends[:, :3, :3], scene.cube.vertices) + ends[:, None, :3, 3]
    seen = scene.lens.project(corners)
    smear = np.linalg.norm(np.diff(seen, axis=0), axis=-1).sum(0).max()
    return int(np.clip(np.ceil(smear / 0.7), MIN_PASSES, MAX_PASSES))


def _window(
    lens: LensModel, points: NDArray[np.float64], poses: NDArray[np.float64]
) -> ImageWindow | None:
    """Box of the picture that holds `points` (n, 3) at all `poses`, or None if out of view."""
    there = np.einsum("nij,kj->nki", poses[:, :3, :3], points) + poses[:, None, :3, 3]
    seen = lens.project(there).reshape(-1, 2)
    first = np.maximum(np.floor(seen.min(0)).astype(int) - MARGIN_PX, 0)
    last = np.minimum(np.ceil(seen.max(0)).astype(int) + MARGIN_PX + 1, lens.size)
    if (first >= last).any():
        return None
    return ImageWindow(int(first[0]), int(first[1]), int(last[0]), int(last[1]))


def _gather(
    scene: Scene,
    window: ImageWindow,
    poses: NDArray[np.float64],
    fingers: tuple[Finger, ...],
    random: np.random.Generator,
) -> NDArray[np.float32]:
    """Mean of all passes (h, w, 4): share and light of the paper, share and light of the skin."""
    rays = scene.lens.rays[window.fine]
    spacing = np.float32(1 / (SUBPIXELS * scene.lens.matrix[0, 0]))
    jitter = random.random(rays.shape, np.float32)
    total = np.zeros((4, *rays.shape[:2]), np.float32)
    covered = bool(fingers) or any(side.patch is not None for side in scene.cube.sides)

    def box_of(points: NDArray[np.float64]) -> tuple[slice, slice]:
        return _box(scene.lens.project(points), window)

    shift = (np.arange(len(poses))[:, None] * R2_STEPS + random.random(2)) % 1
    for pose, offset in zip(poses, shift.astype(np.float32), strict=True):
        aim = jitter + offset
        aim -= np.floor(aim)
        aim -= np.float32(0.5)
        aim *= spacing
        aim += rays
        seen, skin = np.zeros((2, *rays.shape[:2]), np.float32)
        for side in scene.cube.sides:
            _draw_side(scene, side, pose, aim, seen, skin, box_of)
        if fingers:
            np.maximum(skin, draw_fingers(fingers, pose, aim, scene.light, box_of), out=skin)
        if covered:
            hand = _hit(skin)
            seen *= 1 - hand
            total[2] += hand
            total[3] += skin
        total[0] += _hit(seen)
        total[1] += seen
    total /= np.float32(len(poses))
    return np.asarray(cv2.merge(list(total)), np.float32)


def _hit(seen: NDArray[np.float32]) -> NDArray[np.float32]:
    """1 where a ray met something that throws light back, else 0."""
    return np.asarray(cv2.threshold(seen, 0, 1, cv2.THRESH_BINARY)[1], np.float32)


R2_STEPS = np.array([0.7548776662466927, 0.5698402909980532])
"""Steps of the R2 sequence (Roberts 2018): points in a square that keep apart."""


def _draw_side(
    scene: Scene,
    side: Side,
    pose: NDArray[np.float64],
    aim: NDArray[np.float32],
    seen: NDArray[np.float32],
    skin: NDArray[np.float32],
    box_of: Callable[[NDArray[np.float64]], tuple[slice, slice]],
) -> None:
    """Write the light of `side` into `seen` (h, w), where the rays `aim` hit it.

    What falls on the patch that covers it goes into `skin` (h, w).
    """
    place = pose[:3, :3] @ side.place
    place[:, 2] += pose[:3, 3]
    normal = pose[:3, :3] @ side.normal
    count = len(side.albedo)
    edge = np.array([(-0.5, -0.5), (count - 0.5, -0.5), (count - 0.5,) * 2, (-0.5, count - 0.5)])
    corners = np.c_[edge, np.ones(4)] @ place.T
    if normal @ corners[0] >= 0:  # faces away
        return
    box = box_of(corners)
    # A ray (x, y, 1) meets the plane where place @ (column, row, 1) is parallel to it.
    grid = np.asarray(cv2.perspectiveTransform(aim[box], np.linalg.inv(place)), np.float32)
    if side.relief is not None:
        upright = np.c_[place[:, :2], normal]
        slope = np.asarray(cv2.perspectiveTransform(aim[box], np.linalg.inv(upright)), np.float32)
        grid = side.relief.met(grid, slope, count)
    light: NDArray[np.float32] | np.float32
    if scene.light.is_even:
        light = np.float32(sum(scene.light.even(normal)))
    else:
        light = scene.light.on(normal, place, grid)
    value = sampled(side.albedo, grid, smooth=False) * light
    np.maximum(seen[box], value, out=seen[box])
    if side.patch is not None:
        laid = sampled(side.patch, grid, smooth=False) * light
        np.maximum(skin[box], laid, out=skin[box])


def _box(pixels: NDArray[np.float64], window: ImageWindow) -> tuple[slice, slice]:
    """Rows and columns of a window's sub-pixels that hold `pixels` (n, 2)."""
    origin = np.array([window.left, window.top])
    first = np.maximum(np.floor(pixels.min(0)).astype(int) - 3 - origin, 0) * SUBPIXELS
    last = np.maximum(np.ceil(pixels.max(0)).astype(int) + 4 - origin, 0) * SUBPIXELS
    return slice(int(first[1]), int(last[1])), slice(int(first[0]), int(last[0]))

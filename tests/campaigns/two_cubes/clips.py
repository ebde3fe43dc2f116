"""Clips of two cubes that cross, are covered by hands, and are swapped, drawn with their truth."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.tracking import CubeModel, Frame
from cubeling.tracking.geometry import se3
from tests.tracking.drawn import CAMERA, Array, Light, photograph, scene

FRAMES_PER_CLIP, RATE_HZ = 32, 30.0
"""Frames of a clip, and how many a second."""

KINDS = ("crossing", "covering", "swap")
"""What happens in a clip: they take turns."""

OUTLINE_PX = 2
"""By so many pixels it is told what of a cube is in view."""

Mask = NDArray[np.uint8]

Poses = tuple[Array | None, Array | None]
"""Where each cube is, (4, 4); None where it is not before the camera."""


@dataclass(frozen=True)
class Hand:
    """A hand in the picture."""

    middle: Array
    """Of its palm [px], (2,)."""

    size: float
    """Width of the palm [px]."""

    angle: float
    """Direction of the arm in the picture [rad]."""


@dataclass(frozen=True)
class Moment:
    """One frame of a clip."""

    frame: Frame
    """What the camera shows."""

    poses: Poses
    """Where the cubes are."""

    shares: tuple[float, float]
    """Which share of each one's outline is in view, 0…1."""


@cache
def cubes() -> tuple[CubeModel, ...]:
    """Return the bundled cubes of a first and of a second player."""
    names = ("locomotion", "companion", "locomotion-2", "companion-2")
    return tuple(CubeModel.load(name) for name in names)


def smooth(share: float) -> float:
    """Return how far a hand has come that starts and stops at rest, 0…1."""
    share = min(max(share, 0.0), 1.0)
    return share * share * (3 - 2 * share)


def draw_clip(seed: int, number: int) -> tuple[tuple[CubeModel, CubeModel], Iterator[Moment]]:
    """Return two cubes and the frames of a clip; it depends on its seed and number alone."""
    rng = np.random.default_rng((seed, number))
    first, second = rng.choice(len(cubes()), 2, replace=False).tolist()
    pair = (cubes()[first], cubes()[second])
    kind = KINDS[number % len(KINDS)]
    script = {"crossing": _crossing, "covering": _covering, "swap": _swap}[kind](rng)
    return pair, (_moment(pair, script, each, seed + number) for each in _times(rng, kind))


Script = Callable[[float], tuple[Poses, tuple[Hand, ...]]]
"""Where cubes and hands are at a time of the clip, 0…1."""


def _times(rng: np.random.Generator, kind: str) -> Iterator[tuple[int, float, float]]:
    """Yield the number, the time [s] and the share of the clip of each frame; some are lost."""
    lost = range(0)
    if rng.random() < 0.3:
        start = int(rng.integers(8, 22))
        lost = range(start, start + int(rng.integers(1, 9)))
    pause = float(rng.choice([0.0, 0.4, 1.5])) if kind == "swap" else 0.0
    for index in range(FRAMES_PER_CLIP):
        if index not in lost:
            late = pause if index > FRAMES_PER_CLIP // 2 else 0.0
            yield index, index / RATE_HZ + late, index / (FRAMES_PER_CLIP - 1)


def _turn(rng: np.random.Generator) -> Callable[[float], Array]:
    """Return the rotation of a cube that is turned in a hand, by the share of the clip."""
    axis = rng.normal(size=3)
    start = se3.rotation(axis / np.linalg.norm(axis) * rng.uniform(0, np.pi))
    step = rng.normal(size=3)
    step *= rng.choice([0.0, 0.4, 1.5]) / np.linalg.norm(step)
    return lambda share: np.asarray(se3.rotation(smooth(share) * step) @ start, np.float64)


def _crossing(rng: np.random.Generator) -> Script:
    """One cube passes in front of the other, once or to and fro, each held by a hand or not."""
    turns = _turn(rng), _turn(rng)
    near = rng.uniform(0.26, 0.36)
    depths = near, near + rng.uniform(0.09, 0.2)
    side, heights = rng.choice([-1, 1]), rng.normal(0, 0.012, 2)
    reach = rng.uniform(0.07, 0.12)
    sways = int(rng.choice([1, 2]))
    held = rng.random(2) < 0.5

    def script(share: float) -> tuple[Poses, tuple[Hand, ...]]:
        way = smooth(sways * share) if sways * share <= 1 else smooth(2 - sways * share)
        x = side * reach * (1 - 2 * way)
        places = [np.array([s * x, y, z]) for s, y, z in zip((1, -1), heights, depths, strict=True)]
        poses = tuple(se3.pose(turn(share), p) for turn, p in zip(turns, places, strict=True))
        # A hand below a cube covers a third of it.
        hands = [
            Hand(_pixel(p + (0, 0.035, 0)), 0.035 * _scale(p), np.pi / 2)
            for p, is_held in zip(places, held, strict=True)
            if is_held
        ]
        return (poses[0], poses[1]), tuple(hands)

    return script


def _covering(rng: np.random.Generator) -> Script:
    """A hand covers one cube or both; meanwhile they stay, are moved, or are taken away."""
    turns, places = (_turn(rng), _turn(rng)), _beside_each_other(rng)
    covered = (0, 1) if rng.random() < 0.4 else (int(rng.integers(2)),)
    act, size = rng.choice(["stay", "move", "leave"]), rng.choice([0.6, 1.0, 1.5])
    drift, returns = rng.normal(0, 0.025, (2, 3)), rng.random() < 0.7
    begin, end = rng.uniform(0.2, 0.3), rng.uniform(0.6, 0.8)

    def script(share: float) -> tuple[Poses, tuple[Hand, ...]]:
        poses: list[Array | None] = []
        for number, place in enumerate(places):
            way = smooth((share - begin) / (end - begin)) if number in covered else 0.0
            at = place + way * drift[number] * (act == "move")
            away = act == "leave" and number in covered and share > (begin + end) / 2
            away = away and not (returns and share > end + 0.1)
            poses.append(None if away else se3.pose(turns[number](share), at))
        over = smooth((share - begin) / 0.2) - smooth((share - end) / 0.2)
        hands = [_over(places[n] + drift[n] * (act == "move") / 2, size, over) for n in covered]
        return (poses[0], poses[1]), tuple(hands)

    return script


def _swap(rng: np.random.Generator) -> Script:
    """The cubes change places between two frames: under hands, or while no frame comes."""
    turns, places = (_turn(rng), _turn(rng)), _beside_each_other(rng)
    size, covered = rng.choice([0.8, 1.2, 1.6]), rng.random() < 0.7

    def script(share: float) -> tuple[Poses, tuple[Hand, ...]]:
        ordered = places if share <= 0.51 else places[::-1]
        poses = [se3.pose(turn(share), p) for turn, p in zip(turns, ordered, strict=True)]
        over = smooth((share - 0.25) / 0.2) - smooth((share - 0.6) / 0.2)
        hands = [_over(place, size, over) for place in places] if covered else []
        return (poses[0], poses[1]), tuple(hands)

    return script


def _beside_each_other(rng: np.random.Generator) -> Array:
    """Return the places of two cubes, (2, 3) [m]."""
    depths, heights = rng.uniform(0.3, 0.5, 2), rng.normal(0, 0.02, 2)
    sides = rng.permutation([-1.0, 1.0]) * rng.uniform(0.055, 0.09)
    return np.stack([sides, heights, depths], axis=1)


def _pixel(place: Array) -> Array:
    seen = CAMERA.matrix @ place
    return np.asarray(seen[:2] / seen[2], np.float64)


def _scale(place: Array) -> float:
    """Return how many pixels a metre has at a place."""
    return float(CAMERA.matrix[0, 0] / place[2])


def _over(place: Array, size: float, share: float) -> Hand:
    """Return a hand that has come so far to a cube from below, and as wide as it times `size`."""
    width = size * 0.075 * _scale(place)
    return Hand(_pixel(place) + (1 - share) * np.array([0.2, 1.0]) * (300 + width), width, 1.35)


def _moment(
    pair: tuple[CubeModel, CubeModel], script: Script, at: tuple[int, float, float], seed: int
) -> Moment:
    index, now, share = at
    poses, hands = script(share)
    shown = [(cube, pose) for cube, pose in zip(pair, poses, strict=True) if pose is not None]
    shown.sort(key=lambda each: -each[1][2, 3])
    light, cover = scene(*shown), _cover(hands)
    skin = 0.33 * _shading(cover, seed)
    picture = photograph(np.asarray(light * (1 - cover) + skin * cover, np.float32), seed=index)
    shares = tuple(_share(pair, poses, number, cover) for number in range(2))
    return Moment(Frame(picture, now, index), poses, (shares[0], shares[1]))


def _cover(hands: tuple[Hand, ...]) -> Light:
    """Return which share of each pixel hands cover, (H, W): an arm, a palm and four fingers."""
    width, height = CAMERA.size
    mask = np.zeros((height, width), np.uint8)
    for hand in hands:
        arm = np.array([np.cos(hand.angle), np.sin(hand.angle)])
        across = np.array([-arm[1], arm[0]])
        middle, size = hand.middle, hand.size
        lines = [(middle, middle + 900 * arm, 0.7), (middle, middle + 0.35 * size * arm, 1.0)]
        for finger, length in zip((-0.37, -0.13, 0.12, 0.36), (0.75, 0.9, 0.85, 0.6), strict=True):
            root = middle + finger * size * across
            tip = root - (length * arm - 0.15 * finger * across) * size
            lines.append((root, tip, 0.24))
        for start, end, thick in lines:
            one, other = np.rint(16 * np.stack([start, end])).astype(int).tolist()
            cv2.line(mask, one, other, (255,), max(1, round(thick * size)), cv2.LINE_AA, shift=4)
    return np.asarray(cv2.GaussianBlur(mask, (0, 0), 0.6) / 255, np.float32)


def _shading(cover: Light, seed: int) -> Light:
    """Return how bright skin is: darker towards its rim, and uneven."""
    inside = cv2.distanceTransform((cover > 0.5).astype(np.uint8), cv2.DIST_L2, 3)
    spots = np.random.default_rng(seed).normal(0, 1, (30, 40)).astype(np.float32)
    uneven = cv2.resize(spots, CAMERA.size, interpolation=cv2.INTER_CUBIC)
    rim = np.minimum(inside / 14, 1.0)
    return np.asarray((0.6 + 0.4 * rim) * (1 + 0.06 * uneven), np.float32)


def _share(pair: tuple[CubeModel, CubeModel], poses: Poses, number: int, cover: Light) -> float:
    """Return which share of a cube's outline neither hands nor the other cube nor a border hide."""
    outline = _outline(pair[number], poses[number])
    whole = np.count_nonzero(outline)
    if not whole:
        return 0.0
    own, other = poses[number], poses[1 - number]
    assert own is not None, "it has an outline"
    hidden = np.ones_like(outline)
    height, width = (each // 3 for each in outline.shape)
    hidden[height:-height, width:-width] = cover[::OUTLINE_PX, ::OUTLINE_PX] > 0.5
    if other is not None and other[2, 3] < own[2, 3]:
        hidden |= _outline(pair[1 - number], other)
    return np.count_nonzero(outline > hidden) / whole


def _outline(cube: CubeModel, pose: Array | None) -> Mask:
    """Draw the outline of a cube, filled, in the middle of a picture three times as large.

    A pixel of it is `OUTLINE_PX` wide.
    """
    width, height = (size // OUTLINE_PX for size in CAMERA.size)
    mask = np.zeros((3 * height, 3 * width), np.uint8)
    if pose is not None:
        points = cube.vertices @ pose[:3, :3].T + pose[:3, 3]
        pixels = points @ CAMERA.matrix.T
        pixels = pixels[:, :2] / pixels[:, 2:] / OUTLINE_PX + (width, height)
        hull = cv2.convexHull(np.rint(pixels).astype(np.int32))
        cv2.fillConvexPoly(mask, hull, (1,))
    return mask

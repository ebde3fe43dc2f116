"""Rooms with a light whose direction and colours are known, and what a hand does in them."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.geometry import se3
from cubeling.tracking.synthetic.source import look_at

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Picture = NDArray[np.uint8]

RATE, MOVED_S = 30.0, 1.5
"""Frames per second, and when the light moves in some rooms [s]."""

MIDDLE = np.array([0.0, 0.1, 0.0])
"""Middle of the cube's ways, in the table frame [m]."""


@dataclass(frozen=True)
class Room:
    """A light, a camera, and what a hand does."""

    seed: int
    """Seed of everything random."""

    to_light: Array
    """Towards the key light, in the table frame, (3,)."""

    key: Array
    """Irradiance of a surface that faces it, linear RGB, (3,)."""

    ambient: Array
    """Irradiance from all around, linear RGB, (3,)."""

    camera_from_table: Array
    """Where the camera is, (4, 4)."""

    resting: bool = False
    """Whether the cube lies on the table."""

    second: Array = field(default_factory=lambda: np.zeros(3))
    """Towards a second light, as long as its strength beside the key light, (3,)."""

    ground: float = 1.0
    """Ambient light on a surface that faces down, beside one that faces up."""

    lamp_m: float = np.inf
    """Distance of the key light from the middle of the cube's ways [m]."""

    moved: Array | None = None
    """Towards the key light after `MOVED_S`, or None where it stays, (3,)."""

    hand: bool = False
    """Whether a hand covers and shades parts of the faces."""

    exposure: Callable[[float], float] = lambda seconds: 1.0
    """Gain of the camera at a time [s]."""

    noise: float = 1.5
    """Noise at middle grey, one standard deviation [grey levels]."""

    jpeg: int = 0
    """Quality of compression, 0 for none."""

    @property
    def ratio(self) -> float:
        """Ambient light, in the mean of up and down, as a share of all."""
        ambient = self.ambient * (1 + self.ground) / 2
        return float(ambient.sum() / (ambient + self.key).sum())

    def at(self, seconds: float) -> Array:
        """Towards the key light at a time, in the table frame, (3,)."""
        late = self.moved is not None and seconds >= MOVED_S
        return self.moved if self.moved is not None and late else self.to_light

    def irradiance(
        self, normal: Array, place: Array, seconds: float, shaded: bool = False
    ) -> Array:
        """Light on a surface, linear RGB, (3,); `normal` and `place` are in the table frame."""
        around = 1 + (self.ground - 1) * (1 - float(normal[1])) / 2
        light = self.ambient * around + max(0.0, float(normal @ self.second)) * self.key
        if shaded:
            return np.asarray(light)
        to_lamp, nearness = self.at(seconds), 1.0
        if np.isfinite(self.lamp_m):
            way = (MIDDLE + to_lamp * self.lamp_m - place) / self.lamp_m
            nearness = 1 / float(way @ way)
            to_lamp = way * np.sqrt(nearness)
        return np.asarray(light + nearness * max(0.0, float(normal @ to_lamp)) * self.key)

    def camera_from_cube(self, seconds: float) -> Array:
        """Pose of the cube at a time, (4, 4)."""
        random = np.random.default_rng([self.seed, 1])
        phases, yaw = random.uniform(0, 2 * np.pi, 6), random.uniform(0, 2 * np.pi)
        place = np.array([random.uniform(-0.08, 0.08), 0.03, random.uniform(-0.05, 0.08)])
        if self.resting:
            yaw = np.pi / 4 + random.uniform(-0.4, 0.4) + np.pi / 2 * random.integers(4)
            return self.camera_from_table @ se3.pose(se3.rotation(np.array([0, yaw, 0])), place)
        waves = np.sin(2 * np.pi * np.array([0.23, 0.31, 0.27, 0.3, 0.25, 0.2]) * seconds + phases)
        way = random.choice([-1.0, 1.0])
        turn = se3.rotation(np.array([0.45 * waves[0], 0, 0.35 * waves[1]])) @ se3.rotation(
            np.array([0, yaw + way * 1.7 * seconds + 0.5 * waves[2], 0])
        )
        place += (0.03 * waves[3], 0.07 + 0.02 * waves[4], 0.03 * waves[5])
        return self.camera_from_table @ se3.pose(turn, place)


def plain(seed: int) -> Room:
    """White light."""
    random = np.random.default_rng([seed, 0])
    up, around = random.uniform(0.2, 1.0), random.uniform(0, 2 * np.pi)
    flat = np.sqrt(1 - up * up)
    to_light = np.array([flat * np.cos(around), up, flat * np.sin(around)])
    total, share = random.uniform(0.7, 1.1), random.uniform(0.2, 0.8)
    eye = np.array([random.uniform(-0.15, 0.15), random.uniform(0.25, 0.45), 0.5])
    white = np.ones(3)
    camera = look_at(eye, np.array([0.0, 0.05, 0.0]))
    return Room(seed, to_light, total * (1 - share) * white, total * share * white, camera)


def coloured(seed: int) -> Room:
    """A warm lamp and daylight, or the other way round."""
    room = plain(seed)
    colours = np.array([[1.25, 1.0, 0.62], [0.85, 1.0, 1.2]])
    key, ambient = colours[:: (-1) ** seed]
    return replace(room, key=room.key * key, ambient=room.ambient * ambient)


def second_light(seed: int) -> Room:
    """A second light, a quarter as strong, from another side."""
    room = plain(seed)
    other = plain(seed + 1000).to_light
    return replace(room, second=0.25 * other)


def uneven(seed: int) -> Room:
    """A lamp 0.8 m away, and less than half as much ambient light from below as from above."""
    return replace(coloured(seed), ground=0.4, lamp_m=0.8)


def moved(seed: int) -> Room:
    """A lamp that jumps to another direction."""
    return replace(coloured(seed), moved=plain(seed + 2000).to_light)


def hand(seed: int) -> Room:
    """A hand that covers and shades a part of each face, and all of some."""
    return replace(coloured(seed), hand=True)


def automatic(seed: int) -> Room:
    """Exposure that hunts: a third darker and brighter, so that some faces saturate."""
    return replace(coloured(seed), exposure=lambda t: 1.05 + 0.35 * float(np.sin(1.9 * t + seed)))


def poor(seed: int) -> Room:
    """All of it, with strong noise and JPEG of quality 50."""
    room = replace(automatic(seed), hand=True, noise=5.0, jpeg=50)
    return replace(room, second=second_light(seed).second * 0.6)


def resting(seed: int) -> Room:
    """A cube that rests, of which three faces are seen."""
    return replace(coloured(seed), resting=True)


KINDS = (plain, coloured, second_light, uneven, hand, automatic, poor, moved, resting)

OWN_ROWS = (moved, resting)
"""Kinds that the bars do not count."""

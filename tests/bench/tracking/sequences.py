"""The benchmark's sequences: seeded, with known truth; any frame can be asked for at any time."""

import zlib
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tests.bench.tracking.desk import desk
from tests.bench.tracking.hand import Finger, drawn_back, grip
from tests.bench.tracking.light import Light, Shadow, lamp_light
from tests.bench.tracking.optics import Lens, Sensor
from tests.bench.tracking.paper import PaperCube
from tests.bench.tracking.paths import (
    Poses,
    eased,
    halton,
    matrices,
    speeds,
    uniform_rotation,
    waves,
)
from tests.bench.tracking.plans import PLANS, Plan
from tests.bench.tracking.renderer import Scene, expose

NAMES = tuple(PLANS)

LENS = Lens(
    np.array([[902.3, 0.0, 645.2], [0.0, 900.8, 355.7], [0.0, 0.0, 1.0]]),
    np.array([-0.11, 0.06, 0.0006, -0.0004, -0.01]),
    (1280, 720),
)
"""The camera of all sequences: 71° from left to right, a barrel of a few pixels."""

CUBE = "locomotion"


@dataclass(frozen=True, eq=False)
class Sequence:
    """Pictures of a moving cube, and the truth."""

    name: str
    """One of `NAMES`."""

    seed: int
    """The same seed gives the same bytes."""

    count: int
    """Frames."""

    rate: float
    """Frames per second."""

    exposure: float
    """Length of a frame's exposure [s]."""

    cube: str
    """Name of the bundled cube."""

    matrix: NDArray[np.float64]
    """Focal lengths and principal point [px], (3, 3)."""

    distortion: NDArray[np.float64]
    """k1, k2, p1, p2, k3, (5,)."""

    size: tuple[int, int]
    """Width and height [px]."""

    independent: bool
    """Whether each frame shows another pose, so that nothing is learned from the one before."""

    scenes: tuple[Scene, ...]
    """What there is to see: one scene, or one for each frame."""

    sensor: Sensor
    """What turns light to numbers."""

    def timestamp(self, index: int) -> float:
        """Middle of the frame's exposure [s]."""
        return index / self.rate + self.exposure / 2

    def truth(self, index: int) -> NDArray[np.float64]:
        """Pose camera_from_cube (4, 4) at the timestamp."""
        return self._scene(index).poses(np.array([self.timestamp(index)]))[0]

    def velocity(self, index: int) -> NDArray[np.float64]:
        """Velocity of the cube's centre [m/s] and of its turning [rad/s] along camera axes, (6,)."""
        return speeds(self._scene(index).poses, np.array([self.timestamp(index)]))[0]

    def frame(self, index: int) -> NDArray[np.uint8]:
        """Picture (720, 1280, 3) BGR."""
        random = np.random.default_rng((self.seed, zlib.crc32(self.name.encode()), index))
        light = expose(self._scene(index), self.timestamp(index), self.exposure, random)
        return self.sensor.develop(light, random)

    def in_view(self, index: int) -> bool:
        """Whether the whole cube is in the picture."""
        return bool(_seen(self._scene(index).cube, self.truth(index)[None])[0])

    def fingers(self, index: int) -> tuple[Finger, ...]:
        """Fingers on the cube at the timestamp, in the cube frame."""
        return self._scene(index).fingers(self.timestamp(index))

    def _scene(self, index: int) -> Scene:
        if not 0 <= index < self.count:
            raise IndexError(f"sequence '{self.name}' has frames 0 to {self.count - 1}")
        return self.scenes[index if self.independent else 0]


RATE = 30.0


@lru_cache(maxsize=2)
def sequence(name: str, seed: int = 1, count: int | None = None) -> Sequence:
    """Return the sequence `name`, drawn anew for each `seed`.

    Parameters
    ----------
    name
        One of `NAMES`.
    seed
        Motion, light, table and noise all come from it.
    count
        Frames; None for as many as the sequence usually has.
    """
    plan = PLANS[name]
    count = plan.count if count is None else count
    random = np.random.default_rng((seed, zlib.crc32(name.encode())))
    cube = PaperCube.load(CUBE)
    light = lamp_light(random)
    if plan.shadows:
        light = _shaded(light, random)
    used = {side.marker_id for side in cube.sides}
    others = [number for number in range(50) if number not in used]
    foreign = tuple(int(number) for number in random.choice(others, plan.foreign, replace=False))
    background = desk(LENS, light, random, cube.dictionary, foreign)
    shift = random.random(6)
    times = np.arange(count) / RATE + plan.exposure / 2
    paths = [_path(plan, cube, seed, shift, random, times)]
    if plan.independent:
        paths = [_still(plan, cube, 50 * index + 1, shift) for index in range(count)]
    first = paths[0](np.zeros(1))[0]
    brightness = plan.light * 6 if plan.light < 1 else 1.0
    scene = Scene(
        LENS, cube, light, background, paths[0], _hold(plan, cube, first, random), brightness
    )
    scenes = tuple(replace(scene, poses=path) for path in paths)
    return Sequence(
        name,
        seed,
        count,
        RATE,
        plan.exposure,
        CUBE,
        LENS.matrix,
        LENS.distortion,
        LENS.size,
        plan.independent,
        scenes,
        Sensor(4000.0 * plan.light),
    )


def _seen(cube: PaperCube, poses: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether the whole cube is in the picture at each pose (n, 4, 4), (n,)."""
    there = np.einsum("nij,kj->nki", poses[:, :3, :3], cube.vertices) + poses[:, None, :3, 3]
    pixels = LENS.project(there)
    inside = (pixels >= 0) & (pixels <= np.array(LENS.size) - 1)
    return np.asarray((inside.all(-1) & (there[..., 2] > 0.1)).all(-1))


def _start(plan: Plan, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pose (4, 4) of a Halton point (6,)."""
    depth = plan.depth[0] + point[0] * (plan.depth[1] - plan.depth[0])
    spread = 0.12 if plan.facing == "frontal" else 0.9 if plan.independent else 0.5
    pixel = (point[1:3] - 0.5) * spread * np.array(LENS.size) + LENS.matrix[:2, 2]
    ray = np.append(LENS.directions(pixel), 1.0)
    rotation = uniform_rotation(point[3:])
    if plan.facing == "frontal":
        roll = Rotation.from_rotvec([0, 0, 2 * np.pi * point[3]])
        tilt = Rotation.from_rotvec([*(0.2 * (point[4:] - 0.5)), 0])
        quarter = Rotation.from_euler("xyz", np.array([2, 0, 0]) * np.pi / 2)
        rotation = tilt * roll * quarter
    return matrices(Rotation.concatenate([rotation]), (ray * depth)[None])[0]


def _still(plan: Plan, cube: PaperCube, index: int, shift: NDArray[np.float64]) -> Poses:
    """One pose of many, the whole cube in view."""
    for more in range(50):
        pose = _start(plan, halton(index + more, shift))
        if _seen(cube, pose[None])[0]:
            break
    return lambda times: np.repeat(pose[None], len(times), axis=0)


def _path(
    plan: Plan,
    cube: PaperCube,
    index: int,
    shift: NDArray[np.float64],
    random: np.random.Generator,
    times: NDArray[np.float64],
) -> Poses:
    """Draw motions until one keeps the cube in view; the one that does so longest, else."""
    best, most = None, -1.0
    for more in range(60):
        start = _start(plan, halton(index + 97 * more, shift))
        path = _moved(plan, start, float(times[-1]), random)
        share = float(_seen(cube, path(times)).mean())
        if plan.facing == "corner":
            share *= float((_faces_in_view(cube, path(times)) >= 2).mean())
        if share > most:
            best, most = path, share
        if most == 1:
            break
    assert best is not None
    return best


def _faces_in_view(cube: PaperCube, poses: NDArray[np.float64]) -> NDArray[np.int64]:
    """How many faces look at the camera, and not just past it, at each pose (n, 4, 4)."""
    normals = np.stack([side.normal for side in cube.sides])
    middles = normals * cube.edge / 2
    there = np.einsum("nij,kj->nki", poses[:, :3, :3], middles) + poses[:, None, :3, 3]
    out = np.einsum("nij,kj->nki", poses[:, :3, :3], normals)
    slant = -(there * out).sum(-1) / np.linalg.norm(there, axis=-1)
    return np.asarray((slant > 0.35).sum(-1))


def _moved(
    plan: Plan, start: NDArray[np.float64], length: float, random: np.random.Generator
) -> Poses:
    """Motion from `start` whose peak speeds within `length` [s] are those of the plan."""
    way = waves(random, plan.reach, plan.pace)
    turn = waves(random, plan.turns, plan.pace)
    base, origin = Rotation.from_matrix(start[:3, :3]), start[:3, 3]
    long = np.arange(0.0, max(3.0, length), 1 / 90)

    def path(times: NDArray[np.float64]) -> NDArray[np.float64]:
        return matrices(Rotation.from_rotvec(turn(times)) * base, origin + way(times))

    for _ in range(5):  # The speed of turning is not quite linear in the height of the waves.
        found = speeds(path, long)
        top, spin = np.linalg.norm(found[:, :3], axis=1), np.linalg.norm(found[:, 3:], axis=1)
        way = way.scaled(plan.speed / max(float(top.max()), 1e-9))
        turn = turn.scaled(plan.turning / max(float(spin.max()), 1e-9))
    return path


def _hold(
    plan: Plan, cube: PaperCube, first: NDArray[np.float64], random: np.random.Generator
) -> "_Hold":
    if not plan.fingers:
        return _Hold((), np.zeros(3), False)
    # The hand comes from behind the cube and from below or beside it.
    hand = np.array([random.uniform(-0.6, 0.6), 0.7, 0.75])
    hand = first[:3, :3].T @ (hand / np.linalg.norm(hand))
    return _Hold(grip(cube, hand, random), hand, plan.fingers == "start")


@dataclass(frozen=True, eq=False)
class _Hold:
    """Fingers that lie on the cube from the start, or come within ten frames."""

    fingers: tuple[Finger, ...]
    hand: NDArray[np.float64]
    start: bool

    def __call__(self, time: float) -> tuple[Finger, ...]:
        if self.start or not self.fingers:
            return self.fingers
        way = 0.09 * (1 - float(eased(np.array([time]), 0.03, 0.27)[0]))
        return tuple(drawn_back(finger, self.hand, way) for finger in self.fingers)


def _shaded(light: Light, random: np.random.Generator) -> Light:
    """Let one hard and one soft edge of shadow fall near the middle of the view, on a slope."""
    shadows = []
    for softness, depth in ((0.002, 0.85), (0.035, 0.6)):
        edge = np.array([np.cos(a := random.uniform(0, np.pi)), np.sin(a), random.normal(0, 0.3)])
        normal = np.cross(light.lamp, edge)
        normal /= np.linalg.norm(normal)
        place = np.array([*random.uniform(-0.05, 0.05, 2), 0.5])
        shadows.append(Shadow(np.append(normal, -normal @ place), softness, depth))
    return replace(light, slope=random.uniform(-1.2, 1.2, 3), shadows=tuple(shadows))

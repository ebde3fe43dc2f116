"""The benchmark's sequences: seeded, with ground truth and random access to frames."""

import zlib
from dataclasses import dataclass, replace
from functools import cache, lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from tests.bench.tracking.desk import desk
from tests.bench.tracking.hand import SKIN_ALBEDO_BGR, Finger, FingerMotion, lay_fingers
from tests.bench.tracking.light import random_lamp, with_shadows
from tests.bench.tracking.motions import drifting, in_view, random_motion, smearing, static_poses
from tests.bench.tracking.optics import LensModel, Sensor
from tests.bench.tracking.paper import PAPER_ALBEDO, BenchmarkCube
from tests.bench.tracking.paths import speeds
from tests.bench.tracking.plans import SEQUENCE_PLANS, SequencePlan
from tests.bench.tracking.renderer import Scene, expose
from tests.bench.tracking.worn_paper import patched, worn

NAMES = tuple(SEQUENCE_PLANS)


@dataclass(frozen=True, eq=False)
class Sequence:
    """Pictures of a moving cube, and the truth."""

    name: str
    """One of `NAMES`, or that of another plan."""

    seed: int
    """The same seed gives the same bytes."""

    count: int
    """Frames."""

    rate: float
    """Frames per second."""

    exposure: float
    """Length of a frame's exposure [s]."""

    cube: str
    """Name of the bundled cube, or path of its file."""

    matrix: NDArray[np.float64]
    """Focal lengths and principal point [px], (3, 3)."""

    distortion: NDArray[np.float64]
    """k1, k2, p1, p2, k3, (5,)."""

    size: tuple[int, int]
    """Width and height [px]."""

    told: LensModel
    """The lens as the trackers are told it; in some sequences without its distortion."""

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
        return np.asarray(self._scene(index).poses(np.array([self.timestamp(index)]))[0])

    def velocity(self, index: int) -> NDArray[np.float64]:
        """Velocity (6,) of the cube's centre [m/s] and of its turning [rad/s], camera axes."""
        return np.asarray(speeds(self._scene(index).poses, np.array([self.timestamp(index)]))[0])

    def frame(self, index: int) -> NDArray[np.uint8]:
        """Picture (height, width, 3) BGR."""
        random = np.random.default_rng((self.seed, zlib.crc32(self.name.encode()), index))
        light = expose(self._scene(index), self.timestamp(index), self.exposure, random)
        return self.sensor.develop(light, random)

    def in_view(self, index: int) -> bool:
        """Whether the whole cube is in the picture."""
        scene = self._scene(index)
        return bool(in_view(scene.lens, scene.cube, self.truth(index)[None])[0])

    def fingers(self, index: int) -> tuple[Finger, ...]:
        """Fingers on the cube at the timestamp, in the cube frame."""
        return self._scene(index).fingers(self.timestamp(index))

    def _scene(self, index: int) -> Scene:
        if not 0 <= index < self.count:
            raise IndexError(f"sequence '{self.name}' has frames 0 to {self.count - 1}")
        return self.scenes[index if self.independent else 0]


RATE = 30.0
"""Frames per second."""

GAIN = 6.0
"""Gain in the dark; it does not fully compensate for the missing light."""


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
    return draw(SEQUENCE_PLANS[name], name, seed, count)


def draw(plan: SequencePlan, name: str, seed: int, count: int | None = None) -> Sequence:
    """Return the sequence of a plan, which need not be one of `NAMES`; see `sequence`."""
    count = plan.count if count is None else count
    key = zlib.crc32(name.encode())
    random = np.random.default_rng((seed, key))
    # All seeds share the shift, so that together they fill the space of poses evenly.
    shift = np.random.default_rng(key).random(6)
    cube = BenchmarkCube.load(plan.cube)
    times = np.arange(count) / RATE + plan.exposure / 2
    own = [np.random.default_rng((seed, key, index, 1)) for index in range(count)]
    if plan.independent:
        poses = static_poses(plan, cube, 1000 * seed, count, shift)
        paths = [drifting(pose, smearing(plan, pose, each), time)
                 for pose, each, time in zip(poses, own, times, strict=True)]  # fmt: skip
    else:
        paths = [random_motion(plan, cube, seed, shift, random, times)]
    first = paths[0](np.zeros(1))[0]
    light = random_lamp(random)
    if plan.shadows and not plan.independent:
        light = with_shadows(light, paths[0](times)[:, :3, 3].mean(0), random)
    hold = _hold(plan, cube, first, random)
    brightness = GAIN * plan.light if plan.light < 1 else 1.0
    lens, sensor = plan.camera.lens, plan.camera.sensor
    foreign = _foreign(plan, cube, random)
    # Drawn with the first frame: it takes longer than all that the truth alone needs.
    table = cache(partial(desk, lens, plan.height, light, random, cube.dictionary, foreign))
    scenes = tuple(Scene(lens, cube, light, table, path, hold, brightness) for path in paths)
    if plan.worn:
        scenes = tuple(_worn(plan, scene, time, each)
                       for scene, time, each in zip(scenes, times, own, strict=False))  # fmt: skip
    seen = plan.camera.seen_lens
    return Sequence(
        name=name,
        seed=seed,
        count=count,
        rate=RATE,
        exposure=plan.exposure,
        cube=plan.cube,
        matrix=seen.matrix,
        distortion=seen.distortion,
        size=seen.size,
        told=replace(seen, distortion=np.zeros(5)) if plan.nominal else seen,
        independent=plan.independent,
        scenes=scenes,
        sensor=replace(sensor, electrons=sensor.electrons * plan.light),
    )


def _worn(plan: SequencePlan, scene: Scene, time: float, random: np.random.Generator) -> Scene:
    """Give a scene paper, light and hand of its own; a motion keeps its light and hand."""
    pose = scene.poses(np.array([time]))[0]
    cube = worn(scene.cube, random)
    if plan.covered:
        cube = patched(cube, plan.covered, random)
    scene = replace(
        scene,
        cube=cube,
        brightness=scene.brightness * random.uniform(0.8, 1.4),
        skin=_cover_albedo(random) if plan.covered else SKIN_ALBEDO_BGR,
    )
    if not plan.independent:
        return scene
    light = scene.light
    if plan.shadows and random.random() < 0.5:
        light = with_shadows(light, pose[:3, 3], random)
    return replace(scene, light=light, fingers=_hold(plan, cube, pose, random))


def _cover_albedo(random: np.random.Generator) -> NDArray[np.float32]:
    """Colour (3,) BGR of what covers a corner: skin, grey, white paper, or any."""
    colours = (
        SKIN_ALBEDO_BGR * random.uniform(0.4, 1.3),
        np.full(3, random.uniform(0.06, 0.85)),
        np.full(3, PAPER_ALBEDO),
        random.uniform(0.06, 0.85, 3),
    )
    return np.asarray(colours[int(random.integers(len(colours)))], np.float32)


def _foreign(
    plan: SequencePlan, cube: BenchmarkCube, random: np.random.Generator
) -> tuple[int, ...]:
    """Markers of the cube's dictionary that are not on the cube."""
    used = {side.marker_id for side in cube.sides}
    others = [number for number in range(50) if number not in used]
    return tuple(int(number) for number in random.choice(others, plan.foreign, replace=False))


def _hold(
    plan: SequencePlan, cube: BenchmarkCube, first: NDArray[np.float64], random: np.random.Generator
) -> FingerMotion:
    """Hold the cube as the plan says; the hand comes from behind it, from below or beside it."""
    if not plan.fingers:
        return FingerMotion()
    hand = np.array([random.uniform(-0.6, 0.6), 0.7, 0.75])
    hand = first[:3, :3].T @ (hand / np.linalg.norm(hand))
    return FingerMotion(lay_fingers(cube, hand, random), hand, plan.fingers == "start")

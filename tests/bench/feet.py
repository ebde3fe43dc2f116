"""How fast standing feet slide at all points of the locomotion space: `python -m tests.bench.feet`.

Exits with 1 if the mean slide of a planted foot reaches 10 mm/s at any point of the locomotion
space or in any script. Lengths are scaled to a person 1.7 m tall.

A foot is planted if its ball is within 12 mm of the ground for at least 0.1 s. While landing or
leaving, a foot is also that low but moves even in the best clips: the first and the last 33 ms of
each stay count only in the column "strict".
"skate" is the height-weighted speed of Zhang et al., "Mode-adaptive neural networks for quadruped
motion control", SIGGRAPH 2018: v (2 − 2^(h/H)), H = 25 mm, over all frames.
"""

import math
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.characters import Character, CharacterCommand, LocomotionIntent, Pose
from cubeling.characters.body.posture import NEUTRAL_EXPRESSIVITY
from cubeling.characters.control.controllers.walk import WalkController
from cubeling.characters.control.layers import FootLockLayer, FrameContext
from cubeling.characters.locomotion.steering import SteeringOutput
from cubeling.characters.motion.contacts import spans
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.feet import find_feet

Array = NDArray[np.float64]

FRAME_RATE = 60
BODY_HEIGHT_M = 1.7
MAX_SLIDE_MM_S = 10.0
"""Mean slide at which the benchmark fails [mm/s]."""

_MAX_PLANTED_HEIGHT_M = 0.012  # [m]
_MIN_STAY_FRAMES, _EDGE_FRAMES = 6, 2  # frames: of a stay, and at either end of it
_SKATE_HEIGHT_M = 0.025  # [m]
_SETTLING_FRAMES = 60  # frames before the measurement starts at a point of the grid

Script = Callable[[int, WalkController], SteeringOutput | CharacterCommand]
"""Returns the input for a frame."""


@dataclass(frozen=True)
class Take:
    """Recorded feet of a walker."""

    balls: Array
    """In the world, (frames, feet, 3) [m of a person 1.7 m tall]."""

    level: Array
    """Heights of the balls at rest, (feet,) [m]."""

    turns: Array
    """Rotations of the legs' joints, (frames, joints, 4)."""

    lowest: float
    """Largest depth of the feet below the ground [m], not negative."""


@dataclass(frozen=True)
class Slide:
    """Measures of sliding feet."""

    mean: float
    """Mean speed of planted feet [mm/s]."""

    strict: float
    """The same including the frames of landing and leaving [mm/s]."""

    skate: float
    """Height-weighted speed over all frames [mm/s]."""

    planted: float
    """Fraction of the time that a foot is planted."""

    jerk: float
    """99.9th percentile of the legs' angular acceleration [rad/s²]."""

    dip: float
    """Largest depth of a foot's ball below its height at rest [mm]."""


class Walking:
    """A walking character whose steering can be told, with its feet locked or free."""

    def __init__(self, character: Character, scale: float = 1.0, hold: bool = True) -> None:
        self.controller = WalkController(character, scale, None)
        self.feet = FootLockLayer(character)
        self._scale, self._hold = scale, hold

    def step(self, asked: SteeringOutput | CharacterCommand, elapsed: float) -> Pose:
        """Advance by a time [s] and return the pose."""
        if isinstance(asked, SteeringOutput):
            frame, command = self.controller.steer(asked, elapsed), CharacterCommand(0.0)
        else:
            frame, command = self.controller.update(asked, elapsed), asked
        if not self._hold:
            return frame.pose
        context = FrameContext(
            elapsed, command, frame, self._scale, np.eye(4), NEUTRAL_EXPRESSIVITY, 1.0
        )
        return self.feet.update(frame.pose, context)


def film(character: Character, script: Script, frames: int, hold: bool = True) -> Take:
    """Play a script at 60 Hz and return the recorded feet."""
    walker = Walking(character, hold=hold)
    poses: list[Pose] = []
    places: list[RootDelta] = []
    for number in range(frames):
        asked = script(number, walker.controller)
        poses.append(walker.step(asked, 1.0 / FRAME_RATE if number else 0.0))
        places.append(walker.controller.place)
    feet = find_feet(character.skeleton)
    joints = [foot[-1] for foot in feet]
    legs = sorted({above for foot in feet for above in _upward(character, foot[-1])[:4]})
    stacked = Pose.of_frames(poses)
    seen = stacked.globals(character.skeleton)[..., :3, 3][:, joints]
    at = np.array([(step.x, 0.0, step.z) for step in places])
    yaw = rotations.about("y", np.array([step.yaw for step in places]))
    size = BODY_HEIGHT_M / character.height
    balls = (rotations.rotate(yaw[:, None], seen) + at[:, None]) * size
    level = character.skeleton.rest.globals(character.skeleton)[..., 1, 3][joints] * size
    return Take(
        balls, level, stacked.rotations[:, legs], float(max((level - balls[..., 1]).max(), 0.0))
    )


def placed_take(character: Character, poses: Pose, placed: Array) -> Take:
    """Return the feet of a character in poses (frames, …), where it stood, (frames, 4, 4)."""
    skeleton, size = character.skeleton, BODY_HEIGHT_M / character.height
    balls = [foot[-1] for foot in find_feet(skeleton)]
    local = poses.globals(skeleton)[..., :3, 3][:, balls]
    world = np.einsum("fij,fnj->fni", placed[:, :3, :3], local) + placed[:, None, :3, 3]
    level = skeleton.rest.globals(skeleton)[balls, 1, 3] * size
    return Take(world * size, level, poses.rotations, 0.0)


def measure(take: Take, start: int = 0) -> Slide:
    """Return the measures from a frame on."""
    steps = np.diff(take.balls[start:], axis=0)[..., [0, 2]]
    speeds = np.linalg.norm(steps, axis=-1) * FRAME_RATE  # of the intervals between frames
    above = take.balls[start:, :, 1] - take.level
    near = above < _MAX_PLANTED_HEIGHT_M
    stays = near[1:] & near[:-1]
    core, whole = np.zeros_like(stays), np.zeros_like(stays)
    for foot in range(stays.shape[1]):
        for first, length in spans(stays[:, foot], loop=False):
            if length >= _MIN_STAY_FRAMES:
                whole[first : first + length, foot] = True
                core[first + _EDGE_FRAMES : first + length - _EDGE_FRAMES, foot] = True
    height = np.clip((above[1:] + above[:-1]) / 2, 0.0, _SKATE_HEIGHT_M)
    skate = speeds * (2 - 2 ** (height / _SKATE_HEIGHT_M))
    spins = rotations.to_rotation_vector(
        rotations.multiply(take.turns[1:], rotations.conjugate(take.turns[:-1]))
    )
    bends = np.linalg.norm(np.diff(spins, axis=0), axis=-1) * FRAME_RATE**2
    return Slide(
        mean=1e3 * float(speeds[core].mean()) if core.any() else 0.0,
        strict=1e3 * float(speeds[whole].mean()) if whole.any() else 0.0,
        skate=1e3 * float(skate.mean()),
        planted=float(core.mean()),
        jerk=float(np.quantile(bends[start:], 0.999)),
        dip=1e3 * take.lowest,
    )


def points(
    speeds: Iterable[float], degrees: Iterable[float], strides: Iterable[float]
) -> dict[tuple[float, float, float], SteeringOutput]:
    """Return a grid over Speed, Angular [degrees] and stride."""
    angles = list(degrees)
    return {
        (speed, angle, stride): SteeringOutput(speed, math.radians(angle), stride)
        for speed in speeds
        for angle in angles
        for stride in strides
    }


def at_point(
    character: Character, course: SteeringOutput, seconds: float, hold: bool = True
) -> Slide:
    """Return the measures at one point of the locomotion space, after settling."""
    frames = _SETTLING_FRAMES + round(seconds * FRAME_RATE)
    return measure(film(character, lambda _, __: course, frames, hold), _SETTLING_FRAMES)


def _upward(character: Character, joint: int) -> list[int]:
    """Return a joint and its ancestors, upward."""
    line = [joint]
    while character.skeleton.parents[line[-1]] >= 0:
        line.append(character.skeleton.parents[line[-1]])
    return line


def _start_stop(number: int, _: WalkController) -> CharacterCommand:
    speed = (0.0, 2.0, 0.0, 4.5)[number // 75 % 4]
    return CharacterCommand(number / FRAME_RATE, LocomotionIntent(speed, np.array([0.0, 1e4])))


def _speed_changes(number: int, _: WalkController) -> CharacterCommand:
    speed = 2.75 + 2.0 * math.sin(number / 40)
    return CharacterCommand(number / FRAME_RATE, LocomotionIntent(speed, np.array([0.0, 1e4])))


def _turn_on_the_spot(number: int, _: WalkController) -> CharacterCommand:
    way = number // 180 * 2.2
    look = np.array([math.sin(way), math.cos(way)]) * 1e3
    return CharacterCommand(number / FRAME_RATE, LocomotionIntent(facing=look))


def _slalom(number: int, _: WalkController) -> SteeringOutput:
    return SteeringOutput(2.2, 1.3 * math.sin(number / 30), 1.0)


def _jumps_of_course(number: int, _: WalkController) -> SteeringOutput:
    speed = (1.0, 2.5, 4.0, 2.9, 0.6)[number // 60 % 5]
    return SteeringOutput(speed, (-1.5, 0.0, 1.5, 0.7)[number // 45 % 4], 1.0)


def _follow(number: int, _: WalkController) -> CharacterCommand:
    angle = number / FRAME_RATE / 2
    target = np.array([3.0 * math.sin(angle), 3.0 * math.sin(2 * angle)])
    return CharacterCommand(number / FRAME_RATE, LocomotionIntent(3.0, target))


def _near_targets(number: int, _: WalkController) -> CharacterCommand:
    turn = number // 150 * 2.4
    target = np.array([math.sin(turn), math.cos(turn)])
    return CharacterCommand(number / FRAME_RATE, LocomotionIntent(2.0, target))


SCRIPTS: dict[str, Script] = {
    "start and stop": _start_stop,
    "speed up and down": _speed_changes,
    "turn on the spot": _turn_on_the_spot,
    "slalom": _slalom,
    "courses that jump": _jumps_of_course,
    "moving target": _follow,
    "near targets": _near_targets,
}
"""Inputs that change over time; a metre on the table is a metre of the character."""


def main() -> None:
    """Print the tables."""
    console, human = Console(), Character.load("human")
    worst = 0.0
    table = Table(
        title="slides [mm/s], bends [rad/s²], dips [mm]",
        caption="worst: Speed, Angular, stride",
    )
    for column in ("where", "lock", "slide", "strict", "skate", "planted", "bend", "dip"):
        table.add_column(column, no_wrap=True)
    grid = points(np.arange(0.5, 5.01, 0.5), range(-90, 91, 30), (1.0,))
    grid |= points((2.8, 2.9, 3.1, 3.2), (-75, 0, 45), (1.0,))
    grid |= points((1.0, 1.2, 2.0, 4.0), (-90, 0, 60), (0.0, 0.3, 0.6))
    for hold in (False, True):
        found = {key: at_point(human, course, 1.7, hold) for key, course in grid.items()}
        means = [slide.mean for slide in found.values()]
        key = max(found, key=lambda point: found[point].mean)
        middle = sorted(found.values(), key=lambda slide: slide.mean)[len(found) // 2]
        _row(table, f"{len(grid)} points, median", hold, middle)
        _row(table, f"worst: {key[0]:g}, {key[1]:g}°, {key[2]:g}", hold, found[key])
        worst = max(means)
        for name, script in SCRIPTS.items():
            slide = measure(film(human, script, 600, hold))
            _row(table, name, hold, slide)
            worst = max(worst, slide.mean)
    console.print(table)
    sys.exit(worst >= MAX_SLIDE_MM_S)


def _row(table: Table, where: str, hold: bool, slide: Slide) -> None:
    table.add_row(
        where,
        "on" if hold else "off",
        f"{slide.mean:.1f}",
        f"{slide.strict:.1f}",
        f"{slide.skate:.1f}",
        f"{slide.planted:.2f}",
        f"{slide.jerk:.0f}",
        f"{slide.dip:.1f}",
    )


if __name__ == "__main__":
    main()

"""What moves a character, compared: `python -m tests.bench.controllers`.

Every controller that a user may choose walks the same script of requests: to walk, run, turn and
stop, each at several moments of the step. Lengths are scaled to a person 1.7 m tall, times are
frames of 1/60 s. A row on CMU recordings needs them in `shared/data/cmu-mocap`.

answer
    From a request until speed or heading has gone a tenth of the way to where it settles; mean.
    It stands for the "response" of Fernández-Baena (2015), section 3.4, for controllers whose
    transitions cannot be looked into.
TBF
    Time between frames: from a request until it stays within a tenth of where it settles; mean
    over all requests (his equation 3.3).
LM
    The same for each pair of gaits, mean over the moments of the request (his equation 3.4); the
    worst pair is printed.
slide
    Mean speed of planted feet, as in `tests.bench.feet` [mm/s].
jerk
    Median and 99th percentile over hips, knees, ankles, elbows and wrists [m/s³].
jump
    Largest change of velocity of these joints from one frame to the next [m/s]: as the controller
    plays them, also as a multiple of the largest in the clips that are walked with, and after the
    feet are held; then that but for one frame in a hundred. With recordings one frame in a
    thousand is left out everywhere: they have glitches, such as hands that leap.
ms
    Time of a frame with all layers: the median, and the longest.

Exits with 1 if a graph or matching slides more than `MAX_SLIDE_MM_S` or jumps more than `MAX_JUMP`.
"""

import sys
import time
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.characters import (
    CONTROLLER_CHOICES,
    ActionIntent,
    Animator,
    Character,
    CharacterCommand,
    Clip,
    LocomotionIntent,
    Pose,
    PosedCharacter,
    choose_controller,
)
from cubeling.characters.control.controllers import ControllerFactory
from cubeling.characters.control.controllers.controller import CharacterController
from cubeling.characters.control.controllers.graph import GraphController
from cubeling.characters.control.controllers.walk import NOT_ACTIONS
from cubeling.characters.control.layers import FOOT_LAYERS, FrameContext
from tests.bench.feet import (
    BODY_HEIGHT_M,
    FRAME_RATE,
    MAX_SLIDE_MM_S,
    Take,
    measure,
    placed_take,
)

CMU = Path(__file__).parents[3] / "shared" / "data" / "cmu-mocap"
MAX_JUMP = 1.2
"""Largest change of velocity, as a multiple of that of the clips, at which the benchmark fails."""

Array = NDArray[np.float64]

GAITS = {"stand": 0.0, "walk": 2.0, "run": 4.5}
"""AvatAR's Speed of each gait."""

REQUESTS = (
    *(("walk", 0), ("run", 0), ("walk", 0), ("walk", 90), ("walk", -90), ("stand", 0), ("run", 0)),
    *(("run", 90), ("stand", 0), ("walk", 0), ("walk", 180), ("run", 0), ("run", -90)),
    ("stand", 0),
)
"""Gait, and by how much the heading changes [degrees], one after the other."""

ROUNDS, HOLD_FRAMES, LONGER_FRAMES = 6, 130, 7  # each round asks at other moments of the step
JOINTS = ("hips", *(side + part for side in ("left", "right") for part in
                    ("LowerLeg", "Foot", "LowerArm", "Hand")))  # fmt: skip


@dataclass(frozen=True)
class Request:
    """A change that is asked for."""

    pair: str
    """The gaits before and after, and the turn."""

    first: int
    """Its frame."""

    end: int
    """The frame of the next request."""

    turn: float
    """How much to turn [rad]; 0 for a change of gait."""


@dataclass(frozen=True)
class Film:
    """What a controller showed."""

    take: Take
    """Its feet."""

    joints: Array
    """Of `JOINTS` in the frame of the character, (frames, joints, 3) [m of a person 1.7 m tall]."""

    before_layers: Array
    """The same as the controller plays them, before the feet are held."""

    speed: Array
    """Over the ground, (frames,) [m/s]."""

    heading: Array
    """(frames,) [rad]."""

    requests: list[Request]
    """What was asked for, in order."""

    milliseconds: Array
    """Time of each frame, with its layers, (frames,)."""


class Tap:
    """A layer that changes nothing and keeps the poses that it is given."""

    def __init__(self, character: Character, seed: int) -> None:
        self.poses: list[Pose] = []

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        self.poses.append(pose)
        return pose


def film(character: Character, controller: ControllerFactory, rounds: int = ROUNDS) -> Film:
    """Let a controller walk the script."""
    tap = Tap(character, 0)
    layers = (lambda *_: tap, *FOOT_LAYERS)
    animator = Animator(character, scale=1.0, layers=layers, controller=controller)
    shown: list[PosedCharacter] = []
    requests: list[Request] = []
    times: list[float] = []
    before, yaw = "stand", 0.0
    for number, (gait, degrees) in enumerate(REQUESTS * rounds):
        turn = np.radians(degrees)
        yaw += turn
        first = len(shown)
        end = first + HOLD_FRAMES + LONGER_FRAMES * (number // len(REQUESTS))
        pair = f"{before} → {gait}" + (f", {degrees:+d}°" if degrees else "")
        requests.append(Request(pair, first, end, float(turn)))
        for frame in range(first, end):
            command = _command(shown[-1] if shown else None, frame / FRAME_RATE, gait, yaw)
            start = time.perf_counter()
            shown.append(animator.update(command))
            times.append(time.perf_counter() - start)
        before = gait
    size = BODY_HEIGHT_M / character.height
    return _developed(character, shown, tap.poses, requests, size, 1e3 * np.array(times))


def _command(posed: PosedCharacter | None, now: float, gait: str, yaw: float) -> CharacterCommand:
    """Return the command of going on in a direction, without end."""
    x, z = (0.0, 0.0) if posed is None else posed.table_from_character[[0, 2], 3]
    target = np.array([x + 100 * np.sin(yaw), z + 100 * np.cos(yaw)])
    stand = ActionIntent("idle") if gait == "stand" else None
    return CharacterCommand(now, LocomotionIntent(GAITS[gait], target, stop=False), stand)


def _developed(
    character: Character,
    shown: Sequence[PosedCharacter],
    played: Sequence[Pose],
    requests: list[Request],
    size: float,
    milliseconds: Array,
) -> Film:
    poses = Pose.of_frames(posed.pose for posed in shown)
    placed = np.stack([posed.table_from_character for posed in shown])
    local = poses.globals(character.skeleton)[..., :3, 3]
    way = placed[:, [0, 2], 3] * size
    steps = np.linalg.norm(np.diff(way, axis=0, prepend=way[:1]), axis=1) * FRAME_RATE
    return Film(
        placed_take(character, poses, placed),
        local[:, joints_of(character)] * size,
        _joints(character, played),
        np.convolve(steps, np.full(7, 1 / 7), "same"),
        np.unwrap(np.arctan2(placed[:, 0, 2], placed[:, 2, 2])),
        requests,
        milliseconds,
    )


def joints_of(character: Character) -> list[int]:
    """Return the numbers of `JOINTS`."""
    return [character.anatomy.joints[part] for part in JOINTS]


def answers(seen: Film) -> dict[str, list[tuple[int, int]]]:
    """Return, by pair, the frames from each request to the first answer and until it settles."""
    found: dict[str, list[tuple[int, int]]] = defaultdict(list)
    for request in seen.requests:
        values = (seen.heading if request.turn else seen.speed)[request.first : request.end]
        final = float(values[-20:].mean())
        change = abs(final - values[0])
        first = int(np.argmax(np.abs(values - values[0]) > 0.1 * change))
        outside = np.flatnonzero(np.abs(values - final) > 0.1 * change)
        found[request.pair].append((first, int(outside[-1]) + 1 if len(outside) else 0))
    return found


def velocity_jumps(joints: Array) -> Array:
    """Return the largest change of velocity at each frame, (frames − 2,) [m/s]."""
    jumps: Array = np.linalg.norm(np.diff(joints, 2, axis=0), axis=-1).max(-1) * FRAME_RATE
    return jumps


def clip_jump(character: Character, clips: Sequence[Clip], share: float) -> float:
    """Return the largest change of velocity in a share of clips' frames, played at 60 Hz [m/s]."""
    jumps: list[Array] = []
    for clip in clips:
        times = np.arange(0.0, clip.duration, 1 / FRAME_RATE)
        if len(times) > 2:
            jumps.append(velocity_jumps(_joints(character, [clip.sample(at) for at in times])))
    return float(np.quantile(np.concatenate(jumps), share))


def _joints(character: Character, poses: Sequence[Pose]) -> Array:
    """Return the positions of `JOINTS`, (poses, joints, 3) [m of a person 1.7 m tall]."""
    at = Pose.of_frames(poses).globals(character.skeleton)[..., :3, 3][:, joints_of(character)]
    scaled: Array = at * (BODY_HEIGHT_M / character.height)
    return scaled


def walked_clips(character: Character, controller: CharacterController) -> Sequence[Clip]:
    """Return the clips that a controller walks with."""
    database = getattr(controller, "database", None)
    if database is not None:
        clips: Sequence[Clip] = database.clips
        return clips
    if isinstance(controller, GraphController):
        return [controller.library.as_clip(name) for name in controller.library.names]
    return [clip for name, clip in character.clips.items() if name in {"idle", *NOT_ACTIONS}]


def main() -> int:
    """Print the table and return an exit code."""
    character = Character.load("human")
    table = Table(title="Controllers on one script: times in frames of 1/60 s, lengths of 1.7 m")
    headings = ("controller", "motions", "answer", "TBF", "LM, worst pair", "slide", "jerk")
    for heading in (*headings, "jump", "× clips", "shown", "ms"):
        table.add_column(heading, no_wrap=True)
    failed = False
    for name in CONTROLLER_CHOICES:
        for motions in ((), (str(CMU),)) if name != "tree" and CMU.is_dir() else ((),):
            controller = choose_controller(name, character, motions)
            clips = walked_clips(character, controller(character, 1.0, None))
            seen = film(character, controller)
            share = 0.999 if motions else 1.0
            own = clip_jump(character, clips, share)
            slide, ratio = _row(table, name, motions, seen, own, share)
            failed |= name != "tree" and (slide >= MAX_SLIDE_MM_S or ratio > MAX_JUMP)
    Console(width=140).print(table)
    return int(failed)


def _row(
    table: Table, name: str, motions: Sequence[str], seen: Film, clips: float, share: float
) -> tuple[float, float]:
    """Add a row; return the slide [mm/s] and the jump as a multiple of that of the clips."""
    found = answers(seen)
    every = [each for pair in found.values() for each in pair]
    means = {pair: float(np.mean([end for _, end in each])) for pair, each in found.items()}
    worst = max(means, key=lambda pair: means[pair])
    slide = measure(seen.take).mean
    jerk = np.linalg.norm(np.diff(seen.joints, 3, axis=0), axis=-1) * FRAME_RATE**3
    jump = float(np.quantile(velocity_jumps(seen.before_layers), share))
    shown = velocity_jumps(seen.joints)
    table.add_row(
        name,
        "CMU" if motions else "own",
        f"{np.mean([first for first, _ in every]):.1f}",
        f"{np.mean([end for _, end in every]):.1f}",
        f"{means[worst]:.0f}: {worst}",
        f"{slide:.1f}",
        f"{np.median(jerk):.0f}, {np.quantile(jerk, 0.99):.0f}",
        f"{jump:.2f}",
        f"{jump / clips:.2f}",
        f"{np.quantile(shown, share):.2f}, {np.quantile(shown, 0.99):.2f}",
        f"{np.median(seen.milliseconds):.2f}, {seen.milliseconds.max():.0f}",
    )
    return slide, jump / clips


if __name__ == "__main__":
    sys.exit(main())

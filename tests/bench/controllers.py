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
run settles
    From a request to run, walking, until the speed stays within a tenth of that of the last second:
    median, and most.
lean
    Of the trunk from the vertical, 95th percentile [°]; of the clips, all together and the most of
    any.
beyond
    Share of frames whose hips are more than 0.10 body heights beyond the feet [%].
slide
    Mean speed of planted feet, as in `tests.bench.feet` [mm/s].
jump
    Largest change of velocity of hips, knees, ankles, elbows and wrists from one frame to the next,
    before the feet are held, as a multiple of the largest in the clips that are walked with; then
    the same but for one frame in a thousand, as recordings have glitches, such as hands that leap;
    and that with the feet held.
ms
    CPU time of a frame with all layers: the median, and the longest.

The sets are our own clips and recordings of others in `shared/data`; the tree plays our own only.
Exits with 1 if one that is not the tree slides more than `MAX_SLIDE_MM_S`, jumps more than
`MAX_JUMP`, or leans more than any of the clips.
"""

import argparse
import gc
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
from cubeling.characters.motion.balance import (
    FAR_BEYOND_HEIGHTS,
    hips_beyond_feet,
    trunk_lean,
)
from tests.bench.feet import (
    BODY_HEIGHT_M,
    FRAME_RATE,
    MAX_SLIDE_MM_S,
    Take,
    measure,
    placed_take,
)

DATA = Path(__file__).parents[3] / "shared" / "data"
CMU = DATA / "cmu-mocap"
SETS: dict[str, tuple[Path, ...]] = {
    "own": (),
    "16": (CMU / "16",),
    "02, 49": (CMU / "02", CMU / "49"),
    "131": (DATA / "bvh" / "131_01.bvh", DATA / "bvh" / "131_03.bvh"),
}
"""Recordings by the name of their set."""

Array = NDArray[np.float64]

GAITS = {"stand": 0.0, "walk": 2.0, "run": 4.5}
"""AvatAR's Speed of each gait."""

REQUESTS = (
    *(("walk", 0), ("run", 0), ("walk", 0), ("walk", 90), ("walk", -90), ("stand", 0), ("run", 0)),
    *(("run", 90), ("stand", 0), ("walk", 0), ("walk", 180), ("run", 0), ("run", -90)),
    ("stand", 0),
)
"""Gait, and by how much the heading changes [degrees], one after the other."""

MAX_JUMP = 1.2
"""Largest change of velocity at which the benchmark does not fail, as a multiple of the clips'."""

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

    positions: Array
    """Of all joints in the frame of the character, (frames, all joints, 3) [its own metres]."""

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
    gc.collect()
    gc.freeze()  # as in play
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
            start = time.thread_time()
            shown.append(animator.update(command))
            times.append(time.thread_time() - start)
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
        local,
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


def settling(seen: Film) -> list[int]:
    """Return the frames until the speed of each run that follows a walk stays within a tenth."""
    found = []
    for request in seen.requests:
        if request.pair == "walk → run":
            speed = seen.speed[request.first : request.end]
            final = speed[-FRAME_RATE:].mean()
            outside = np.flatnonzero(np.abs(speed - final) > 0.1 * final)
            found.append(int(outside[-1]) + 1 if len(outside) else 0)
    return found


def lean_deg(character: Character, positions: Array) -> float:
    """Return the 95th percentile of the trunk's lean [°]."""
    lean = np.linalg.norm(trunk_lean(positions, character.anatomy), axis=1)
    return float(np.degrees(np.quantile(lean, 0.95)))


def beyond(character: Character, positions: Array) -> float:
    """Return the share of frames whose hips are far beyond the feet [%]."""
    away = hips_beyond_feet(positions, character.anatomy) / character.height
    return float(100.0 * np.mean(away > FAR_BEYOND_HEIGHTS))


def clip_positions(character: Character, clips: Sequence[Clip]) -> list[Array]:
    """Return the positions of all joints in the frames of clips at 60 Hz, (frames, joints, 3)."""
    every = [np.arange(0.0, clip.duration, 1 / FRAME_RATE) for clip in clips]
    return [
        Pose.of_frames([clip.sample(at) for at in times]).globals(character.skeleton)[..., :3, 3]
        for clip, times in zip(clips, every, strict=True)
        if len(times) > 2
    ]


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
    parser = argparse.ArgumentParser(description="What moves a character, compared.")
    parser.add_argument("--sets", default=",".join(name.replace(", ", "+") for name in SETS))
    parser.add_argument("--controllers", default=",".join(CONTROLLER_CHOICES))
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="of 14 requests each")
    options = parser.parse_args()
    character, failed = Character.load("human"), False
    headings = ("set", "controller", "answer", "TBF", "run settles", "lean", "beyond", "slide")
    for name in [each.replace("+", ", ") for each in options.sets.split(",")]:
        table = Table()
        for heading in (*headings, "jump", "ms"):
            table.add_column(heading, no_wrap=True)
        motions = tuple(map(str, SETS[name]))
        if all(path.exists() for path in SETS[name]):
            chosen = [c for c in options.controllers.split(",") if c != "tree" or not motions]
            for number, each in enumerate(chosen):
                names = name, each
                failed |= _add_rows(table, character, names, motions, options.rounds, not number)
        else:
            table.add_row(name, "no recordings")
        Console(width=130).print(table)
    return int(failed)


def _add_rows(
    table: Table,
    character: Character,
    names: tuple[str, str],
    motions: Sequence[str],
    rounds: int,
    first: bool,
) -> bool:
    """Add the row of a controller, and before the first of a set that of its clips.

    Return whether it fails.
    """
    controller = choose_controller(names[1], character, motions)
    clips = clip_positions(character, walked_clips(character, controller(character, 1.0, None)))
    leans = [lean_deg(character, each) for each in clips]
    if first:
        every = np.concatenate(clips)
        leaned = f"{lean_deg(character, every):.1f}, {max(leans):.1f}"
        table.add_row(names[0], "clips", "", "", "", leaned, f"{beyond(character, every):.1f}")
    seen = film(character, controller, rounds)
    found = [each for pair in answers(seen).values() for each in pair]
    runs = settling(seen)
    scaled = BODY_HEIGHT_M / character.height
    own_jumps = [velocity_jumps(each[:, joints_of(character)] * scaled) for each in clips]
    jumps, held = velocity_jumps(seen.before_layers), velocity_jumps(seen.joints)
    own = np.concatenate(own_jumps)
    ratios = [
        np.quantile(each, share) / np.quantile(own, share)
        for each, share in ((jumps, 1.0), (jumps, 0.999), (held, 0.999))
    ]
    lean, slide = lean_deg(character, seen.positions), measure(seen.take).mean
    table.add_row(
        "",
        names[1],
        f"{np.mean([start for start, _ in found]):.1f}",
        f"{np.mean([end for _, end in found]):.1f}",
        f"{np.median(runs):.0f}, {max(runs)}",
        f"{lean:.1f}",
        f"{beyond(character, seen.positions):.1f}",
        f"{slide:.1f}",
        ", ".join(f"{ratio:.2f}" for ratio in ratios),
        f"{np.median(seen.milliseconds):.2f}, {seen.milliseconds.max():.0f}",
    )
    beyond_clips = slide >= MAX_SLIDE_MM_S or ratios[0] > MAX_JUMP or lean > max(leans)
    return names[1] != "tree" and bool(beyond_clips)


if __name__ == "__main__":
    sys.exit(main())

"""Whether a body whose parts play different clips looks like one person.

`python -m tests.bench.coherence` lets controllers walk the script of `tests.bench.controllers` with
parts of the body and without, and prints for each, and for the clips:

apart
    Share of frames in which parts play, or pass over to, different moments [%].
phase
    Between the swing of the arms and that of the opposite legs, while it walks or runs: median of
    the size, and 95th percentile [°]; 0 if each hand is ahead with the other side's foot.
lean
    Of the trunk from the vertical, 95th percentile [°].
taken up
    How much of the legs' angular momentum about the vertical axis the arms take up [%]: the
    coefficient of a regression, over all frames. It is negative where they add to it. Bodies are
    point masses in segments (P. de Leva, 1996).
jump, slide
    As in `tests.bench.controllers`: the largest change of velocity, as a multiple of the clips',
    and of planted feet [mm/s].

"whole" is matching without parts, "hands only" with arms that are matched by their own motion, not
to the steps of the legs: what the rest of the features is for. Exits with 1 if parts are further
out of phase than the controller without them, by the median, by more than `MAX_PHASE_DEG`, lean
more by more than `MAX_LEAN_DEG`, or take up less by more than `MAX_MOMENTUM`.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.characters import Character, CharacterCommand, Clip, Pose, choose_controller
from cubeling.characters.control.controllers import ControllerFactory
from cubeling.characters.control.controllers.controller import CharacterController, ControllerFrame
from cubeling.characters.control.controllers.graph import GraphController
from cubeling.characters.control.controllers.matching import MatchingController, prepare_database
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.synthesis.matching.database import ARM_WEIGHTS, MotionDatabase
from cubeling.characters.synthesis.matching.features import FeatureSpace, clip_features
from cubeling.characters.synthesis.transitions.live import PartsSource
from tests.bench.controllers import (
    SETS,
    Array,
    clip_positions,
    film,
    joints_of,
    lean_deg,
    velocity_jumps,
    walked_clips,
)
from tests.bench.feet import BODY_HEIGHT_M, FRAME_RATE, measure

MAX_PHASE_DEG, MAX_LEAN_DEG, MAX_MOMENTUM = 10.0, 2.0, 10.0
"""By how much parts may be worse before the benchmark fails; the last in per cent."""

WALKING_M_S = 0.5
"""Slower bodies have no steps that could be in phase."""

SLOW_S = 1.2
"""What changes more slowly than this is no swing of a step [s]."""

SIDES = ("left", "right")
LEGS = {"UpperLeg": ("LowerLeg", 0.1416), "LowerLeg": ("Foot", 0.0433), "Foot": ("Toes", 0.0137)}
ARMS = {"UpperArm": ("LowerArm", 0.0271), "LowerArm": ("Hand", 0.0162), "Hand": ("Hand", 0.0061)}
"""Ends of the segments, and their share of the body's mass."""

TRUNK = {"hips": ("neck", 0.4346), "head": ("head", 0.0694)}


def swings(character: Character, at: Array) -> tuple[Array, Array]:
    """Return how far the left hand and the right foot are ahead of the other, (frames,) [m]."""
    joint = character.anatomy.joints
    hands, feet = (
        at[:, joint["left" + part], 2] - at[:, joint["right" + part], 2]
        for part in ("Hand", "Foot")
    )
    return hands, -feet


def without_slow(values: Array) -> Array:
    """Return values (frames, …) less their mean over `SLOW_S`."""
    count = round(SLOW_S * FRAME_RATE)
    padded = np.pad(values, (count // 2, count - 1 - count // 2), mode="edge")
    smooth: Array = values - np.convolve(padded, np.full(count, 1 / count), "valid")
    return smooth


def phase_differences(hands: Array, feet: Array, walking: NDArray[np.bool_]) -> Array:
    """Return the phase of one swing after the other's where a body walks, (n,) [°]."""
    signals = [_analytic(without_slow(each)) for each in (hands, feet)]
    apart = np.degrees(np.angle(signals[0] * np.conj(signals[1])))
    sizes = [np.abs(signal) for signal in signals]
    swinging = np.logical_and.reduce([size > 0.3 * np.median(size[walking]) for size in sizes])
    found: Array = apart[walking & swinging]
    return found


def _analytic(values: Array) -> NDArray[np.complex128]:
    """Return the analytic signal of values (n,): its angle is their phase (D. Gabor, 1946)."""
    spectrum = np.fft.fft(values)
    spectrum[len(values) // 2 + 1 :] = 0.0
    spectrum[1 : (len(values) + 1) // 2] *= 2.0
    return np.fft.ifft(spectrum)


def momenta(character: Character, at: Array, heading: Array) -> tuple[Array, Array]:
    """Return the angular momentum of legs and of arms about the vertical axis, (frames,)."""
    joint = character.anatomy.joints
    turn = rotations.about("y", heading)[:, None]
    placed = rotations.rotate(turn, at)
    groups = []
    for segments in (TRUNK, LEGS, ARMS):
        sides = ("",) if segments is TRUNK else SIDES
        ends = [(side + a, side + b, m) for a, (b, m) in segments.items() for side in sides]
        middles = [(placed[:, joint[a]] + placed[:, joint[b]]) / 2 for a, b, _ in ends]
        groups.append((np.stack(middles, 1), np.array([mass for *_, mass in ends])))
    every = np.concatenate([middles for middles, _ in groups], axis=1)
    masses = np.concatenate([mass for _, mass in groups])
    centre = (every * masses[:, None]).sum(1, keepdims=True) / masses.sum()
    found = []
    for centres, mass in groups[1:]:
        arm = centres - centre
        velocity = np.gradient(arm, axis=0) * FRAME_RATE
        moment = arm[..., 2] * velocity[..., 0] - arm[..., 0] * velocity[..., 2]
        found.append(without_slow((moment * mass).sum(1)))
    return found[0], found[1]


def clip_motion(character: Character, clip: Clip) -> tuple[Array, Array, Array]:
    """Return positions in the character's frame, headings and speeds of a clip at 60 Hz."""
    times = np.arange(0.0, clip.duration, 1 / FRAME_RATE)
    at = Pose.of_frames([clip.sample(time) for time in times]).globals(character.skeleton)
    steps = [clip.travel(time, time + 1 / FRAME_RATE) for time in times]
    heading = np.cumsum([step.yaw for step in steps])
    speed = np.array([np.hypot(step.x, step.z) * FRAME_RATE for step in steps])
    return at[..., :3, 3], heading, speed


def measures(
    character: Character, motions: Sequence[tuple[Array, Array, Array]]
) -> tuple[float, float, float, float]:
    """Return phase (median, 95th percentile), lean and the share that arms take up."""
    phases, legs, arms = [], [], []
    for at, heading, speed in motions:
        walking = speed > WALKING_M_S
        if walking.sum() > FRAME_RATE / 2:
            phases.append(np.abs(phase_differences(*swings(character, at), walking)))
            own = momenta(character, at, heading)
            legs.append(own[0][walking])
            arms.append(own[1][walking])
    phase, leg, arm = map(np.concatenate, (phases, legs, arms))
    taken = -100.0 * float(leg @ arm / (leg @ leg))
    lean = lean_deg(character, np.concatenate([at for at, *_ in motions]))
    return float(np.median(phase)), float(np.quantile(phase, 0.95)), lean, taken


def hands_only(database: MotionDatabase) -> MotionDatabase:
    """Return a database whose arms are matched by their own motion alone."""
    features = [clip_features(clip, database.skeleton, database.joints) for clip in database.clips]
    weights = {name: w if "hand" in name else 1e-9 for name, w in ARM_WEIGHTS.items()}
    return replace(database, arms=FeatureSpace.of(features, weights))


def choices(
    character: Character, motions: Sequence[str]
) -> list[tuple[str, str, Callable[[], ControllerFactory]]]:
    """Return the controllers: name, that of the one without parts, and what makes them."""
    database = prepare_database(character, motions)

    def matching(base: MotionDatabase) -> ControllerFactory:
        return partial(MatchingController, database=base)

    return [
        ("graph", "", lambda: choose_controller("graph", character, motions)),
        ("parts", "graph", lambda: choose_controller("parts", character, motions)),
        ("whole", "", lambda: matching(replace(database, arms=None))),
        ("hands only", "", lambda: matching(hands_only(database))),
        ("matching", "whole", lambda: matching(database)),
    ]


def watched(controller: ControllerFactory, apart: list[bool]) -> ControllerFactory:
    """Return a controller that notes, each frame, whether its parts play different moments."""

    def make(character: Character, scale: float, place: RootDelta | None) -> CharacterController:
        made = controller(character, scale, place)
        update = made.update

        def noted(command: CharacterCommand, elapsed: float, tempo: float = 1.0) -> ControllerFrame:
            frame = update(command, elapsed, tempo)
            apart.append(_is_apart(made))
            return frame

        vars(made)["update"] = noted
        return made

    return make


def _is_apart(controller: CharacterController) -> bool:
    """Return whether parts play different moments now."""
    if isinstance(controller, GraphController):
        source = controller._live.source
        return isinstance(source, PartsSource) and source._planned is not None
    assert isinstance(controller, MatchingController)
    legs, arms = controller.motion._legs.play, controller.motion._arms.play
    later = (legs.head.time - legs.time) - (arms.head.time - arms.time)
    same = legs.head.clip == arms.head.clip and abs(later) < 1 / FRAME_RATE
    return controller.database.arms is not None and not same


def main() -> int:
    """Print the table and return an exit code."""
    parser = argparse.ArgumentParser(description="Whether parts of a body look like one person.")
    parser.add_argument("--sets", default=",".join(name.replace(", ", "+") for name in SETS))
    parser.add_argument("--rounds", type=int, default=2, help="of 14 requests each")
    options = parser.parse_args()
    character, failed = Character.load("human"), False
    for name in [each.replace("+", ", ") for each in options.sets.split(",")]:
        table = Table("set", "controller", "apart", "phase", "lean", "taken up", "jump", "slide")
        motions = tuple(map(str, SETS[name]))
        found: dict[str, tuple[float, float, float, float]] = {}
        for row, without, make in choices(character, motions):
            controller, apart = make(), list[bool]()
            clips = walked_clips(character, controller(character, 1.0, None))
            if not found:
                found["clips"] = measures(character, [clip_motion(character, c) for c in clips])
                table.add_row(name, "clips", "", *_cells(found["clips"]))
            seen = film(character, watched(controller, apart), options.rounds)
            found[row] = measures(character, [(seen.positions, seen.heading, seen.speed)])
            own = _largest_jump(character, clips)
            jump = float(velocity_jumps(seen.before_layers).max()) / own
            cells = f"{100 * np.mean(apart):.0f}", *_cells(found[row])
            table.add_row("", row, *cells, f"{jump:.2f}", f"{measure(seen.take).mean:.1f}")
            if without:
                on, off = np.array(found[row]), np.array(found[without])
                worse = (on - off)[[0, 2, 3]] * [1.0, 1.0, -1.0]
                failed |= bool((worse > [MAX_PHASE_DEG, MAX_LEAN_DEG, MAX_MOMENTUM]).any())
        Console(width=100).print(table)
    return int(failed)


def _cells(found: tuple[float, float, float, float]) -> tuple[str, str, str]:
    median, most, lean, taken = found
    return f"{median:.0f}, {most:.0f}", f"{lean:.1f}", f"{taken:.0f}"


def _largest_jump(character: Character, clips: Sequence[Clip]) -> float:
    """Return the largest change of velocity in clips [m/s of a person 1.7 m tall]."""
    scale, joints = BODY_HEIGHT_M / character.height, joints_of(character)
    positions = [each[:, joints] * scale for each in clip_positions(character, clips)]
    return max(float(velocity_jumps(each).max()) for each in positions)


if __name__ == "__main__":
    sys.exit(main())

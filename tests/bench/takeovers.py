"""Takeovers: how fast joints turn where one act replaces another.

`python -m tests.bench.takeovers [CHARACTER …] [--worst N] [--pair FIRST:SECOND …]`

Every kind of act is played alone, from idle to its end, and then every ordered pair of kinds: the
second begins at several moments of the first, which is given up at once, as when a person speaks,
presses a key or lifts the cube. A place to reach for is before the body wherever that stands by
then, so that the act is the one that was played alone. The largest speed of any joint beside its
parent, eyes and springs apart, is compared with that of the faster of the two alone. Exits with 1
if a pair exceeds `MAX_RATIO`.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.checkpoint import Checkpoint
from cubeling.characters import (
    ActionIntent,
    Animator,
    Character,
    CharacterCommand,
    LocomotionIntent,
)
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.gestures.timing import natural_times
from cubeling.characters.behaviour.intents import (
    BehaviourIntent,
    ClipIntent,
    GestureIntent,
    HeadIntent,
    PostureIntent,
    ReachIntent,
    StrokeTimes,
    Times,
)
from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.control.loading import load_to_play
from cubeling.characters.skeleton import rotations
from cubeling.characters.speech.mouth import phones_from_sound
from cubeling.characters.speech.prosody.analysis import utterance_of
from cubeling.characters.speech.speech import GestureSpan, Speech

MAX_RATIO = 1.2
"""Bar of issue 59: speed at a takeover ÷ that of the faster of the two acts alone."""

FRAME_S = 1 / 60
IDLE_S = 1.0
"""How long a character stands before its first act [s]."""

ACT_S, AFTER_S = 5.0, 1.5
"""How long an act is played alone, and looked at after a takeover [s]."""

MOMENTS = (0.12, 0.3, 0.45, 0.6, 0.8, 1.0, 1.2, 1.5, 1.9, 2.6)
"""When a takeover is, from the begin of the first act [s]."""

MODELS = Path(__file__).parents[2] / ".." / "shared" / "data" / "gltf"
STRANGERS = ("RiggedFigure.glb", "dino_t-rex.glb")
"""Models of others that are measured where they are there."""

AHEAD, BESIDE = np.array([0.0, 99.0]), np.array([0.6, 0.4])

Fields = dict[str, Any]
Act = Callable[[float], Fields]
"""Returns the fields of a command at the time at which an act has begun [s]."""


@dataclass(frozen=True)
class Peak:
    """The largest speed of a joint."""

    speed: float
    """[rad/s]."""

    joint: str = ""

    time: float = 0.0
    """When, after the act began [s]."""


def acts_of(
    character: Character, animator: Animator, placed: Callable[[], NDArray[np.float64]]
) -> dict[str, Act]:
    """Return every kind of act that a character can do; `placed` returns where it is, (4, 4)."""
    height = character.height * animator.scale
    place = np.array([0.15 * height, 0.6 * height, 0.35 * height]) / animator.scale

    def before_it() -> NDArray[np.float64]:
        table = placed()
        return np.asarray(table[:3, :3] @ place + table[:3, 3])

    said = _said()
    acts: dict[str, Act] = {"idle": lambda begun: {}}
    for name, speed, target in (("walk", 2.0, AHEAD), ("run", 4.5, AHEAD), ("turn", 2.0, BESIDE)):
        acts[name] = _always("locomotion", LocomotionIntent(speed, target))
    for name in animator.actions[:3]:
        acts[name] = _always("action", ActionIntent(name, 0.5))
    for name in ("WAVE", "OPEN_ARMS", "FACEPALM"):
        acts[name] = _gesturing(name)
    acts["reach"] = lambda begun: _body(
        reaches=(ReachIntent("it", before_it(), Times(begun, begun + 0.6), "touch", "right"),)
    )
    acts["crouch"] = lambda begun: _body(
        postures=(PostureIntent("it", "CROUCHING", Times(begun, begun + 0.8)),)
    )
    clip = next((name for name in character.clips if name in ("wave", "kiss_head", "nod")), "")
    waved = StrokeTimes(0.0, 0.3, 1.7, 2.0, 0.3, 1.0, 1.7)
    if clip:
        acts["clip"] = lambda begun: _body(clips=(ClipIntent("it", clip, _later(waved, begun)),))
    acts["speech"] = lambda begun: {"speech": SpeechIntent(said, begun)}
    acts["script"] = lambda begun: _body(
        gestures=(_gesture("POINT_FORWARD", begun), _gesture("CROSS_ARMS", begun + 1.2)),
        heads=(HeadIntent("nod", "NOD", _later(StrokeTimes(0, 0.2, 1, 1.3, 0.2, 0.5, 1), begun)),),
        postures=(PostureIntent("it", "LEANING_FORWARD", Times(begun, begun + 0.6)),),
    )
    return acts


def _always(field: str, intent: object) -> Act:
    return lambda begun: {field: intent}


def _gesturing(name: str) -> Act:
    return lambda begun: _body(gestures=(_gesture(name, begun),))


def _body(**intents: Any) -> Fields:
    return {"behaviour": BehaviourIntent(**intents)}


def _gesture(name: str, begun: float) -> GestureIntent:
    gesture = GestureCollection.load_bundled().get(name)
    return GestureIntent(f"{name}@{begun:g}", gesture, natural_times(gesture, begun))


def _later(times: StrokeTimes, begun: float) -> StrokeTimes:
    return StrokeTimes(**{name: value + begun for name, value in vars(times).items()})


def _said() -> Any:
    """Return four seconds of a buzz in syllables, with two tagged gestures."""
    rate, seconds = 16000, 4.0
    times = np.arange(round(seconds * rate)) / rate
    syllable = np.floor(4.0 * times)
    loudness = (0.3 + 0.7 * np.abs(np.sin(1.3 * syllable))) * np.maximum(
        np.sin(8.0 * np.pi * times), 0.0
    )
    phase = np.cumsum(140.0 + 40.0 * np.sin(2.1 * syllable)) * 2.0 * np.pi / rate
    buzz = (0.3 * loudness * sum(np.sin(n * phase) / n for n in range(1, 8))).astype(np.float32)
    tags = (GestureSpan("SHRUG", 0.3, 1.5), GestureSpan("POINT_SELF", 2.0, 3.2))
    said = utterance_of(Speech(buzz, rate, phones=phones_from_sound(buzz, rate)))
    return replace(said, gestures=tags)


class Player:
    """Plays acts of one character, from checkpoints."""

    def __init__(self, character: Character) -> None:
        self._animator = Animator(character)
        self._placed = np.eye(4)
        self.acts = acts_of(character, self._animator, lambda: self._placed)
        # What swings follows the body by its own laws, and eyes leap.
        swinging = {bone.joint for bone in character.springs}
        self._joints = np.array(
            [
                number
                for number, name in enumerate(character.skeleton.names)
                if name not in swinging and "eye" not in name.lower()
            ]
        )
        self._names = character.skeleton.names
        self._shown: NDArray[np.float64] | None = None
        self._play(lambda begun: {}, 0.0, 0.0, IDLE_S)
        self._standing = self._copy()

    def alone(self, name: str) -> tuple[Peak, list[Checkpoint]]:
        """Return the peak of an act alone, and copies of the character at `MOMENTS` of it."""
        self._restore(self._standing)
        peak, now, copies = Peak(0.0), 0.0, []
        for moment in (*MOMENTS, ACT_S):
            found = self._play(self.acts[name], IDLE_S, IDLE_S + now, IDLE_S + moment)
            peak, now = max(peak, found, key=lambda each: each.speed), moment
            if moment != ACT_S:
                copies.append(self._copy())
        return peak, copies

    def takeover(self, name: str, copies: Sequence[Checkpoint]) -> Peak:
        """Return the peak of an act that takes over from another one at one of `MOMENTS`."""
        peak = Peak(0.0)
        for moment, copy in zip(MOMENTS, copies, strict=True):
            self._restore(copy)
            now = IDLE_S + moment
            found = self._play(self.acts[name], now, now, now + AFTER_S)
            if found.speed > peak.speed:
                peak = replace(found, joint=f"{found.joint} at {moment:g} s")
        return peak

    def _copy(self) -> Checkpoint:
        state = {"animator": self._animator, "shown": self._shown, "placed": self._placed}
        return Checkpoint(state)

    def _restore(self, copy: Checkpoint) -> None:
        content = copy.content()
        self._animator, self._shown = content["animator"], content["shown"]
        self._placed = content["placed"]

    def _play(self, act: Act, begun: float, start: float, end: float) -> Peak:
        frames = round((end - start) / FRAME_S)
        shown, fields = [] if self._shown is None else [self._shown], act(begun)
        for frame in range(frames):
            posed = self._animator.update(CharacterCommand(start + (frame + 1) * FRAME_S, **fields))
            self._placed = posed.table_from_character
            shown.append(posed.pose.rotations[self._joints])
        self._shown = shown[-1]
        turns = np.array(shown)
        steps = rotations.multiply(rotations.conjugate(turns[:-1]), turns[1:])
        speeds = np.linalg.norm(rotations.to_rotation_vector(steps), axis=-1) / FRAME_S
        latest, joint = np.unravel_index(np.argmax(speeds), speeds.shape)
        name = self._names[self._joints[joint]]
        time = float(start - begun + (latest + 1) * FRAME_S)
        return Peak(float(speeds.max()), name, time)


def measure(name: str, worst: int, pairs: Sequence[str], console: Console) -> float:
    """Print the table of one character, of some pairs or all, and return its largest ratio."""
    player = Player(load_to_play(name))
    alone, copies = {}, {}
    asked = {tuple(pair.split(":")) for pair in pairs}
    for each in player.acts:
        if not asked or any(each in pair for pair in asked):
            alone[each], copies[each] = player.alone(each)
    table = Table(f"{Path(name).name}: ratio", *player.acts)
    found: list[tuple[float, str, str, Peak]] = []
    for first in alone:
        row = []
        for second in player.acts:
            if second == first or (asked and (first, second) not in asked):
                row.append("")
                continue
            peak = player.takeover(second, copies[first])
            ratio = peak.speed / max(alone[first].speed, alone[second].speed)
            found.append((ratio, first, second, peak))
            row.append(f"[red]{ratio:.2f}[/]" if ratio > MAX_RATIO else f"{ratio:.2f}")
        table.add_row(f"{first} ({alone[first].speed:.1f})", *row)
    console.print(table)
    found.sort(key=lambda each: -each[0])
    over = sum(each[0] > MAX_RATIO for each in found)
    console.print(f"{over} of {len(found)} pairs above {MAX_RATIO}; the worst:")
    for ratio, first, second, peak in found[:worst]:
        console.print(
            f"  {first} to {second}: x {ratio:.2f}, {peak.speed:.1f} rad/s "
            f"({alone[first].speed:.1f} and {alone[second].speed:.1f} alone), "
            f"{peak.joint}, {peak.time:.2f} s after"
        )
    return found[0][0]


def main() -> int:
    """Print the tables and return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("characters", nargs="*")
    parser.add_argument("--worst", type=int, default=8, help="how many pairs are listed")
    parser.add_argument("--pair", action="append", default=[], help="FIRST:SECOND instead of all")
    asked = parser.parse_args()
    strangers = [str(MODELS / name) for name in STRANGERS if (MODELS / name).exists()]
    console = Console(highlight=False, width=200)
    ratios = [
        measure(name, asked.worst, asked.pair, console)
        for name in asked.characters or ["human", "vleo", *strangers]
    ]
    return int(max(ratios) > MAX_RATIO)


if __name__ == "__main__":
    sys.exit(main())

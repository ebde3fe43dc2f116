"""When what is heard: a function of the steps alone, so that a replay sounds the same."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cubeling.affect import closest_word
from cubeling.app.pipeline.step import Performance, Step
from cubeling.app.sound.sounds import MOOD_SOUNDS
from cubeling.characters import Character, Footfalls, PosedCharacter

EDGE_RAD = math.radians(30.0)
"""A character at this angle from the middle of the picture is heard on one side only."""

MIN_MOOD_S = 1.0
"""Shortest time between two sounds of the robot [s]."""

ROBOT_RATES = (1.0, 0.8)
"""How fast the sounds of the players' robots are played: the second one is heard to be another."""

MOUTHS = {"kiss": ("ou", 1.05, 0.4), "shout": ("aa", 0.5, 0.3)}
"""For actions that sound each time the mouth moves: the morph, the weight from which on it sounds,
and the weight below which it may sound again. "mwah" begins before the lips part."""

GAIT_STATES = ("walk", "run")
"""States of a character in which all feet leave the ground without a leap."""

NO_ACTIONS = ("idle", "hop", *GAIT_STATES)
"""States of a character that are no actions."""

LEAP_CLEARANCE = 0.035
"""A character whose feet are all this high leaps [body heights]."""

STOMP_SPEED = 2.0
"""A foot that comes down faster than this in an action stomps [body heights/s]."""


@dataclass(frozen=True)
class Cue:
    """A sound that begins with a frame."""

    name: str
    """Name of the sound: one of `SOUNDS`, or an action of the character."""

    gain: float = 1.0
    """Factor of its amplitude, 0…1."""

    pan: float = 0.0
    """Where it is heard, from left, −1, to right, 1."""

    rate: float = 1.0
    """How fast it is played; above 1 it is higher and shorter."""

    variant: int = 0
    """How many cues of this name there were before; the variants of a sound take turns."""


class SoundCues:
    """Finds what is heard with each step of a session, in the order of time.

    Parameters
    ----------
    character
        The character of the steps.
    moods
        Whether the moods of each player's robot are heard.
    """

    def __init__(self, character: Character, *, moods: Sequence[bool] = (True,)) -> None:
        self._feet = _FootCues(character)
        self._actions = _ActionCues(character)
        rates = zip(moods, ROBOT_RATES, strict=False)
        self._moods = [_MoodCues(rate) if heard else None for heard, rate in rates]
        self._points = 0
        self._counts: Counter[str] = Counter()

    def update(self, step: Step, started_over: bool = False) -> list[Cue]:
        """Return the sounds that begin with a step.

        `started_over` says whether the player asked to start over in this frame.
        """
        cues = [Cue("start_over")] if started_over else []
        if step.controls.placed:
            cues.append(Cue("placed"))
        points = sum(len(path.points) + path.closed for path in step.outcome.floor)
        if points > self._points:
            cues.append(Cue("pencil"))
        self._points = points
        for moods, each in zip(self._moods, step.cast, strict=False):
            cues += [] if moods is None else moods.update(each)
        if step.posed.visible:
            pan = pan_of(step.posed, step)
            actions = self._actions.update(step.posed)
            if step.command.speaks:
                actions = []  # the character has one mouth
            heard = [*actions, *self._feet.update(step.posed)]
            cues += [replace(cue, pan=pan) for cue in heard]
        return [self._with_variant(cue) for cue in cues]

    def _with_variant(self, cue: Cue) -> Cue:
        """Return a cue with the number of its variant."""
        self._counts[cue.name] += 1
        return replace(cue, variant=self._counts[cue.name] - 1)


class _FootCues:
    """Steps, leaps and landings; a heavy body sounds lower, and the left foot unlike the right."""

    def __init__(self, character: Character) -> None:
        self._footfalls = Footfalls(character.skeleton, character.height)
        self._rate = max(character.height, 1e-3) ** -0.15
        self._leaping = False

    def update(self, posed: PosedCharacter) -> list[Cue]:
        falls = self._footfalls.update(posed.pose, posed.table_from_character, posed.timestamp)
        speed = max((fall.speed for fall in falls), default=0.0)
        landed = self._leaping and bool(falls)
        stomps = posed.state not in NO_ACTIONS and speed > STOMP_SPEED
        cues: list[Cue] = []
        if len(falls) > 1 or landed or stomps:
            cues.append(Cue("land", _clip_gain(0.2 + 0.2 * speed), rate=self._rate))
        else:
            name = "running_step" if posed.state == "run" else "step"
            for fall in falls:
                rate = self._rate * (1.03 if fall.foot % 2 else 0.97)
                cues.append(Cue(name, _clip_gain(0.25 + 0.22 * fall.speed), rate=rate))
        leaps = self._footfalls.clearance > LEAP_CLEARANCE and posed.state not in GAIT_STATES
        if leaps and not self._leaping:
            cues.append(Cue("hop"))
        self._leaping = leaps or (self._leaping and not falls)
        return cues


class _ActionCues:
    """The sounds of actions: when the mouth moves, else when the action begins."""

    def __init__(self, character: Character) -> None:
        self._mouths = {
            action: (character.morphs.index(morph), *weights)
            for action, (morph, *weights) in MOUTHS.items()
            if morph in character.morphs
        }
        self._state = ""
        self._waiting = True

    def update(self, posed: PosedCharacter) -> list[Cue]:
        begins, self._state = posed.state != self._state, posed.state
        if posed.state in NO_ACTIONS:
            return []
        self._waiting |= begins
        sounds = begins
        if posed.state in self._mouths and posed.pose.morphs is not None:
            morph, least, most = self._mouths[posed.state]
            weight = float(posed.pose.morphs[int(morph)])
            sounds = self._waiting and weight > least
            self._waiting = not sounds and (self._waiting or weight < most)
        return [Cue(posed.state, _clip_gain(0.8 + 0.2 * posed.weight))] if sounds else []


class _MoodCues:
    """A robot's voice: heard when its mood has another word."""

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self._label: str | None = None
        self._last = -math.inf

    def update(self, performance: Performance) -> list[Cue]:
        emotion, now = performance.emotion.emotion, performance.emotion.timestamp
        if self._label is not None and performance.command.speaks:
            return []  # the robot listens, and answers afterwards
        if self._label is None:
            self._label = emotion.label
        if emotion.label == self._label or now - self._last < MIN_MOOD_S:
            return []
        self._label, self._last = emotion.label, now
        return [Cue(closest_word(MOOD_SOUNDS, emotion) or "neutral", rate=self._rate)]


def pan_of(posed: PosedCharacter, step: Step) -> float:
    """Return where a character of a step is heard, by its direction from the camera."""
    if step.controls.camera_from_table is None:
        return 0.0
    x, _, z, _ = step.controls.camera_from_table @ posed.table_from_character[:, 3]
    return float(np.clip(math.atan2(x, z) / EDGE_RAD, -1.0, 1.0))


def _clip_gain(gain: float) -> float:
    return min(max(gain, 0.0), 1.0)

"""A character that performs blocks, frame by frame, with its voice."""

import math
import re
import zlib
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.affect import Emotion
from cubeling.app.behaving.voice import LineSource
from cubeling.app.behaving.walking_times import SPEEDS, WalkingTimes
from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.characters import (
    Animator,
    Character,
    CharacterCommand,
    CharacterError,
    LocomotionIntent,
    PosedCharacter,
    RootDelta,
    SpeechIntent,
)
from cubeling.characters.behaviour import (
    BML,
    NEUTRAL,
    Block,
    BmlWarning,
    CannotRealize,
    CharacterRealizer,
    Feedback,
    GestureCollection,
    GestureExpressivity,
    NamedPlaces,
    RealizationContext,
    RealizedFrame,
    Realizer,
    Saying,
    behaviours_of,
    numbers_of,
    parse,
    parse_dialect,
    retime_speeches,
    shown_by,
)
from cubeling.characters.speech import Utterance

VIEWER = np.array([0.1, 0.16, 0.7])
"""The place called "viewer", in the table frame [m]."""

CUBE = np.array([0.16, 0.03, 0.12])
"""The place called "cube" where there is none: before the character, to its left [m]."""

LEFT, RIGHT = np.array([0.4, 0.12, 0.25]), np.array([-0.4, 0.12, 0.25])
"""The places called "left" and "right" [m]."""

EYE_SHARE = 0.88
"""Height of the eyes of a body without eyes, as a part of its height."""


MAX_PLACES = 64
"""Places by name, those included that are given to unknown targets."""

MAX_RECENT_LETTERS = 20_000
"""Letters of the lines whose sound is kept, besides the last one."""


@dataclass(frozen=True)
class BehaviourOptions:
    """How blocks are performed."""

    expressivity: GestureExpressivity = NEUTRAL
    """How gestures are performed unless they say it."""

    emotion: Emotion | None = None
    """What the character feels; None for nothing in particular."""

    seed: int = 0
    """Of blinks and sway."""

    targets: Mapping[str, NDArray[np.float64]] | None = None
    """Places by name besides viewer, cube, left and right, (3,) in the table frame [m]."""

    strict: bool = False
    """Whether only BML 1.0 and FML are read; else also drafts and dialects, with warnings."""


@dataclass(frozen=True, eq=False)
class BehaviourFrame:
    """What a player shows and reports for one frame."""

    posed: PosedCharacter
    """The character with its pose and its place on the table."""

    realized: RealizedFrame
    """What it does in this frame for the active behaviours."""

    feedback: tuple[Feedback, ...]
    """What has happened since the last frame."""


class BehaviourPlayer:
    """Performs blocks with a character.

    Parameters
    ----------
    character
        Who performs.
    lines
        What its voice says; the caller closes it.
    options
        How.
    """

    def __init__(
        self, character: Character, lines: LineSource, options: BehaviourOptions | None = None
    ) -> None:
        options = options or BehaviourOptions()
        self.emotion = options.emotion
        """What it feels throughout."""
        self._lines = lines
        self._strict = options.strict
        self._animator = Animator(character, place=RootDelta(), seed=options.seed)
        self._ways = WalkingTimes(character)
        self._refused: list[str] = []
        self._recent: deque[SpokenLine] = deque()
        self._eye_height = _eye_height(character)
        places = {"viewer": VIEWER, "cube": CUBE, "left": LEFT, "right": RIGHT}
        places |= {name.lower(): place for name, place in (options.targets or {}).items()}
        self.who = RealizationContext(
            character,
            GestureCollection.load_bundled(),
            NamedPlaces(places),
            self._utterance,
            options.expressivity,
            lambda target, manner: self._ways.time(self._place, target, manner),
        )
        """The character, what it knows and where it is."""
        self._place = RootDelta()
        self._character_realizer = CharacterRealizer(self.who)
        self.realizer = Realizer(self._character_realizer)
        """What keeps the time of the blocks; `play_block` gives it one."""

    def play_block(self, document: str | bytes) -> None:
        """Accept a document of BML or FML; it counts from the next update on."""
        try:
            block = block_of(document, strict=self._strict)
        except CharacterError as error:
            self._refused.append(str(error))
            return
        if not self._strict:
            block = replace(
                block, notes=(*block.notes, *place_unknown(block, self.who.surroundings))
            )
        self.realizer.accept(block)

    def update(self, now: float) -> BehaviourFrame:
        """Advance to a time [s] and return the frame."""
        refused = (BmlWarning("", "PARSING_FAILURE", why, now) for why in self._refused)
        feedback = (*refused, *self.realizer.update(now))
        self._refused = []
        retime_speeches(self.realizer, self.who, now)
        realized = self._character_realizer.frame_of(self.realizer.active(now), now)
        posed = self._animator.update(command_of(realized, self.emotion, self.who))
        self._tell_place(posed)
        return BehaviourFrame(posed, realized, feedback)

    def prepare(self) -> None:
        """Measure what would make a frame late."""
        self._ways.measure()

    def settle(self, seconds: float, rate: float) -> None:
        """Stand for a time before time 0, in frames of a rate [Hz]: eyes find the viewer."""
        for number in range(-round(seconds * rate), 0):
            now = number / rate
            posed = self._animator.update(command_of(RealizedFrame(now), self.emotion, self.who))
            self._tell_place(posed)

    def over(self, now: float) -> bool:
        """Return whether nothing more happens by itself: all is over, or goes on for ever."""
        if self.realizer.idle:
            return True
        times = [time for each in self.realizer.scheduled for time in each.times.values()]
        return bool(times) and not any(now < time < math.inf for time in times)

    def line_of(self, saying: Saying) -> SpokenLine | None:
        """Return the sound of something that is being said."""
        return next((e for e in self._recent if e.utterance is saying.utterance), None)

    def _utterance(self, text: str, language: str) -> Utterance | None:
        line = self._lines.line(text, language)
        if line is None:
            return None
        if line not in self._recent:
            self._recent.append(line)
            letters = sum(len(each.utterance.text) for each in self._recent)
            while letters > MAX_RECENT_LETTERS and len(self._recent) > 1:
                letters -= len(self._recent.popleft().utterance.text)
        return line.utterance

    def _tell_place(self, posed: PosedCharacter) -> None:
        placed = posed.table_from_character
        self.who.surroundings.move(placed, self._eye_height)
        self._place = RootDelta(float(placed[0, 3]), float(placed[2, 3]), self.who.surroundings.yaw)


def block_of(document: str | bytes, *, strict: bool = False) -> Block:
    """Return the block of a document of BML, or of FML by the usual lexicon.

    Unless `strict`, drafts and dialects are read too; `Block.notes` says what was changed.

    Raises
    ------
    CharacterError
        If it is none.
    """
    if not strict:
        return shown_by(parse_dialect(document))
    is_fml = b"<fml" in document if isinstance(document, bytes) else "<fml" in document
    return behaviours_of(document) if is_fml else parse(document)


def place_unknown(block: Block, places: NamedPlaces) -> Iterator[str]:
    """Give places to the targets of a block that nobody knows, and yield a note on each.

    A name has the same place each time: somewhere beside the viewer, or on the table for a thing.
    """
    for behaviour in block.behaviours:
        name = behaviour.get("target").strip().lower()
        if not name or behaviour.namespace != BML or len(places.places) >= MAX_PLACES:
            continue
        try:
            places.point(name)
        except CannotRealize:
            share = zlib.crc32(name.encode()) / 2**32 - 0.5
            aside = math.copysign(0.15 + 0.5 * abs(share), share)
            low = behaviour.kind in ("pointing", "locomotion")
            places.places[name] = VIEWER + (aside, -0.12 if low else 0.0, -0.4 if low else 0.0)
            yield (
                f'line {behaviour.line}: "{name[:80]}" is given a place beside the viewer; '
                f"--target {name[:80]}=x,y,z gives it its own"
            )


def command_of(
    realized: RealizedFrame, emotion: Emotion | None, who: RealizationContext
) -> CharacterCommand:
    """Return the command for what a character does in a frame; it looks at the viewer else."""
    viewer = who.surroundings.places.get("viewer")
    facing = viewer if realized.facing is None else realized.facing
    speed, target = 0.0, None
    if realized.going is not None:
        speed, target = SPEEDS[realized.going.manner], realized.going.target
    speech = None
    if realized.sayings:
        said = realized.sayings[-1]
        speech = SpeechIntent(said.utterance, said.start)
    return CharacterCommand(
        realized.now,
        LocomotionIntent(speed, target, facing=None if facing is None else facing[[0, 2]]),
        gaze=viewer,
        emotion=emotion,
        speech=speech,
        behaviour=realized.intent,
    )


def target_of(text: str) -> tuple[str, NDArray[np.float64]]:
    """Return name and place of NAME=x,y,z.

    >>> target_of("door=1,0,-0.5")
    ('door', array([ 1. ,  0. , -0.5]))

    Raises
    ------
    ValueError
        If it is none.
    """
    found = re.fullmatch(r"([^\s=:]+)=(.+)", text.strip())
    numbers = numbers_of(found[2]) if found else []
    if found is None or len(numbers) != 3:
        raise ValueError(text)
    return found[1], np.array(numbers)


def _eye_height(character: Character) -> float:
    """Return how high the eyes are at rest, in the character frame [m]."""
    places = character.skeleton.rest.globals(character.skeleton)[:, 1, 3]
    eyes = [character.anatomy.joint(part) for part in ("leftEye", "rightEye")]
    heights = [float(places[eye]) for eye in eyes if eye is not None]
    return sum(heights) / len(heights) if heights else EYE_SHARE * character.height

"""What a character does for blocks of BML: its commands, frame by frame."""

import math
import re
import zlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from cubeling.affect import Emotion
from cubeling.app.show.walking_times import SPEEDS, WalkingTimes
from cubeling.characters import (
    Character,
    CharacterCommand,
    CharacterError,
    ComingAct,
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
    Manner,
    NamedPlaces,
    RealizationContext,
    RealizedFrame,
    Realizer,
    XmlElement,
    behaviours_of,
    numbers_of,
    parse,
    parse_dialect,
    retime_speeches,
    shown_by,
)
from cubeling.characters.speech import Utterance
from cubeling.files import FileKind

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

BEHAVIOUR_FILE = FileKind(
    "document",
    (".bml", ".fml", ".xml"),
    CharacterError,
    1 << 20,
    "cubeling.app.show.blocks:read_document",
)
"""A file of BML or FML."""


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


BODY_KINDS = ("gesture", "pointing", "posture", "postureShift", "locomotion")
"""Kinds of behaviours before which a shift of the weight ends."""


class BlockDirector:
    """Directs a character by blocks: what it does in each frame, and what is reported.

    Its state is plain: a checkpoint copies it, if it can copy what `utterance_of` belongs to.

    Parameters
    ----------
    character
        Who performs.
    utterance_of
        Returns what its voice says of a text in a language ("" for the usual one); None while that
        is not known.
    options
        How.
    """

    def __init__(
        self,
        character: Character,
        utterance_of: Callable[[str, str], Utterance | None],
        options: BehaviourOptions | None = None,
    ) -> None:
        options = options or BehaviourOptions()
        self._strict = options.strict
        self._ways = WalkingTimes(character)
        self._refused: list[str] = []
        self._eye_height = _eye_height(character)
        places = {"viewer": VIEWER, "cube": CUBE, "left": LEFT, "right": RIGHT}
        places |= {name.lower(): place for name, place in (options.targets or {}).items()}
        self.who = RealizationContext(
            character,
            GestureCollection.load_bundled(),
            NamedPlaces(places),
            utterance_of,
            options.expressivity,
            self._walk_time,
        )
        """The character, what it knows and where it is."""
        self._place = RootDelta()
        self._character_realizer = CharacterRealizer(self.who)
        self.realizer = Realizer(self._character_realizer)
        """What keeps the time of the blocks."""

    def accept(self, document: str | bytes | Block) -> None:
        """Accept BML or FML; it counts from the next update on."""
        try:
            block = document
            if not isinstance(block, Block):
                block = block_of(block, strict=self._strict)
        except CharacterError as error:
            self._refused.append(str(error))
            return
        if not self._strict:
            notes = place_unknown(block, self.who.surroundings)
            block = replace(block, notes=(*block.notes, *notes))
        self.realizer.accept(block)

    def cut_off(self, block: str) -> None:
        """End a block before its time."""
        self.realizer.accept(Block("", interrupt=(block,)))

    def update(self, now: float) -> tuple[RealizedFrame, tuple[Feedback, ...]]:
        """Advance to a time [s]; return what the character does then, and what has happened."""
        refused = (BmlWarning("", "PARSING_FAILURE", why, now) for why in self._refused)
        feedback = (*refused, *self.realizer.update(now))
        self._refused = []
        retime_speeches(self.realizer, self.who, now)
        return self._character_realizer.frame_of(self.realizer.active(now), now), feedback

    def move(self, posed: PosedCharacter) -> None:
        """Tell where the character is now."""
        placed = posed.table_from_character
        self.who.surroundings.move(placed, self._eye_height)
        self._place = RootDelta(float(placed[0, 3]), float(placed[2, 3]), self.who.surroundings.yaw)

    def coming(self, now: float) -> ComingAct | None:
        """Return when hands or body begin something next, after a time [s]; None for nothing."""
        starts = (e.start for e in self.realizer.scheduled if e.behaviour.kind in BODY_KINDS)
        following = min((start for start in starts if start > now), default=math.inf)
        return ComingAct(following) if following < math.inf else None

    def prepare(self) -> None:
        """Measure what would make a frame late."""
        self._ways.measure()

    def over(self, now: float) -> bool:
        """Return whether nothing more happens by itself: all is over, or goes on for ever."""
        if self.realizer.idle:
            return True
        times = [time for each in self.realizer.scheduled for time in each.times.values()]
        return bool(times) and not any(now < time < math.inf for time in times)

    def _walk_time(self, target: NDArray[np.float64], manner: Manner) -> float:
        return self._ways.time(self._place, target, manner)


def read_document(path: Path, *, strict: bool = False) -> bytes:
    """Return the BML or FML of a file that can be read; drafts and dialects unless `strict`.

    Raises
    ------
    CharacterError
        It is none; the message names the file.
    """
    document = BEHAVIOUR_FILE.read(path)
    try:
        block_of(document, strict=strict)
    except CharacterError as error:
        raise CharacterError(f"{path}: {error}") from None
    return document


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


def document_of(element: XmlElement) -> str:
    """Return an element `bml` of a play as a document of its own."""
    found = ElementTree.Element("")
    _copy(element, found)
    for name in ("who", "file"):
        found.attrib.pop(name, None)
    return ElementTree.tostring(found, "unicode")


def _copy(element: XmlElement, to: ElementTree.Element) -> None:
    """Copy an element with its content; what has no namespace is BML."""
    to.tag = f"{{{element.namespace or BML}}}{element.tag}"
    to.attrib.update(element.attributes)
    last = None
    for part in element.parts:
        if isinstance(part, XmlElement):
            last = ElementTree.SubElement(to, "")
            _copy(part, last)
        elif last is None:
            to.text = (to.text or "") + part
        else:
            last.tail = (last.tail or "") + part


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
    realized: RealizedFrame,
    emotion: Emotion | None,
    who: RealizationContext,
    coming: ComingAct | None = None,
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
        coming=coming,
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

"""Gestures of a tagged text: the behaviours of BML, at the times of its words."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

from cubeling.characters.behaviour.bml.document import Behaviour, Block, SyncReference
from cubeling.characters.behaviour.bml.schedule import Scheduler
from cubeling.characters.behaviour.bml.timing import CannotRealize, Scheduled
from cubeling.characters.behaviour.gesticon import Gesticon
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.gestures.timing import Repeats
from cubeling.characters.behaviour.intents import BehaviourIntent
from cubeling.characters.behaviour.realization.character_realizer import CharacterRealizer
from cubeling.characters.behaviour.realization.frame import RealizationContext
from cubeling.characters.behaviour.realization.hand_kinds import meaning_of
from cubeling.characters.behaviour.realization.surroundings import NamedPlaces
from cubeling.characters.control.command import CharacterCommand, ComingAct, SpeechIntent
from cubeling.characters.face.expressions import EXPRESSIONS
from cubeling.characters.model.character import Character
from cubeling.characters.speech.speech import GestureSpan

HANDS = ("gesture", "clip", "posture")
"""What leaves no hands for the rhythm of a speech."""

LEADS_S = (-0.03, 0.22)
"""How long an apex leads the accent that it belongs to: the middle half of those of people
(Fernández-Baena 2015, section 4.3) [s]."""

MOST_SHIFT_S = 0.3
"""How far the last apex of a gesture is moved to an accent [s]."""

STROKE_SYNCS = {"start", "ready", "strokeStart", "strokeEnd", "relax", "end"}
"""The times of a gesture whose apex is known."""


class GestureCalls:
    """Gestures that a character is asked for by their names, one at a time.

    It changes from frame to frame, and a checkpoint copies it.
    """

    def __init__(self, character: Character) -> None:
        self._character = character
        self._scheduled: tuple[Scheduled, ...] = ()

    @cached_property
    def _realizer(self) -> CharacterRealizer:
        # In most sessions nobody calls for a gesture: they are read with the first one.
        return CharacterRealizer(_context(self._character))

    def begin(self, name: str, now: float) -> None:
        """Make a gesture from a time on [s], in its own time and in the place of the one before.

        One that the character does not know is none; `meanings_of` tells.
        """
        start = {"start": SyncReference()}
        called = Behaviour(name, "gesture", syncs=start, attributes={"lexeme": name})
        block = Block(f"called@{now:g}", (called,))
        self._scheduled = _schedule(block, self._realizer, now)

    def intent(self, now: float) -> BehaviourIntent | None:
        """Return what is asked of the body at a time [s]; None for nothing."""
        active = [each for each in self._scheduled if each.start <= now < each.end]
        return self._realizer.frame_of(active, now).intent if active else None


class TaggedGestures:
    """Adds what tagged texts ask for to the commands of a character."""

    def __init__(self, character: Character) -> None:
        self._character = character
        self._speech: SpeechIntent | None = None
        self._scheduled: tuple[Scheduled, ...] = ()

    @cached_property
    def _realizer(self) -> CharacterRealizer:
        # Most sessions have no tagged text: the gestures are read with the first one.
        return CharacterRealizer(_context(self._character))

    def add(self, command: CharacterCommand) -> CharacterCommand:
        """Return a command that asks for the gestures of its speech too."""
        self._follow(command.speech, command.timestamp)
        now = command.timestamp
        starts = (each.start for each in self._scheduled if each.behaviour.kind in HANDS)
        following = min((start for start in starts if start > now), default=math.inf)
        if following < math.inf and (command.coming is None or following < command.coming.start):
            command = replace(command, coming=ComingAct(following))
        active = [each for each in self._scheduled if each.start <= now < each.end]
        if not active:
            return command
        own, asked = self._realizer.frame_of(active, now).intent, command.behaviour
        return replace(command, behaviour=own.joined(asked))

    def _follow(self, speech: SpeechIntent | None, now: float) -> None:
        """Schedule a new speech, and forget one that is cut off."""
        if speech is not None:
            if self._speech is None or speech.start != self._speech.start:
                self._scheduled = self._schedule(speech)
            self._speech = speech
        elif self._speech is not None:
            if now < self._speech.end:
                self._scheduled = ()
            self._speech = None

    def _schedule(self, speech: SpeechIntent) -> tuple[Scheduled, ...]:
        spans = speech.utterance.gestures
        if not spans:
            return ()
        block = Block(f"text@{speech.start:g}", tuple(map(_behaviour, range(len(spans)), spans)))
        scheduled = _schedule(block, self._realizer, speech.start)
        if not speech.profile.liveliness:
            return scheduled
        return tuple(
            replace(each, times=self._on_accent(each.behaviour, each.times, speech))
            for each in scheduled
        )

    def _on_accent(
        self, behaviour: Behaviour, syncs: Mapping[str, float], speech: SpeechIntent
    ) -> Mapping[str, float]:
        """Return the times of a gesture with its last apex by an accent, if one is near."""
        meaning = meaning_of(behaviour, _context(self._character))
        accents = [speech.start + each.time for each in speech.utterance.accents]
        if meaning.kind != "gesture" or not accents or not syncs.keys() >= STROKE_SYNCS:
            return syncs
        gesture = GestureCollection.load_bundled().get(meaning.name)
        repeats = Repeats.of(gesture)
        share = repeats.in_all(repeats.count - 1, gesture.apex * repeats.share)
        first, last = syncs["strokeStart"], syncs["strokeEnd"]
        shift = accent_shift(first + share * (last - first), accents)
        # Preparation and retraction give way, by half of their lengths at most.
        shift = min(shift, 0.5 * (syncs["end"] - syncs["relax"]))
        shift = max(shift, -0.5 * (syncs["ready"] - syncs["start"]))
        return {
            name: time if name in ("start", "end") else time + shift for name, time in syncs.items()
        }


def accent_shift(apex: float, accents: Sequence[float]) -> float:
    """Return how far an apex is to move so that it comes with an accent; 0 if none is near [s].

    >>> round(accent_shift(1.0, [1.3]), 6), accent_shift(1.0, [1.1, 3.0]), accent_shift(1.0, [2.0])
    (0.08, 0.0, 0.0)
    """
    least, most = LEADS_S
    shifts = [accent - apex - min(max(accent - apex, least), most) for accent in accents]
    nearest = min(shifts, key=abs, default=0.0)
    return nearest if abs(nearest) <= MOST_SHIFT_S else 0.0


def known_gestures(character: Character) -> tuple[str, ...]:
    """Return the names that a text may ask a character for, without their other spellings."""
    names = (*GestureCollection.load_bundled().names, *Gesticon.bundled().names, *character.clips)
    return tuple(meanings_of(character, dict.fromkeys((*names, *EXPRESSIONS))))


def meanings_of(character: Character, names: Iterable[str]) -> dict[str, str]:
    """Return what names lead to that a text may ask a character for: gesture, head, face, clip.

    Those that it cannot perform are left out.
    """
    who = _context(character)
    known = dict[str, str]()
    for name in names:
        behaviour = _behaviour(0, GestureSpan(name, 0.0, 1.0))
        try:
            CharacterRealizer(who).timing(behaviour, Block(""))
            known[name] = meaning_of(behaviour, who).kind
        except CannotRealize:
            continue
    return known


def _context(character: Character) -> RealizationContext:
    return RealizationContext(character, GestureCollection.load_bundled(), NamedPlaces())


def spans_with_hands(character: Character, spans: Sequence[GestureSpan]) -> tuple[GestureSpan, ...]:
    """Return the gestures of a text that leave no hands for its rhythm."""
    if not spans:
        return ()
    known = meanings_of(character, [span.name for span in spans])
    return tuple(span for span in spans if known.get(span.name) in HANDS)


def _behaviour(number: int, span: GestureSpan) -> Behaviour:
    """Return the behaviour of BML for a gesture of a text."""
    return Behaviour(
        f"{span.name}{number}",
        "gesture",
        syncs={
            "start": SyncReference(offset=span.start),
            "end": SyncReference(offset=span.end),
        },
        attributes={"lexeme": span.name},
        yielding=True,
    )


def _schedule(block: Block, realizer: CharacterRealizer, start: float) -> tuple[Scheduled, ...]:
    """Return the behaviours of a block with their times, from `start` on [s]."""
    scheduler = Scheduler(block, realizer, lambda _: None)
    return tuple(
        Scheduled(
            block.id,
            track.behaviour,
            dict(zip(track.timing.syncs, track.times, strict=True)),
            {},
        )
        for track in scheduler.schedule(start, ()).tracks.values()
    )

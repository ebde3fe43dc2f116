"""Plays BML behaviours with a character: their natural times, and its body frame by frame."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from cubeling.characters.behaviour.bml import (
    BML,
    Behaviour,
    Block,
    CannotRealize,
    Scheduled,
    Timing,
)
from cubeling.characters.behaviour.realization.body_kinds import (
    LocomotionKind,
    PostureKind,
    PostureShiftKind,
    WaitKind,
)
from cubeling.characters.behaviour.realization.face_kinds import FaceKind, FaceShiftKind
from cubeling.characters.behaviour.realization.frame import (
    Going,
    RealizationContext,
    RealizedFrame,
)
from cubeling.characters.behaviour.realization.hand_kinds import GestureKind, PointingKind
from cubeling.characters.behaviour.realization.head_kinds import GazeKind, GazeShiftKind, HeadKind
from cubeling.characters.behaviour.realization.kinds import BehaviourKind
from cubeling.characters.behaviour.realization.speech_kind import SpeechKind

KINDS: Mapping[str, BehaviourKind] = {
    "speech": SpeechKind(),
    "gesture": GestureKind(),
    "pointing": PointingKind(),
    "head": HeadKind(),
    "headDirectionShift": GazeShiftKind(),
    "gaze": GazeKind(),
    "gazeShift": GazeShiftKind(),
    "face": FaceKind(),
    "faceLexeme": FaceKind(),
    "faceFacs": FaceKind(),
    "faceShift": FaceShiftKind(),
    "posture": PostureKind(),
    "postureShift": PostureShiftKind(),
    "locomotion": LocomotionKind(),
    "wait": WaitKind(),
}
"""The behaviours of the standard by the names of their elements."""


@dataclass(frozen=True)
class _Shift:
    """A shift that stays after its end."""

    kind: BehaviourKind
    scheduled: Scheduled


class CharacterRealizer:
    """Plays behaviours with a character; a `TimingEstimator` for a realizer.

    Parameters
    ----------
    who
        The character, what it knows and where it is.
    kinds
        What it can do, by name.
    """

    def __init__(self, who: RealizationContext, kinds: Mapping[str, BehaviourKind] = KINDS) -> None:
        self.who = who
        """The character, what it knows and where it is."""
        self._kinds = kinds
        self._shifting: dict[str, _Shift] = {}
        self._kept: dict[str, _Shift] = {}
        self._going: Going | None = None

    def timing(self, behaviour: Behaviour, block: Block) -> Timing:
        """Return the natural times of a behaviour.

        Raises
        ------
        CannotRealize
            If this character cannot perform it.
        """
        kind = self._kind(behaviour)
        if kind is None:
            raise CannotRealize(f"<{behaviour.kind}> is not known here")
        return kind.timing(behaviour, self.who)

    def frame_of(self, active: Sequence[Scheduled], now: float) -> RealizedFrame:
        """Return what the character does at a time [s] for the behaviours that are active."""
        shown = RealizedFrame(now)
        started = [each for each in active if each.start <= now]
        self._keep_shifts(started, now)
        for channel, kept in self._kept.items():
            self._add(kept.kind, self._release(kept.scheduled, channel), shown)
        for scheduled in started:
            kind = self._kind(scheduled.behaviour)
            if kind is not None:
                self._add(kind, scheduled, shown)
        self._keep_going(shown)
        keys = {each.key for each in active}
        self.who.late = {key: at for key, at in self.who.late.items() if key in keys}
        return shown

    def _kind(self, behaviour: Behaviour) -> BehaviourKind | None:
        return self._kinds.get(behaviour.kind) if behaviour.namespace == BML else None

    def _add(self, kind: BehaviourKind, scheduled: Scheduled, shown: RealizedFrame) -> None:
        """Add what a behaviour does; one whose target has gone meanwhile does nothing."""
        try:
            kind.realize(scheduled, self.who, shown)
        except CannotRealize:
            return

    def _keep_shifts(self, started: Sequence[Scheduled], now: float) -> None:
        """Let shifts that have come to their end stay; those that were cut off before do not."""
        running: dict[str, _Shift] = {}
        for scheduled in started:
            kind = self._kind(scheduled.behaviour)
            if kind is not None and kind.channel:
                running[scheduled.key] = _Shift(kind, scheduled)
        for key, shift in self._shifting.items():
            if key not in running and now >= shift.scheduled.end:
                self._kept[shift.kind.channel] = shift
        self._shifting = running

    def _release(self, scheduled: Scheduled, channel: str) -> Scheduled:
        """Return a shift that goes as far as another one of its channel comes."""
        newer = [s.scheduled for s in self._shifting.values() if s.kind.channel == channel]
        if not newer:
            return scheduled
        times = {**scheduled.times, "relax": newer[-1].start, "gone": newer[-1].end}
        return replace(scheduled, times=times)

    def _keep_going(self, shown: RealizedFrame) -> None:
        """Let a character that has not quite arrived in time go on; one that is cut off stops."""
        if shown.going is None and self._going is not None and shown.now >= self._going.end:
            shown.going = self._going
        self._going = shown.going

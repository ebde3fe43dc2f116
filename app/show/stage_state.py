"""Where a play is: which cue comes next, and what goes on."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from cubeling.app.pipeline.table.stage_sounds import PlayedSound, SoundClip
from cubeling.app.show.script import ShowCue, ShowScript
from cubeling.characters import ComingAct

MAX_WAIT_S = 6.0
"""A voice that has not answered after so long does not answer any more [s]."""


@dataclass
class OngoingCue:
    """Something that a character does since its cue."""

    cue: ShowCue
    """The cue by which it was begun."""

    since: float
    """When its turn came [s]."""

    end: float
    """When it is over [s]; infinite while that is not known."""

    fades_s: float = 0.0
    """How long it takes to fade out before its end [s]."""

    def share(self, now: float) -> float:
        """Return how much of it is left at a time [s], 0…1."""
        if now >= self.end:
            return 0.0
        return min((self.end - now) / self.fades_s, 1.0) if self.fades_s else 1.0


@dataclass
class StageState:
    """What all of the cast share: plain values, which a checkpoint copies."""

    script: ShowScript
    """What its file says."""

    next: int = 0
    """The cue that comes next."""

    since: float | None = None
    """When the last cue was carried out [s]; None before the beginning."""

    ongoing: dict[int, OngoingCue] = field(default_factory=dict)
    """What was begun, by the number of its cue."""

    orders: dict[int, list[ShowCue]] = field(default_factory=dict)
    """Cues that their characters have not seen yet, by the number in the cast."""

    talks: bool = False
    """Whether the dialogue has taken over."""

    clips: dict[str, SoundClip] = field(default_factory=dict)
    """Its sounds that have come, by their names."""

    comes_back: bool = False
    """Whether the play goes on after it."""

    def advance(self, now: float) -> None:
        """Carry out all cues whose turn has come at a time [s]."""
        cues = self.script.cues
        self.since = now if self.since is None else self.since
        for each in self.ongoing.values():
            if each.end == math.inf and now - each.since > MAX_WAIT_S:
                each.end = now  # no voice has come: the play goes on
        while self.next < len(cues) and not self.talks and self._is_due(cues[self.next], now):
            cue = cues[self.next]
            HANDLERS[cue.kind](self, cue, now)
            self.next, self.since = self.next + 1, now

    def _is_due(self, cue: ShowCue, now: float) -> bool:
        if cue.kind == "sound":  # one that never comes is left out
            return cue.text in self.clips or self.waited(now) > MAX_WAIT_S
        if cue.kind != "wait":
            return True
        if not cue.text:
            return self.waited(now) >= cue.seconds
        awaited = self.named(cue.text)
        return awaited is None or now >= awaited.end - cue.seconds

    def waited(self, now: float) -> float:
        """Return how long ago the last cue was carried out [s]."""
        return 0.0 if self.since is None else now - self.since

    def named(self, name: str) -> OngoingCue | None:
        """Return what was begun by the cue of an id; None for a sound that never came."""
        return next((each for each in self.ongoing.values() if each.cue.id == name), None)

    def begin(self, cue: ShowCue, now: float) -> None:
        """Begin something; when it is over is not known of what is said."""
        end = now + cue.seconds if cue.kind == "do" else math.inf
        self.ongoing[self.next] = OngoingCue(cue, now, end)
        self.orders.setdefault(cue.who, []).append(cue)

    def play(self, cue: ShowCue, now: float) -> None:
        """Begin a sound; one that has not come is left out."""
        if cue.text in self.clips:
            end = now + self.clips[cue.text].duration
            self.ongoing[self.next] = OngoingCue(cue, now, end)

    def sounds(self, now: float) -> tuple[PlayedSound, ...]:
        """Return the sounds that go on at a time [s]."""
        return tuple(
            PlayedSound(
                f"{number}@{each.since:.3f}",
                self.clips[each.cue.text],
                each.since,
                each.cue.value,
                each.end if each.fades_s else math.inf,
            )
            for number, each in self.ongoing.items()
            if each.cue.kind == "sound" and now < each.end
        )

    def stop(self, cue: ShowCue, now: float) -> None:
        """Cut something off, with a fade."""
        stopped = self.named(cue.text)
        if stopped is not None and now < stopped.end:
            stopped.end = min(stopped.end, now + cue.seconds)
            stopped.fades_s = max(stopped.end - now, 1e-9)
            self.orders.setdefault(stopped.cue.who, []).append(cue)

    def order(self, cue: ShowCue, now: float) -> None:
        """Tell a character of a cue that takes no time."""
        self.orders.setdefault(cue.who, []).append(cue)

    def take_orders(self, who: int) -> list[ShowCue]:
        """Return the cues that a character has not seen yet."""
        return self.orders.pop(who, [])

    def expect(self, cue: ShowCue, end: float) -> None:
        """Note when what a cue began is over, as far as is known [s], unless it was cut off."""
        for each in self.ongoing.values():
            known = each.end < math.inf and cue.kind == "say"
            if each.cue is cue and not known and not each.fades_s:
                each.end = end

    def acting(self, who: int, now: float) -> OngoingCue | None:
        """Return the action of a character that began last and goes on."""
        own = [e for e in self.ongoing.values() if e.cue.who == who and e.cue.kind == "do"]
        return next((each for each in reversed(own) if now < each.end), None)

    def speaks(self, who: int, now: float) -> bool:
        """Return whether a character says something at a time [s]."""
        return any(
            each.cue.kind == "say" and each.cue.who == who and now < each.end < math.inf
            for each in self.ongoing.values()
        )

    def coming(self, who: int, now: float) -> ComingAct | None:
        """Return what a character does next by the cues, as far as their times are known."""
        if self.talks or self.since is None:
            return None
        due = self.since
        for cue in self.script.cues[self.next :]:
            if cue.kind == "wait" and not cue.text:
                due += cue.seconds
            elif cue.kind == "wait":
                awaited = self.named(cue.text)
                if awaited is None or awaited.end == math.inf:
                    return None  # it has not begun, or its voice has not answered
                due = max(due, awaited.end - cue.seconds)
            elif cue.kind == "talk":
                return None
            elif cue.who == who and cue.kind in ("do", "say", "bml") and due > now:
                return ComingAct(due, cue.text if cue.kind == "do" else "")
        return None

    def is_over(self, now: float) -> bool:
        """Return whether the last cue was carried out, and nothing goes on."""
        done = self.next == len(self.script.cues) and not self.talks
        return done and all(now >= each.end for each in self.ongoing.values())

    def take_over(self, *, comes_back: bool = False) -> None:
        """Let the dialogue go on from here, for good or until `come_back`."""
        if not self.talks:
            self.talks, self.comes_back = True, comes_back

    def come_back(self, now: float) -> None:
        """Go on with the play at a time [s], with the cue that comes next."""
        self.talks, self.since = False, now
        for each in self.ongoing.values():
            if each.cue.kind != "sound":
                each.end = min(each.end, now)


HANDLERS: dict[str, Callable[[StageState, ShowCue, float], None]] = {
    "say": StageState.begin,
    "do": StageState.begin,
    "bml": StageState.begin,
    "sound": StageState.play,
    "stop": StageState.stop,
    "feel": StageState.order,
    "wait": lambda state, cue, now: None,
    "talk": lambda state, cue, now: state.take_over(),
}
"""What carries out each kind of cue."""

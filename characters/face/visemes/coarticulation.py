"""Coarticulation: how the mouth of a speech runs from one viseme to the next.

Sources: Cohen and Massaro, "Modeling coarticulation in synthetic visual speech", 1993; Egges,
*Real-time Animation of Interactive Virtual Humans*, 2006, section 5.3.1 and appendix D, for the
dominance curves (eqs. 5.12, 5.13); Fernández-Baena, PhD thesis, La Salle – URL, 2015, section 4.5,
for low, neutral and high vowels.

Dominance alone gives a p between two vowels 57 % of the mouth: its lips do not meet. So a contact
of lips or teeth is a constraint on top: around the middle of such a phone its shape takes over
entirely, begins to do so before the sound and lets go after it.
"""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate, pairwise

import numpy as np

from cubeling.characters.face.visemes.sets import (
    MOUTH_SHAPES,
    SoundingViseme,
    VisemeSet,
    viseme_set,
)
from cubeling.characters.motion.curves import ease
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.speech.speech import SILENCE, Phone, Utterance

EMPHASIS_LEVELS = ("low", "neutral", "high")
"""The versions of the shape of a vowel."""

NEUTRAL_LEVEL = EMPHASIS_LEVELS.index("neutral")

PAUSE_BESIDE_S = 0.4
"""The pause before and after a speech, in which the mouth opens and closes [s]."""

LONG_S = 0.2
"""Length from which on a phone only stays longer and does not reach further [s]."""

MIN_PHONE_S = 1e-3
"""Least length that a phone is given [s]."""

MIN_CONTACT_S = 0.042
"""Least time for which lips or teeth touch: a frame at 24 Hz falls into it [s]."""

CONTACT_SHARE = 0.8
"""Share of a phone for which lips or teeth touch."""

CLOSING_S, PARTING_S = 0.075, 0.06
"""How long before a contact it begins to form, and how long after it is over [s]."""

ACCENT_MARGIN_S = 0.03
"""How far outside of a vowel its accent may lie [s]."""

NEUTRAL_STRENGTH = 0.5
"""Strength of a vowel without an accent."""


@dataclass(frozen=True)
class Coarticulation:
    """How visemes run together."""

    visemes: str = "oculus"
    """The name of the set."""

    sharpness: float = 2.0
    """Exponent of the dominance: 1 is published, with which fast vowels are hardly seen."""

    contacts: bool = True
    """Whether lips meet on p, b, m and teeth touch the lip on f, v; False is plain dominance."""


DEFAULT = Coarticulation()
"""How the bundled characters speak."""


def dominance(x: float, alpha: float) -> float:
    """Return the dominance C_α(x) of a viseme (Egges 2006, eq. 5.13); 0 outside of 0…1.

    >>> [round(dominance(x, 1.0), 4) for x in (0.0, 0.25, 0.5, 2.0)]
    [0.0, 0.4226, 1.0, 0.0]
    """
    off = 2.0 * abs(x - 0.5)
    return math.exp(-alpha * off) - off * math.exp(-alpha) if off < 1.0 else 0.0


def level_weights(strength: float) -> tuple[float, float, float]:
    """Return the weights of `EMPHASIS_LEVELS` for a strength of 0…1; they sum to 1.

    >>> level_weights(0.0), level_weights(0.5), level_weights(0.75)
    ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.5, 0.5))
    """
    low, high = max(1.0 - 2.0 * strength, 0.0), max(2.0 * strength - 1.0, 0.0)
    return low, 1.0 - low - high, high


class MouthTrack:
    """The mouth of one utterance at any time; it is planned once and then only read."""

    def __init__(self, utterance: Utterance, settings: Coarticulation = DEFAULT) -> None:
        found = viseme_set(settings.visemes)
        self._phones = _with_contacts(list(_timed_visemes(utterance, found)))
        self._settings = settings
        shapes = [phone.sounding.viseme.shape for phone in self._phones]
        self._shapes = np.array([[mix.get(name, 0.0) for name in MOUTH_SHAPES] for mix in shapes])
        self._accents = [phone.accent for phone in self._phones]
        # Ascending bounds of the time in which phones are active, so that a search finds them.
        firsts = [phone.centre - phone.reach for phone in self._phones]
        self._first = list(accumulate(reversed(firsts), min))[::-1]
        self._last = list(accumulate((phone.centre + phone.reach for phone in self._phones), max))

    def shares(self, time: float) -> tuple[slice, list[float]]:
        """Return the phones that are active at a time [s], and their shares; they sum to 1."""
        time = min(max(time, self._phones[0].centre), self._phones[-1].centre)
        active = slice(bisect_right(self._last, time), bisect_left(self._first, time))
        phones = self._phones[active]
        sharpness = self._settings.sharpness
        weights = [phone.dominance(time) ** sharpness for phone in phones]
        held = [0.0] * len(phones)
        if self._settings.contacts:
            held = [phone.contact(time) if phone.touches else 0.0 for phone in phones]
        most = max(sum(held), 1.0)
        left = (1.0 - sum(held) / most) / sum(weights)
        return active, [left * w + hold / most for w, hold in zip(weights, held, strict=True)]

    def at(self, time: float, emphasis: float = 0.0) -> Array:
        """Return the weights of the shapes at a time [s], (levels, shapes).

        `emphasis`, −1…1, is added to the strength of accents, which stays within 0…1.
        """
        active, shares = self.shares(time)
        shapes = np.zeros((len(EMPHASIS_LEVELS), len(MOUTH_SHAPES)))
        accents = self._accents[active]
        if accents.count(None) == len(accents):  # most of the time, and several times as fast
            np.dot(shares, self._shapes[active], out=shapes[NEUTRAL_LEVEL])
            return shapes
        rows = []
        for accent, share in zip(accents, shares, strict=True):
            strength = NEUTRAL_STRENGTH
            if accent is not None:
                strength = min(max(accent + emphasis, 0.0), 1.0)
            rows.append([share * level for level in level_weights(strength)])
        return np.asarray(np.array(rows).T @ self._shapes[active])


@dataclass(frozen=True)
class _TimedViseme:
    """A viseme and when it sounds."""

    start: float
    """When it begins [s]."""

    end: float
    """When it ends [s]."""

    sounding: SoundingViseme

    accent: float | None = None
    """Strength of the accent on it, 0…1; None without one."""

    room: float = math.inf
    """How long a contact may hold before and after its middle [s]."""

    closing: float = CLOSING_S
    """How long a contact forms before it holds [s]."""

    parting: float = PARTING_S
    """How long a contact parts after it has held [s]."""

    @cached_property
    def centre(self) -> float:
        """The middle of its time [s]."""
        return 0.5 * (self.start + self.end)

    @cached_property
    def width(self) -> float:
        """Length of its dominance curve, without the flat middle of a long phone [s]."""
        return min(self.end - self.start, LONG_S) * self.sounding.viseme.spread

    @cached_property
    def reach(self) -> float:
        """How far from its centre it counts [s]."""
        touching = self.hold + max(self.closing, self.parting) if self.sounding.contact else 0.0
        return max(self.flat + 0.5 * self.width, touching)

    @cached_property
    def flat(self) -> float:
        """Half the length of the flat middle of its dominance curve [s]."""
        return 0.5 * max(self.end - self.start - LONG_S, 0.0)

    @cached_property
    def hold(self) -> float:
        """Half the time for which a contact holds [s]."""
        return min(0.5 * max(CONTACT_SHARE * (self.end - self.start), MIN_CONTACT_S), self.room)

    @cached_property
    def touches(self) -> bool:
        """Whether lips or teeth touch."""
        return self.sounding.contact

    def dominance(self, time: float) -> float:
        """Return its dominance at a time [s]."""
        off = max(abs(time - self.centre) - self.flat, 0.0)
        viseme = self.sounding.viseme
        return viseme.weight * dominance(0.5 + off / self.width, viseme.alpha)

    def contact(self, time: float) -> float:
        """Return how far lips or teeth have come to touch at a time [s], 0…1."""
        off = time - self.centre
        away = abs(off) - self.hold
        if away <= 0.0:
            return 1.0
        away /= self.closing if off < 0.0 else self.parting
        return ease(1.0 - away, "cubic") if away < 1.0 else 0.0


def _with_contacts(phones: list[_TimedViseme]) -> list[_TimedViseme]:
    """Return phones whose contacts leave time for each other, and for a vowel between them."""
    numbers = [number for number, phone in enumerate(phones) if phone.sounding.contact]
    for a, b in pairwise(numbers):
        apart = phones[b].centre - phones[a].centre
        first = replace(phones[a], room=min(phones[a].room, 0.25 * apart))
        second = replace(phones[b], room=0.25 * apart)
        between = apart - first.hold - second.hold
        if b > a + 1:  # else one contact goes over into the other
            between *= 0.5
        phones[a] = replace(first, parting=min(between, PARTING_S))
        phones[b] = replace(second, closing=min(between, CLOSING_S))
    return phones


def _timed_visemes(utterance: Utterance, found: VisemeSet) -> Iterator[_TimedViseme]:
    """Yield the visemes of every phone, with a pause at both ends.

    A phone without a known letter belongs to the one before it.
    """
    silence = SoundingViseme(found.silence, 1.0, vowel=False, contact=False)
    phones = [Phone(SILENCE, -PAUSE_BESIDE_S, 0.0)]
    for phone in utterance.phones:
        if phone.symbol == SILENCE or found.of(phone.symbol):
            phones.append(phone)
        else:
            phones[-1] = replace(phones[-1], end=phone.end)
    end = max(phones[-1].end, utterance.duration)
    for phone in (*phones, Phone(SILENCE, end, end + PAUSE_BESIDE_S)):
        start, length = phone.start, max(phone.end - phone.start, MIN_PHONE_S)
        accent = _accent_strength(utterance, phone)
        for part in found.of(phone.symbol) or (silence,):
            stop = start + part.share * length
            yield _TimedViseme(start, stop, part, accent if part.vowel else None)
            start = stop


def _accent_strength(utterance: Utterance, phone: Phone) -> float | None:
    """Return the strength of the strongest accent on a phone; None without one."""
    first, last = phone.start - ACCENT_MARGIN_S, phone.end + ACCENT_MARGIN_S
    on_it = (accent.strength for accent in utterance.accents if first <= accent.time <= last)
    return max(on_it, default=None)

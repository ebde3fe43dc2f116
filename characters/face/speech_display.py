"""Speech display: the mouth, and the brows, of a character that speaks."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cubeling.characters.face.brows import FALLING_S, AccentBrows
from cubeling.characters.face.expressions import EXPRESSIONS, ExpressionMorphs
from cubeling.characters.face.lids import numbers_by_name
from cubeling.characters.face.visemes.coarticulation import (
    DEFAULT,
    EMPHASIS_LEVELS,
    PAUSE_BESIDE_S,
    Coarticulation,
    MouthTrack,
)
from cubeling.characters.face.visemes.mouth_morphs import MouthMorphs, jaw_opening
from cubeling.characters.face.visemes.sets import MOUTH_SHAPES
from cubeling.characters.motion.curves import ease
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.speech.speech import Utterance

LEAD_S = 0.02
"""How far the mouth is ahead of the phones [s]: vowels are loudest before their middle. Without it
the mouth is 15 to 25 ms behind the sound of eSpeak NG (`python -m tests.bench.face`)."""

SWITCH_S = 0.1
"""How long the mouth takes from one speech to another that cuts in [s]."""

CLOSING_S = 0.15
"""How long the mouth takes to close after the end of a speech or a cut [s]."""

ONSET_S = 0.12
"""How long an expression takes to leave the mouth to a speech, and to take it back [s]."""

_CLOSED = np.zeros((len(EMPHASIS_LEVELS), len(MOUTH_SHAPES)))


class SpeechDisplay:
    """The speaking face of one character.

    The mouth belongs to the speech, also in an action that would move it, such as a kiss: it is
    the voice that is heard.
    """

    def __init__(
        self, morphs: Sequence[str], seed: int, settings: Coarticulation = DEFAULT
    ) -> None:
        self._settings = settings
        self.visemes = settings.visemes
        """The set of visemes of the utterances that begin from now on."""
        self._mouth = MouthMorphs.of(morphs)
        self._expression = SpeakingExpression(morphs)
        self._brows = AccentBrows(morphs, seed)
        self._numbers: list[int] = self._mouth.numbers.tolist()
        self._clips: list[int] = ExpressionMorphs.of(morphs).speech.tolist()
        self._utterance: Utterance | None = None
        self._start = 0.0
        self._track: MouthTrack | None = None
        self._shapes = self._before = _CLOSED
        self._since = self._length = CLOSING_S
        self._presence, self._raised = 0.0, 0.0

    @property
    def active(self) -> bool:
        """Whether the face speaks, or still closes its mouth."""
        moving = self._presence > 0.0 or self._raised > 0.0 or self._since < self._length
        return self._utterance is not None or moving

    @property
    def has_morphs(self) -> bool:
        """Whether the face has morphs that speak."""
        return bool(self._mouth)

    @property
    def opening(self) -> float:
        """How far the jaw is open, 0…1."""
        return jaw_opening(self._shapes)

    def update(
        self,
        elapsed: float,
        utterance: Utterance | None,
        start: float,
        now: float,
        emphasis: float,
    ) -> None:
        """Advance by a time [s] to `now` [s].

        The sound of the utterance, None for silence, begins at `start` [s]. `emphasis`, −1…1, is
        added to the strength of its accents.
        """
        # Without phones the mouth is moved by somebody else, or nobody.
        if utterance is not None and (
            not utterance.phones or not -PAUSE_BESIDE_S <= now - start < utterance.duration
        ):
            utterance = None
        if utterance is None and not self.active:
            return
        self._since += elapsed
        if utterance != self._utterance or (utterance is not None and start != self._start):
            self._begin(utterance, start)
        step = elapsed / ONSET_S
        self._presence = min(max(self._presence + (-step if utterance is None else step), 0.0), 1.0)
        target, raised = _CLOSED, 0.0
        if utterance is not None and self._track is not None:
            time = now - start + LEAD_S
            target, raised = self._track.at(time, emphasis), self._brows.height(time)
        self._raised = max(raised, self._raised - elapsed / FALLING_S)  # also after a cut
        left = 1.0 - ease(min(self._since / self._length, 1.0), "cubic")
        self._shapes = target + left * (self._before - target)

    def _begin(self, utterance: Utterance | None, start: float) -> None:
        """Take another utterance, or silence; the mouth goes over to it from where it is."""
        self._utterance, self._start = utterance, start
        settings = replace(self._settings, visemes=self.visemes)
        self._track = None if utterance is None else MouthTrack(utterance, settings)
        self._brows.plan(() if utterance is None else utterance.accents)
        self._before = self._shapes
        self._since, self._length = 0.0, CLOSING_S if utterance is None else SWITCH_S

    def apply(self, weights: Array, closed: float) -> None:
        """Lay the speech over morph weights (morphs,) with an expression on them, in place.

        `closed` is how far a blink closes the lids, 0…1.
        """
        values = weights.tolist()  # plain numbers are quicker than arrays
        if self._presence > 0.0 and self._mouth:
            presence = ease(self._presence, "cubic")
            self._expression.apply(values, presence)
            for number in self._clips:
                values[number] *= 1.0 - presence
        if self._mouth:
            spoken = self._mouth.of_shapes(self._shapes).tolist()
            for number, weight in zip(self._numbers, spoken, strict=True):
                values[number] += weight
        if self._raised > 0.0:
            self._brows.apply(values, self._raised, closed)
        weights[:] = values


MOUTH_SHARE = 0.3
"""Share of an expression that stays on the mouth of a face that speaks."""

_CORNERS = {
    "happy": ("mouthsmile", 1.0),
    "angry": ("mouthfrown", 0.7),
    "sad": ("mouthfrown", 1.0),
    "relaxed": ("mouthsmile", 0.7),
}
"""What an expression does with the corners of closed lips, on faces with a morph for it."""

_UPPER_FACE = ("brow", "eye", "cheek", "nose")


class SpeakingExpression:
    """Takes expressions off the mouth of one character while it speaks.

    Egges, *Real-time Animation of Interactive Virtual Humans*, 2006, section 5.3.1: speech has more
    weight on the mouth, an expression on eyes and brows. The numbers are ours (specification S21).

    A morph of the whole face has either a second one with its mouth alone, named `happyMouth`,
    which is subtracted: the lips stay as closed as those of the speech, and the smile returns at
    their corners. Or it has none, as with VRM: then it is shown less as a whole.
    """

    def __init__(self, morphs: Sequence[str]) -> None:
        found, names = ExpressionMorphs.of(morphs), numbers_by_name(morphs)
        self._divided: list[tuple[int, int, int | None, float]] = []
        self._weakened: list[int] = []
        for row, number in zip(found.weights, found.numbers.tolist(), strict=True):
            expression = EXPRESSIONS[int(row.argmax())]
            name = morphs[number].rpartition(".")[2].lower()
            mouth = names.get(f"{expression}mouth")
            if mouth is not None and name == expression:
                corners, share = _CORNERS.get(expression, ("", 0.0))
                self._divided.append((number, mouth, names.get(corners), share * MOUTH_SHARE))
            elif not name.startswith(_UPPER_FACE):
                self._weakened.append(number)

    def apply(self, weights: list[float], presence: float) -> None:
        """Change the weights of all morphs in place for a face that speaks so much, 0…1."""
        for number, mouth, corners, share in self._divided:
            shown = presence * weights[number]
            weights[mouth] -= shown
            if corners is not None:
                weights[corners] += share * shown
        for number in self._weakened:
            weights[number] *= 1.0 - (1.0 - MOUTH_SHARE) * presence

"""What a speech does with the layers after its own in one frame."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from cubeling.affect import Emotion
from cubeling.characters.body.gaze import Aversion
from cubeling.characters.skeleton.pose import Array


@dataclass(frozen=True, eq=False)
class SpeakingState:
    """What a speech does with the layers after its own in one frame."""

    nod: Array = field(default_factory=lambda: np.zeros(3))
    """How the head moves with the accents: a rotation vector about the body's axes, (3,) [rad]."""

    stance: Array | None = None
    """What is added to the stance, as `StanceJoints` takes it, (15,); None for nothing."""

    aversion: Aversion | None = None
    """Where the eyes look beside the listener; None at the listener."""

    emotion: Emotion | None = None
    """What the words tell of feeling; None for nothing."""

    talking: bool = False
    """Whether something is being said."""

    phrase_ends: bool = False
    """Whether a phrase ends in this frame."""

    def with_later(self, later: SpeakingState) -> SpeakingState:
        """Return the state of who is still at rest from one speech and has begun a later one."""
        stances = [each for each in (self.stance, later.stance) if each is not None]
        return SpeakingState(
            self.nod + later.nod,
            sum(stances[1:], stances[0]) if stances else None,
            later.aversion,
            later.emotion,
            later.talking,
            later.phrase_ends,
        )


NOT_SPEAKING = SpeakingState()
"""The state of who is silent."""

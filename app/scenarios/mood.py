"""The mood of a session: it changes with what the hand and the character do."""

from collections.abc import Mapping, Sequence

from cubeling.affect import Feelings, Personality
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.tracking import CubeControls


class MoodController:
    """Turns the events of a session into the one emotion that character and robots show.

    A cube that is not visible causes no events: the mood stays or fades, as the personality says.
    """

    def __init__(self, personality: Personality) -> None:
        self._personality = personality
        self._now = 0.0
        self.reset()

    def reset(self) -> None:
        """Start over at the personality's baseline."""
        self._feelings = Feelings(self._personality)
        self._lifted = False

    def adjust(self, personality: Personality) -> None:
        """Feel with a personality from now on; another one starts at its baseline."""
        if personality != self._personality:
            self._personality = personality
            self.reset()

    @property
    def intensities(self) -> Mapping[str, float]:
        """How strongly each of the 24 emotions is felt, 0…1."""
        return self._feelings.intensities

    def update(
        self,
        controls: CubeControls,
        action: str,
        weight: float = 1.0,
        speed: float = 0.0,
        events: Sequence[str] = (),
        influences: Sequence[tuple[str, float]] = (),
    ) -> EmotionTarget:
        """Advance by one frame and return the emotion to show.

        The action is "idle" for nothing that changes the mood; `weight` is its intensity, −1…1, and
        `speed` AvatAR's Speed of the character, 0…5. `events` happened besides the gestures,
        and `influences` are emotions that are felt for another reason, each 0…1.
        """
        for event in (*controls.gestures, *events):
            self._feelings.apply_event(event)
        for word, value in influences:
            self._feelings.influence(word, value)
        if controls.lifted and not self._lifted:
            self._feelings.apply_event("lifted")
        self._lifted = controls.lifted
        self._now = max(self._now, controls.timestamp)  # a timestamp that goes back is ignored
        emotion = self._feelings.update(action, weight, self._now, speed)
        return EmotionTarget(emotion, controls.timestamp)

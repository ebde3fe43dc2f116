"""What happens in a frame, as the character takes it: the one feeling that everyone shows."""

from affect import Feelings, Personality
from app.pipeline.scenario import EmotionTarget
from tracking import CubeControls


class Temper:
    """The feelings of the character of one session.

    A cube that is out of sight moves nothing: what was felt stays or fades, as the personality
    has it.

    Parameters
    ----------
    personality
        Who feels.
    """

    def __init__(self, personality: Personality) -> None:
        self._personality = personality
        self._now = 0.0
        self.forget()

    def forget(self) -> None:
        """Start over, where the personality is at home."""
        self._feelings = Feelings(self._personality)
        self._lifted = False

    def update(
        self, controls: CubeControls, action: str, weight: float = 1.0, speed: float = 0.0
    ) -> EmotionTarget:
        """Account for one frame and return what is felt.

        Parameters
        ----------
        controls
            What the hand does: a cube that is shaken or lifted is an event.
        action
            What the character does; "idle" for nothing that it could feel.
        weight
            Intensity of the action, −1…1.
        speed
            AvatAR's Speed of its feet, 0…5.
        """
        if controls.shaken:
            self._feelings.apply_event("shaken")
        if controls.lifted and not self._lifted:
            self._feelings.apply_event("lifted")
        self._lifted = controls.lifted
        self._now = max(self._now, controls.timestamp)  # time that runs backwards counts as none
        emotion = self._feelings.update(action, weight, self._now, speed)
        return EmotionTarget(emotion, controls.timestamp)

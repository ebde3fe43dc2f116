"""The body: it feels, moves and sounds at its own pace. All whole numbers; feelings in 1/10000."""

from array import array
from math import pi, sin, sqrt

from .board import Board
from .joints import Joints
from .messages import NOTHING
from .motions import ANGRY_BELOW, HAPPY_ABOVE, HYSTERESIS, MOODS, MOTIONS, TURN
from .sounds import SOUNDS, Voice

STEP = 20
"""The body advances when this long has passed [ms]: one pulse of its servos."""

STEP_MAX = 40
"""Longest time that one step makes up for [ms]. After a hang it is late, not hasty."""

FEELING_SPEED = 10
"""Fastest change of the emotion shown, in the plane of valence and arousal [1/10000 per ms]."""

_UNIT = 10000
_SINE = array("h", [round(_UNIT * sin(2 * pi * part / TURN)) for part in range(TURN)])
_NAMES = [motion[0] for motion in MOTIONS]
_NEUTRAL, _HAPPY, _ANGRY = [_NAMES.index(name) for name in ("neutral", "happy", "angry")]


class Body:
    """A dinosaur of servos.

    Parameters
    ----------
    joints
        Its servos.
    board
        What it runs on.
    buzzer
        Whether it can sound.
    rest_after
        Without a host for this long [ms] it stands still and lets its servos go.
    """

    def __init__(self, joints: Joints, board: Board, buzzer: bool, rest_after: int) -> None:
        self.joints = joints
        self.motions = _NAMES
        """Names of what it can play; the first are the loops of its moods."""
        self.moods = _NAMES[:MOODS]
        """Words for its moods."""
        self.voice = Voice(board, buzzer)
        self.valence = 0
        """Shown now."""
        self.arousal = 0
        """Shown now."""
        self.mood = _NEUTRAL
        """Shown now, an index."""
        self.still = False
        """Whether it holds its neutral pose after STOP."""
        self._rest_after = rest_after
        self._target = (0, 0)
        self._told = NOTHING
        self._motion = _NEUTRAL
        self._time = 0
        self._once = False
        self._now = -1
        self._alone = 0
        self._wanted = [0] * len(joints.angles)
        names = joints.names()
        # Joints that this robot does not have are left out.
        self._sways = [
            [(names.index(sway[0]),) + sway[1:] for sway in motion[3] if sway[0] in names]
            for motion in MOTIONS
        ]

    # --- What the host commands ----------------------------------------------------------------

    def express(self, valence: int, arousal: int, mood: int) -> None:
        """Feel this from now on; the mood is an index, or `NOTHING`: choose one."""
        self._target = (valence, arousal)
        self._told = mood
        self.still = False

    def play_motion(self, index: int) -> None:
        """Play a motion once."""
        self.still = False
        self._start(index, True)

    def play_sound(self, index: int) -> None:
        """Play a sound."""
        self.still = False
        self.voice.play(index)

    def stop(self) -> None:
        """End everything and hold the neutral pose."""
        self.neutral()
        self.still = True

    def neutral(self) -> None:
        """Feel neutral, and end what was played. A body that holds still keeps still."""
        self._target = (0, 0)
        if self._told != NOTHING:
            self._told = _NEUTRAL
        self.voice.end()
        self._start(self.mood)

    # --- What it says of itself ----------------------------------------------------------------

    @property
    def motion(self) -> int:
        """The motion played now, an index, or `NOTHING`."""
        return NOTHING if self.still else self._motion

    @property
    def sound(self) -> int:
        """The sound played now, an index, or `NOTHING`."""
        return NOTHING if self.voice.sound < 0 else self.voice.sound

    # --- Time ----------------------------------------------------------------------------------

    def advance(self, now: int, attended: bool) -> None:
        """Live until `now` [ms]; `attended`: whether a host is there."""
        if self._now < 0:
            self._now = self._alone = now
        elapsed = now - self._now
        if attended:
            self._alone = now
        if elapsed < STEP:
            return
        self._now = now
        elapsed = min(elapsed, STEP_MAX)
        resting = now - self._alone >= self._rest_after
        self._feel(elapsed)
        self.voice.advance(elapsed)
        self._move(elapsed, self.still or resting)
        if not resting:
            self.joints.start(now)
        elif self.joints.neutral and not self.joints.limp:
            self.joints.release()

    def _feel(self, elapsed: int) -> None:
        """Come closer to the emotion commanded, and change the loop when the mood changes."""
        right, up = self._target[0] - self.valence, self._target[1] - self.arousal
        if right or up:
            reach = FEELING_SPEED * elapsed
            length = int(sqrt(right * right + up * up)) + 1
            if length > reach:
                right, up = int(right * reach / length), int(up * reach / length)
            self.valence += right
            self.arousal += up
        before = self.mood
        self.mood = self._next_mood() if self._told == NOTHING else self._told
        if self.mood != before:
            if not self._once:
                self._start(self.mood)
            if not self.still:
                self._sound_of(self.mood)

    def _next_mood(self) -> int:
        """Return the mood that fits, with hysteresis; between two others always neutral."""
        if self.mood == _HAPPY:
            return _HAPPY if self.valence >= HAPPY_ABOVE - HYSTERESIS else _NEUTRAL
        if self.mood == _ANGRY:
            return _ANGRY if self.valence <= ANGRY_BELOW + HYSTERESIS else _NEUTRAL
        if self.valence > HAPPY_ABOVE:
            return _HAPPY
        return _ANGRY if self.valence < ANGRY_BELOW else _NEUTRAL

    def _sound_of(self, mood: int) -> None:
        for index, sound in enumerate(SOUNDS):
            if sound[0] == MOTIONS[mood][2] and self.voice.names():
                self.voice.play(index)

    def _move(self, elapsed: int, hold: bool) -> None:
        """Turn every joint towards where the motion wants it; to neutral if it is to hold still."""
        self._time += elapsed
        period = MOTIONS[self._motion][1]
        if self._time >= period:
            if not self._once:
                self._time -= period
            else:
                self._start(self.mood)
                period = MOTIONS[self._motion][1]
        wanted = self._wanted
        for index in range(len(wanted)):
            wanted[index] = 0
        if not hold:
            for joint, offset, amplitude, times, begin in self._sways[self._motion]:
                part = times * self._time * TURN // period + begin
                wanted[joint] = offset + amplitude * _SINE[part % TURN] // _UNIT
        self.joints.move(wanted, elapsed)

    def _start(self, motion: int, once: bool = False) -> None:
        self._motion, self._time, self._once = motion, 0, once

"""The body: emotion, motions and sounds, advanced in time. All integers; emotions in 1/10000."""

from array import array
from math import pi, sin, sqrt

from .board import RobotBoard
from .joints import ServoJoints
from .messages import NOTHING
from .motions import ANGRY_BELOW, HAPPY_ABOVE, HYSTERESIS, MOODS, MOTIONS, TURN
from .sounds import SOUNDS, SoundPlayer

STEP_MS = 20
"""Shortest step of the body [ms]: one period of the servos' pulses."""

MAX_STEP_MS = 40
"""Longest step [ms]: after a hang the body is late, but does not jump."""

EMOTION_SPEED = 10
"""Speed of the emotion shown, in the plane of valence and arousal [1/10000 per ms]."""

_UNIT = 10000
_SINE = array("h", [round(_UNIT * sin(2 * pi * part / TURN)) for part in range(TURN)])
_NAMES = [motion[0] for motion in MOTIONS]
_NEUTRAL, _HAPPY, _ANGRY = [_NAMES.index(name) for name in ("neutral", "happy", "angry")]


class DinoBody:
    """A dinosaur of servos and a buzzer; it rests after `rest_after` ms without a session."""

    def __init__(
        self, joints: ServoJoints, board: RobotBoard, buzzer: bool, rest_after: int
    ) -> None:
        self.joints = joints
        self.motions = _NAMES
        """Names of the motions; the first are the loops of the moods."""
        self.moods = _NAMES[:MOODS]
        """Names of the moods."""
        self.sounds = SoundPlayer(board, buzzer)
        self.valence = 0
        """Valence shown now."""
        self.arousal = 0
        """Arousal shown now."""
        self.mood = _NEUTRAL
        """Mood shown now, an index."""
        self.stopped = False
        """Whether it holds its neutral pose after STOP."""
        self._rest_after = rest_after
        self._target = (0, 0)
        self._named_mood = NOTHING
        self._motion = _NEUTRAL
        self._time = 0
        self._play_once = False
        self._last_step = -1
        self._last_attended = 0
        self._targets = [0] * len(joints.angles)
        self.held = 0
        """Joints that the host holds; bit i for joint i."""
        self._ways = [(0, 0, 0, 1)] * len(joints.angles)  # begin, end, time, duration
        names = joints.names()
        # Without the joints that this robot does not have.
        self._sines = [
            [(names.index(sine[0]),) + sine[1:] for sine in motion[3] if sine[0] in names]
            for motion in MOTIONS
        ]

    def express(self, valence: int, arousal: int, mood: int) -> None:
        """Set the emotion; the mood is an index, or `NOTHING` for the body's own choice."""
        self._target = (valence, arousal)
        self._named_mood = mood
        self.stopped = False

    def play_motion(self, index: int) -> None:
        """Play a motion once."""
        self.stopped = False
        self._start(index, True)

    def play_sound(self, index: int) -> None:
        """Play a sound by its index in `SOUNDS`, from its start."""
        self.stopped = False
        self.sounds.play(index)

    def move(self, released: int, moved: int, angles: tuple[int, ...], duration: int) -> None:
        """Let go of some joints, then turn others to `angles` [mrad] in `duration` ms."""
        self.stopped = False
        self.held = self.held & ~released | moved
        for index, mrad in enumerate(angles):
            if moved >> index & 1:
                goal = self.joints.from_mrad(mrad)
                self._ways[index] = (self.joints.angles[index], goal, 0, max(duration, 1))

    def stop(self) -> None:
        """End motion and sound, and hold the neutral pose."""
        self.neutral()
        self.stopped = True

    def neutral(self) -> None:
        """Go to neutral, end motion and sound, let go of the joints. A stopped body stays so."""
        self._target = (0, 0)
        self.held = 0
        if self._named_mood != NOTHING:
            self._named_mood = _NEUTRAL
        self.sounds.end()
        self._start(self.mood)

    @property
    def motion(self) -> int:
        """The motion that is played, an index, or `NOTHING`."""
        return NOTHING if self.stopped else self._motion

    @property
    def sound(self) -> int:
        """The sound that is played, an index, or `NOTHING`."""
        return NOTHING if self.sounds.sound < 0 else self.sounds.sound

    def advance(self, now: int, attended: bool) -> None:
        """Advance to `now` [ms]; `attended`: whether there is a session."""
        if self._last_step < 0:
            self._last_step = self._last_attended = now
        elapsed = now - self._last_step
        if attended:
            self._last_attended = now
        if elapsed < STEP_MS:
            return
        self._last_step = now
        # After a hang joints go on from where they are, at their speed, instead of leaping.
        elapsed = min(elapsed, MAX_STEP_MS)
        resting = now - self._last_attended >= self._rest_after
        self._approach_emotion(elapsed)
        self.sounds.advance(elapsed)
        self._move(elapsed, self.stopped or resting)
        if not resting:
            self.joints.start(now)
        elif self.joints.neutral and not self.joints.limp:
            self.joints.release()

    def _approach_emotion(self, elapsed: int) -> None:
        """Move towards the emotion commanded, and change the loop when the mood changes."""
        d_valence, d_arousal = self._target[0] - self.valence, self._target[1] - self.arousal
        if d_valence or d_arousal:
            max_change = EMOTION_SPEED * elapsed
            # Rounded up, so that the length is never zero and the speed never exceeded.
            length = int(sqrt(d_valence * d_valence + d_arousal * d_arousal)) + 1
            if length > max_change:
                d_valence = int(d_valence * max_change / length)
                d_arousal = int(d_arousal * max_change / length)
            self.valence += d_valence
            self.arousal += d_arousal
        before = self.mood
        self.mood = self._next_mood() if self._named_mood == NOTHING else self._named_mood
        if self.mood == before:
            return
        if not self._play_once:
            self._start(self.mood)
        if not self.stopped and self.sounds.names():
            for index, sound in enumerate(SOUNDS):
                if sound[0] == MOTIONS[self.mood][2]:
                    self.sounds.play(index)

    def _next_mood(self) -> int:
        """Return the mood of the emotion, with hysteresis; happy and angry only follow neutral."""
        if self.mood == _HAPPY:
            # It leaves at a lower valence than it entered: an emotion at the border does not
            # flutter.
            return _HAPPY if self.valence >= HAPPY_ABOVE - HYSTERESIS else _NEUTRAL
        if self.mood == _ANGRY:
            return _ANGRY if self.valence <= ANGRY_BELOW + HYSTERESIS else _NEUTRAL
        if self.valence > HAPPY_ABOVE:
            return _HAPPY
        return _ANGRY if self.valence < ANGRY_BELOW else _NEUTRAL

    def _move(self, elapsed: int, hold: bool) -> None:
        """Move every joint towards its angle in the motion, or to neutral if `hold` is set.

        A joint that the host holds goes its own way.
        """
        self._time += elapsed
        period = MOTIONS[self._motion][1]
        if self._time >= period:
            if not self._play_once:
                self._time -= period
            else:
                self._start(self.mood)
                period = MOTIONS[self._motion][1]
        targets = self._targets
        for index in range(len(targets)):
            targets[index] = 0
        if not hold:
            for joint, offset, amplitude, cycles, begin in self._sines[self._motion]:
                part = cycles * self._time * TURN // period + begin
                # Integers: a float would be allocated for each joint and step.
                targets[joint] = offset + amplitude * _SINE[part % TURN] // _UNIT
        for index in range(len(targets)):
            # After the motion: a joint that the host holds overrides it.
            if self.held >> index & 1:
                start, goal, time, duration = self._ways[index]
                time = min(time + elapsed, duration)
                self._ways[index] = (start, goal, time, duration)
                targets[index] = start + (goal - start) * time // duration
        self.joints.move(targets, elapsed)

    def _start(self, motion: int, once: bool = False) -> None:
        self._motion, self._time, self._play_once = motion, 0, once

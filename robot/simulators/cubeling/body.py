"""The body of the simulated dinosaur: emotion, joints, sounds and battery, each at its own rate."""

from math import hypot

import numpy as np

from cubeling.affect import Emotion
from cubeling.affect.hysteresis import THESIS_LABELS, next_label
from cubeling.robot.contract.motions import Array, SineMotion
from cubeling.robot.protocol import messages as m
from cubeling.robot.simulators.cubeling import dinosaur

STEP_S = 0.020
"""Step of the simulation [s], as of hobby servos; the result does not depend on how often `advance`
is called."""

MAX_TIME_STEP_S = 2.0
"""A longer time between two calls counts as sleep of the computer and is skipped [s]."""

MAX_EMOTION_SPEED = 1.0
"""Fastest change of the emotion shown, in the plane of valence and arousal [1/s]."""

BATTERY_LIFE_S = 2 * 3600.0
"""Time from full to empty [s]."""

CHARGE_TIME_S = 3600.0
"""Time from empty to full [s]."""

MIN_BATTERY = 0.06
"""Charge below which it plays no motion and moves no joint; it goes to its charger at 0.05."""

ANGLE_NOISE_RAD = np.radians(0.2)
"""Standard deviation of a measured angle [rad]."""

_MAX_STEP_RAD = dinosaur.MAX_SPEEDS_RAD_PER_S * STEP_S


class Battery:
    """A battery that is put on its charger when it is nearly empty, until it is full."""

    def __init__(self, level: float) -> None:
        self.level = level
        """From 0, empty, to 1, full."""
        self.charging = False
        """Whether it is on its charger."""

    def advance(self, seconds: float) -> None:
        """Discharge or charge for a time."""
        change = seconds / CHARGE_TIME_S if self.charging else -seconds / BATTERY_LIFE_S
        self.level = min(max(self.level + change, 0.0), 1.0)
        if self.level < 0.05:
            self.charging = True
        elif self.level == 1.0:
            self.charging = False


class DinosaurBody:
    """A simulated robot like a Pleo; a `Body` for `DeviceLink`.

    The seed determines the sensor noise and the first battery level.
    """

    catalogue = dinosaur.CATALOGUE

    def __init__(self, seed: int = 0) -> None:
        self._random = np.random.default_rng(seed)
        self._now: float | None = None
        self._target = np.zeros(2)
        self._emotion = np.zeros(2)
        self._commanded_mood = m.NOTHING
        self.label = THESIS_LABELS[0]
        """The mood that it shows."""
        self._angles = np.zeros(len(dinosaur.MIN_ANGLES_RAD))
        self._motion: SineMotion = dinosaur.MOOD_LOOPS[0]
        self._motion_time = 0.0
        self._plays_once = False
        self._sound: str | None = None
        self._sound_left = 0.0
        self._still = False
        self._held = HeldJoints(len(self._angles))
        self._battery = Battery(float(self._random.uniform(0.7, 1.0)))

    def express(self, emotion: Emotion, mood: int = m.NOTHING) -> None:
        """Show an emotion and a mood; for `NOTHING` the mood follows the emotion."""
        self._target = np.array([emotion.valence, emotion.arousal])
        self._commanded_mood = mood
        self._still = False

    def play(self, item: int, index: int) -> None:
        """Play a motion or a sound once."""
        self._still = False
        if item == m.ITEM_SOUND:
            self._start_sound(self.catalogue.sounds[index])
        else:
            self._start_motion(dinosaur.MOTIONS[index], once=True)

    def move(self, command: m.Move) -> None:
        """Let go of some joints, then turn others and hold them."""
        self._still = False
        self._held.move(command, self._angles)

    def refusal(self) -> int:
        """Return why no motion and no joint can be moved now."""
        return m.RESULT_LOW_BATTERY if self._battery.level < MIN_BATTERY else m.RESULT_TAKEN

    def stop(self) -> None:
        """End everything, let go of all joints, and hold the neutral pose."""
        self.neutral()
        self._still = True

    def neutral(self) -> None:
        """Return to the neutral emotion, end motion and sound, and let go of all joints.

        After `stop` it remains still.
        """
        self._target = np.zeros(2)
        self._held.release()
        if self._commanded_mood != m.NOTHING:
            self._commanded_mood = THESIS_LABELS.index("neutral")
        self._sound, self._sound_left = None, 0.0
        self._start_motion(self._loop)

    def advance(self, now: float) -> None:
        """Advance to time `now` [s]."""
        if self._now is None or not 0 <= now - self._now <= MAX_TIME_STEP_S:
            self._now = now
        while self._now + STEP_S <= now:
            self._now += STEP_S
            self._step()

    def _step(self) -> None:
        self._update_emotion()
        self._update_joints()
        self._sound_left -= STEP_S
        if self._sound_left <= 0:
            self._sound = None
        self._battery.advance(STEP_S)

    def _update_emotion(self) -> None:
        """Approach the commanded emotion, and change the loop when the mood changes."""
        way = self._target - self._emotion
        length = hypot(*way.tolist())
        self._emotion = self._emotion + way * min(
            1.0, MAX_EMOTION_SPEED * STEP_S / max(length, 1e-9)
        )
        before = self.label
        if self._commanded_mood == m.NOTHING:
            self.label = next_label(before, float(self._emotion[0]))
        else:
            self.label = THESIS_LABELS[self._commanded_mood]
        if self.label != before:
            if not self._plays_once:
                self._start_motion(self._loop)
            if self._loop.sound and not self._still:
                self._start_sound(self._loop.sound)

    def _update_joints(self) -> None:
        """Turn every joint towards the motion, within the speed of its servo."""
        self._motion_time += STEP_S
        if self._plays_once and self._motion_time > self._motion.period:
            self._start_motion(self._loop)
        wanted = np.zeros_like(self._angles)
        if not self._still:
            wanted = self._motion.angles(self._motion_time, dinosaur.JOINTS)
        wanted = self._held.angles(wanted, STEP_S)
        # Not np.clip: for so few numbers its overhead is most of the time.
        wanted = np.minimum(np.maximum(wanted, dinosaur.MIN_ANGLES_RAD), dinosaur.MAX_ANGLES_RAD)
        way = wanted - self._angles
        self._angles = self._angles + np.minimum(np.maximum(way, -_MAX_STEP_RAD), _MAX_STEP_RAD)

    def state(self) -> m.State:
        """Return the state; the angles are measured, with noise."""
        noise = self._random.normal(0.0, ANGLE_NOISE_RAD, self._angles.shape)
        measured = np.clip(self._angles + noise, dinosaur.MIN_ANGLES_RAD, dinosaur.MAX_ANGLES_RAD)
        emotion = self.emotion
        return m.State(
            beat=0,
            taken=0,
            flags=m.FLAG_CHARGING * self._battery.charging | m.FLAG_STILL * self._still,
            valence=emotion.valence,
            arousal=emotion.arousal,
            battery=self._battery.level,
            mood=THESIS_LABELS.index(self.label),
            motion=m.NOTHING if self._still else dinosaur.MOTIONS.index(self._motion),
            sound=self.catalogue.sounds.index(self._sound) if self._sound else m.NOTHING,
            joints=(*measured.tolist(), *[0.0] * (m.JOINTS_MAX - measured.size)),
            held=self._held.bits,
        )

    @property
    def emotion(self) -> Emotion:
        """The emotion that it shows."""
        valence, arousal = np.clip(self._emotion, -1.0, 1.0).tolist()
        return Emotion(valence, arousal)

    @property
    def target(self) -> Emotion:
        """The commanded emotion, towards which the shown one moves."""
        valence, arousal = self._target.tolist()
        return Emotion(valence, arousal)

    @property
    def angles(self) -> Array:
        """The true joint angles, (joints,) [rad]."""
        return self._angles.copy()

    @property
    def _loop(self) -> SineMotion:
        return dinosaur.MOOD_LOOPS[THESIS_LABELS.index(self.label)]

    def _start_motion(self, motion: SineMotion, once: bool = False) -> None:
        self._motion, self._motion_time, self._plays_once = motion, 0.0, once

    def _start_sound(self, name: str) -> None:
        self._sound, self._sound_left = name, dinosaur.SOUND_LENGTHS_S[name]


class HeldJoints:
    """Which joints MOVE holds, and where each should be now."""

    def __init__(self, count: int) -> None:
        self._held = np.zeros(count, bool)
        self._start, self._goal = np.zeros(count), np.zeros(count)
        self._elapsed, self._duration = np.zeros(count), np.ones(count)

    @property
    def bits(self) -> int:
        """The held joints as STATE has them."""
        return sum(1 << int(index) for index in np.flatnonzero(self._held))

    def move(self, command: m.Move, angles: Array) -> None:
        """Let go of some joints and take others, which now have `angles` (joints,) [rad]."""
        count = len(self._held)
        moved = _mask(command.moved, count)
        self._held = self._held & ~_mask(command.released, count) | moved
        self._start = np.where(moved, angles, self._start)
        self._goal = np.where(moved, command.angles[:count], self._goal)
        self._elapsed = np.where(moved, 0.0, self._elapsed)
        self._duration = np.where(moved, max(command.duration, 1e-3), self._duration)

    def release(self) -> None:
        """Let go of all joints."""
        self._held[:] = False

    def angles(self, free: Array, seconds: float) -> Array:
        """Return where all joints should be after another time [s]: `free` where none is held."""
        if not self._held.any():
            return free
        self._elapsed = self._elapsed + seconds
        part = np.minimum(self._elapsed / self._duration, 1.0)
        return np.where(self._held, self._start + part * (self._goal - self._start), free)


def _mask(bits: int, count: int) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    return np.array([bool(bits >> index & 1) for index in range(count)])

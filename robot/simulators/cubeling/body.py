"""The body of the simulated dinosaur: it feels, moves, sounds and tires at its own pace."""

from math import hypot

import numpy as np

from affect.emotion import Emotion
from affect.mood_line import LABELS, next_label
from robot.contract.motions import SineMotion
from robot.protocol import messages as m
from robot.simulators.cubeling import dinosaur
from robot.simulators.cubeling.device import BodyState

STEP = 0.020
"""Everything advances in steps of this length [s], as hobby servos do; so the outcome does not
depend on how often `advance` is called."""

GAP_MAX = 2.0
"""A longer time between two calls is taken for sleep, and left out [s]."""

FEELING_SPEED = 1.0
"""Fastest change of the emotion shown, in the plane of valence and arousal [1/s]."""

BATTERY_LIFE = 2 * 3600.0
"""A full battery lasts so long [s]."""

CHARGE_TIME = 3600.0
"""An empty battery is full after so long [s]."""

SENSOR_NOISE = np.radians(0.2)
"""Standard deviation of a measured angle [rad]."""

_REACH = dinosaur.SPEED * STEP


class DinosaurBody:
    """A simulated Pleo-like robot; a `Body` for `DeviceLink`.

    Parameters
    ----------
    seed
        Of the noise of its sensors, and of how full its battery is at first.
    """

    catalogue = dinosaur.CATALOGUE

    def __init__(self, seed: int = 0) -> None:
        self._random = np.random.default_rng(seed)
        self._now: float | None = None
        self._target = np.zeros(2)
        self._feeling = np.zeros(2)
        self._told = m.NOTHING
        self._label = LABELS[0]
        self._angles = np.zeros(len(dinosaur.LOW))
        self._motion: SineMotion = dinosaur.MOOD_LOOPS[0]
        self._motion_time = 0.0
        self._once = False
        self._sound: str | None = None
        self._sound_left = 0.0
        self._still = False
        self._battery = float(self._random.uniform(0.7, 1.0))
        self._charging = False

    # --- What the host commands ----------------------------------------------------------------

    def express(self, emotion: Emotion, mood: int = m.NOTHING) -> None:
        """Feel this from now on, and show this mood, or the one that fits."""
        self._target = np.array([emotion.valence, emotion.arousal])
        self._told = mood
        self._still = False

    def play(self, item: int, index: int) -> None:
        """Play a motion once, or a sound."""
        self._still = False
        if item == m.ITEM_SOUND:
            self._start_sound(self.catalogue.sounds[index])
        else:
            self._start_motion(dinosaur.MOTIONS[index], once=True)

    def stop(self) -> None:
        """End everything and hold the neutral pose."""
        self.neutral()
        self._still = True

    def neutral(self) -> None:
        """Feel neutral, and end what was played. A body that holds still keeps still."""
        self._target = np.zeros(2)
        if self._told != m.NOTHING:
            self._told = LABELS.index("neutral")
        self._sound, self._sound_left = None, 0.0
        self._start_motion(self._loop)

    # --- Time ----------------------------------------------------------------------------------

    def advance(self, now: float) -> None:
        """Live until time `now` [s]."""
        if self._now is None or not 0 <= now - self._now <= GAP_MAX:
            self._now = now
        while self._now + STEP <= now:
            self._now += STEP
            self._step()

    def _step(self) -> None:
        self._feel()
        self._move()
        self._sound_left -= STEP
        if self._sound_left <= 0:
            self._sound = None
        self._live()

    def _feel(self) -> None:
        """Come closer to the emotion commanded, and change the loop when the mood changes."""
        way = self._target - self._feeling
        length = hypot(*way.tolist())
        self._feeling = self._feeling + way * min(1.0, FEELING_SPEED * STEP / max(length, 1e-9))
        before = self._label
        if self._told == m.NOTHING:
            self._label = next_label(before, float(self._feeling[0]))
        else:
            self._label = LABELS[self._told]
        if self._label != before:
            if not self._once:
                self._start_motion(self._loop)
            if self._loop.sound and not self._still:
                self._start_sound(self._loop.sound)

    def _move(self) -> None:
        """Turn every joint towards where the motion wants it, no faster than its servo can."""
        self._motion_time += STEP
        if self._once and self._motion_time > self._motion.period:
            self._start_motion(self._loop)
        wanted = np.zeros_like(self._angles)
        if not self._still:
            wanted = self._motion.angles(self._motion_time, dinosaur.JOINTS)
        # Not np.clip, whose own overhead is most of the time for so few numbers.
        wanted = np.minimum(np.maximum(wanted, dinosaur.LOW), dinosaur.HIGH)
        way = wanted - self._angles
        self._angles = self._angles + np.minimum(np.maximum(way, -_REACH), _REACH)

    def _live(self) -> None:
        """Use the battery; when it is nearly empty somebody puts the robot on its charger."""
        change = STEP / CHARGE_TIME if self._charging else -STEP / BATTERY_LIFE
        self._battery = min(max(self._battery + change, 0.0), 1.0)
        if self._battery < 0.05:
            self._charging = True
        elif self._battery == 1.0:
            self._charging = False

    # --- What it says of itself ----------------------------------------------------------------

    def state(self) -> BodyState:
        """Say how it is now; the angles are measured, and so not quite true."""
        noise = self._random.normal(0.0, SENSOR_NOISE, self._angles.shape)
        measured = np.clip(self._angles + noise, dinosaur.LOW, dinosaur.HIGH)
        motion = m.NOTHING if self._still else dinosaur.MOTIONS.index(self._motion)
        sounds = self.catalogue.sounds
        return BodyState(
            emotion=self.feeling,
            mood=LABELS.index(self._label),
            battery=self._battery,
            joints=tuple(measured.tolist()),
            motion=motion,
            sound=sounds.index(self._sound) if self._sound else m.NOTHING,
            charging=self._charging,
            still=self._still,
        )

    @property
    def feeling(self) -> Emotion:
        """What it shows now."""
        valence, arousal = np.clip(self._feeling, -1.0, 1.0).tolist()
        return Emotion(valence, arousal)

    @property
    def label(self) -> str:
        """The mood that it shows now."""
        return self._label

    @property
    def target(self) -> Emotion:
        """What it has been told to feel."""
        valence, arousal = self._target.tolist()
        return Emotion(valence, arousal)

    @property
    def angles(self) -> dinosaur.Array:
        """True angles of its joints, (joints,) [rad]."""
        return self._angles.copy()

    @property
    def _loop(self) -> SineMotion:
        return dinosaur.MOOD_LOOPS[LABELS.index(self._label)]

    def _start_motion(self, motion: SineMotion, once: bool = False) -> None:
        self._motion, self._motion_time, self._once = motion, 0.0, once

    def _start_sound(self, name: str) -> None:
        self._sound, self._sound_left = name, dinosaur.SOUNDS[name]

"""The sounds of Cubeling, each a few lines of synthesis with a little chance in it."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from cubeling.app.sound.synthesis import (
    SAMPLE_RATE,
    Array,
    Formant,
    curve,
    glide,
    hit,
    noise,
    phase,
    strike,
    times,
    voice,
    wobble,
)

Maker = Callable[[np.random.Generator], Array]
"""Makes one variant of a sound from what is random in it."""


class Sound(NamedTuple):
    """One sound: how it is made, how loud it is, and what it is heard for."""

    make: Maker
    """Synthesises one variant of it."""

    level: float
    """Loudness at full volume: RMS of its loudest 50 ms [dB of full scale]."""

    meaning: str
    """What it is heard for: a few words."""


def _near(random: np.random.Generator, value: float, spread: float = 0.05) -> float:
    """Return a value that differs from `value` by up to the part `spread`."""
    return value * float(random.uniform(1.0 - spread, 1.0 + spread))


def _opening(
    start: float, end: float, *shapes: tuple[float, float], width: float = 110.0
) -> list[Formant]:
    """Return a mouth whose resonances move from one frequency to another [Hz] between times [s]."""
    return [
        ([(start, first), (end, last)], width * (1.0 + 0.5 * index), 1.0 / (1.0 + index))
        for index, (first, last) in enumerate(shapes)
    ]


def _mouth(*frequencies: float, width: float = 110.0) -> list[Formant]:
    """Return a mouth that keeps its shape, by its resonances from the lowest [Hz]."""
    return _opening(0.0, 1.0, *((frequency, frequency) for frequency in frequencies), width=width)


def _kiss(random: np.random.Generator) -> Array:
    """Hum behind closed lips, a smack, and a rising "wah": its lips open after 0.12 s."""
    time, high = times(0.50), _near(random, 1.0)
    pitch = high * glide([(0.0, 330), (0.11, 350), (0.19, 400), (0.44, 640)], time)
    pitch *= 1.0 + 0.012 * np.sin(2.0 * np.pi * 6.0 * time)
    mouth = _opening(0.11, 0.27, (260, 760), (900, 1500), (2300, 2800), width=220)
    hum, wah = [(0.0, 0.0), (0.04, 0.30), (0.10, 0.35)], [(0.17, 1.0), (0.28, 0.9), (0.49, 0.0)]
    loud = curve([*hum, (0.12, 0.05), *wah], time)
    # Lips that part: a short burst, and a bubble whose resonance rises as the mouth opens.
    smack = noise(random, len(time), 2600, 0.55) * curve(
        [(0.108, 0), (0.112, 1), (0.120, 0.25), (0.125, 0.7), (0.145, 0)], time
    )
    bubble = np.sin(phase(glide([(0.11, 420), (0.14, 1500)], time)))
    bubble *= curve([(0.106, 0), (0.112, 1), (0.142, 0)], time)
    return 1.3 * voice(pitch, mouth, 0.9) * loud + 0.2 * smack + 0.45 * bubble


def _shout(random: np.random.Generator) -> Array:
    """Roar "raaah" with a wide mouth that vibrates eight times a second."""
    time, high = times(1.05), _near(random, 1.0)
    pitch = high * glide([(0.0, 190), (0.12, 310), (0.6, 285), (1.0, 190)], time)
    tremble = np.sin(2.0 * np.pi * 8.0 * time)
    pitch *= 1.0 + 0.045 * tremble * curve([(0.1, 0), (0.3, 1)], time)
    pitch *= 1.0 + 0.012 * wobble(random, len(time), 60.0)
    mouth = _opening(0.02, 0.12, (420, 900), (1000, 1450), (2300, 2750))
    rough = 1.0 + 0.35 * np.sin(0.5 * phase(pitch)) * curve([(0.1, 0.3), (0.5, 1)], time)
    loud = curve([(0.0, 0), (0.08, 0.9), (0.2, 1), (0.7, 0.85), (1.04, 0)], time)
    breath = noise(random, len(time), 1500, 0.9) * 0.05
    return (voice(pitch, mouth, 0.75) * rough + breath) * loud * (1.0 - 0.18 * (1.0 + tremble))


def _cheer(random: np.random.Generator) -> Array:
    """Call "yay", up and over."""
    time, high = times(0.75), _near(random, 1.0)
    pitch = high * glide([(0.0, 380), (0.16, 560), (0.4, 620), (0.72, 430)], time)
    pitch *= 1.0 + 0.02 * np.sin(2.0 * np.pi * 6.5 * time) * curve([(0.2, 0), (0.5, 1)], time)
    mouth = _opening(0.03, 0.2, (300, 640), (2500, 2000), (3200, 2900))
    loud = curve([(0.0, 0), (0.06, 0.7), (0.2, 1), (0.45, 0.8), (0.74, 0)], time)
    return voice(pitch, mouth) * loud


def _step(random: np.random.Generator) -> Array:
    """Set a small foot on a wooden table: the heel, then more softly the ball."""
    time, low = times(0.16), _near(random, 1.0, 0.08)
    roll = _near(random, 0.055, 0.25)
    wood = [(165 * low, 0.024, 1.0), (392 * low, 0.016, 0.5), (905 * low, 0.007, 0.22)]
    skin = noise(random, len(time), 1900, 0.8) * (hit(time, 0.006) + 0.5 * hit(time, 0.010, roll))
    return strike(time, wood) + 0.35 * strike(time, wood, roll) + 0.15 * skin


def _running_step(random: np.random.Generator) -> Array:
    """Set the ball of a running foot down: one short tap with a scuff."""
    time, low = times(0.13), _near(random, 1.0, 0.08)
    wood = [(190 * low, 0.020, 1.0), (455 * low, 0.013, 0.65), (1080 * low, 0.006, 0.35)]
    scuff = noise(random, len(time), 2600, 0.7)
    scuff *= curve([(0.0, 0), (0.004, 1), (0.02, 0.4), (0.06, 0)], time)
    return strike(time, wood) + 0.16 * scuff


def _land(random: np.random.Generator) -> Array:
    """Land with the whole weight: a thump of the table top."""
    time, low = times(0.26), _near(random, 1.0, 0.06)
    top = [(96 * low, 0.055, 1.0), (203 * low, 0.035, 0.6), (410 * low, 0.018, 0.3)]
    dust = noise(random, len(time), 900, 1.0)
    return strike(time, top) + 0.2 * dust * hit(time, 0.02)


def _hop(random: np.random.Generator) -> Array:
    """Leap: air that rushes by, and a small whistle upwards."""
    time, high = times(0.22), _near(random, 1.0)
    bell = curve([(0.0, 0), (0.10, 1), (0.21, 0)], time)
    rise = curve([(0.0, 0), (0.2, 1)], time)
    low, top = (noise(random, len(time), center, 0.5) for center in (650, 1700))
    whistle = np.sin(phase(high * glide([(0.0, 330), (0.2, 720)], time)))
    return bell * ((1.0 - rise) * low + rise * top + 0.45 * whistle)


def _boop(time: Array, high: float, start: float = 0.0) -> Array:
    """Return a round, hollow knock at a pitch [Hz], which it reaches from below."""
    pitch = high * glide([(start, 0.82), (start + 0.06, 1.0)], time)
    angle = phase(pitch * (time >= start))
    fade = curve([(time[-1] - 0.03, 1), (time[-1], 0)], time)
    return (np.sin(angle) + 0.25 * np.sin(2.0 * angle)) * hit(time, 0.045, start) * fade


def _put_down(random: np.random.Generator) -> Array:
    """Say "boop"."""
    return _boop(times(0.20), _near(random, 525, 0.03))


def _start_over(random: np.random.Generator) -> Array:
    """Say "boop-boop", a fourth down."""
    time, high = times(0.36), _near(random, 525, 0.03)
    return _boop(time, high) + _boop(time, 0.75 * high, 0.12)


def _pencil(random: np.random.Generator) -> Array:
    """Draw a short line: grains of paper under a pencil."""
    time = times(_near(random, 0.30, 0.15))
    grain = noise(random, len(time), 4200, 0.45) + 0.4 * noise(random, len(time), 1500, 0.4)
    stroke = curve([(0.0, 0), (0.05, 1), (0.15, 0.6), (0.22, 0.9), (time[-1], 0)], time)
    return grain * stroke * np.clip(0.55 + 0.35 * wobble(random, len(time), 90.0), 0.05, None)


def _neutral(random: np.random.Generator) -> Array:
    """Coo like a dove: "hoo"."""
    time, high = times(0.48), _near(random, 1.0)
    pitch = high * glide([(0.0, 300), (0.15, 370), (0.45, 310)], time)
    loud = curve([(0.0, 0), (0.10, 1), (0.28, 0.8), (0.47, 0)], time)
    return voice(pitch, _mouth(370, 820), 1.6) * loud


def _happy(random: np.random.Generator) -> Array:
    """Chirp three times, each time higher."""
    sound = np.zeros(len(times(0.62)))
    high = _near(random, 1.0)
    for number, start in enumerate((0.0, 0.15, 0.31)):
        time = times(0.13 + 0.06 * (number == 2))
        low = high * 720 * 1.17**number
        end = float(time[-1])
        pitch = glide([(0.0, low), (0.6 * end, 1.75 * low), (end, 1.6 * low)], time)
        loud = curve([(0.0, 0), (0.25 * end, 1), (end, 0)], time)
        chirp = voice(pitch, _mouth(1100, 2300, width=500), 1.4) * loud
        first = round(start * SAMPLE_RATE)
        sound[first : first + len(chirp)] += chirp
    return sound


def _angry(random: np.random.Generator) -> Array:
    """Grumble deep in the throat."""
    time, high = times(0.85), _near(random, 1.0)
    pitch = high * glide([(0.0, 105), (0.2, 128), (0.55, 112), (0.82, 84)], time)
    pitch *= 1.0 + 0.03 * wobble(random, len(time), 45.0)
    growl = 1.0 + 0.45 * np.sin(2.0 * np.pi * 24.0 * time + wobble(random, len(time), 12.0))
    loud = curve([(0.0, 0), (0.10, 1), (0.45, 0.85), (0.84, 0)], time)
    return voice(pitch, _mouth(430, 980, 2100), 0.8) * growl * loud


def _sad(random: np.random.Generator) -> Array:
    """Whimper, down and trembling."""
    time, high = times(0.80), _near(random, 1.0)
    pitch = high * glide([(0.0, 500), (0.15, 560), (0.75, 330)], time)
    pitch *= 1.0 + 0.018 * np.sin(2.0 * np.pi * 5.5 * time)
    loud = curve([(0.0, 0), (0.12, 1), (0.4, 0.7), (0.79, 0)], time)
    return voice(pitch, _mouth(480, 1150), 1.5) * loud


def _surprised(random: np.random.Generator) -> Array:
    """Ask "oh?", quickly up."""
    time, high = times(0.34), _near(random, 1.0)
    pitch = high * glide([(0.0, 420), (0.08, 440), (0.26, 900), (0.33, 930)], time)
    loud = curve([(0.0, 0), (0.06, 0.7), (0.2, 1), (0.33, 0)], time)
    return voice(pitch, _opening(0.05, 0.25, (450, 750), (900, 1300)), 1.3) * loud


def _afraid(random: np.random.Generator) -> Array:
    """Squeak and shiver."""
    time, high = times(0.55), _near(random, 1.0)
    shiver = np.sin(2.0 * np.pi * 11.0 * time)
    pitch = high * glide([(0.0, 820), (0.1, 980), (0.5, 860)], time) * (1.0 + 0.03 * shiver)
    loud = curve([(0.0, 0), (0.06, 1), (0.3, 0.7), (0.54, 0)], time) * (0.7 + 0.3 * shiver)
    return voice(pitch, _mouth(950, 2100, width=350), 1.6) * loud


def _disgusted(random: np.random.Generator) -> Array:
    """Say "bleh", down, through the nose."""
    time, high = times(0.50), _near(random, 1.0)
    pitch = high * glide([(0.0, 290), (0.1, 320), (0.45, 170)], time)
    tongue = 1.0 - 0.5 * curve([(0.0, 1), (0.05, 0)], time)
    loud = curve([(0.0, 0), (0.05, 1), (0.3, 0.8), (0.49, 0)], time)
    return voice(pitch, _opening(0.05, 0.4, (330, 620), (1900, 1250)), 1.0) * loud * tongue


SOUNDS: dict[str, Sound] = {
    "step": Sound(_step, -19.0, "a foot that walks comes down"),
    "running_step": Sound(_running_step, -17.0, "a foot that runs comes down"),
    "land": Sound(_land, -17.0, "several feet come down at once"),
    "hop": Sound(_hop, -24.0, "all feet leave the table"),
    "kiss": Sound(_kiss, -14.0, "the character kisses"),
    "shout": Sound(_shout, -14.0, "the character shouts"),
    "cheer": Sound(_cheer, -15.0, "the character cheers"),
    "placed": Sound(_put_down, -20.0, "the cube is put down"),
    "start_over": Sound(_start_over, -19.0, "the player starts over"),
    "pencil": Sound(_pencil, -26.0, "the path of a sketch grows or closes"),
    "neutral": Sound(_neutral, -19.0, "the robot becomes neutral"),
    "happy": Sound(_happy, -20.0, "the robot becomes happy"),
    "angry": Sound(_angry, -16.0, "the robot becomes angry"),
    "sad": Sound(_sad, -19.0, "the robot becomes sad"),
    "surprised": Sound(_surprised, -19.0, "the robot is surprised"),
    "afraid": Sound(_afraid, -21.0, "the robot becomes afraid"),
    "disgusted": Sound(_disgusted, -18.0, "the robot becomes disgusted"),
}
"""Every sound by its name; that of an action has the action's name. A new one is one line here."""

MOOD_SOUNDS = ("neutral", "happy", "angry", "sad", "surprised", "afraid", "disgusted")
"""The sounds of the robot's moods; a mood with another name sounds like the nearest of them."""

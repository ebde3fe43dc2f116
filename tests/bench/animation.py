"""Time of one update of a character: `python -m tests.bench.animation`.

A full update includes locomotion at a changing speed, a layer of waving arms, head and eyes that
follow a point, blinks, breath, foot lock, and a mood in face and posture. Exits with 1 if its
median exceeds `LIMIT_MS`, or `HANDS_LIMIT_MS` while a hand reaches for a moving place and the
other one waves.
"""

import sys
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.affect import Emotion
from cubeling.characters import (
    ActionIntent,
    Animator,
    Character,
    CharacterCommand,
    LocomotionIntent,
    mask_of,
)
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.gestures.timing import natural_times
from cubeling.characters.behaviour.intents import BehaviourIntent, GestureIntent, ReachIntent, Times
from cubeling.characters.motion.layers import overlaid

FRAMES = 600

LIMIT_MS = 0.5
"""Limit of the median of a full update."""

HANDS_LIMIT_MS = 0.6
"""Limit of the median of a full update with a reach and a gesture."""


def measure(work: Callable[[int], object]) -> tuple[float, float]:
    """Return median and 95th percentile of one call, in milliseconds."""
    for number in range(30):
        work(number)
    times = []
    for number in range(30, 30 + FRAMES):
        start = time.perf_counter()
        work(number)
        times.append(time.perf_counter() - start)
    return float(np.median(times)) * 1e3, float(np.percentile(times, 95)) * 1e3


def paired_ratio(work: Callable[[int], object], other: Callable[[int], object]) -> float:
    """Return how much longer one work takes than another one, frame by frame in turns."""
    times = np.empty((FRAMES, 2))
    for number in range(FRAMES):
        for column, each in enumerate((work, other)):
            start = time.perf_counter()
            each(number)
            times[number, column] = time.perf_counter() - start
    longer, shorter = np.median(times[30:], axis=0)
    return float(longer / shorter)


def wandering(animator: Animator, speed: float) -> Callable[[int], object]:
    """Return the work of following a target on a circle."""

    def work(number: int) -> object:
        angle = number / 60
        target = 0.4 * np.array([np.sin(angle), np.cos(angle)])
        return animator.update(CharacterCommand(number / 30, LocomotionIntent(speed, target)))

    return work


def everything(animator: Animator, speed: float, mood: str = "happy") -> Callable[[int], object]:
    """Return the work of a full update: locomotion, a layer, a moving gaze target, and a mood.

    An empty mood is no emotion.
    """
    character = animator.character
    arms = mask_of(character.skeleton, {"LeftShoulder": 1.0, "RightShoulder": 1.0})
    wave = character.clips["wave"]

    def work(number: int) -> object:
        angle, time = number / 60, number / 30
        target = 0.4 * np.array([np.sin(angle), np.cos(angle)])
        gaze = np.array([0.3 * np.sin(time), 0.1, 0.4])
        command = CharacterCommand(time, LocomotionIntent(speed, target), gaze=gaze)
        if mood:
            emotion = Emotion(float(np.sin(time / 3)), float(np.cos(time / 5)), mood)
            command = replace(command, emotion=emotion)
        posed = animator.update(command)
        return overlaid(posed.pose, wave.sample(time % wave.duration), arms, 0.0)

    return work


def with_hands(animator: Animator, speed: float) -> Callable[[int], object]:
    """Return the work of a full update with a reach for a moving place and a gesture."""
    wave = GestureCollection.load_bundled().get("WAVE")
    times = natural_times(wave, 1.0)
    held = replace(times, relax=1e6, end=1e6 + 1.0)
    gesture = GestureIntent("wave", wave, held, "right")

    def work(number: int) -> object:
        angle, time = number / 60, number / 30
        target = 0.4 * np.array([np.sin(angle), np.cos(angle)])
        place = np.array([0.1 + 0.05 * np.sin(time), 0.1, 0.1])
        reach = ReachIntent("it", place, Times(0.0, 0.5), "touch", "left")
        return animator.update(
            CharacterCommand(
                time,
                LocomotionIntent(speed, target),
                gaze=place,
                emotion=Emotion(float(np.sin(time / 3)), float(np.cos(time / 5)), "happy"),
                behaviour=BehaviourIntent((gesture,), (reach,)),
            )
        )

    return work


def acting(animator: Animator, action: str) -> Callable[[int], object]:
    """Return the work of an action with changing intensity."""

    def work(number: int) -> object:
        weight = float(np.sin(number / 40))
        return animator.update(CharacterCommand(number / 30, action=ActionIntent(action, weight)))

    return work


def switching(animator: Animator) -> Callable[[int], object]:
    """Return the work of repeated starts and stops: always in a transition."""

    def work(number: int) -> object:
        speed = 2.0 if number // 6 % 2 else 0.0
        target = np.array([0.0, 99.0])
        return animator.update(CharacterCommand(number / 30, LocomotionIntent(speed, target)))

    return work


def main() -> int:
    """Print the table and return an exit code."""
    human, vleo = Character.load("human"), Character.load("vleo")
    rest = human.skeleton.rest
    rows = {
        "stand": wandering(Animator(human), 0.0),
        "walk": wandering(Animator(human), 2.0),
        "walk and run mixed": wandering(Animator(human), 3.0),
        "run": wandering(Animator(human), 4.5),
        "start and stop": switching(Animator(human)),
        "full update without emotion": everything(Animator(human), 3.0, ""),
        "kiss, intensity changing": acting(Animator(vleo), "kiss"),
        "globals of the human only": lambda number: rest.globals(human.skeleton),
    }
    full = {
        f"full update at Speed {speed:g}": everything(Animator(human), speed)
        for speed in (1.5, 3.0, 4.5)
    }
    hands = {
        f"with reach and gesture at Speed {speed:g}": with_hands(Animator(human), speed)
        for speed in (0.0, 1.5)
    }
    table, slowest, busiest = Table("one update", "median ms", "p95 ms"), 0.0, 0.0
    for name, work in {**rows, **full, **hands}.items():
        median, high = measure(work)
        table.add_row(name, f"{median:.3f}", f"{high:.3f}")
        if name in full:
            slowest = max(slowest, median)
        if name in hands:
            busiest = max(busiest, median)
    Console().print(table)
    if slowest > LIMIT_MS:
        Console().print(f"a full update takes {slowest:.3f} ms, more than {LIMIT_MS} ms")
    ratio = paired_ratio(with_hands(Animator(human), 1.5), everything(Animator(human), 1.5))
    Console().print(f"reach and gesture: x {ratio:.2f} of a full update, in turns at Speed 1.5")
    if busiest > HANDS_LIMIT_MS:
        Console().print(f"with hands it takes {busiest:.3f} ms, more than {HANDS_LIMIT_MS} ms")
    return int(slowest > LIMIT_MS or busiest > HANDS_LIMIT_MS)


if __name__ == "__main__":
    sys.exit(main())

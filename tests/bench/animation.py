"""How long one update of a character takes: `python -m tests.bench.animation`."""

import time
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.table import Table

from characters import Animator, Character, CharacterCommand

FRAMES = 600


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


def wandering(animator: Animator, speed: float) -> Callable[[int], object]:
    """Return the work of chasing a target that runs round a circle."""

    def work(number: int) -> object:
        angle = number / 60
        target = 0.4 * np.array([np.sin(angle), np.cos(angle)])
        return animator.update(CharacterCommand(number / 30, "move", speed, target))

    return work


def acting(animator: Animator, action: str) -> Callable[[int], object]:
    """Return the work of an action whose intensity rises and falls."""

    def work(number: int) -> object:
        weight = float(np.sin(number / 40))
        return animator.update(CharacterCommand(number / 30, action, weight=weight))

    return work


def switching(animator: Animator) -> Callable[[int], object]:
    """Return the work of setting off and stopping again and again: always in a transition."""

    def work(number: int) -> object:
        speed = 2.0 if number // 6 % 2 else 0.0
        target = np.array([0.0, 99.0])
        return animator.update(CharacterCommand(number / 30, "move", speed, target))

    return work


def main() -> None:
    """Print the table."""
    human, vleo = Character.load("human"), Character.load("vleo")
    rest = human.skeleton.rest
    rows = {
        "stand": wandering(Animator(human), 0.0),
        "walk": wandering(Animator(human), 2.0),
        "walk and run mixed": wandering(Animator(human), 3.0),
        "run": wandering(Animator(human), 4.5),
        "set off and stop": switching(Animator(human)),
        "kiss, intensity changing": acting(Animator(vleo), "kiss"),
        "globals of the human alone": lambda number: rest.globals(human.skeleton),
    }
    table = Table("one update", "median ms", "p95 ms")
    for name, work in rows.items():
        median, high = measure(work)
        table.add_row(name, f"{median:.3f}", f"{high:.3f}")
    Console().print(table)


if __name__ == "__main__":
    main()

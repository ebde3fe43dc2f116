"""How bodies reach, and what it costs: `python -m tests.bench.reach`.

reached
    Share of places in front, up to 1.2 arm lengths from the shoulder, that torso and arm reach.
miss
    Largest distance of the palm from such a place, scaled to a person 1.7 m tall.
turn
    Turn of any joint for a centimetre (of a person) that a place moves: 95 % quantile of places
    that are reached, and share of all places, up to two arm lengths away, with less than 5°.
within, beyond
    Least time of one reach for a place within the arm's reach, and for one at the torso's.
layer
    Least time of an update with a reach less that without, in the same run.

Exits with 1 if a palm misses by a centimetre or more.
"""

import sys
import time
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters import Animator, Character, CharacterCommand
from cubeling.characters.behaviour.intents import BehaviourIntent, ReachIntent, Times
from cubeling.characters.control.layers import FOOT_LAYERS, LIVELINESS_LAYERS
from cubeling.characters.control.layers.gaze import GazeLayer
from cubeling.characters.control.layers.reach import ReachLayer
from cubeling.characters.ik.reaching import HandTarget
from cubeling.characters.skeleton.pose import Array

PERSON_MM, STEP_MM, MAX_MISS_MM = 1700.0, 2.0, 10.0
PLACES, CALLS, FRAMES = 1500, 3000, 400


def least_ms(work: Callable[[int], object], calls: int) -> float:
    """Return the least time of a call [ms]."""
    least = np.inf
    for number in range(calls):
        start = time.perf_counter()
        work(number)
        least = min(least, time.perf_counter() - start)
    return 1e3 * float(least)


def accuracy(character: Character) -> tuple[float, float, float, float]:
    """Return the share that is reached, the largest miss [mm], and both figures of the turns."""
    body, rest = character.upper_body, character.skeleton.rest
    arm = body.arms["left"]
    shoulder = rest.globals(character.skeleton)[arm.joints[1], :3, 3]
    size = arm.upper + float(np.linalg.norm(arm.hand.palm - np.array(arm.elbow)))
    seed, metre = np.random.default_rng(17), character.height / PERSON_MM
    misses, near, turns, reached_turns = [], 0, [], []
    for _ in range(PLACES):
        aim = seed.normal(size=3) + [0.0, 0.0, 1.0]
        aim[2], far = abs(aim[2]), seed.uniform(0.4, 2.0)
        place = shoulder + far * size * aim / np.linalg.norm(aim)
        step = seed.normal(size=3)
        step *= STEP_MM * metre / np.linalg.norm(step)
        one, other = (body.reach_for(rest, HandTarget(where)) for where in (place, place + step))
        cosine = np.abs((one.pose.rotations * other.pose.rotations).sum(-1)).min()
        turns.append(np.degrees(2 * np.arccos(min(cosine, 1.0))) / (STEP_MM / 10))
        near += far < 1.2
        if one.effort < 1.0:
            palm = body.palm(one.pose, "left")
            misses.append(float(np.linalg.norm(np.asarray(palm) - place)) / metre)
            reached_turns.append(turns[-1])
    gentle = float(np.mean(np.array(turns) < 5.0))
    return len(misses) / near, max(misses), float(np.quantile(reached_turns, 0.95)), gentle


def reach_ms(character: Character, place: Array) -> float:
    """Return the least time of one reach [ms]."""
    body, rest, target = character.upper_body, character.skeleton.rest, HandTarget(place)
    return least_ms(lambda _: body.reach(rest, target), CALLS)


def update_ms(character: Character, place: Array | None) -> float:
    """Return the least time of an update of a standing character that reaches, or does not [ms]."""
    plain = [layer for layer in LIVELINESS_LAYERS if layer is not ReachLayer]
    gaze = plain.index(GazeLayer)
    layers = (*FOOT_LAYERS, *plain[:gaze], ReachLayer, *plain[gaze:])
    animator = Animator(character, layers=layers)
    target = np.zeros(3) if place is None else place * animator.scale

    def work(number: int) -> object:
        intent = ReachIntent("it", target, Times(0.0, 0.5), hand="left")
        asked = BehaviourIntent() if place is None else BehaviourIntent(reaches=(intent,))
        return animator.update(CharacterCommand(number / 30, behaviour=asked))

    return least_ms(work, FRAMES)


def main() -> int:
    """Print the table and return an exit code."""
    table, worst = Table(title="reaching"), 0.0
    headings = ("who", "reached", "miss", "turn", "< 5°/cm", "within", "beyond", "layer")
    for heading in headings:
        table.add_column(heading, justify="left" if heading == "who" else "right")
    for name in Character.bundled_names():
        character = Character.load(name)
        body, rest = character.upper_body, character.skeleton.rest
        shoulder = rest.globals(character.skeleton)[body.arms["left"].joints[1], :3, 3]
        size = body.arms["left"].upper + body.arms["left"].fore
        ahead = size * np.array([0.1, -0.2, 0.9])
        share, miss, turn, gentle = accuracy(character)
        worst = max(worst, miss)
        times = [reach_ms(character, shoulder + far * ahead) for far in (0.8, 1.5)]
        layer = update_ms(character, shoulder + 0.8 * ahead) - update_ms(character, None)
        table.add_row(
            name,
            f"{share:.0%}",
            f"{miss:.2f} mm",
            f"{turn:.1f} °/cm",
            f"{gentle:.1%}",
            *(f"{each:.3f} ms" for each in (*times, layer)),
        )
    Console(width=110).print(table)
    return int(worst >= MAX_MISS_MM)


if __name__ == "__main__":
    sys.exit(main())

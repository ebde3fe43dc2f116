"""A stander whose choices and pauses are known, and what is learned from her."""

import numpy as np
import pytest

from cubeling.characters import Character
from cubeling.characters.synthesis.idle.database import IdleDatabase
from cubeling.characters.synthesis.idle.posture_space import PostureVectors
from cubeling.characters.synthesis.idle.recordings import StandingRecording, find_rests

RATE = 25.0

SIDES = {"left": 0.4, "both": 0.0, "right": -0.4}

CHANCES = {"left": (0.0, 0.3, 0.7), "both": (0.5, 0.0, 0.5), "right": (0.8, 0.2, 0.0)}

PAUSES = (1.0, 4.0)


@pytest.fixture(scope="module")
def kind(human: Character) -> PostureVectors:
    return PostureVectors.of(human.skeleton, human.anatomy)


def script(count: int, seed: int) -> tuple[np.ndarray, list[tuple[str, float]]]:
    """Return the balance of a stander whose choices and pauses are known."""
    rng = np.random.default_rng(seed)
    name, values, truth = "both", [], []
    for _ in range(count):
        pause = float(rng.uniform(*PAUSES))
        truth.append((name, pause))
        values += [SIDES[name]] * round(pause * RATE)
        after = str(rng.choice([*SIDES], p=CHANCES[name]))
        u = np.linspace(0.0, 1.0, round(1.2 * RATE))
        eased = u * u * (3.0 - 2.0 * u)
        values += (SIDES[name] + (SIDES[after] - SIDES[name]) * eased).tolist()
        name = after
    return np.array(values), truth


@pytest.fixture(scope="module")
def database(kind: PostureVectors) -> IdleDatabase:
    """What is learned from that stander, whose joints follow the balance and sway by themselves."""
    balance, _ = script(60, 3)
    rng = np.random.default_rng(4)
    size = kind.size
    times = np.arange(len(balance)) / RATE
    sway = [np.sin(2 * np.pi * times * rng.uniform(0.1, 0.5) + rng.uniform(0, 6)) for _ in range(6)]
    vectors = np.outer(balance, rng.normal(size=size) * 0.2)
    vectors += 0.01 * np.stack(sway, axis=1) @ rng.normal(size=(6, size))
    found = StandingRecording("anna", RATE, vectors, balance, find_rests(balance, RATE))
    return IdleDatabase.of([found], kind)

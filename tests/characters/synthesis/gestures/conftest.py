"""The bundled gesture library, and strokes whose truth is known."""

from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from cubeling.characters import Character, Clip, Pose
from cubeling.characters.skeleton import rotations
from cubeling.characters.synthesis.gestures.library import GestureLibrary
from tests.bundled_characters import bundled_character

RATE = 60.0


@pytest.fixture(scope="session")
def human() -> Character:
    return bundled_character("human")


@pytest.fixture(scope="session")
def library() -> GestureLibrary:
    return GestureLibrary.load(
        Path(str(resources.files("cubeling.characters") / "assets/human.gestures"))
    )


@pytest.fixture(scope="session")
def beating(human):
    """Return a function that makes a clip of a right arm: knots of (time [s], bend [degrees])."""

    def make(knots, side="right", others=None):
        times, bends = np.array(knots, float).T
        now = np.arange(round(times[-1] * RATE) + 1) / RATE
        # Minimum jerk from knot to knot: speed and acceleration are zero in each.
        after = np.clip(np.searchsorted(times, now, side="right"), 1, len(times) - 1)
        u = np.clip((now - times[after - 1]) / (times[after] - times[after - 1]), 0.0, 1.0)
        ease = u**3 * (10 - 15 * u + 6 * u * u)
        angle = np.radians(bends[after - 1] + (bends[after] - bends[after - 1]) * ease)
        rest = human.skeleton.rest
        turns = np.repeat(rest.rotations[None], len(now), axis=0)
        joint = human.anatomy.joints[f"{side}LowerArm"]
        turns[:, joint] = rotations.multiply(turns[:, joint], rotations.about("x", -angle))
        moved = np.repeat(rest.translations[None], len(now), axis=0)
        if others is not None:
            others(turns, now)
        return Clip("beating", RATE, Pose(moved, turns), loop=False)

    return make

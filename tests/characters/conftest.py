"""Small characters with known truth: a walker on two stiff feet, and an actor with a tail."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from cubeling.characters import Character, Clip, Mesh, Pose, Skeleton
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from tests.bundled_characters import (
    bundled_characters_are_read_once as bundled_characters_are_read_once,
)

STANCE_SHARE = 0.6
SIDES = (("Left", 0.1, 0.0), ("Right", -0.1, 0.5))
NAMES = ("root", "hips", "head", "LeftFoot", "RightFoot")


def _arc(speed: float, yaw_rate: float, time: float) -> RootDelta:
    half = yaw_rate * time / 2
    chord = speed * time * (math.sin(half) / half if abs(half) > 1e-12 else 1.0)
    return RootDelta(chord * math.sin(half), chord * math.cos(half), 2 * half)


def _foot(speed: float, yaw_rate: float, cycle: float, side: float, own: float) -> list[float]:
    """Where a foot is in the root's frame, so long after it landed (part of the cycle)."""

    def planted(part: float) -> tuple[float, float]:
        back = _arc(speed, yaw_rate, (STANCE_SHARE / 2 - part) * cycle)
        at = back.then(RootDelta(side, 0.0))
        return at.x, at.z

    if own <= STANCE_SHARE:
        x, z = planted(own)
        return [x, 0.05, z]
    u = (own - STANCE_SHARE) / (1 - STANCE_SHARE)
    ease = u * u * (3 - 2 * u)
    (x0, z0), (x1, z1) = planted(STANCE_SHARE), planted(0.0)
    return [x0 + (x1 - x0) * ease, 0.05 + 0.1 * math.sin(math.pi * u), z0 + (z1 - z0) * ease]


@pytest.fixture(scope="session")
def skeleton() -> Skeleton:
    translations = np.array(
        [[0, 0, 0], [0, 0.8, 0], [0, 0.7, 0], [0.1, -0.75, 0], [-0.1, -0.75, 0]]
    )
    rest = Pose(translations.astype(float), np.tile(rotations.IDENTITY, (5, 1)))
    return Skeleton(NAMES, (-1, 0, 1, 1, 1), rest)


@pytest.fixture(scope="session")
def gait(skeleton: Skeleton) -> Callable[..., Clip]:
    """Make a walk along an arc; its left foot lands `lead` cycles after its first frame."""

    def make(
        name: str, speed: float, yaw_rate: float, cycle: float, lead: float = 0.0, rate: float = 60
    ) -> Clip:
        frames = round(cycle * rate)
        cycle = frames / rate
        translations = np.tile(skeleton.rest.translations, (frames + 1, 1, 1))
        turns = np.tile(skeleton.rest.rotations, (frames + 1, 1, 1))
        for frame in range(frames + 1):
            place = _arc(speed, yaw_rate, frame / rate)
            translations[frame, 0] = place.x, 0, place.z
            turns[frame, 0] = rotations.about("y", place.yaw)
            for joint, (_, side, late) in enumerate(SIDES, start=3):
                own = (frame / frames - lead - late) % 1.0
                foot = _foot(speed, yaw_rate, cycle, side, own)
                translations[frame, joint] = np.array(foot) - [0, 0.8, 0]
            nod = 0.2 * math.sin(2 * math.pi * (frame / frames - lead))
            turns[frame, 2] = rotations.about("x", nod)
        return Clip(name, rate, Pose(translations, turns), loop=True, root_motion=True)

    return make


def _box(skeleton: Skeleton) -> Mesh:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (0, 1) for z in (-1, 1)], float)
    positions = corners * [0.2, 1.7, 0.1]
    inverse_bind = np.asarray(np.linalg.inv(skeleton.rest.globals(skeleton)), np.float64)
    joints = np.zeros((8, 4), np.uint16)
    joints[:, 0], joints[:, 1] = 1, 2
    normals = positions / np.linalg.norm(positions, axis=1, keepdims=True)
    return Mesh(
        name="box",
        positions=positions.astype(np.float32),
        normals=normals.astype(np.float32),
        triangles=np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5]], np.uint32),
        joints=joints,
        weights=np.tile(np.array([0.75, 0.25, 0, 0], np.float32), (8, 1)),
        inverse_bind=inverse_bind,
        colors=np.linspace(0, 1, 32, dtype=np.float32).reshape(8, 4),
    )


@pytest.fixture(scope="session")
def walker(skeleton: Skeleton, gait: Callable[..., Clip]) -> Character:
    """A character with the whole movement tree; each clip starts elsewhere in its stride."""
    clips = [
        Clip("idle", 60.0, gait("idle", 0.0, 0.0, 1.0).poses[np.zeros(31, int)], True, True),
        gait("Walk", 1.35, 0.0, 1.0, 0.3),
        gait("Run", 3.4, 0.0, 0.7, 0.8),
    ]
    curves = [
        ("WalkLeftWide", 1.3, 45.0, 1.0),
        ("WalkLeftMedium", 1.1, 90.0, 0.95),
        ("WalkLeftShort", 0.9, 135.0, 0.9),
        ("RunLeftWide", 3.2, 67.5, 0.7),
        ("RunLeftMedium", 2.8, 135.0, 0.65),
    ]
    for number, (name, speed, rate, cycle) in enumerate(curves):
        for sign, side in ((1, "Left"), (-1, "Right")):
            yaw_rate = sign * math.radians(rate)
            lead = 0.1 * number + 0.05 * sign
            clips.append(gait(name.replace("Left", side), speed, yaw_rate, cycle, lead))
    return Character("walker", skeleton, {clip.name: clip for clip in clips}, (_box(skeleton),))


@pytest.fixture(scope="session")
def actor(skeleton: Skeleton) -> Character:
    """A character with two actions at three intensities: the head nods the more."""

    def nod(name: str, depth: float) -> Clip:
        angles = depth * np.sin(2 * np.pi * np.arange(61) / 60)
        turns = np.tile(skeleton.rest.rotations, (61, 1, 1))
        turns[:, 2] = rotations.about("x", angles)
        still = np.tile(skeleton.rest.translations, (61, 1, 1))
        return Clip(name, 30.0, Pose(still, turns), loop=True, root_motion=True)

    depths = {"idle": 0.0, "kiss_head": 0.2, "kiss_legs": 0.4, "kiss_tail": 0.8}
    depths |= {"shout_head": -0.2, "shout_legs": -0.4, "shout_tail": -0.8}
    clips = {name: nod(name, depth) for name, depth in depths.items()}
    return Character("actor", skeleton, clips, (_box(skeleton),))

"""Learning a gesture library from recordings: anyone's, with open hands and rests in between."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.baking import bake
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.synthesis.gestures.analysis import (
    bimanual_strength,
    find_apex,
    gesture_strength,
    hand_paths,
    hand_speed,
    masses,
)
from cubeling.characters.synthesis.gestures.library import (
    GestureLibrary,
    GesturePhrase,
    GestureRecording,
    Hand,
    gesture_joints,
)
from cubeling.characters.synthesis.gestures.segmentation import (
    REST,
    STROKE,
    Labels,
    arm_length,
    both_labels,
    hand_labels,
    phrase_bounds,
    runs,
)

RATE_HZ = 60.0
"""Frame rate of learned libraries [Hz]."""

MARGIN_S = 0.1
"""Rest that is kept before and after a unit of gestures [s]."""


@dataclass(frozen=True, eq=False)
class AnalysedGestures:
    """The gestures of one clip."""

    poses: Pose
    """The clip at `RATE_HZ`, (frames, joints, …)."""

    labels: dict[str, Labels]
    """The label of each frame, by side and for "both"."""

    phrases: tuple[GesturePhrase, ...]
    """Its phrases, as if the clip were recording 0."""


def analyse(clip: Clip, skeleton: Skeleton, anatomy: Anatomy) -> AnalysedGestures:
    """Find the gestures of a clip, their phases, apices and strengths."""
    poses = bake(clip, RATE_HZ, clip.duration, clip.name).poses
    paths = hand_paths(poses, skeleton, anatomy)
    lengths = {side: _arm_length(skeleton, anatomy, side) for side in paths}
    labels = {side: hand_labels(path, RATE_HZ, lengths[side]) for side, path in paths.items()}
    speeds = {side: hand_speed(path, RATE_HZ) for side, path in paths.items()}
    merged = both_labels(labels, speeds)
    phrases = [
        _phrase(bounds, labels, paths, poses.rotations, anatomy) for bounds in phrase_bounds(merged)
    ]
    return AnalysedGestures(poses, labels | {"both": merged}, tuple(phrases))


def learn_gestures(clips: Sequence[Clip], skeleton: Skeleton, anatomy: Anatomy) -> GestureLibrary:
    """Return the gestures of clips as a library.

    Raises
    ------
    CharacterError
        If no clip has a gesture, or the body has no spine or head.
    """
    joints = [*gesture_joints(skeleton, anatomy)]
    if not joints:
        raise CharacterError("gestures need a spine and a head; name them in the character's file")
    recordings: list[GestureRecording] = []
    phrases: list[GesturePhrase] = []
    resting: list[Array] = []
    for clip in clips:
        found = analyse(clip, skeleton, anatomy)
        turns = rotations.continuous(found.poses.rotations[:, joints])
        resting.append(turns[found.labels["both"] == REST])
        for first, last in _units(found.labels["both"]):
            inside = [each for each in found.phrases if first <= each.bounds[0] < last]
            if inside:
                phrases += [_renumber(each, len(recordings), first) for each in inside]
                recordings.append(GestureRecording(clip.name, turns[first : last + 1]))
    if not phrases:
        names = ", ".join(clip.name for clip in clips)
        raise CharacterError(
            f"{names}: no gesture found; hands must rest, move away, and come back to rest"
        )
    rest = _typical(np.concatenate(resting))
    return GestureLibrary(
        skeleton, anatomy, tuple(joints), RATE_HZ, rest, tuple(recordings), tuple(phrases)
    )


def stroke_strength(
    turns: Array, hand: Hand, anatomy: Anatomy, apices: tuple[float, float] = (0.0, 0.0)
) -> float:
    """Return the GSI of a stroke, local rotations of all joints (frames, joints, 4) at `RATE_HZ`.

    `apices` are those of the left and the right hand [s].
    """
    sides = SIDES if hand == "both" else (hand,)
    each = [gesture_strength(turns, masses(anatomy, side), RATE_HZ) for side in sides]
    return bimanual_strength((each[0], each[1]), apices) if len(each) == 2 else each[0]


def _phrase(
    bounds: tuple[int, int, int, int, int, int],
    labels: dict[str, Labels],
    paths: dict[str, Array],
    turns: Array,
    anatomy: Anatomy,
) -> GesturePhrase:
    stroke = bounds[2], bounds[3]
    part = slice(stroke[0], stroke[1] + 1)
    busy = [side for side, own in labels.items() if (own[part] == STROKE).any()]
    hand: Hand = "both" if len(busy) == 2 else "left" if busy == ["left"] else "right"
    apices = {side: min(find_apex(paths[side], RATE_HZ, stroke), bounds[5]) for side in busy}
    times = [apex / RATE_HZ for apex in apices.values()]
    strength = stroke_strength(turns[part], hand, anatomy, (times[0], times[-1]))
    longest = max(busy, key=lambda side: _reach(paths[side], stroke[0], apices[side]))
    return GesturePhrase(0, hand, bounds, apices[longest], strength)


def _reach(path: Array, first: int, last: int) -> float:
    return float(np.linalg.norm(path[last] - path[first]))


def _arm_length(skeleton: Skeleton, anatomy: Anatomy, side: str) -> float:
    """Return the length of an arm, or, on four legs, of the neck [m]."""
    arm = [side + part for part in ("UpperArm", "LowerArm", "Hand")]
    parts = arm if arm[2] in anatomy.joints else ["chest", "neck", "head"]
    placed = skeleton.rest.globals(skeleton)[..., :3, 3]
    return arm_length(placed[[anatomy.joints[part] for part in parts if part in anatomy.joints]])


def _units(labels: Labels) -> list[tuple[int, int]]:
    """Return first and last frame of what is from rest to rest, with a margin."""
    margin = round(MARGIN_S * RATE_HZ)
    return [
        (max(first - margin, 0), min(last + margin, len(labels) - 1))
        for first, last in runs(labels != REST)
    ]


def _renumber(phrase: GesturePhrase, recording: int, first: int) -> GesturePhrase:
    """Return a phrase of a recording that begins with this frame."""
    a, b, c, d, e, f = (bound - first for bound in phrase.bounds)
    return replace(phrase, recording=recording, bounds=(a, b, c, d, e, f), apex=phrase.apex - first)


def _typical(turns: Array) -> Array:
    """Return the rotations (joints, 4) that are nearest to the mean of frames."""
    mean = rotations.normalize(rotations.align(turns, turns[0]).mean(0))
    nearest: Array = turns[np.abs((turns * mean).sum(-1)).sum(-1).argmax()]
    return nearest

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
    Bounds,
    GestureLibrary,
    GesturePhrase,
    GestureRecording,
    Hand,
    gesture_joints,
)
from cubeling.characters.synthesis.gestures.marks import GestureMarks, marked_labels
from cubeling.characters.synthesis.gestures.segmentation import (
    REST,
    STROKE,
    Labels,
    Segmentation,
    arm_length,
    phrase_bounds,
    runs,
    segment,
)

RATE_HZ = 60.0
"""Frame rate of learned libraries [Hz]."""

MARGIN_S = 0.1
"""Rest that is kept before and after a unit of gestures [s]."""


WALK_HEIGHTS, WALK_HEIGHTS_S = 0.3, 0.27
"""A unit in which hips go further than this, and at least so fast on average, is a walk, whose arms
swing [body heights, body heights/s]. People walk twice as fast; who dances or steps aside goes
slower."""

WALKS = "hands move only while the body walks"
"""Why a clip has no gesture that has some such units."""

MINOR_STROKE = 0.4
"""A hand whose peak speed is below this share of the other hand's makes no stroke (M4)."""


@dataclass(frozen=True, eq=False)
class AnalysedGestures:
    """The gestures of one clip."""

    name: str
    """Name of the clip."""

    poses: Pose
    """The clip at `RATE_HZ`, (frames, joints, …)."""

    labels: Labels
    """The label of each frame, (frames,)."""

    phrases: tuple[GesturePhrase, ...]
    """Its phrases, as if the clip were recording 0."""

    reason: str
    """Why it has none; "" if it has some."""

    @property
    def marks(self) -> list[GestureMarks]:
        """The times of its gestures."""
        return [GestureMarks.of(phrase, RATE_HZ) for phrase in self.phrases]


def find_gestures(
    clip: Clip, skeleton: Skeleton, anatomy: Anatomy, marks: Sequence[GestureMarks] = ()
) -> AnalysedGestures:
    """Find the gestures of a clip, their phases, apices and strengths.

    With the marks of a person, their times are taken; hands and strengths are still found.
    """
    poses = bake(clip, RATE_HZ, clip.duration, clip.name).poses
    paths = {
        side: path / _arm_length(skeleton, anatomy, side)
        for side, path in hand_paths(poses, skeleton, anatomy).items()
    }
    if marks:
        frames = len(poses.rotations)
        marked = [each.frames(RATE_HZ, frames) for each in marks]
        found = Segmentation(marked_labels([bounds for bounds, _ in marked], frames), "")
        phrases = [_phrase(*each, paths, poses.rotations, anatomy) for each in marked]
    else:
        found = _without_walks(segment(paths, RATE_HZ), poses, skeleton, anatomy)
        phrases = [
            _phrase(bounds, None, paths, poses.rotations, anatomy)
            for bounds in phrase_bounds(found.labels)
        ]
    return AnalysedGestures(clip.name, poses, found.labels, tuple(phrases), found.reason)


def learn_gestures(clips: Sequence[Clip], skeleton: Skeleton, anatomy: Anatomy) -> GestureLibrary:
    """Return the gestures of clips as a library; errors as of `library_of`."""
    return library_of([find_gestures(clip, skeleton, anatomy) for clip in clips], skeleton, anatomy)


def library_of(
    found: Sequence[AnalysedGestures], skeleton: Skeleton, anatomy: Anatomy
) -> GestureLibrary:
    """Return what was found in clips as a library.

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
    for each in found:
        turns = rotations.continuous(each.poses.rotations[:, joints])
        # A clip that is cut tightly rests in its edges.
        resting += [turns[each.labels == REST], turns[[0, -1]]]
        for first, last in _units(each.labels):
            inside = [phrase for phrase in each.phrases if first <= phrase.bounds[0] < last]
            if inside:
                phrases += [_renumber(phrase, len(recordings), first) for phrase in inside]
                recordings.append(GestureRecording(each.name, turns[first : last + 1]))
    if not phrases:
        reasons = "; ".join(f"{each.name}: {each.reason}" for each in found)
        raise CharacterError(f"no gesture found in {reasons}")
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
    bounds: Bounds,
    marked_apex: int | None,
    paths: dict[str, Array],
    turns: Array,
    anatomy: Anatomy,
) -> GesturePhrase:
    begin, _, first, last, _, end = bounds
    peaks = {
        side: float(hand_speed(path, RATE_HZ)[begin : last + 1].max())
        for side, path in paths.items()
    }
    busy = [side for side in peaks if peaks[side] >= MINOR_STROKE * max(peaks.values())]
    hand: Hand = "both" if len(busy) == 2 else "left" if busy == ["left"] else "right"
    apices = {side: min(find_apex(paths[side], RATE_HZ, (first, last)), end) for side in busy}
    times = [apex / RATE_HZ for apex in apices.values()]
    stop = max(*apices.values(), first + 1)  # what settles is no part of the strength
    strength = stroke_strength(turns[first : stop + 1], hand, anatomy, (times[0], times[-1]))
    apex = apices[max(busy, key=peaks.__getitem__)] if marked_apex is None else marked_apex
    return GesturePhrase(0, hand, bounds, apex, strength)


def _without_walks(
    found: Segmentation, poses: Pose, skeleton: Skeleton, anatomy: Anatomy
) -> Segmentation:
    """Return the phases without units in which the body walks."""
    hips = anatomy.joint("hips")
    if hips is None or found.reason:
        return found
    heights = skeleton.rest.globals(skeleton)[:, 1, 3]
    ways = poses.globals(skeleton)[:, hips, [0, 2], 3] / float(np.ptp(heights))
    labels = found.labels.copy()
    for first, last in runs(labels != REST):
        far = float(np.linalg.norm(ways[first : last + 1] - ways[first], axis=1).max())
        if far > max(WALK_HEIGHTS, WALK_HEIGHTS_S * (last - first) / RATE_HZ):
            labels[first : last + 1] = REST
    return Segmentation(labels, "" if (labels == STROKE).any() else WALKS)


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

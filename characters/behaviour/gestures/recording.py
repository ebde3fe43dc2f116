"""A symbolic gesture from a recording: sectors, palms and paths of the hands in a clip.

The way of a palm in the gesture space becomes a polyline (Ramer 1972). Its first and last turning
points are the ends of the stroke; what comes before and after them is preparation and retraction,
if the hand hangs down there.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.behaviour.gestures.body import SIDES, arm_length
from cubeling.characters.behaviour.gestures.place.directions import words_of
from cubeling.characters.behaviour.gestures.place.space import GestureSpace
from cubeling.characters.behaviour.gestures.style.trunk import chest_part
from cubeling.characters.behaviour.symbolic_gesture import BodyKey, HandKey, Place, SymbolicGesture
from cubeling.characters.errors import CharacterError
from cubeling.characters.ik.reaching import HAND_SHAPES, UpperBody
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

RATE_HZ = 50.0
"""Frames of a recording that are looked at."""

TOLERANCE = 0.08
"""How far a palm may be from the polyline of its way, in parts of an arm's length."""

MIN_HAND_TRAVEL = 0.15
"""A hand that stays within this takes no part, in parts of an arm's length."""

HANGING = -0.45
"""Height below the chest at which a hand is at rest, in parts of an arm's length."""

TURNING_DEG = 60.0
"""Change of direction at a turning point [degrees]."""

SLOW = 0.25
"""Speed at a turning point ÷ the greatest speed."""

MIN_BODY_DEG = 4.0
"""Turns of the trunk below which they are left out [degrees]."""

SHORTEST_S = 0.1
"""Shortest preparation and retraction [s]."""

SNAP_DISTANCE = 0.04
"""Offsets from the centre of a cell that are left out, in parts of an arm's length."""


@dataclass(frozen=True, eq=False)
class RecordedHand:
    """A hand over the frames of a recording."""

    left: bool
    """Whether it is the left one."""

    places: Array
    """Of its palm, (frames, 3), from the chest and in its frame, in parts of an arm's length."""

    fingers: Array
    """Where they point, (frames, 3)."""

    palms: Array
    """Where the palm faces, (frames, 3)."""

    shapes: tuple[str, ...]
    """Name of its shape in each frame."""

    @property
    def moves(self) -> bool:
        """Whether it takes part."""
        return float(np.ptp(self.places, axis=0).max()) > MIN_HAND_TRAVEL

    def stroke(self) -> list[int]:
        """Return the frames of its keys, those of the stroke alone."""
        keys = polyline(self.places, TOLERANCE)
        speeds = np.linalg.norm(np.gradient(self.places, axis=0), axis=1)
        turns = [key for key in keys if self._turns(key, keys, speeds)]
        hanging = self.places[:, 1] < HANGING
        first = turns[0] if hanging[0] and turns else 0
        last = turns[-1] if hanging[-1] and turns else len(hanging) - 1
        kept = [key for key in keys if first <= key <= last]
        return _without_holds(kept, self.places) or [first]

    def _turns(self, key: int, keys: list[int], speeds: Array) -> bool:
        number = keys.index(key)
        if number in (0, len(keys) - 1):
            return False
        before = self.places[key] - self.places[keys[number - 1]]
        after = self.places[keys[number + 1]] - self.places[key]
        cosine = float(before @ after) / max(
            float(np.linalg.norm(before) * np.linalg.norm(after)), 1e-9
        )
        slow = bool(speeds[key] < SLOW * speeds.max())
        return slow or cosine < math.cos(math.radians(TURNING_DEG))


def gesture_from_recording(
    clip: Clip,
    skeleton: Skeleton,
    anatomy: Anatomy,
    start: float = 0.0,
    end: float | None = None,
    name: str = "RECORDED",
) -> SymbolicGesture:
    """Return the gesture in a span of a recording [s].

    Raises
    ------
    CharacterError
        If no hand moves in the span, or the body has no arms.
    """
    end = clip.duration if end is None else min(end, clip.duration)
    body = UpperBody.of(skeleton, anatomy)
    if not body.arms:
        raise CharacterError(f"{clip.name}: the skeleton has no arms whose gesture could be taken")
    times = np.linspace(start, end, max(round((end - start) * RATE_HZ), 1) + 1)
    poses = Pose.of_frames([clip.sample(float(time)) for time in times])
    chest, space = _chest(poses, skeleton, anatomy, body)
    hands = {side: _record_hand(side, poses, skeleton, body, chest, space) for side in body.arms}
    hands = {side: hand for side, hand in hands.items() if hand.moves}
    if not hands or end <= start:
        raise CharacterError(
            f"{clip.name}: no hand moves from {start:g} s to {end:g} s; choose another span"
        )
    return _gesture(name, hands, chest, times)


def _gesture(
    name: str, hands: dict[str, RecordedHand], chest: Array, times: Array
) -> SymbolicGesture:
    frames = {side: hand.stroke() for side, hand in hands.items()}
    first = min(each[0] for each in frames.values())
    last = max(each[-1] for each in frames.values())
    length = max(float(times[last] - times[first]), 1.0 / RATE_HZ)
    keys = {side: _keys(hands[side], each, times, first, length) for side, each in frames.items()}
    fastest = max(
        int(np.linalg.norm(np.diff(hand.places[first : last + 1], axis=0), axis=1).argmax())
        if last > first
        else 0
        for hand in hands.values()
    )
    after = [frame for each in frames.values() for frame in each if frame > first + fastest]
    apex = (float(times[min(after)]) - float(times[first])) / length if after else 1.0
    single = len(keys) == 1
    return SymbolicGesture(
        name,
        right=keys["left"] if single and "left" in keys else keys.get("right", ()),
        left=() if single else keys["left"],
        body=_body_keys(chest, times, first, last, mirrored=single and "left" in keys),
        one_handed=single,
        preparation=round(max(float(times[first] - times[0]), SHORTEST_S), 3),
        stroke=round(length, 3),
        apex=round(min(max(apex, 0.0), 1.0), 3),
        hold=0.0,
        retraction=round(max(float(times[-1] - times[last]), SHORTEST_S), 3),
    )


def _keys(
    hand: RecordedHand, frames: list[int], times: Array, first: int, length: float
) -> tuple[HandKey, ...]:
    unit = GestureSpace(np.zeros(3), 1.0)
    keys = []
    for number, frame in enumerate(frames):
        palm = words_of(_vector(hand.palms[frame]), hand.left)
        fingers = words_of(_vector(hand.fingers[frame]), hand.left, without=palm)
        keys.append(
            HandKey(
                round(min(max(float(times[frame] - times[first]) / length, 0.0), 1.0), 4),
                _snap(unit.nearest(hand.places[frame], hand.left)),
                hand.shapes[frame],
                palm,
                fingers,
                "keys" if number else "line",
            )
        )
    return tuple(keys)


def _snap(place: Place) -> Place:
    """Return a place, in the middle of its cell if it is near it."""
    offset = tuple(round(value, 3) if abs(value) > SNAP_DISTANCE else 0.0 for value in place.offset)
    return replace(place, offset=(offset[0], offset[1], offset[2]))


def _body_keys(
    chest: Array, times: Array, first: int, last: int, mirrored: bool
) -> tuple[BodyKey, ...]:
    """Return how the chest turns from its first frame, at start, middle and end of the stroke."""
    turns = rotations.from_matrix(chest[:, :3, :3])
    moved = rotations.multiply(turns, rotations.conjugate(turns[0]))
    degrees = np.degrees(rotations.to_rotation_vector(moved))
    if last <= first or np.abs(degrees[first : last + 1]).max() < MIN_BODY_DEG:
        return ()
    side = -1.0 if mirrored else 1.0
    keys = []
    for at in (0.0, 0.5, 1.0):
        lean, turn, across = degrees[round(first + at * (last - first))].round(1).tolist()
        keys.append(BodyKey(at, lean_deg=lean, turn_deg=side * turn, side_deg=-side * across))
    return tuple(keys)


def _chest(
    poses: Pose, skeleton: Skeleton, anatomy: Anatomy, body: UpperBody
) -> tuple[Array, GestureSpace]:
    """Return how the chest is moved from its rest, (frames, 4, 4), and the space at rest."""
    rest = skeleton.rest.globals(skeleton)
    joint = anatomy.joint(chest_part(anatomy)) if "hips" in anatomy.joints else 0
    moved = poses.globals(skeleton)[:, joint or 0] @ np.linalg.inv(rest[joint or 0])
    shoulders = rest[[arm.joints[1] for arm in body.arms.values()], :3, 3].mean(0)
    return moved, GestureSpace.about(shoulders, arm_length(body))


def _record_hand(
    side: str,
    poses: Pose,
    skeleton: Skeleton,
    body: UpperBody,
    chest: Array,
    space: GestureSpace,
) -> RecordedHand:
    hand = body.arms[side].hand
    rest = skeleton.rest.globals(skeleton)[hand.joint]
    moved = np.linalg.inv(chest) @ poses.globals(skeleton)[:, hand.joint] @ np.linalg.inv(rest)
    places = moved[:, :3, :3] @ np.asarray(hand.palm) + moved[:, :3, 3]
    axes = np.asarray(hand.axes)
    return RecordedHand(
        SIDES[side],
        (places - space.chest) / space.arm,
        moved[:, :3, :3] @ axes[0],
        moved[:, :3, :3] @ axes[2],
        _shapes(side, poses, body),
    )


def _shapes(side: str, poses: Pose, body: UpperBody) -> tuple[str, ...]:
    """Return the shape that the fingers are nearest to in each frame."""
    postures = {name: body.shapes.posture(side, name) for name in HAND_SHAPES}
    joints = next(iter(postures.values())).joints
    if not len(joints):
        return ("relaxed",) * len(poses.rotations)
    fingers = poses.rotations[:, joints]
    likeness = [
        np.abs(np.einsum("fji,ji->fj", fingers, posture.rotations)).sum(axis=1)
        for posture in postures.values()
    ]
    names = tuple(postures)
    return tuple(names[number] for number in np.argmax(likeness, axis=0))


def polyline(points: Array, tolerance: float) -> list[int]:
    """Return the points that are needed so that none is too far from the line through them.

    Ramer, "An iterative procedure for the polygonal approximation of plane curves", 1972.

    >>> polyline(np.array([[0.0, 0], [1, 0], [2, 0], [2, 1]]), 0.1)
    [0, 2, 3]
    """
    kept: NDArray[np.bool_] = np.zeros(len(points), bool)
    kept[[0, -1]] = True
    spans = [(0, len(points) - 1)]
    while spans:
        start, end = spans.pop()
        if end - start < 2:
            continue
        line = points[end] - points[start]
        offsets = points[start + 1 : end] - points[start]
        along = np.clip(offsets @ line / max(float(line @ line), 1e-12), 0.0, 1.0)
        distances = np.linalg.norm(offsets - along[:, None] * line, axis=1)
        farthest = int(distances.argmax())
        if distances[farthest] > tolerance:
            middle = start + 1 + farthest
            kept[middle] = True
            spans += [(start, middle), (middle, end)]
    return [int(number) for number in np.flatnonzero(kept)]


def _without_holds(keys: list[int], places: Array) -> list[int]:
    """Return keys without those that are where the one before is."""
    moving: list[int] = []
    for key in keys:
        if not moving or np.linalg.norm(places[key] - places[moving[-1]]) > TOLERANCE:
            moving.append(key)
    return moving


def _vector(values: Array) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return x, y, z

"""From recordings of a standing person: where she rests, and how she shifts her balance.

Source: Egges 2006, section 3.3.2 (S2, S6).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from cubeling.affect.regions import Region
from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.contacts import find_contacts, spans
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.feet import find_feet
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.smoothing import gaussian_smooth
from cubeling.characters.synthesis.choices import Alignment
from cubeling.characters.synthesis.idle.posture_space import PostureVectors

BALANCES = ("left", "both", "right")
"""Categories of resting postures: on which foot she stands."""

STANDING_SHARE = 0.12
"""She stands on both feet while the hips are nearer than this to the middle between them [stances],
where a stance is the distance of the feet."""

MIN_SHIFT = 0.15
"""Least way of the hips to the side in a balance shift [stances]."""

_SHIFTING_SPEED = 0.06  # [stances/s] to the side; slower hips rest
_SMOOTHING_S = 0.2
_MIN_EDGE_S = 0.2  # with a shorter rest at an end, the recording begins or ends within a shift
_MIN_STANCE = 0.05  # [body heights]: of feet closer than this, nobody can say which one stands
MIN_PART_S = 5.0
"""Shortest part of a recording between two steps that is used [s]."""

_STEPPING_SPEED = 0.25  # [body heights/s]: a foot that is faster over the ground steps
_FAR_LEAN = 0.5  # [trunks]: as far to the side as one foot is from the other
_MIN_STANDING_SHARE = 0.8  # of the frames with both feet on the ground
_MIN_HIPS_HEIGHT = 0.75  # of those at rest: lower hips belong to somebody who sits
_MAX_SPEED = 5.0  # [body heights/s]: a joint that is faster has jumped


@dataclass(frozen=True)
class RestSpan:
    """Frames of a recording in which a person rests, between two shifts."""

    first: int
    """Index of the first frame that belongs to it."""

    end: int
    """The frame after their last."""

    balance: str
    """One of `BALANCES`."""


@dataclass(frozen=True)
class StandingRecording:
    """A recording of a standing person, with the root held in the middle between the feet."""

    name: str
    """Name of the clip it was cut from."""

    rate: float
    """[Hz]."""

    vectors: Array
    """Posture vectors, (frames, size)."""

    balance: Array
    """Where the hips are between the feet, (frames,) [stances]: 0.5 above the left, −0.5 above the
    right one."""

    rests: tuple[RestSpan, ...]
    """Where she rests, in order; what is between them are balance shifts."""

    feeling: Region | None = None
    """The emotions that it shows; None if it suits any."""

    before: Region | None = None
    """The emotions that it shows before its last shift, where that leads from them to others."""

    @property
    def shifts(self) -> tuple[tuple[RestSpan, RestSpan], ...]:
        """The pairs of rests between which the balance shifts."""
        return tuple(pairwise(self.rests))


def read_parts(
    clip: Clip,
    skeleton: Skeleton,
    anatomy: Anatomy,
    feeling: Region | None = None,
    alignment: Alignment = "feet",
    before: Region | None = None,
) -> tuple[StandingRecording, ...]:
    """Return the parts of a clip in which a person stays where she is; see `read_standing`.

    A clip without steps is one part. Parts of less than `MIN_PART_S` are left out. The last shift
    of the last one leads from the emotions `before` to those of `feeling`, if both are given.
    """
    feet = find_feet(skeleton)
    placed = clip.poses.globals(skeleton)[..., :3, 3]
    size = float(np.ptp(skeleton.rest.globals(skeleton)[:, 1, 3]))
    stays = np.ones(len(clip), np.bool_)
    if len(feet) >= 2 and len(clip) > 1:
        places = np.stack([placed[:, [*foot]].mean(1) for foot in feet], axis=1)[..., [0, 2]]
        smooth = gaussian_smooth(places.reshape(len(clip), -1), _SMOOTHING_S * clip.rate)
        speeds = np.gradient(smooth, axis=0).reshape(places.shape) * clip.rate
        stays = np.linalg.norm(speeds, axis=2).max(1) < _STEPPING_SPEED * size
        jumps = np.linalg.norm(np.diff(placed, axis=0), axis=-1).max(1) * clip.rate
        stays[1:] &= jumps <= _MAX_SPEED * size
    parts = [
        slice(first, first + count)
        for first, count in spans(stays, loop=False)
        if count >= MIN_PART_S * clip.rate
    ]
    if stays.all() or not parts:  # what is wrong with the whole clip is said of it
        parts = [slice(None)]
    found = [
        read_standing(replace(clip, poses=clip.poses[part]), skeleton, anatomy, feeling, alignment)
        for part in parts
    ]
    if before is None:
        return tuple(found)
    return (*(replace(e, feeling=before) for e in found[:-1]), replace(found[-1], before=before))


def read_standing(
    clip: Clip,
    skeleton: Skeleton,
    anatomy: Anatomy,
    feeling: Region | None = None,
    alignment: Alignment = "feet",
) -> StandingRecording:
    """Return a clip of a standing person with its rests; `feeling` is what she shows.

    Of somebody who sits, the balance is that of the trunk: how far it leans to a side.

    Raises
    ------
    CharacterError
        If she neither stands nor sits, or a joint jumps.
    """
    hips, feet = anatomy.joint("hips"), find_feet(skeleton)
    if hips is None or len(feet) < 2:
        raise CharacterError(f"clip {clip.name!r}: idle motion needs hips and two feet")
    placed = clip.poses.globals(skeleton)
    _refuse_unrest(clip, skeleton, placed, hips)
    balance, middle, heading = _balance(clip, skeleton, anatomy, placed)
    if _sits(skeleton, placed, hips):
        balance = _lean(anatomy, placed, heading)
    places, turns = placed[:, hips, :3, 3], rotations.from_matrix(placed[:, hips, :3, :3])
    if alignment == "feet":
        back = rotations.about("y", -heading)
        places = rotations.rotate(back, places - middle * [1.0, 0.0, 1.0])
        turns = rotations.multiply(back, turns)
    else:
        places, turns = align(places, turns, alignment)
    poses = _on_the_spot(clip.poses, skeleton, hips, places, turns)
    vectors = PostureVectors.of(skeleton, anatomy).vectors(poses)
    rests = find_rests(balance, clip.rate)
    return StandingRecording(clip.name, clip.rate, vectors, balance, rests, feeling)


def borrow_shifts(
    own: Sequence[StandingRecording], lent: Sequence[StandingRecording]
) -> tuple[StandingRecording, ...]:
    """Return recordings of somebody who never shifts, and those of a lender in her mean posture.

    Both are on one skeleton. A lender plays at the rate of the first own recording.
    """
    middle = np.concatenate([each.vectors for each in own]).mean(0)
    theirs = np.concatenate([each.vectors for each in lent]).mean(0)
    return (*own, *(_move(each, middle - theirs, own[0].rate) for each in lent))


def _move(recording: StandingRecording, offset: Array, rate: float) -> StandingRecording:
    """Return a recording whose postures are moved by an offset, at another rate [Hz]."""
    count = round(len(recording.vectors) * rate / recording.rate)
    at = np.minimum(np.arange(count) * recording.rate / rate, len(recording.vectors) - 1)
    low = at.astype(int)
    high, part = np.minimum(low + 1, len(recording.vectors) - 1), at - low
    vectors = recording.vectors[low] + part[:, None] * (
        recording.vectors[high] - recording.vectors[low]
    )
    balance = recording.balance[low]
    rests = find_rests(balance, rate)
    return StandingRecording(recording.name, rate, vectors + offset, balance, rests)


def _refuse_unrest(clip: Clip, skeleton: Skeleton, placed: Array, hips: int) -> None:
    """Refuse a clip in which nobody stands, or that jumps."""
    rest = skeleton.rest.globals(skeleton)[:, :3, 3]
    size = float(np.ptp(rest[:, 1]))
    where = f"clip {clip.name!r}"
    steps = np.linalg.norm(np.diff(placed[..., :3, 3], axis=0), axis=-1).max(1)
    if len(steps) and steps.max() * clip.rate > _MAX_SPEED * size:
        at = int(steps.argmax()) / clip.rate
        raise CharacterError(f"{where}: a joint jumps at {at:.1f} s; cut the recording there")
    if _sits(skeleton, placed, hips):
        return
    standing = float(find_contacts(clip, skeleton, find_feet(skeleton)).all(1).mean())
    if standing < _MIN_STANDING_SHARE:
        raise CharacterError(
            f"{where}: both feet stand in only {standing:.0%} of it; idle motion is learned from "
            "people who stand still"
        )


def _sits(skeleton: Skeleton, placed: Array, hips: int) -> bool:
    """Return whether the hips are too low for somebody who stands."""
    standing = float(skeleton.rest.globals(skeleton)[hips, 1, 3])
    return float(np.median(placed[:, hips, 1, 3])) < _MIN_HIPS_HEIGHT * standing


def _lean(anatomy: Anatomy, placed: Array, heading: float) -> Array:
    """Return how far a trunk leans to the left, (frames,), as a share of its height ÷ `_FAR_LEAN`.

    So somebody who sits shifts if she leans by about as much as she may while standing.
    """
    top = next((anatomy.joint(part) for part in ("neck", "head", "chest")), None)
    hips = anatomy.joints["hips"]
    if top is None:
        return np.zeros(len(placed))
    trunk = placed[:, top, :3, 3] - placed[:, hips, :3, 3]
    side = rotations.rotate(rotations.about("y", -heading), trunk)[:, 0]
    leaning: Array = side / (_FAR_LEAN * float(np.median(np.linalg.norm(trunk, axis=1))))
    return leaning


def _balance(
    clip: Clip, skeleton: Skeleton, anatomy: Anatomy, placed: Array
) -> tuple[Array, Array, float]:
    """Return the balance of each frame, and the mean place and heading of the feet."""
    hips = anatomy.joints["hips"]
    left, right = (placed[:, anatomy.joints[side + "Foot"], :3, 3] for side in ("left", "right"))
    across = (left - right)[:, [0, 2]]
    stance = np.linalg.norm(across.mean(0))
    if stance < _MIN_STANCE * float(np.ptp(skeleton.rest.globals(skeleton)[:, 1, 3])):
        raise CharacterError(f"clip {clip.name!r}: the feet are too close to tell them apart")
    middle = (left + right) / 2
    balance = ((placed[:, hips, :3, 3] - middle)[:, [0, 2]] * across).sum(1)
    balance = balance / (across**2).sum(1)
    return balance, middle.mean(0), float(np.arctan2(-across.mean(0)[1], across.mean(0)[0]))


def _on_the_spot(poses: Pose, skeleton: Skeleton, hips: int, places: Array, turns: Array) -> Pose:
    """Return poses with their hips at places (frames, 3) and orientations (frames, 4) of their own.

    The joints above the hips rest, so feet that stand do not move.
    """
    parents = skeleton.with_ancestors([hips])[:-1]
    rest = skeleton.rest[np.array(parents, int)]
    translations, local = poses.translations.copy(), poses.rotations.copy()
    translations[:, parents], local[:, parents] = rest.translations, rest.rotations
    above = skeleton.rest.globals(skeleton)[skeleton.parents[hips]] if parents else np.eye(4)
    translations[:, hips] = (places - above[:3, 3]) @ above[:3, :3]
    local[:, hips] = rotations.multiply(
        rotations.conjugate(rotations.from_matrix(above[:3, :3])), turns
    )
    return Pose(translations, local)


def find_rests(balance: Array, rate: float) -> tuple[RestSpan, ...]:
    """Return where a person rests between her balance shifts, (frames,) [stances].

    A shift is a way to one side of at least `MIN_SHIFT`, without a stop. Between a shift and the
    way back is at least the frame in which she turns round.

    >>> sway = np.repeat([0.3, -0.3], 50) + 0.01 * np.sin(np.arange(100))
    >>> [(rest.balance, rest.first, rest.end) for rest in find_rests(sway, 25.0)]
    [('left', 0, 38), ('right', 62, 100)]
    """
    smooth = gaussian_smooth(balance, _SMOOTHING_S * rate)
    speed = np.gradient(smooth) * rate if len(smooth) > 1 else np.zeros(1)
    bounds = [0]
    for sign in (1, -1):
        for first, count in spans(sign * speed > _SHIFTING_SPEED, loop=False):
            if abs(smooth[first + count - 1] - smooth[first]) > MIN_SHIFT:
                bounds += [first, first + count]
    bounds = sorted([*bounds, len(smooth)])
    rests = []
    for first, end in zip(bounds[::2], bounds[1::2], strict=True):
        first = min(first, len(smooth) - 1)
        end = max(end, first + 1)
        side = float(np.median(smooth[first:end]))
        name = "both" if abs(side) < STANDING_SHARE else "left" if side > 0 else "right"
        rests.append(RestSpan(first, end, name))
    inner = [
        rest
        for rest in rests
        if (rest.first > 0 and rest.end < len(smooth)) or rest.end - rest.first > _MIN_EDGE_S * rate
    ]
    return tuple(inner or rests)


def align(places: Array, turns: Array, how: Alignment) -> tuple[Array, Array]:
    """Return hips (frames, 3), and their orientations (frames, 4), with the first frame aligned.

    The height stays as it was recorded. Source: Egges 2006, section 3.1.1 (S2).

    >>> at = np.array([[1.0, 0.9, 2.0], [1.0, 0.8, 3.0]])
    >>> facing = rotations.about("y", np.array([0.5, 0.5]))
    >>> moved, turned = align(at, facing, "turn")
    >>> moved.round(3).tolist()
    [[0.0, 0.9, 0.0], [-0.479, 0.8, 0.878]]
    """
    if how == "none":
        return places, turns
    ahead = rotations.rotate(turns[0], np.array([0.0, 0.0, 1.0]))
    back = rotations.about("y", -np.arctan2(ahead[0], ahead[2]))
    if how == "place":
        back = rotations.IDENTITY
    # Printed, the path is turned by the whole orientation, which would tip it over.
    moved = rotations.rotate(back, places - places[0] * [1.0, 0.0, 1.0])
    moved[:, 1] = places[:, 1]
    if how == "full":
        back = rotations.conjugate(turns[0])
    return moved, rotations.multiply(back, turns)

"""Finding the cycle of walking or running in a recording that closes best.

A recording is cut where pose and velocity repeat after one step of each foot, wherever the body
then is and looks. What remains of the difference in pose is spread over the whole cycle, and that
in velocity over the frames next to the cut. Of a take that hardly repeats, each step is averaged
with the mirror image of the other one, which halves the difference.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.retargeting.root import ground_positions, root_trajectory
from cubeling.characters.retargeting.transfer import in_common_axes
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose

_CYCLE_DURATION_S = (0.3, 2.4)
_PAUSE_DURATION_S = (2.0, 10.0)
_VELOCITY_INTERVAL_S = 0.1
_MAX_STARTS = 400  # first frames that are tried
_VELOCITY_SPREAD_S = 0.15  # to either side of the cut
# Eyes look anywhere, and the joints of a hand would count it many times.
_UNCOMPARED_PARTS = ("Eye", "Thumb", "Index", "Middle", "Ring", "Little")
_SWINGING_PARTS = ("LowerArm", "Hand")  # they say little about where a body stands


@dataclass(frozen=True)
class LoopCut:
    """A part of a clip that repeats."""

    start: int
    """Index of the first frame in the recording."""

    end: int
    """The frame that matches the first, one cycle later."""

    seam: float
    """Distance of the joints between both, root mean square [leg lengths]."""

    drift: RootDelta = field(default_factory=RootDelta)
    """Where the root is to be in the frame `end`, seen from where it is there: so the body stands
    around it as in the first frame."""


def find_cycle(clip: Clip, rig: Rig, contacts: NDArray[np.bool_]) -> LoopCut:
    """Return the cycle that closes best for the way it goes, or refuse the clip.

    Each foot lands once in it; `contacts` say when the left and the right foot stand, (frames, 2).
    """
    landings, track = count_landings(contacts), root_trajectory(clip, rig, 1.0)
    shortest, longest = (round(seconds * clip.rate) for seconds in _CYCLE_DURATION_S)
    features = _features(clip, rig)
    best, best_cost = None, float("inf")
    for start, ends in _spans(len(clip), shortest, longest):
        ends = ends[(landings[ends] - landings[start] == 1).all(-1)]
        if not len(ends):
            continue
        seams, _ = _distances(features[:, start], features[:, ends], rig)
        ways = np.linalg.norm(track[ends, :2] - track[start, :2], axis=1)
        turns = np.abs(track[ends, 2] - track[start, 2])
        # Shuffling in place and spinning close well, but are no gaits.
        costs = seams / np.maximum(ways * np.cos(np.minimum(turns / 2, np.pi / 2)), 1e-9)
        nearest = int(costs.argmin())
        if best is None or costs[nearest] < best_cost:
            best_cost = costs[nearest]
            best = start, int(ends[nearest])
    if best is None:
        counts = " and ".join(str(int(number)) for number in landings[-1])
        raise CharacterError(
            f"clip {clip.name!r}: no whole cycle found; its left and right foot land {counts} "
            "times, and both must land once between two similar poses; give a longer clip"
        )
    return cut_at(clip, rig, *best)


def cut_at(clip: Clip, rig: Rig, start: int, end: int) -> LoopCut:
    """Return the cut of a clip between two frames."""
    features = _features(clip, rig)
    (seam,), (drift,) = _distances(features[:, start], features[:, [end]], rig)
    x, z, yaw = (drift * [rig.leg_length, rig.leg_length, 1.0]).tolist()
    return LoopCut(start, end, float(seam), RootDelta(x, z, yaw))


def count_landings(contacts: NDArray[np.bool_]) -> NDArray[np.int_]:
    """Return how often each foot has landed up to each frame, (frames, feet)."""
    landed = np.cumsum(contacts[1:] & ~contacts[:-1], axis=0)
    return np.concatenate([np.zeros((1, contacts.shape[1]), int), landed])


def find_middle(
    clip: Clip, image: Clip, rig: Rig, cut: LoopCut, contacts: NDArray[np.bool_]
) -> int | None:
    """Return the frame of a stride in which the mirror image is most like its first frame.

    One foot lands before it and one after it; None if there is no such frame.
    """
    frames = np.arange(cut.start + 1, cut.end)
    landings = count_landings(contacts)
    frames = frames[(landings[frames] - landings[cut.start]).sum(-1) == 1]
    if not len(frames):
        return None
    seams, _ = _distances(_features(clip, rig)[:, cut.start], _features(image, rig)[:, frames], rig)
    return int(frames[seams.argmin()])


def symmetric_steps(clip: Clip, image: Clip, cut: LoopCut, middle: int) -> list[Pose]:
    """Return both steps of a stride in place, each averaged with the mirror image of the other.

    `image` is the mirror image of the clip.
    """
    frames = round((cut.end - cut.start) / 2) + 1
    first, second = (
        np.linspace(*ends, frames) for ends in ((cut.start, middle), (middle, cut.end))
    )
    steps = ((first, second), (second, first))
    return [
        _mean(sample_frames(clip.in_place, own), sample_frames(image.in_place, other))
        for own, other in steps
    ]


def _mean(one: Pose, other: Pose) -> Pose:
    """Return the pose half-way between two."""
    return Pose(
        (one.translations + other.translations) / 2,
        rotations.nlerp(one.rotations, other.rotations, 0.5),
        one.scales,
        one.morphs,
    )


def find_pause(clip: Clip, rig: Rig) -> LoopCut:
    """Return the part of a clip that closes best and is long enough to idle."""
    shortest, longest = (round(seconds * clip.rate) for seconds in _PAUSE_DURATION_S)
    shortest = max(min(shortest, (len(clip) - 1) // 2), 1)
    features = _features(clip, rig)
    best, best_cost = LoopCut(0, len(clip) - 1, float("inf")), float("inf")
    for start, ends in _spans(len(clip), shortest, longest):
        apart = features[:, ends] - features[:, start, None]
        seams = np.sqrt(np.square(apart).mean((0, -2, -1)))
        costs = seams / np.sqrt(ends - start)  # longer loops are better
        nearest = int(costs.argmin())
        if costs[nearest] < best_cost:
            best_cost = costs[nearest]
            best = LoopCut(start, int(ends[nearest]), float(seams[nearest]))
    return best


def close_loop(clip: Clip, steps: Sequence[Pose]) -> Clip:
    """Return steps of a clip in place as a loop that goes on at its end as it begins.

    A stride is one of them, or two: each ends in the frame in which the next one begins.
    """
    whole = clip.loop and len(steps[0].rotations) == len(clip)
    near = 0.0 if whole else _VELOCITY_SPREAD_S * clip.rate
    turns = _closed([step.rotations for step in steps], _turn_between, _turned, near)
    scales = [step.scales for step in steps if step.scales is not None]
    morphs = [step.morphs for step in steps if step.morphs is not None]
    loop = Pose(
        _closed([step.translations for step in steps], _difference, np.add, near),
        rotations.continuous(turns),
        _closed(scales, _difference, np.add, near) if scales else None,
        _closed(morphs, _difference, np.add, 0.0) if morphs else None,
    )
    return replace(clip, poses=loop, loop=True)


def _difference(one: Array, other: Array) -> Array:
    return np.asarray(other - one)


def _turn_between(one: Array, other: Array) -> Array:
    """Return rotation vectors that turn one rotation to the other, in its own axes."""
    turn = rotations.multiply(rotations.conjugate(one), other)
    return rotations.to_rotation_vector(np.where(turn[..., 3:] < 0.0, -turn, turn))


def _turned(turns: Array, vectors: Array) -> Array:
    return rotations.multiply(turns, rotations.from_rotation_vector(vectors))


def _closed(
    parts: Sequence[Array],
    between: Callable[[Array, Array], Array],
    moved: Callable[[Array, Array], Array],
    near: float,
) -> Array:
    """Return parts of equal length (frames, …) in a row, closed to a loop (frames, …).

    Each part ends in the frame in which the next one begins. Their differences in value are spread
    evenly, those in velocity over `near` frames to either side; `between` returns differences, and
    `moved` adds them.
    """
    frames = np.arange(len(parts[0])).reshape(-1, *[1] * (parts[0].ndim - 1))
    last = len(frames) - 1
    after = [*parts[1:], parts[0]]
    gaps = [between(one[-1], other[0]) / 2 for one, other in zip(parts, after, strict=True)]
    share = frames / max(last, 1)
    closed = [
        moved(part, gaps[n] * share - gaps[n - 1] * (1 - share)) for n, part in enumerate(parts)
    ]
    near = min(near, last / 2)
    if near > 2.0:  # frames; velocities need three
        after = [*closed[1:], closed[0]]
        changes = [
            (_first_velocity(other, between) + _first_velocity(one[::-1], between)) / 2
            for one, other in zip(closed, after, strict=True)
        ]
        # Curves that are 0 at both of their ends, and begin with the slope 1.
        begin = frames * np.maximum(1 - frames / near, 0.0) ** 2
        closed = [
            moved(part, -begin * changes[n - 1] - begin[::-1] * changes[n])
            for n, part in enumerate(closed)
        ]
    return np.concatenate([*(part[:-1] for part in closed), closed[0][:1]])


def _first_velocity(values: Array, between: Callable[[Array, Array], Array]) -> Array:
    """Return the velocity in the first frame of (frames, …), by the parabola of three frames."""
    return (4 * between(values[0], values[1]) - between(values[0], values[2])) / 2


def resample_loop(clip: Clip, rate: float) -> Clip:
    """Return a loop at another rate; its duration is rounded to whole frames."""
    frames = max(round(clip.duration * rate), 2)
    at = np.linspace(0.0, len(clip) - 1, frames + 1)
    return replace(clip, rate=rate, poses=sample_frames(clip.poses, at))


def sample_frames(poses: Pose, at: Array) -> Pose:
    """Return poses at fractions of frames (n,)."""
    before = np.minimum(at.astype(int), len(poses.rotations) - 2)
    part = (at - before)[:, None, None]

    def interpolate(values: Array) -> Array:
        weight = part if values.ndim == 3 else part[..., 0]
        return np.asarray(values[before] * (1 - weight) + values[before + 1] * weight)

    return Pose(
        interpolate(poses.translations),
        rotations.normalize(interpolate(rotations.continuous(poses.rotations))),
        None if poses.scales is None else interpolate(poses.scales),
        None if poses.morphs is None else interpolate(poses.morphs),
    )


def _features(clip: Clip, rig: Rig) -> Array:
    """Return positions and velocities in each frame, seen from the root, (2, frames, joints, 3)."""
    joints = list(_compared_joints(rig))
    at = (
        in_common_axes(rig, rig.placements(clip.poses, joints)[:, joints][..., :3, 3])
        / rig.leg_length
    )
    track = root_trajectory(clip, rig, 1 / rig.leg_length)
    ground, back = ground_positions(track)[:, None], rotations.about("y", -track[:, 2])[:, None]
    count = len(at)
    interval = min(max(round(_VELOCITY_INTERVAL_S * clip.rate), 1), count - 1)
    # At the end of the clip, the velocity is the last known one.
    later = np.minimum(np.arange(count) + interval, count - 1)
    in_place = rotations.rotate(back, at - ground)
    return np.stack([in_place, in_place[later] - in_place[later - interval]])


def _compared_joints(rig: Rig) -> dict[int, bool]:
    """Return the joints that are compared, and whether each shows where the body stands."""
    return {
        joint: not any(word in part for word in _SWINGING_PARTS)
        for part, joint in sorted(rig.anatomy.joints.items(), key=lambda item: item[1])
        if not any(word in part for word in _UNCOMPARED_PARTS)
    }


def _spans(count: int, shortest: int, longest: int) -> Iterator[tuple[int, NDArray[np.intp]]]:
    """Yield first frames, and the last frames that may go with each."""
    stride = max(1, (count - shortest) // _MAX_STARTS)
    for start in range(0, count - shortest, stride):
        yield start, np.arange(start + shortest, min(start + longest, count - 1) + 1)


def _distances(first: Array, ends: Array, rig: Rig) -> tuple[Array, Array]:
    """Return how far the body in several frames is from that in one, wherever it stands and looks.

    `first` are features (2, joints, 3), `ends` those of several frames (2, frames, joints, 3).
    Returns root mean squares (frames,), and the planar poses (frames, 3) of the body: the best
    by least squares, as of Kovar, Gleicher and Pighin 2002, section 3.1.
    """
    weights = np.array(list(_compared_joints(rig).values()), float)
    ground = np.array([1.0, 0.0, 1.0])
    middle, middles = (
        np.average(at, axis=-2, weights=weights) * ground for at in (first[0], ends[0])
    )
    one = np.stack([first[0] - middle, first[1]])[:, None]
    other = np.stack([ends[0] - middles[:, None], ends[1]])
    sines = (one[..., 2] * other[..., 0] - one[..., 0] * other[..., 2]) * weights
    cosines = (one[..., 0] * other[..., 0] + one[..., 2] * other[..., 2]) * weights
    yaw = np.arctan2(sines.sum((0, -1)), cosines.sum((0, -1)))
    turn = rotations.about("y", yaw)
    apart = other - rotations.rotate(turn[:, None], one)
    shift = middles - rotations.rotate(turn, middle)
    drifts = np.stack([shift[:, 0], shift[:, 2], yaw], axis=-1)
    return np.sqrt(np.square(apart).mean((0, -2, -1))), drifts

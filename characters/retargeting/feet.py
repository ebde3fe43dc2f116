"""Feet that hold: where a foot of the source stands, that of the target stands still.

Each standing foot is given one place for the whole of its contact; what it is moved by fades in
and out while it swings. Hips and knees then bend to it. Where a leg is too short for that, the
hips come down.

Source: Kovar, Schreiner and Gleicher, "Footskate cleanup for motion capture editing", SCA 2002.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from characters.motion.clip import Clip
from characters.motion.contacts import find_contacts, spans
from characters.retargeting.body import Body, Leg, turns_of
from characters.retargeting.ground import Way
from characters.retargeting.limb import bend
from characters.retargeting.root import smoothed
from characters.retargeting.transfer import ankle, place, upright_clip
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose

_LIFTED = 0.02  # leg lengths that the ball of a standing foot is above its lowest
_ROLL = 0.25  # [s] that a foot takes at most from its heel onto its ball
_HEEL = 0.35  # how far the heel is behind the ankle, for how far the ball is ahead of it
_SETTLE = 0.12  # [s] that a foot takes to leave, or come to, the speed of a place that it holds
_STRETCH = 0.997  # part of a leg's length that it may reach
_SINK = 0.06  # [s]: standard deviation of how the hips come down
_FARTHEST = 0.3  # leg lengths: see `_Foot.farthest`
_DEEPEST = 0.2  # leg lengths that they come down at most


@dataclass(frozen=True)
class Footing:
    """When the feet of a clip stand."""

    heel: NDArray[np.bool_]
    """Whether only the heel does: the ankle is low and slow, (frames, legs)."""

    ball: NDArray[np.bool_]
    """Whether the toes are; as the ankle where there are none, (frames, legs)."""


def find_footing(clip: Clip, body: Body, legs: Sequence[Leg]) -> Footing:
    """Return when the feet of a clip stand, heel and ball apart."""
    clip = upright_clip(clip, body)
    feet = [[leg.foot] if leg.toes is None else [leg.foot, leg.toes] for leg in legs]
    stands = find_contacts(clip, body.skeleton, feet)
    heights = clip.poses.globals(body.skeleton)[:, [leg.end for leg in legs], 1, 3]
    heel, ball = np.zeros_like(stands), np.zeros_like(stands)
    count = len(clip) - 1 if clip.loop else len(clip)
    for leg in range(len(legs)):
        for first, length in spans(stands[:, leg], clip.loop):
            frames = np.arange(first, first + length) % max(count, 1)
            low = heights[frames, leg] < heights[frames, leg].min() + _LIFTED * body.leg_length
            down, up = int(low.argmax()), length - int(low[::-1].argmax())
            # Once the ball of the foot has risen, the foot leaves, however slowly.
            struck = max(down - round(_ROLL * clip.rate), 0)
            heel[frames[struck:down], leg], ball[frames[down:up], leg] = True, True
    if clip.loop:
        heel[-1], ball[-1] = heel[0], ball[0]
    return Footing(heel, ball)


def hold(
    pose: Pose,
    body: Body,
    legs: Sequence[Leg],
    footing: Footing,
    way: Way,
    ends: Array | None = None,
) -> Pose:
    """Return poses whose feet stand still where they stand.

    Parameters
    ----------
    pose
        (frames, joints, …), of the whole clip; +y up.
    body, legs
        Whose, and which of its legs, in the order of the footing.
    footing
        When they stand.
    way
        How the ground goes by, and how the clip repeats.
    ends
        Where the ends of the legs are to be while they do not stand, (frames, legs, 3) [m],
        common axes; where they are, without.
    """
    globals_ = pose.globals(body.skeleton)
    turns = rotations.multiply(body.upright, turns_of(globals_))
    ankles: list[Array] = []
    for number, leg in enumerate(legs):
        to_end, to_heel = _from_ankle(body, leg, turns)
        at = rotations.rotate(body.upright, ankle(globals_, body, leg)) + to_end
        goal = at if ends is None else ends[:, number]
        floor = float(body.rest_places[leg.end, 1]) if body.stands else None
        foot = _Foot(
            way.unrolled(goal),
            way.unrolled_directions(to_end - to_heel),
            way.again(footing.heel[:, number]),
            way.again(footing.ball[:, number]),
            floor,
            _FARTHEST * body.leg_length,
            way.rate,
        )
        ankles.append(way.rolled(foot.held()) - to_end)
    pose = lowered(pose, body, _sinking(body, legs, globals_, ankles, way))
    back = rotations.conjugate(body.upright)
    for leg, target in zip(legs, ankles, strict=True):
        pose = bend(pose, body, leg, rotations.rotate(back, target))
    return pose


def lowered(pose: Pose, body: Body, down: Array) -> Pose:
    """Return poses with the hips down by so much, (frames,) [m]."""
    if not down.any():
        return pose
    hips = body.anatomy.joints["hips"]
    at = pose.globals(body.skeleton)[:, hips, :3, 3]
    shift = down[:, None] * rotations.rotate(rotations.conjugate(body.upright), [0.0, -1.0, 0.0])
    lower = replace(pose, translations=pose.translations.copy())
    place(lower, body, hips, at + shift)
    return lower


def _from_ankle(body: Body, leg: Leg, turns: Array) -> tuple[Array, Array]:
    """Return from the ankle to the ball of the foot and to its heel, (frames, 3) [m] each.

    No joint marks the heel: it is taken to be on the ground, a part of the foot behind the ankle.
    """
    if leg.toes is None:
        nothing = np.zeros((len(turns), 3))
        return nothing, nothing
    ball = body.rest_places[leg.toes] - body.rest_places[leg.foot]
    up, ahead = rotations.rotate(body.sole(leg), np.eye(3)[1:])
    tall = body.rest_places[leg.foot, 1] if body.stands else -1.5 * float(ball @ up)
    heel = -tall * up - _HEEL * float(ball @ ahead) * ahead
    facing = rotations.multiply(turns[:, leg.foot], rotations.conjugate(body.rest_turns[leg.foot]))
    return rotations.rotate(facing, ball), rotations.rotate(facing, heel)


@dataclass(frozen=True)
class _Foot:
    """One foot over a clip that does not repeat."""

    goal: Array
    """Where its end would be, (frames, 3) [m]."""

    to_end: Array
    """From the heel to the end, (frames, 3) [m]."""

    heel: NDArray[np.bool_]
    """Whether only the heel stands, (frames,)."""

    ball: NDArray[np.bool_]
    """Whether the end stands, (frames,)."""

    floor: float | None
    """How high the end is when it stands [m]; None for as it comes."""

    farthest: float
    """A stand that the foot is farther from than this was none: it is let go [m]."""

    rate: float
    """Frames a second [Hz]."""

    def held(self) -> Array:
        """Return where its end goes, (frames, 3) [m]: still where it stands."""
        down = self.heel | self.ball
        shift = np.zeros_like(self.goal)
        stands: list[tuple[int, int]] = []
        for first, length in spans(down, loop=False):
            span = np.arange(first, first + length)
            wanted = self._stood(span) - self.goal[span]
            if np.abs(wanted).max() < self.farthest:
                shift[span] = wanted
                stands.append((first, length))
        self._fade(shift, stands)
        held: Array = self.goal + shift
        held[:, 1] = np.maximum(held[:, 1], self._lowest())
        return held

    def _lowest(self) -> Array:
        """Return how high the end is with the ball or the heel on the ground, (frames,) [m]."""
        if self.floor is None:
            return np.full(len(self.goal), -np.inf)
        return np.maximum(self.floor, self.to_end[:, 1])

    def _stood(self, span: NDArray[np.intp]) -> Array:
        """Return where the end is while the foot stands: on its ball, first on its heel."""
        goal, to_end = self.goal[span], self.to_end[span]
        ball = self.ball[span]
        if not ball.any():  # cut off, or too short to come down: on the heel
            return np.asarray((goal - to_end).mean(0) + to_end)
        spot = goal[ball].mean(0)
        first = int(ball.argmax())
        at = np.tile(spot, (len(span), 1))
        # Before the ball is down the foot turns about its heel.
        at[:first] = spot - to_end[first] + to_end[:first]
        if self.floor is not None:
            at[:, 1] = self._lowest()[span]
        return at

    def _fade(self, shift: Array, stands: Sequence[tuple[int, int]]) -> None:
        """Fill in what the foot is moved by between its stands, smoothly."""
        if not stands:
            return
        edges = [(0, 0), *stands, (len(shift), 0)]
        for (first, length), (after, _) in pairwise(edges):
            start, gap = first + length, after - first - length
            if gap <= 0:
                continue
            here = shift[start - 1] if length else shift[after]
            there = shift[after] if after < len(shift) else here
            still = np.zeros(3)
            leave = _slope(shift, start - 1, -1) if length > 1 else still
            come = _slope(shift, after, 1) if after + 1 < len(shift) else still
            u: Array = np.arange(1.0, gap + 1)[:, None]
            part = u / (gap + 1)
            ease = part * part * (3 - 2 * part)
            width = min(_SETTLE * self.rate, (gap + 1) / 2)
            shift[start:after] = here + (there - here) * ease
            shift[start:after] += leave * _dying(u, width) - come * _dying(gap + 1 - u, width)


def _slope(shift: Array, frame: int, inward: int) -> Array:
    """Return the change a frame at an end of a stand, forward in time."""
    change: Array = (shift[frame + inward] - shift[frame]) * inward
    return change


def _dying(frames: Array, width: float) -> Array:
    """Return a curve that starts from 0 at slope 1 and is flat at 0 from `width` on."""
    return np.asarray(frames * np.clip(1 - frames / width, 0.0, 1.0) ** 2)


def _sinking(
    body: Body, legs: Sequence[Leg], globals_: Array, ankles: Sequence[Array], way: Way
) -> Array:
    """Return how far the hips must come down for the legs to reach, smooth, (frames,) [m]."""
    needed = np.zeros(len(globals_))
    for leg, target in zip(legs, ankles, strict=True):
        hip = rotations.rotate(body.upright, globals_[:, leg.upper, :3, 3])
        aside = np.linalg.norm((hip - target)[:, [0, 2]], axis=-1)
        most = np.sqrt(np.maximum((_STRETCH * sum(body.bones(leg))) ** 2 - aside**2, 0.0))
        needed = np.maximum(needed, hip[:, 1] - target[:, 1] - most)
    needed = np.clip(needed, 0.0, _DEEPEST * body.leg_length)
    if not needed.any():
        return needed
    deviation = _SINK * way.rate
    reach = round(2 * deviation)
    long = way.again(needed)
    padded = np.pad(long, reach, mode="edge")
    widest = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1).max(-1)
    return way.middle(smoothed(widest[:, None], deviation))[:, 0]

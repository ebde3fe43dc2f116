"""One even cycle of a recording, on a character: from its first step to a `Gait`."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.model.character import Character
from characters.motion.clip import Clip
from characters.motion.motion import RootDelta
from characters.retargeting.body import Body
from characters.retargeting.feet import Footing, find_footing
from characters.retargeting.ground import way_of
from characters.retargeting.locomotion.arcs import Course
from characters.retargeting.locomotion.cycle import Cut, closed, find_cycle, resampled
from characters.retargeting.locomotion.gait import Gait, held
from characters.retargeting.recording import Recording
from characters.retargeting.retarget import leg_pairs, retarget
from characters.retargeting.rooted import is_rooted, on_way, rooted_clip
from characters.skeleton.pose import Array, Pose, Skeleton

RATE = 60.0
"""Frames a second of what is made from finer recordings [Hz]."""

_SLOWEST = 0.1  # leg lengths a second: what is slower goes nowhere


def gait_of(recording: Recording, character: Character, walker: Character) -> Gait:
    """Return the best cycle of a recording on a character, on an arc of even speed.

    Parameters
    ----------
    recording
        What to take it from.
    character, walker
        Whose it is to be, before and after it got a root.
    """
    body = Body(walker.skeleton, walker.anatomy)
    clip, footing = on_character(recording, character, walker)
    clip = _carried(clip, body, footing)
    cut = Cut(0, len(clip) - 1, 0.0)
    if not clip.loop:
        cut = find_cycle(clip, body, (footing.heel | footing.ball)[:, :2])
    step = RootDelta(*clip.track[cut.start]).inverse().then(RootDelta(*clip.track[cut.end]))
    seconds = (cut.end - cut.start) / clip.rate
    course = Course.of(step, seconds)
    if course.speed < _SLOWEST * body.leg_length:
        raise CharacterError(
            f"{recording.origin}: goes nowhere ({course.speed:.2f} m/s), and its "
            "feet do not stand as on an even treadmill; give a clip that walks"
        )
    # The root looks along the arc: half of the turn is before the middle of its chord.
    aside = math.atan2(step.x, step.z) - step.yaw / 2
    loop = closed(_turned_root(clip, body, aside), cut)
    footing = _cut_footing(footing, cut)
    first = _first_landing(footing)
    loop, footing = _rolled(loop, footing, first)
    if clip.rate > RATE:
        loop, footing = _coarser(loop, footing)
    course = Course(course.speed * seconds / loop.duration, step.yaw / loop.duration)
    times = np.arange(len(loop)) / loop.rate
    pose = on_course(loop.poses, course.at(times))
    loop = replace(loop, poses=pose, root_motion=True)
    seam = cut.seam * body.leg_length
    return held(Gait(recording.origin, loop, body, footing, course, seam))


def on_character(
    recording: Recording, character: Character, walker: Character
) -> tuple[Clip, Footing]:
    """Return a recording as a clip of the walker, and when its feet stand."""
    theirs = Body(recording.skeleton, recording.anatomy)
    ours = Body(walker.skeleton, walker.anatomy)
    legs = [leg for leg, _ in leg_pairs(theirs, ours)]
    try:
        footing = find_footing(recording.clip, theirs, legs)
    except CharacterError as error:
        raise CharacterError(f"{recording.origin}: {error}") from None
    if not _alike(recording.skeleton, character.skeleton):
        args = (recording.skeleton, recording.anatomy, walker.skeleton, walker.anatomy)
        clip = retarget(recording.clip, *args)
    elif is_rooted(character.skeleton, character.anatomy):
        clip = replace(recording.clip, root_motion=True)
    else:
        clip = rooted_clip(recording.clip, character.skeleton, character.anatomy)
    return clip, footing


def _alike(one: Skeleton, other: Skeleton) -> bool:
    """Return whether a clip of one skeleton is a clip of the other."""
    return (
        one.names == other.names
        and one.parents == other.parents
        and np.allclose(one.rest.translations, other.rest.translations, atol=1e-4)
        and np.allclose(one.rest.rotations, other.rest.rotations, atol=1e-4)
    )


def _carried(clip: Clip, body: Body, footing: Footing) -> Clip:
    """Return a clip that walks in place as one that gets on."""
    legs = body.legs[: footing.ball.shape[1]]
    way = way_of(replace(clip, loop=False), body, legs, footing.ball, 1.0).carried
    if not way.any():
        return clip
    steps = [RootDelta(*w).then(RootDelta(*t)) for w, t in zip(way, clip.track, strict=True)]
    track = np.array([[step.x, step.z, step.yaw] for step in steps])
    return replace(clip, poses=on_course(clip.in_place, track))


def on_course(pose: Pose, way: Array) -> Pose:
    """Return poses in place with their root on a way (frames, 3)."""
    still = np.zeros_like(way)
    root = on_way(pose, np.zeros(0, np.intp), still)
    moved = on_way(root, np.zeros(0, np.intp), way)
    translations = pose.translations.copy()
    translations[:, 0] = moved.translations[:, 0] + pose.translations[:, 0] * [0.0, 1.0, 0.0]
    turns = pose.rotations.copy()
    turns[:, 0] = moved.rotations[:, 0]
    return replace(pose, translations=translations, rotations=turns)


def _turned_root(clip: Clip, body: Body, aside: float) -> Clip:
    """Return a clip whose root looks elsewhere by an angle [rad]; the body stays in the world."""
    below = np.flatnonzero(np.array(body.skeleton.parents) == 0)
    return replace(clip, poses=on_way(clip.poses, below, clip.track + [0.0, 0.0, aside]))


def _cut_footing(footing: Footing, cut: Cut) -> Footing:
    """Return when feet stand in a cycle; its last frame is its first."""

    def part(down: NDArray[np.bool_]) -> NDArray[np.bool_]:
        return np.concatenate([down[cut.start : cut.end], down[cut.start : cut.start + 1]])

    return Footing(part(footing.heel), part(footing.ball))


def _first_landing(footing: Footing) -> int:
    """Return the frame of a loop at which the left foot lands, 0 if it never does."""
    down = (footing.heel | footing.ball)[:-1, 0]
    return int(np.argmax(down & ~np.roll(down, 1)))


def _rolled(clip: Clip, footing: Footing, first: int) -> tuple[Clip, Footing]:
    """Return a loop in place that starts at another frame."""
    order = (np.arange(len(clip)) + first) % (len(clip) - 1)
    return replace(clip, poses=clip.poses[order]), Footing(footing.heel[order], footing.ball[order])


def _coarser(clip: Clip, footing: Footing) -> tuple[Clip, Footing]:
    """Return a loop at the rate of what is made."""
    coarse = resampled(clip, RATE)
    nearest = np.linspace(0, len(clip) - 1, len(coarse)).round().astype(int)
    return coarse, Footing(footing.heel[nearest], footing.ball[nearest])

"""From a few recordings of walking and running to a character that goes where it is sent.

Each recording is put on the character, cut to one cycle and laid on an arc of even speed; then
every clip of the movement tree is bent from the recording that turns most like it.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from characters.errors import CharacterError
from characters.locomotion.gaits import RUN_CLIPS, WALK_CLIPS
from characters.model.bind_pose import with_bind_pose
from characters.model.character import Character
from characters.model.mirroring import mirror_of
from characters.motion.clip import Clip
from characters.motion.mirror import Mirror
from characters.retargeting.body import Body
from characters.retargeting.feet import Footing
from characters.retargeting.locomotion.arcs import Course
from characters.retargeting.locomotion.cycle import Cut, closed, find_pause, resampled
from characters.retargeting.locomotion.gait import Gait, held, slide
from characters.retargeting.locomotion.recorded_gait import RATE, gait_of, on_character, on_course
from characters.retargeting.recording import Recording
from characters.retargeting.rooted import with_root
from characters.skeleton.pose import Pose

_TURN = 1.5  # degrees a second that the movement tree turns for each degree of Angular
_STRAIGHT = 8.0  # degrees of Angular that are taken as none
# Speed in a curve as a part of that straight on, by Angular: people slow down to turn.
_SLOWER: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    "walk": ((0.0, 30.0, 60.0, 90.0), (1.0, 0.97, 0.86, 0.72)),
    "run": ((0.0, 45.0, 90.0), (1.0, 0.94, 0.82)),
}


@dataclass(frozen=True)
class Found:
    """What was found in a recording, or made for the movement tree."""

    name: str
    """Of the file, or of the clip that was made."""

    origin: str
    """What it was made from, and how."""

    duration: float
    """Of one cycle [s]."""

    speed: float
    """Over the ground [m/s of the character]."""

    angular: float
    """How sharply it turns, positive to the right, as the movement tree counts [degrees]."""

    seam: float
    """How far joints were apart where the cycle was closed, root mean square [m]."""

    slide: float
    """Mean speed of standing feet over the ground [m/s]."""


@dataclass(frozen=True)
class Locomotion:
    """A character that can walk, and how it came to."""

    character: Character
    """With the clips of the movement tree."""

    recordings: tuple[Found, ...]
    """What was found in the recordings."""

    clips: tuple[Found, ...]
    """What was made."""


def make_locomotion(
    character: Character,
    walks: Sequence[Recording],
    runs: Sequence[Recording] = (),
    idle: Recording | None = None,
) -> Locomotion:
    """Return a character with the clips of the movement tree, made from recordings.

    Parameters
    ----------
    character
        Who is to walk; it gets a root joint on the ground if it has none.
    walks, runs
        Straight or curved; at least one walk.
    idle
        Standing; without, the character's own clip "idle" stays, or a stand is made.

    Raises
    ------
    CharacterError
        If a recording does not fit the character, or holds no cycle.
    """
    as_given = character
    character = replace(character, skeleton=with_bind_pose(character))
    walker = with_root(character)
    body = Body(walker.skeleton, walker.anatomy)
    trees = (("walk", WALK_CLIPS, walks), ("run", RUN_CLIPS, runs))
    clips, recordings, made = dict(walker.clips), [], []
    mirror = _mirror(walker)
    for kind, names, given in trees:
        gaits = [gait_of(recording, character, walker) for recording in given]
        recordings += [_found(gait.origin, gait.origin, gait) for gait in gaits]
        for gait in gaits and _tree(kind, names, gaits, mirror):
            clips[gait.clip.name] = gait.clip
            made.append(_found(gait.clip.name, gait.origin, gait))
    if idle is not None:
        clips["idle"] = _pause(idle, character, walker)
    elif "idle" not in clips:
        clips["idle"] = _stand(clips["Walk"], body)
    rooted = replace(with_root(as_given), clips=clips)
    return Locomotion(rooted, tuple(recordings), tuple(made))


def _angular(course: Course) -> float:
    return -math.degrees(course.yaw_rate) / _TURN


def _tree(
    kind: str, names: Mapping[float, str], gaits: Sequence[Gait], mirror: Mirror | None
) -> list[Gait]:
    """Return the clips of a tree, each bent from the gait that turns most like it."""
    angles, slower = _SLOWER[kind]
    made: list[Gait] = []
    for knot, name in names.items():
        gait, mirrored = _nearest(knot, gaits, mirror)
        sign = -1.0 if mirrored else 1.0
        now = sign * _angular(gait.course)
        share = np.interp(abs(knot), angles, slower) / np.interp(abs(now), angles, slower)
        yaw_rate = -math.radians(_TURN * knot)
        bent = gait.on(Course(gait.course.speed * float(share), sign * yaw_rate))
        how = "" if abs(now - knot) < _STRAIGHT else ", bent"
        clip = replace(bent.clip, name=name)
        course = bent.course
        if mirrored and mirror is not None:
            clip = _mirrored(clip, mirror)
            course = Course(course.speed, -course.yaw_rate)
            how += ", mirrored"
            # A body that is not quite symmetric steps a little elsewhere: its feet are held anew.
            bent = held(replace(bent, clip=clip, course=course, footing=_swapped(bent.footing)))
            clip = bent.clip
        made.append(replace(bent, clip=clip, course=course, origin=gait.origin + how))
    return made


def _nearest(knot: float, gaits: Sequence[Gait], mirror: Mirror | None) -> tuple[Gait, bool]:
    """Return the gait that turns most like a knot, and whether it is to be mirrored.

    Only where that makes it turn to the right side; what is straight is bent to the left and
    mirrored to the right, so that both sides are alike.
    """
    options: list[tuple[float, int, bool]] = []
    for number, gait in enumerate(gaits):
        angular = _angular(gait.course)
        straight = abs(angular) < _STRAIGHT
        apart = max(abs(angular - knot), _STRAIGHT)  # of those alike the first given is taken
        options.append((apart, number, straight and knot > 0 and mirror is not None))
        if mirror is not None and not straight:
            options.append((abs(-angular - knot) + 1.0, number, True))
    _, number, mirrored = min(options)
    return gaits[number], mirrored


def _mirror(character: Character) -> Mirror | None:
    """Return the mirror of a character, or None if it is not symmetric."""
    try:
        return mirror_of(character)
    except CharacterError:
        return None


def _mirrored(clip: Clip, mirror: Mirror) -> Clip:
    """Return a gait mirrored, half a cycle later: with the left foot first again."""
    image = mirror.clip(clip)
    # Bones keep their lengths where a body is not quite symmetric.
    bones = np.flatnonzero(np.ptp(clip.in_place.translations, axis=0).max(-1) < 1e-9)
    image.poses.translations[:, bones[bones > 0]] = clip.poses.translations[:, bones[bones > 0]]
    count = len(image) - 1
    order = (np.arange(len(image)) + count // 2) % count
    poses = image.in_place[order]
    return replace(image, poses=on_course(poses, image.track))


def _swapped(footing: Footing) -> Footing:
    """Return when feet stand in the mirror image, half a cycle later."""
    count, legs = len(footing.ball) - 1, footing.ball.shape[1]
    order = (np.arange(count + 1) + count // 2) % count
    sides = [leg + 1 - 2 * (leg % 2) for leg in range(legs)]
    return Footing(footing.heel[order][:, sides], footing.ball[order][:, sides])


def _pause(recording: Recording, character: Character, walker: Character) -> Clip:
    """Return a recording of standing as a loop in place."""
    clip, _ = on_character(recording, character, walker)
    body = Body(walker.skeleton, walker.anatomy)
    cut = Cut(0, len(clip) - 1, 0.0) if clip.loop else find_pause(clip, body)
    loop = closed(clip, cut)
    loop = resampled(loop, RATE) if loop.rate > RATE else loop
    return replace(loop, name="idle", root_motion=True)


def _stand(walk: Clip, body: Body) -> Clip:
    """Return a stand: legs and trunk as at rest, arms as they hang on the mean in walking."""
    rest = body.skeleton.rest
    pose = walk.in_place
    mean = pose.rotations.sum(0)
    mean /= np.maximum(np.linalg.norm(mean, axis=-1, keepdims=True), 1e-9)
    arms = [j for part, j in body.anatomy.joints.items() if part[4:].startswith("UpperArm")]
    arms += [j for part, j in body.anatomy.joints.items() if part[5:].startswith("UpperArm")]
    hang = [j for j in range(len(body.skeleton)) if set(body.line(j)) & set(arms)]
    turns = rest.rotations.copy()
    turns[hang] = mean[hang]
    frames = 31
    scales = None if rest.scales is None else np.tile(rest.scales, (frames, 1, 1))
    still = Pose(np.tile(rest.translations, (frames, 1, 1)), np.tile(turns, (frames, 1, 1)), scales)
    return Clip("idle", 30.0, still, True, True)


def _found(name: str, origin: str, gait: Gait) -> Found:
    return Found(
        name,
        origin,
        gait.clip.duration,
        gait.course.speed,
        _angular(gait.course),
        gait.seam,
        slide(gait),
    )

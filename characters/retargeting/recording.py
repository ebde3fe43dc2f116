"""Motions with skeleton and anatomy, read from files."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.loading import RecordedMotion, is_motion_only, load_motion
from cubeling.characters.model.bind_pose import with_bind_pose
from cubeling.characters.model.character import Character
from cubeling.characters.model.sidecar import read_sidecar
from cubeling.characters.motion.clip import Clip
from cubeling.characters.retargeting.standing_rest import standing_skeleton
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.facing import common_from_skeleton
from cubeling.characters.skeleton.pose import Skeleton

_MIN_WAY = 0.05  # of hips in a cycle, in sizes of the skeleton; loops close less exactly
_UNROLLED_CYCLES = 3
_REST_GUESSES = 3
_SHORTEST_CLIP = 12  # frames, of which the first may be one of calibration
_MAX_FIRST_STEP = 5.0  # of the greatest of the next steps


@dataclass(frozen=True)
class Recording:
    """A motion with the skeleton and the anatomy of its performer."""

    origin: str
    """Its file or clip, for messages and reports."""

    clip: Clip

    skeleton: Skeleton
    """The skeleton of the clip; it rests in the bind pose."""

    anatomy: Anatomy
    """Which joint is which body part."""


def load_recording(
    name: str,
    skeleton: "str | Path | None" = None,
    *,
    up: str | None = None,
    rest: str | None = None,
    rate: float | None = None,
    load: Callable[[str], Character] = Character.load,
) -> Recording:
    """Read a motion: a .bvh, .amc or .vrma file, a .glb without a mesh, or a character's clip.

    A [joints] table in the sidecar .toml file may state the body parts.

    Parameters
    ----------
    name
        A file, or a character (file or bundled) and one of its clips: "fox.glb#Walk". The clip may
        be left out if there is only one.
    skeleton
        The .asf file of an .amc; left out, the one in the same folder.
    up
        The vertical axis of a .bvh or .amc file ("y", "z", "-y", …); left out, it is recognised.
    rest
        The rest pose of a motion without a body: "zero" or "frame:N"; left out, the zero pose if
        it stands, else the most upright frame.
    rate
        Frame rate of a .bvh or .amc file [Hz]; left out, what it states.
    load
        Reads a character; one that keeps them reads the clips of one file faster.

    Raises
    ------
    CharacterError
        If there is no such motion.
    """
    file, _, clip = name.partition("#")
    if is_motion_only(file):
        motion = load_motion(file, clip or None, skeleton=skeleton, rate=rate, up=up)
        return _of_recorded_motion(name, motion, rest)
    character = load(file)
    if not clip and len(character.clips) == 1:
        clip = next(iter(character.clips))
    if clip not in character.clips:
        known = ", ".join(character.clips) or "none"
        raise CharacterError(
            f"{file}: which clip? write {file}#CLIP with one of its clips: {known}"
        )
    bound = with_bind_pose(character)
    found = _unroll(character.clips[clip], bound, character.anatomy)
    return Recording(Path(name).name, found, bound, character.anatomy)


def _of_recorded_motion(name: str, motion: RecordedMotion, rest: str | None) -> Recording:
    """Return a motion without a body as a recording that stands at rest."""
    file = name.partition("#")[0]
    sidecar = Path(file).with_suffix(".toml")
    stated = {**motion.semantics, **read_sidecar(sidecar, (motion.clip.name,)).joints}
    upright = motion.skeleton
    # Bones that lie along one axis show the body parts by their names only, so the guess from the
    # standing pose is better, and with it the choice of that pose.
    for _ in range(_REST_GUESSES):
        try:
            anatomy = Anatomy.guess(upright, stated)
        except CharacterError as error:
            raise CharacterError(f"{sidecar}: {error}") from None
        try:
            found = standing_skeleton(motion.skeleton, anatomy, motion.clip, rest)
        except CharacterError as error:
            raise CharacterError(f"{file}: {error}") from None
        if found is upright:
            break
        upright = found
    clip = _unroll(motion.clip, upright, anatomy)
    clip = _without_calibration_frame(clip, upright)
    return Recording(Path(name).name, clip, upright, anatomy)


def _without_calibration_frame(clip: Clip, skeleton: Skeleton) -> Clip:
    """Return a clip without a first frame that is a pose of its own, such as a T-pose."""
    if len(clip) < _SHORTEST_CLIP:
        return clip
    places = clip.poses[np.arange(_SHORTEST_CLIP)].globals(skeleton)[..., :3, 3]
    steps = np.linalg.norm(np.diff(places, axis=0), axis=-1).max(-1)
    if steps[0] < _MAX_FIRST_STEP * steps[1:].max():
        return clip
    return replace(clip, poses=clip.poses[np.arange(1, len(clip))])


def _unroll(clip: Clip, skeleton: Skeleton, anatomy: Anatomy) -> Clip:
    """Return a loop whose hips end elsewhere as several cycles on their way over the ground.

    Its joints close but for the way, which it has in the hips and not in a root joint.
    """
    hips = anatomy.joint("hips")
    if not clip.loop or clip.root_motion or hips is None:
        return clip
    start, end = (clip.poses[frame].globals(skeleton)[hips, :3, 3] for frame in (0, -1))
    common = common_from_skeleton(skeleton, anatomy)
    way = rotations.rotate(common, end - start) * [1.0, 0.0, 1.0]
    places = skeleton.rest.globals(skeleton)[:, :3, 3]
    if np.linalg.norm(way) < _MIN_WAY * np.ptp(places, axis=0).max():
        return clip
    step = rotations.rotate(rotations.conjugate(common), way)
    count = len(clip) - 1
    frames = np.arange(_UNROLLED_CYCLES * count + 1)
    poses = clip.poses[frames % count]
    translations = poses.translations.copy()
    roots = [joint for joint, parent in enumerate(skeleton.parents) if parent < 0]
    translations[:, roots] += (frames // count)[:, None, None] * step
    return replace(clip, poses=replace(poses, translations=translations), loop=False)

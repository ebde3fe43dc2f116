"""How a character stands, if it was recorded: the .idle file beside it, or another one."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.motion import StandingMotion
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Skeleton
from cubeling.files import is_there

# Few characters stand as recorded: what that takes is loaded for those.
if TYPE_CHECKING:
    from cubeling.characters.synthesis.idle.pauses import PauseLaw
    from cubeling.characters.synthesis.idle.recordings import StandingRecording

StandingFactory = Callable[[int], StandingMotion]
"""Makes the motion that a character stands with from a seed."""

STANDING_FOOT_WAY = 0.25
"""How far a foot of who stands may be from where it is on average, in parts of the leg."""


def idle_clips(clips: Mapping[str, Clip]) -> list[Clip]:
    """Return the clips of idling: those whose name contains "idle"."""
    return [clips[name] for name in clips if "idle" in name.lower()]


def idle_clip(clips: Iterable[str]) -> str | None:
    """Return the name of the clip to stand with: without an idle clip, the first one.

    >>> idle_clip(["nod", "Idle"]), idle_clip(["nod", "kiss"]), idle_clip([])
    ('Idle', 'nod', None)
    """
    names = list(clips)
    return next((name for name in names if "idle" in name.lower()), next(iter(names), None))


def can_stand(clips: Mapping[str, Clip], skeleton: Skeleton, anatomy: Anatomy) -> bool:
    """Return whether there is a clip to stand with: of idling, or one whose feet hardly move.

    A clip of one frame is a pose, and none to stand with.
    """
    moving = {name: clip for name, clip in clips.items() if clip.duration > 0.0}
    name = idle_clip(moving)
    if name is None or idle_clips(moving):
        return name is not None
    feet = [joint for part, joint in anatomy.joints.items() if part.endswith("Foot")]
    hips = anatomy.joint("hips")
    if not feet or hips is None:
        return True
    rest = skeleton.rest.globals(skeleton)[:, :3, 3]
    leg = float(np.linalg.norm(rest[feet] - rest[hips], axis=-1).mean())
    at = moving[name].in_place.globals(skeleton)[:, feet][..., :3, 3]
    return bool(np.linalg.norm(at - at.mean(0), axis=-1).max() < STANDING_FOOT_WAY * leg)


def standing_factory(
    skeleton: Skeleton,
    anatomy: Anatomy,
    clips: Mapping[str, Clip],
    recordings: "tuple[StandingRecording, ...]",
    *,
    acting: bool = True,
    pauses: "PauseLaw | None" = None,
) -> StandingFactory:
    """Return what makes the idle motion of a person in recordings on a skeleton.

    The first of its idle clips shows how it holds what posture vectors leave out,
    such as its fingers. All these clips are its acts, if it is `acting`. Its pauses are those of
    the thesis, unless others are given.
    """
    from cubeling.characters.synthesis.idle.database import IdleDatabase
    from cubeling.characters.synthesis.idle.idle_motion import USUAL_PAUSES, IdleMotion
    from cubeling.characters.synthesis.idle.posture_space import PostureVectors
    from cubeling.characters.synthesis.idle.standing import PlantedPaws, StandingPerson

    acts = idle_clips(clips)
    held = acts[0].poses[0] if acts else skeleton.rest
    paws = PlantedPaws.of(held, skeleton, anatomy)

    @lru_cache(maxsize=1)
    def database() -> IdleDatabase:
        kind = PostureVectors.of(skeleton, anatomy)
        return IdleDatabase.of(recordings, replace(kind, others=held))

    law = pauses or USUAL_PAUSES
    return lambda seed: StandingPerson(
        IdleMotion(database(), seed, pauses=law), acts if acting else (), seed, paws
    )


def recordings_beside(path: Path, skeleton: Skeleton) -> "tuple[StandingRecording, ...]":
    """Return the recordings in the .idle file beside the file of a character; () without one.

    Raises
    ------
    CharacterError
        If it cannot be read, or was made for another skeleton.
    """
    idle = path.with_suffix(".idle")
    if not is_there(idle):
        return ()
    from cubeling.characters.synthesis.archive import skeleton_identity
    from cubeling.characters.synthesis.idle.storage import load_person

    own, _, recordings = load_person(idle)
    if skeleton_identity(own) != skeleton_identity(skeleton):
        raise CharacterError(
            f"{idle}: made for another skeleton than that of {path.name}; make it again with "
            f"cubeling idle learn --character {path.name}, or rename it"
        )
    return recordings

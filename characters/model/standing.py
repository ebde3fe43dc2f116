"""How a character stands, if it was recorded: the .idle file beside it, or another one."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

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


def idle_clips(clips: Mapping[str, Clip]) -> list[Clip]:
    """Return the clips of idling: those whose name contains "idle"."""
    return [clips[name] for name in clips if "idle" in name.lower()]


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

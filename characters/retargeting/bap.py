"""Writing the motion of any person as MPEG-4 body animation parameters."""

from pathlib import Path

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.mocap.bap import BapTrack, track_of, write_baps
from cubeling.characters.formats.mocap.hanim import hanim_anatomy, hanim_skeleton
from cubeling.characters.motion.clip import Clip
from cubeling.characters.retargeting.retarget import retarget
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Skeleton


def baps_of(clip: Clip, skeleton: Skeleton, anatomy: Anatomy) -> BapTrack:
    """Return the parameters of a clip; see `save_bap` for its errors."""
    if anatomy.kind != "humanoid":
        raise CharacterError(f"clip {clip.name!r}: body animation parameters are for people")
    own = retarget(clip, skeleton, anatomy, hanim_skeleton(), hanim_anatomy(), hold_feet=False)
    return track_of(own)


def save_bap(clip: Clip, skeleton: Skeleton, anatomy: Anatomy, path: Path) -> None:
    """Write a clip as a .bap file, in the proportions of H-ANIM's body.

    Raises
    ------
    CharacterError
        If it is no person's, or the file cannot be written.
    """
    write_baps(path, baps_of(clip, skeleton, anatomy))

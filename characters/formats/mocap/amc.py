"""Acclaim motions (.amc), which say how the bones of an .asf move, frame by frame."""

from pathlib import Path

from characters.errors import CharacterError
from characters.formats.mocap import asf
from characters.formats.mocap.amc_frames import read_header, read_values
from characters.formats.mocap.axes_and_units import settle
from characters.formats.mocap.text import check_size, read_text
from characters.model.performance import Performance
from characters.motion.clip import Clip


def load(
    path: "str | Path",
    skeleton: "str | Path | None" = None,
    *,
    rate: float | None = None,
    scale: float | None = None,
    up: str | None = None,
) -> Performance:
    """Read an .amc file and the .asf that goes with it.

    Every joint's rest rotation is the identity: joints keep the axes of the file, so the bones'
    own frames are folded into the motion. Joints are called as the bones are, the hips "root";
    the ends of last bones are joints too, called ``ltoes_end``.

    Parameters
    ----------
    path
        The .amc file.
    skeleton
        The .asf file. Left out, it is the one beside the motion that is called as it is or as
        the first part of its name (16_08.amc: 16.asf), or the only one there.
    rate
        Frames a second [Hz]; left out, what the file says, or 120.
    scale
        Metres a unit; left out, 0.0254 over the `length` of the .asf, as CMU means it, if that
        makes a performer of 0.5 to 2.5 m, else recognised by size.
    up
        The axis that points up: "y", "z", "-y", …. Left out, it is the one from feet to head.

    Raises
    ------
    CharacterError
        If one of the files is absent or cannot be read, with the line that is at fault.
    """
    path = Path(path)
    text = read_text(path)
    body = asf.load(Path(skeleton) if skeleton is not None else find_skeleton(path))
    header = read_header(path, text, body.radians)
    rate = rate if rate is not None else header.rate
    if not 0 < rate < 1e5:
        raise CharacterError(f"{path}: {rate:g} frames a second is no rate; give rate= in Hz")
    values, notes = read_values(path, text, header, body)
    check_size(path, len(body.skeleton), len(values))
    poses = body.channels(header.radians).poses(values)
    settled = settle(path, body.skeleton, poses, scale=scale, up=up, stated=body.unit)
    clip = Clip(path.stem, rate, settled.poses, loop=False)
    return Performance(settled.skeleton, clip, notes + settled.notes)


def find_skeleton(path: Path) -> Path:
    """Return the .asf beside an .amc.

    Raises
    ------
    CharacterError
        If there is none, or if there are several and none is called as the motion is.
    """
    try:
        beside = sorted(p for p in path.parent.iterdir() if p.suffix.lower() == ".asf")
    except OSError as error:
        raise CharacterError(
            f"{path.parent}: cannot be read ({error.strerror}); check the path"
        ) from None
    for stem in (path.stem, path.stem.partition("_")[0]):
        for candidate in beside:
            if candidate.stem.lower() == stem.lower():
                return candidate
    if len(beside) == 1:
        return beside[0]
    found = f"{len(beside)} .asf files, none of its name" if beside else "no .asf file"
    raise CharacterError(
        f"{path}: an .amc needs its skeleton, and beside it there is {found}; "
        "name it: --skeleton, or skeleton= in Python"
    )

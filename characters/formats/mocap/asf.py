"""Acclaim skeletons (.asf), the half of Acclaim's motion capture that does not move.

Source of the format: Lander, "Working with motion capture file formats", Game Developer, January
1998. A bone is a joint at its start, and its direction and the axes that it turns about are given
in the axes of the file; so are they here, with rest rotations that are the identity.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from characters.formats.mocap.asf_bones import Bone, read_bones
from characters.formats.mocap.asf_sections import Line, read_sections
from characters.formats.mocap.channels import Channels, Slide, Turn
from characters.formats.mocap.text import number, read_text, refuse, shown
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose, Skeleton

_INCH = 0.0254


@dataclass(frozen=True)
class Acclaim:
    """What an .asf file says."""

    path: Path
    """The file."""

    skeleton: Skeleton
    """In the file's axes and units: a joint at the start of every bone, called as the bone is,
    and one at the end of every last bone, called ``ltoes_end``."""

    bones: tuple[Bone, ...]
    """The root and the bones, parents first: bone i is joint i."""

    unit: float
    """Metres a unit, as it is stated: CMU's `length 0.45` means inches times 0.45."""

    radians: float
    """How much an angle of 1 is [rad]."""

    @property
    def columns(self) -> "dict[str, slice]":
        """Which numbers of a frame are each bone's."""
        ends = np.cumsum([len(bone.dof) for bone in self.bones]).tolist()
        return {
            bone.name: slice(end - len(bone.dof), end)
            for bone, end in zip(self.bones, ends, strict=True)
        }

    def channels(self, radians: float) -> Channels:
        """Return how the numbers of a frame move the joints; `radians` is an angle of 1."""
        children: dict[int, list[int]] = {}
        for joint, parent in enumerate(self.skeleton.parents):
            children.setdefault(parent, []).append(joint)
        turns: list[Turn] = []
        slides: list[Slide] = []
        columns = self.columns
        for joint, bone in enumerate(self.bones):
            frame = bone.frame(self.radians)
            start = columns[bone.name].start
            own: list[Turn] = []
            for column, dof in enumerate(bone.dof, start=start):
                if dof == "l":
                    slides += [
                        Slide(child, bone.along, column) for child in children.get(joint, ())
                    ]
                elif dof[0] == "t":
                    slides.append(Slide(joint, frame[:, "xyz".index(dof[1])], column))
                else:
                    own.append(Turn(joint, frame[:, "xyz".index(dof[1])], column))
            # What is listed first is done first, so it stands last in the product.
            turns += reversed(own)
        return Channels(self.skeleton.rest.translations, tuple(turns), tuple(slides), radians)


def load(path: "str | Path") -> Acclaim:
    """Read an .asf file.

    Raises
    ------
    CharacterError
        If it cannot be read, with the line that is at fault.
    """
    path = Path(path)
    sections = read_sections(path, read_text(path))
    unit, radians = _units(path, sections.get("units", []))
    bones, parents = read_bones(path, sections)
    names = [bone.name for bone in bones]
    places: list[Array] = [bones[0].position]
    places += [bones[parent].along * bones[parent].length for parent in parents[1:]]
    inner, taken = set(parents), set(names)
    for joint, bone in enumerate(bones):
        if joint and joint not in inner:
            end = bone.name + "_end"
            while end in taken:
                end += "_end"
            taken.add(end)
            names.append(end)
            parents.append(joint)
            places.append(bone.along * bone.length)
    turns = np.tile(rotations.IDENTITY, (len(names), 1))
    skeleton = Skeleton(tuple(names), tuple(parents), Pose(np.array(places), turns))
    return Acclaim(path, skeleton, tuple(bones), unit, radians)


def _units(path: Path, lines: "list[Line]") -> tuple[float, float]:
    """Return metres a unit and radians an angle of 1."""
    unit, radians = _INCH, float(np.pi / 180)
    for line, words in lines:
        key, value = words[0].lower(), words[1] if len(words) > 1 else ""
        if key == "length":
            length = number(path, line, value)
            if not length > 0:
                raise refuse(path, line, f"a length of {length:g} is no unit", "state one above 0")
            unit = _INCH / length
        elif key == "angle":
            if value.lower()[:3] not in ("deg", "rad"):
                raise refuse(path, line, f"angles in {shown(value)}", "state deg or rad")
            radians = 1.0 if value.lower().startswith("rad") else float(np.pi / 180)
    return unit, radians

"""Acclaim skeletons (.asf), to which the motions in .amc files refer.

Source of the format: Lander, "Working with motion capture file formats", Game Developer, January
1998. A bone is a joint at its start; its direction and its rotation axes are given in the axes of
the file. Joints keep these axes, so their rest rotations are the identity.
"""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.loading import MotionOptions, RecordedMotion
from cubeling.characters.formats.mocap.asf_bones import AsfBone, Line, read_bones, read_sections
from cubeling.characters.formats.mocap.channels import AxisChannel, ChannelLayout
from cubeling.characters.formats.mocap.text import TextFile, quote
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

INCH_M = 0.0254


@dataclass(frozen=True)
class AcclaimSkeleton:
    """The content of an .asf file."""

    path: Path
    """The file, for error messages."""

    skeleton: Skeleton
    """In the file's axes and units: a joint at the start of every bone, with the bone's name,
    and one at the end of every last bone, such as ``ltoes_end``."""

    bones: tuple[AsfBone, ...]
    """The root and the bones, parents first: bone i is joint i."""

    unit: float
    """Stated unit [m]: CMU's `length 0.45` means inches divided by 0.45."""

    angle_unit: float
    """Size of an angle of 1 [rad]."""

    @cached_property
    def columns(self) -> dict[str, slice]:
        """Which numbers of a frame belong to each bone."""
        ends = np.cumsum([len(bone.dof) for bone in self.bones]).tolist()
        return {
            bone.name: slice(end - len(bone.dof), end)
            for bone, end in zip(self.bones, ends, strict=True)
        }

    @property
    def width(self) -> int:
        """Number of values of a frame."""
        return sum(len(bone.dof) for bone in self.bones)

    def channels(self, angle_unit: float) -> ChannelLayout:
        """Return how the numbers of a frame, with angles in this unit [rad], move the joints."""
        rotating: list[AxisChannel] = []
        moving: list[AxisChannel] = []
        for joint, bone in enumerate(self.bones):
            frame = bone.file_from_bone(self.angle_unit)
            own: list[AxisChannel] = []
            for column, dof in enumerate(bone.dof, start=self.columns[bone.name].start):
                if dof == "l":
                    moving += [
                        AxisChannel(child, bone.direction, column)
                        for child, parent in enumerate(self.skeleton.parents)
                        if parent == joint
                    ]
                    continue
                channel = AxisChannel(joint, frame[:, "xyz".index(dof[1])], column)
                (moving if dof[0] == "t" else own).append(channel)
            # The first one listed is applied first, so it stands last in the product.
            rotating += reversed(own)
        offsets = self.skeleton.rest.translations
        return ChannelLayout(offsets, tuple(rotating), tuple(moving), angle_unit)


def refuse_motion(path: Path, options: MotionOptions) -> RecordedMotion:
    """Refuse an .asf file that is given as a motion."""
    raise CharacterError(f"{path}: a skeleton without motion; give the .amc that goes with it")


def load_skeleton(path: Path) -> AcclaimSkeleton:
    """Read an .asf file; errors name the line of the problem."""
    file = TextFile.read(path)
    sections = read_sections(file)
    unit, angle_unit = _units(file, sections.get("units", []))
    bones, parents = read_bones(file, sections)
    names = [bone.name for bone in bones]
    offsets: list[Array] = [bones[0].position]
    offsets += [bones[parent].direction * bones[parent].length for parent in parents[1:]]
    inner = set(parents)
    for joint, bone in enumerate(bones):
        if joint and joint not in inner:
            end = bone.name + "_end"
            while end in names:
                end += "_end"
            names.append(end)
            parents.append(joint)
            offsets.append(bone.direction * bone.length)
    unrotated = np.tile(rotations.IDENTITY, (len(names), 1))
    skeleton = Skeleton(tuple(names), tuple(parents), Pose(np.array(offsets), unrotated))
    return AcclaimSkeleton(path, skeleton, tuple(bones), unit, angle_unit)


def _units(file: TextFile, lines: list[Line]) -> tuple[float, float]:
    """Return the length unit [m] and the angle unit [rad]."""
    unit, angle_unit = INCH_M, float(np.pi / 180)
    for line, words in lines:
        key, value = words[0].lower(), words[1] if len(words) > 1 else ""
        if key == "length":
            length = file.number(line, value)
            if not length > 0:
                raise file.error(line, f"a length unit of {length:g}", "state one above 0")
            unit = INCH_M / length
        elif key == "angle":
            if value.lower()[:3] not in ("deg", "rad"):
                raise file.error(line, f"angles in {quote(value)}", "state deg or rad")
            angle_unit = 1.0 if value.lower().startswith("rad") else float(np.pi / 180)
    return unit, angle_unit

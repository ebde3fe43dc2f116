"""How far the joints of people and animals turn, for any skeleton whose body parts are known.

Ranges of people: those that textbooks of joint motion give for healthy adults, rounded to five
degrees and widened to what the bundled clips do; those of quadrupeds are our estimates.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.joint_limits import AngleLimits
from cubeling.characters.skeleton.pose import Array, Skeleton

Toward = Literal["forward", "backward", "up", "palm"]
"""Where a positive bend moves the end of a bone."""

_DIRECTIONS = {"forward": (0.0, 0.0, 1.0), "backward": (0.0, 0.0, -1.0), "up": (0.0, 1.0, 0.0)}
_DOWN = np.array([0.0, -1.0, 0.0])


@dataclass(frozen=True)
class JointRange:
    """How far a joint turns from where its bone goes on from the bone before it."""

    bend: tuple[float, float]
    """To and fro [deg]; positive is `toward`."""

    side: tuple[float, float]
    """Sideways [deg]; positive is to the left, or outward for a limb."""

    twist: float
    """About the bone, either way [deg]."""

    toward: Toward = "forward"
    """Where a positive bend moves the end of the bone."""

    zero: Literal["before", "rest", "down"] = "before"
    """Where the bone points at zero: along the bone before it, as at rest, or down."""


RANGES: dict[str, JointRange] = {
    "spine": JointRange((-20, 40), (-25, 25), 25, zero="rest"),
    "neck": JointRange((-35, 45), (-35, 35), 45, zero="rest"),
    "head": JointRange((-40, 45), (-35, 35), 50, zero="rest"),
    "Shoulder": JointRange((-20, 45), (-30, 30), 30, "up", "rest"),
    "LowerArm": JointRange((-10, 155), (-35, 35), 100),
    "Hand": JointRange((-75, 85), (-75, 75), 60, "palm"),
    "UpperLeg": JointRange((-35, 125), (-30, 50), 50, zero="down"),
    "LowerLeg": JointRange((-10, 155), (-15, 15), 35, "backward"),
    "Foot": JointRange((-60, 40), (-50, 50), 35, "up", "rest"),
    "Thumb": JointRange((-60, 70), (-60, 60), 45, "palm", "rest"),
    "Proximal": JointRange((-30, 100), (-25, 25), 20, "palm"),
    "Finger": JointRange((-15, 115), (-10, 10), 10, "palm"),
    "FrontShoulder": JointRange((-40, 40), (-30, 30), 30, zero="rest"),
    "FrontUpperLeg": JointRange((-90, 90), (-40, 60), 50, zero="down"),
    "FrontLowerLeg": JointRange((-155, 155), (-25, 25), 40),
    "FrontFoot": JointRange((-90, 90), (-35, 35), 35, zero="rest"),
    "tail": JointRange((-50, 50), (-50, 50), 45, zero="rest"),
}
"""The ranges of the parts, without sides. Upper arms are in `_upper_arm`."""

QUADRUPED_HEAD = JointRange((-85, 50), (-35, 35), 50, zero="rest")
"""The range of a head that rests in front of its trunk: it looks up where people cannot."""

_AZIMUTH_DEG, _LATITUDE_DEG, _ARM_TWIST_DEG = (-120.0, 160.0), (-88.0, 70.0), 120.0


def natural_limits(skeleton: Skeleton, anatomy: Anatomy) -> AngleLimits:
    """Return the limits of all joints of a skeleton; joints of no known part turn freely.

    >>> from cubeling.characters import Character
    >>> human = Character.load("human")
    >>> limits = natural_limits(human.skeleton, human.anatomy)
    >>> elbow = human.anatomy.joints["leftLowerArm"]
    >>> np.degrees(limits.high[elbow]).round().tolist()
    [100.0, 35.0, 155.0]
    """
    free = AngleLimits.none(len(skeleton))
    low, high = free.low.copy(), free.high.copy()
    before, after = free.before.copy(), free.after.copy()
    rest = skeleton.rest.globals(skeleton)
    frames = rotations.from_matrix(rest[:, :3, :3])
    bones = _Bones(skeleton, anatomy, rest[:, :3, 3])
    for joint, part in bones.parts().items():
        axes, interval = _axes(part, joint, bones)
        direction = bones.direction(joint)
        carried = rotations.to_matrix(rotations.between(axes[:, 0], direction)) @ axes
        parent = skeleton.parents[joint]
        above = frames[parent] if parent >= 0 else rotations.IDENTITY
        before[joint] = rotations.multiply(rotations.conjugate(above), rotations.from_matrix(axes))
        inverse = rotations.conjugate(rotations.from_matrix(carried))
        after[joint] = rotations.multiply(inverse, frames[joint])
        low[joint], high[joint] = np.radians(interval)
    return AngleLimits(low, high, before, after)


@dataclass(frozen=True)
class _Bones:
    """The bones of a skeleton at rest."""

    skeleton: Skeleton
    anatomy: Anatomy
    positions: Array

    def parts(self) -> dict[int, str]:
        """Return the part of each joint that has a range; joints of the trunk between parts too."""
        found = {joint: part for joint, part in self.anatomy.parts.items() if _range_name(part)}
        head = self.anatomy.joint("head")
        joint = -1 if head is None else self.skeleton.parents[head]
        while joint > self.anatomy.joints.get("hips", -1):
            found.setdefault(joint, "spine")
            joint = self.skeleton.parents[joint]
        return found

    def direction(self, joint: int) -> Array:
        """Return where the bone of a joint points at rest, in the frame of the character."""
        below = [child for child, parent in enumerate(self.skeleton.parents) if parent == joint]
        known = [child for child in below if child in self.anatomy.parts] or below
        way = self.positions[known].mean(0) - self.positions[joint] if known else np.zeros(3)
        size = float(np.linalg.norm(way))
        return way / size if size > 1e-9 else self.direction_before(joint)

    def direction_before(self, joint: int) -> Array:
        """Return where the bone that ends in a joint points at rest."""
        parent = self.skeleton.parents[joint]
        way = self.positions[joint] - self.positions[parent] if parent >= 0 else _DOWN
        size = float(np.linalg.norm(way))
        return way / size if size > 1e-9 else -_DOWN


def _range_name(part: str) -> str | None:
    """Return the entry of `RANGES` for a part, or None for one that turns freely."""
    for side in SIDES:
        part = part.removeprefix(side)
    if part in ("chest", "upperChest"):
        return "spine"
    if part.startswith("tail"):
        return "tail"
    if part.startswith("Thumb"):
        return "Thumb"
    if part.endswith("Proximal"):
        return "Proximal"
    if part.endswith(("Intermediate", "Distal")):
        return "Finger"
    return part if part in RANGES or part == "UpperArm" else None


def _axes(part: str, joint: int, bones: _Bones) -> tuple[Array, Array]:
    """Return the axes of a joint at zero, as columns in the frame of the character at rest.

    And the least and greatest (φ, θ, ψ), (2, 3) [deg].
    """
    sign = -1.0 if part.startswith("right") else 1.0
    name = _range_name(part) or part
    if name == "UpperArm":
        return _upper_arm(sign)
    quadruped = bones.anatomy.kind == "quadruped"
    own = QUADRUPED_HEAD if quadruped and name == "head" else RANGES[name]
    along = {"rest": bones.direction, "before": bones.direction_before}
    ahead = _DOWN if own.zero == "down" else along[own.zero](joint)
    toward = _toward(own.toward, ahead, sign)
    axes = np.stack([ahead, toward, np.cross(ahead, toward)], -1)
    # A positive θ moves the bone away from the third axis.
    left = np.array([sign, 0.0, 0.0]) @ axes[:, 2] < 0
    side = own.side if left else (-own.side[1], -own.side[0])
    intervals = [(-own.twist, own.twist), side, own.bend]
    return axes, np.array(intervals, float).T


def _toward(name: Toward, ahead: Array, sign: float) -> Array:
    """Return the direction of a positive bend, perpendicular to the bone."""
    if name == "palm":
        wanted = np.cross(ahead, np.array([0.0, 0.0, sign]))
    else:
        wanted = np.array(_DIRECTIONS[name])
    wanted = wanted - (wanted @ ahead) * ahead
    if float(np.linalg.norm(wanted)) < 1e-3:  # such as the toes of a foot that point up
        wanted = np.array([0.0, 1.0, 0.0]) - ahead[1] * ahead
    unit: Array = wanted / np.linalg.norm(wanted)
    return unit


def _upper_arm(sign: float) -> tuple[Array, Array]:
    """Return the axes and intervals of an upper arm, which points forward at zero.

    The poles, where two of the angles are one, are up to the side and down across the body: an arm
    is seldom there, or cannot be. ψ turns from forward down and back, θ to the poles.
    """
    ahead = np.array([0.0, 0.0, 1.0])
    pole = np.array([sign, 1.0, 0.0]) / np.sqrt(2.0)
    axes = np.stack([ahead, np.cross(pole, ahead), pole], -1)
    least, most = _AZIMUTH_DEG if sign > 0 else (-_AZIMUTH_DEG[1], -_AZIMUTH_DEG[0])
    low = [-_ARM_TWIST_DEG, _LATITUDE_DEG[0], least]
    high = [_ARM_TWIST_DEG, _LATITUDE_DEG[1], most]
    return axes, np.array([low, high])

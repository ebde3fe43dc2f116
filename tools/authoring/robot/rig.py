"""The robot's skeleton: the servos of a small four-legged machine, its lids, lips and lamps."""

from dataclasses import replace

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose, Skeleton
from tools.authoring.modelling.quadruped import AnimationTracks
from tools.authoring.modelling.rig import build_skeleton
from tools.authoring.modelling.shapes import Array, Vector

FEET = ("LeftFrontFoot", "RightFrontFoot", "LeftHindFoot", "RightHindFoot")
NECK = ("neck1", "neck2", "neck3")
TAIL = ("tail1", "tail2", "tail3", "tail4", "tail5")
MOODS = ("happy", "neutral", "angry")
LAMP_PLACES = ("head", "chest", "tail", "LeftIris", "RightIris")
LAMPS = tuple(f"{place}_{mood}" for place in LAMP_PLACES for mood in MOODS)
"""Joints of the lamps, one for each place and colour; unlit ones are scaled down."""
LAMP_OFF_SCALE = 0.02
"""Scale of an unlit lamp, which hides it in the casing."""
HEAD_SCALE = 1.13
"""Scale of the head, which is sculpted at size one."""
LID_YAW_RAD = 0.34
"""Outward yaw of the eyes at rest [rad]."""
UPPER_LID_TRAVEL_RAD, LOWER_LID_TRAVEL_RAD = 1.36, 1.20
"""Rotation of an upper and a lower lid until they meet [rad]."""

EYE_CENTRE_M: Vector = (0.0330, 0.2595, 0.1835)
"""Centre of the left eye [m]."""
TAIL_TIP_M: Vector = (0.0, 0.122, -0.262)
_TEMPLE_LAMPS_M: Vector = (
    0.0,
    0.2370,
    0.1420,
)  # the temple lamps shrink to a point between them
_CHEST_LAMP_M: Vector = (0.0, 0.118, 0.030)

_JOINT_POSITIONS: dict[str, tuple[str, Vector]] = {
    "root": ("", (0.0, 0.0, 0.0)),
    "hips": ("root", (0.0, 0.118, -0.050)),
    "spine1": ("hips", (0.0, 0.120, -0.014)),
    "chest": ("spine1", (0.0, 0.122, 0.022)),
    "neck1": ("chest", (0.0, 0.144, 0.064)),
    "neck2": ("neck1", (0.0, 0.168, 0.084)),
    "neck3": ("neck2", (0.0, 0.191, 0.102)),
    "head": ("neck3", (0.0, 0.213, 0.120)),
    "jaw": ("head", (0.0, 0.2160, 0.152)),
    "tongue": ("jaw", (0.0, 0.2110, 0.2000)),
    "lips": ("head", (0.0, 0.2120, 0.2300)),
    "tail1": ("hips", (0.0, 0.114, -0.098)),
    "tail2": ("tail1", (0.0, 0.106, -0.133)),
    "tail3": ("tail2", (0.0, 0.101, -0.166)),
    "tail4": ("tail3", (0.0, 0.102, -0.199)),
    "tail5": ("tail4", (0.0, 0.109, -0.231)),
    "LeftEye": ("head", EYE_CENTRE_M),
    "LeftUpperLid": ("head", EYE_CENTRE_M),
    "LeftLowerLid": ("head", EYE_CENTRE_M),
    "LeftMouthCorner": ("head", (0.0400, 0.2130, 0.1840)),
    "LeftFrontUpperLeg": ("chest", (0.047, 0.102, 0.044)),
    "LeftFrontLowerLeg": ("LeftFrontUpperLeg", (0.052, 0.060, 0.034)),
    "LeftFrontFoot": ("LeftFrontLowerLeg", (0.054, 0.022, 0.046)),
    "LeftHindUpperLeg": ("hips", (0.049, 0.104, -0.054)),
    "LeftHindLowerLeg": ("LeftHindUpperLeg", (0.055, 0.062, -0.038)),
    "LeftHindFoot": ("LeftHindLowerLeg", (0.057, 0.022, -0.060)),
}
_LAMP_JOINTS = {
    "head": ("head", _TEMPLE_LAMPS_M),
    "chest": ("chest", _CHEST_LAMP_M),
    "tail": ("tail5", TAIL_TIP_M),
    "LeftIris": ("LeftEye", EYE_CENTRE_M),
}


def skeleton(head_size: float = HEAD_SCALE) -> Skeleton:
    """Return the skeleton in its bind pose: only lids are rotated, scales are one."""
    lamps = {
        f"{place}_{mood}": (parent, at)
        for place, (parent, at) in _LAMP_JOINTS.items()
        for mood in MOODS
    }
    bound = build_skeleton(_JOINT_POSITIONS | lamps)
    places, still = bound.rest.translations.copy(), bound.rest.rotations.copy()
    for name, side in (("Left", 1.0), ("Right", -1.0)):
        for lid in ("UpperLid", "LowerLid"):  # they rotate about the axis of an outward-looking eye
            still[bound.index(name + lid)] = rotations.about("y", side * LID_YAW_RAD)
    head = bound.index("head")
    in_head = [parent in (head, bound.index("jaw")) for parent in bound.parents]
    places[in_head] *= head_size
    return replace(bound, rest=Pose(places, still))


def scaled_with_head(mesh: Mesh, bound: Skeleton) -> Mesh:
    """Return a mesh made for a head of size one, scaled and bound to a skeleton."""
    neck = bound.rest.globals(bound)[bound.index("head"), :3, 3]
    positions = neck + HEAD_SCALE * (mesh.positions - neck)
    inverse_bind = np.asarray(np.linalg.inv(bound.rest.globals(bound)), np.float64)
    return replace(mesh, positions=positions.astype(np.float32), inverse_bind=inverse_bind)


def shipped_skeleton(bound: Skeleton) -> Skeleton:
    """Return the bundled skeleton, with its neutral lamps lit."""
    scales = np.ones((len(bound), 3))
    for lamp in LAMPS:
        scales[bound.index(lamp)] = 1.0 if lamp.endswith("_neutral") else LAMP_OFF_SCALE
    rest = Pose(bound.rest.translations, bound.rest.rotations, scales)
    return Skeleton(bound.names, bound.parents, rest)


def set_lamps(anim: AnimationTracks, mood: str) -> None:
    """Light the lamps in the colour of a mood."""
    for lamp in LAMPS:
        anim.scales[lamp] = np.full(
            anim.frames, 1.0 if lamp.endswith(f"_{mood}") else LAMP_OFF_SCALE
        )


def set_lids(
    anim: AnimationTracks,
    shut: Array | float = 0.0,
    smile: Array | float = 0.0,
    anger: Array | float = 0.0,
    sides: tuple[str, ...] = ("Left", "Right"),
) -> None:
    """Close the eyes (0…1), raise the lower lids in a smile (0…1), slant them in anger (−1…1).

    Negative anger slants them the other way, as in sadness.
    """
    cross = np.asarray(anger)
    upper = np.minimum(1.0, shut + 0.46 * np.abs(cross) * (1 - np.asarray(shut)))
    lower = np.maximum(shut, 0.62 * np.asarray(smile) + 0.22 * np.maximum(cross, 0))
    for side in sides:
        sign = 1.0 if side == "Left" else -1.0
        level = -0.20 * np.asarray(shut)  # closed lids are level although the eyes look outward
        _roll(anim, f"{side}UpperLid", -UPPER_LID_TRAVEL_RAD * upper, sign * (0.44 * cross + level))
        _roll(anim, f"{side}LowerLid", LOWER_LID_TRAVEL_RAD * lower, sign * (level - 0.15 * cross))


def _roll(anim: AnimationTracks, lid: str, up: Array, tilt: Array) -> None:
    """Roll a lid, then tilt it about the axis of the gaze.

    The product of the two rotations is converted to the three angles of a track.
    """
    roll = -up
    steep = np.arcsin(np.clip(np.cos(tilt) * np.sin(roll), -1.0, 1.0))
    aside = np.arctan2(np.sin(tilt) * np.sin(roll), np.cos(roll))
    lean = np.arctan2(np.sin(tilt), np.cos(tilt) * np.cos(roll))
    anim.turn(lid, up=-steep, left=aside, tilt=lean)


def set_mouth(
    anim: AnimationTracks,
    open_: Array | float = 0.0,
    grin: Array | float = 0.0,
    round_: Array | float = 0.0,
) -> None:
    """Drop the jaw (0…1), raise (1) or drop (−1) the corners of the mouth, draw them in (0…1)."""
    up, down = np.maximum(grin, 0.0), np.maximum(-np.asarray(grin), 0.0)
    anim.turn("jaw", up=-0.52 * np.asarray(open_))
    anim.move("tongue", y=-0.0058 * down)  # a snarl hides the tongue
    anim.move("lips", y=0.0072 * down - 0.0032 * up, z=0.0014 * down)
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        anim.move(
            f"{side}MouthCorner",
            x=sign * (0.0036 * up - 0.0040 * down - 0.007 * np.asarray(round_)),
            y=0.0165 * up - 0.0058 * down,
            z=0.011 * np.asarray(round_) - 0.0023 * up,
        )

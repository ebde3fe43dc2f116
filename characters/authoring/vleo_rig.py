"""Vleo's skeleton, and from a performance to poses: turns of joints, and feet that stay planted."""

from dataclasses import dataclass, field, replace

import numpy as np

from characters import rotations
from characters.authoring.ik import aim, bend
from characters.authoring.rig import build_skeleton
from characters.authoring.shapes import Array, Vector
from characters.pose import Pose, Skeleton

FEET = ("LeftFrontFoot", "RightFrontFoot", "LeftHindFoot", "RightHindFoot")
HEARTS = ("heart1", "heart2", "heart3")
BURSTS = ("burst1", "burst2", "burst3")
NECK = ("neck1", "neck2", "neck3")
TAIL = ("tail1", "tail2", "tail3", "tail4", "tail5")
BACK = ("hips", "spine1", "spine2", "chest")
LID_YAW = 0.45
"""How far to the side the eyes sit in the head [rad]."""
HIDDEN = 1e-3
"""Scale of a joint whose mesh is not to be seen; not zero, so that its matrix can be inverted."""

_JOINTS: dict[str, tuple[str, Vector]] = {
    "root": ("", (0.0, 0.0, 0.0)),
    "hips": ("root", (0.0, 0.112, -0.045)),
    "spine1": ("hips", (0.0, 0.115, -0.012)),
    "spine2": ("spine1", (0.0, 0.117, 0.018)),
    "chest": ("spine2", (0.0, 0.122, 0.045)),
    "neck1": ("chest", (0.0, 0.145, 0.066)),
    "neck2": ("neck1", (0.0, 0.171, 0.079)),
    "neck3": ("neck2", (0.0, 0.196, 0.086)),
    "head": ("neck3", (0.0, 0.221, 0.094)),
    "jaw": ("head", (0.0, 0.2235, 0.128)),
    "lips": ("head", (0.0, 0.2200, 0.176)),
    "belly": ("spine1", (0.0, 0.100, -0.005)),
    "tail1": ("hips", (0.0, 0.094, -0.090)),
    "tail2": ("tail1", (0.0, 0.083, -0.125)),
    "tail3": ("tail2", (0.0, 0.077, -0.161)),
    "tail4": ("tail3", (0.0, 0.079, -0.197)),
    "tail5": ("tail4", (0.0, 0.092, -0.232)),
    "LeftEye": ("head", (0.0300, 0.2575, 0.1475)),
    "LeftUpperLid": ("head", (0.0300, 0.2575, 0.1475)),
    "LeftLowerLid": ("head", (0.0300, 0.2575, 0.1475)),
    "LeftBrow": ("head", (0.0290, 0.2780, 0.1620)),
    "LeftMouthCorner": ("head", (0.0430, 0.2320, 0.1500)),
    "LeftFrontUpperLeg": ("chest", (0.036, 0.098, 0.052)),
    "LeftFrontLowerLeg": ("LeftFrontUpperLeg", (0.041, 0.058, 0.030)),
    "LeftFrontFoot": ("LeftFrontLowerLeg", (0.043, 0.020, 0.053)),
    "LeftHindUpperLeg": ("hips", (0.036, 0.100, -0.046)),
    "LeftHindLowerLeg": ("LeftHindUpperLeg", (0.043, 0.058, -0.026)),
    "LeftHindFoot": ("LeftHindLowerLeg", (0.045, 0.020, -0.052)),
}
NEARLY_STRAIGHT = 0.97
"""Reach of a leg over the length of its bones from which on it stretches instead."""
MOUTH = (0.0, 0.222, 0.200)
"""Where kisses and shouts leave, character frame [m]."""


def skeleton() -> Skeleton:
    """Return the skeleton in its bind pose: axes as the character's but for lids, scales one."""
    effects: dict[str, tuple[str, Vector]] = dict.fromkeys(HEARTS + BURSTS, ("root", MOUTH))
    bound = build_skeleton(_JOINTS | effects)
    still = bound.rest.rotations.copy()
    for name, side in (("Left", 1.0), ("Right", -1.0)):
        for lid in ("UpperLid", "LowerLid"):  # they roll about the axis of an eye that looks aside
            still[bound.index(name + lid)] = rotations.about("y", side * LID_YAW)
    return replace(bound, rest=Pose(bound.rest.translations, still))


def resting(bound: Skeleton) -> Skeleton:
    """Return the skeleton as it is shipped: effects, lips and brows too small to be seen."""
    scales = np.ones((len(bound), 3))
    for name in (*HEARTS, *BURSTS, "lips", "LeftBrow", "RightBrow"):
        scales[bound.index(name)] = HIDDEN
    rest = Pose(bound.rest.translations, bound.rest.rotations, scales)
    return Skeleton(bound.names, bound.parents, rest)


@dataclass
class Performance:
    """What an animator says: how joints turn and move, and where the feet are."""

    frames: int
    """Number of frames of the loop."""

    turns: dict[str, Array] = field(default_factory=dict)
    """Joint to (frames, 3): nose up, to its left, tilted to its right [rad]."""

    moves: dict[str, Array] = field(default_factory=dict)
    """Joint to its offset from rest, (frames, 3) [m]."""

    scales: dict[str, Array] = field(default_factory=dict)
    """Joint to its scale, (frames,) or (frames, 3); effects not named are hidden."""

    feet: dict[str, Array] = field(default_factory=dict)
    """Foot to (frames, 4): offset from rest x, y, z [m] and toes up [rad]; else it is planted."""

    def turn(
        self, joint: str, up: Array | float = 0, left: Array | float = 0, tilt: Array | float = 0
    ) -> None:
        """Add a turn to a joint; each argument is (frames,) or a number [rad]."""
        added = np.stack(np.broadcast_arrays(up, left, tilt, np.zeros(self.frames))[:3], axis=-1)
        self.turns[joint] = self.turns.get(joint, 0.0) + added

    def move(
        self, joint: str, x: Array | float = 0, y: Array | float = 0, z: Array | float = 0
    ) -> None:
        """Add an offset to a joint; each argument is (frames,) or a number [m]."""
        added = np.stack(np.broadcast_arrays(x, y, z, np.zeros(self.frames))[:3], axis=-1)
        self.moves[joint] = self.moves.get(joint, 0.0) + added

    def step(
        self,
        foot: str,
        x: Array | float = 0,
        y: Array | float = 0,
        z: Array | float = 0,
        toes: Array | float = 0,
    ) -> None:
        """Add an offset to a foot on or above the ground [m] and a turn of its toes [rad]."""
        added = np.stack(np.broadcast_arrays(x, y, z, toes, np.zeros(self.frames))[:4], axis=-1)
        self.feet[foot] = self.feet.get(foot, 0.0) + added


def poses(performance: Performance, bound: Skeleton) -> Pose:
    """Return the poses of a performance, (frames, joints, …); the legs follow from the feet."""
    frames, joints = performance.frames, len(bound)
    translations = np.tile(bound.rest.translations, (frames, 1, 1))
    turns = np.zeros((frames, joints, 3))
    scales = np.tile(_shipped_scales(bound), (frames, 1, 1))
    for name, move in performance.moves.items():
        translations[:, bound.index(name)] += move
    for name, turn in performance.turns.items():
        turns[:, bound.index(name)] = turn
    for name, scale in performance.scales.items():
        scales[:, bound.index(name)] = np.reshape(scale, (frames, -1))
    # Yaw, then pitch, then roll; nose up is a negative turn about x.
    turned = rotations.from_euler("yxz", turns[..., [1, 0, 2]] * np.array([1.0, -1.0, 1.0]))
    local = rotations.multiply(bound.rest.rotations, turned)
    body = Pose(translations, local).globals(bound)
    for foot in FEET:
        steps = performance.feet.get(foot, np.zeros((frames, 4)))
        stretch = _place_leg(foot, steps, body, local, bound)
        knee = bound.parents[bound.index(foot)]
        translations[:, [knee, bound.index(foot)]] *= stretch[:, None]
    return Pose(translations, rotations.continuous(local), scales)


def _place_leg(foot: str, offset: Array, body: Array, local: Array, bound: Skeleton) -> Array:
    """Turn the three joints of a leg so that its foot is where it should.

    Returns how much longer than at rest its bones must be, (frames, 1): legs of rubber give a
    little before a foot leaves its place.
    """
    ankle = bound.index(foot)
    knee = bound.parents[ankle]
    hip = bound.parents[knee]
    rest = bound.rest.globals(bound)[:, :3, 3]
    parent = rotations.from_matrix(body[:, bound.parents[hip], :3, :3])
    start, target = body[:, hip, :3, 3], rest[ankle] + offset[:, :3]
    thigh, shin = rest[knee] - rest[hip], rest[ankle] - rest[knee]
    upper, lower = float(np.linalg.norm(thigh)), float(np.linalg.norm(shin))
    reach = np.linalg.norm(target - start, axis=1, keepdims=True)
    stretch = np.maximum(1.0, reach / (NEARLY_STRAIGHT * (upper + lower)))
    straight = (thigh + shin) / np.linalg.norm(thigh + shin)
    pole = rotations.rotate(parent, thigh - straight * float(straight @ thigh))
    bent = stretch * bend(start / stretch, target / stretch, pole, upper, lower)
    hinge, rest_hinge = np.cross(target - start, pole), np.cross(thigh + shin, thigh)
    thigh_turn = aim(thigh, rest_hinge, bent - start, hinge)
    shin_turn = aim(shin, rest_hinge, target - bent, hinge)
    sole = rotations.about("x", -offset[:, 3])
    local[:, hip] = rotations.multiply(rotations.conjugate(parent), thigh_turn)
    local[:, knee] = rotations.multiply(rotations.conjugate(thigh_turn), shin_turn)
    local[:, ankle] = rotations.multiply(rotations.conjugate(shin_turn), sole)
    return np.asarray(stretch)


def _shipped_scales(bound: Skeleton) -> Array:
    scales = resting(bound).rest.scales
    return np.ones((len(bound), 3)) if scales is None else scales

"""Animation of quadrupeds: tracks of joints, and leg IK for planted feet."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose, Skeleton
from tools.authoring.modelling.curves import smoothstep, spring_follow
from tools.authoring.modelling.ik import aim_rotation, hinge_position
from tools.authoring.modelling.shapes import Array

DEGREE = np.pi / 180
FRAME_RATE_HZ = 60.0
"""Frames a second [Hz]: between two frames, interpolated legs slide half as fast as at 30 Hz."""
MAX_LEG_EXTENSION = 0.985
"""Leg extension over the length of its bones beyond which the leg stretches."""
LIFT_CLEARANCE_M = 0.003, 0.012
"""Heights of a foot from which it leaves its place, and from which it is free [m]."""


@dataclass
class AnimationTracks:
    """Animation tracks of a loop: rotations and offsets of joints, and positions of feet."""

    frames: int
    """Number of frames of the loop."""

    turns: dict[str, Array] = field(default_factory=dict)
    """Joint to rotations (frames, 3): nose up, to its left, tilted to its right [rad]."""

    moves: dict[str, Array] = field(default_factory=dict)
    """Joint to its offset from rest, (frames, 3) [m]."""

    scales: dict[str, Array] = field(default_factory=dict)
    """Joint to its scale, (frames,) or (frames, 3); others keep that of the rest pose."""

    morphs: dict[str, Array] = field(default_factory=dict)
    """Morph target to weights, (frames,); others are 0."""

    feet: dict[str, Array] = field(default_factory=dict)
    """Foot to (frames, 4): offset from rest x, y, z [m] and toes up [rad]; others are planted."""

    @property
    def seconds(self) -> float:
        """Duration of the loop [s]."""
        return self.frames / FRAME_RATE_HZ

    def turn(
        self, joint: str, up: Array | float = 0, left: Array | float = 0, tilt: Array | float = 0
    ) -> None:
        """Add a rotation to a joint; each argument is (frames,) or a number [rad]."""
        self.turns[joint] = self.turns.get(joint, 0.0) + self._columns(up, left, tilt)

    def move(
        self, joint: str, x: Array | float = 0, y: Array | float = 0, z: Array | float = 0
    ) -> None:
        """Add an offset to a joint; each argument is (frames,) or a number [m]."""
        self.moves[joint] = self.moves.get(joint, 0.0) + self._columns(x, y, z)

    def show(self, morph: str, on: Array | float) -> None:
        """Add to the weight of a morph target; `on` is (frames,) or a number."""
        self.morphs[morph] = self.morphs.get(morph, 0.0) + self._columns(on)[:, 0]

    def step(
        self,
        foot: str,
        x: Array | float = 0,
        y: Array | float = 0,
        z: Array | float = 0,
        toes: Array | float = 0,
    ) -> None:
        """Add an offset of a foot [m] and a rotation of its toes [rad].

        On the ground it stays where it is: it goes aside and turns only as far as it is lifted.
        """
        low, high = LIFT_CLEARANCE_M
        free = smoothstep((np.asarray(y) - low) / (high - low))
        self.feet[foot] = self.feet.get(foot, 0.0) + self._columns(
            x * free, y, z * free, toes * free
        )

    def _columns(self, *values: Array | float) -> Array:
        return np.stack([np.broadcast_to(value, self.frames) for value in values], axis=-1)


def solve_poses(anim: AnimationTracks, bound: Skeleton, feet: Sequence[str]) -> Pose:
    """Return the poses of the tracks, (frames, joints, …), with the legs solved by IK.

    Parameters
    ----------
    tracks : the animation
    bound : the skeleton at rest; only joints of the face are rotated
    feet : the last joint of every leg, below two bones
    """
    frames, rest = anim.frames, bound.rest
    translations = np.tile(rest.translations, (frames, 1, 1))
    turns = np.zeros((frames, len(bound), 3))
    still = np.ones((len(bound), 3)) if rest.scales is None else rest.scales
    scales = np.tile(still, (frames, 1, 1))
    for name, move in anim.moves.items():
        translations[:, bound.index(name)] += move
    for name, turn in anim.turns.items():
        turns[:, bound.index(name)] = turn
    for name, scale in anim.scales.items():
        scales[:, bound.index(name)] = np.reshape(scale, (frames, -1))
    # Yaw, then pitch, then roll; nose up is a negative turn about x.
    turned = rotations.from_euler("yxz", turns[..., [1, 0, 2]] * np.array([1.0, -1.0, 1.0]))
    local = rotations.multiply(rest.rotations, turned)
    body = Pose(translations, local).globals(bound)
    for foot in feet:
        steps = anim.feet.get(foot, np.zeros((frames, 4)))
        stretch = _place_leg(bound.index(foot), steps, body, local, bound)
        knee = bound.parents[bound.index(foot)]
        translations[:, [knee, bound.index(foot)]] *= stretch[:, None]
    return Pose(translations, rotations.continuous(local), scales)


def _place_leg(ankle: int, offset: Array, body: Array, local: Array, bound: Skeleton) -> Array:
    """Rotate the three joints of a leg so that its foot reaches its target.

    Returns the stretch of its bones over their rest length, (frames, 1): a leg stretches a little
    before its foot leaves the ground.
    """
    knee = bound.parents[ankle]
    hip = bound.parents[knee]
    rest = bound.rest.globals(bound)[:, :3, 3]
    parent = rotations.from_matrix(body[:, bound.parents[hip], :3, :3])
    start, target = body[:, hip, :3, 3], rest[ankle] + offset[:, :3]
    thigh, shin = rest[knee] - rest[hip], rest[ankle] - rest[knee]
    upper, lower = float(np.linalg.norm(thigh)), float(np.linalg.norm(shin))
    reach = np.linalg.norm(target - start, axis=1, keepdims=True)
    stretch = np.maximum(1.0, reach / (MAX_LEG_EXTENSION * (upper + lower)))
    straight = (thigh + shin) / np.linalg.norm(thigh + shin)
    pole = rotations.rotate(parent, thigh - straight * float(straight @ thigh))
    bent = stretch * hinge_position(start / stretch, target / stretch, pole, upper, lower)
    hinge, rest_hinge = np.cross(target - start, pole), np.cross(thigh + shin, thigh)
    thigh_turn = aim_rotation(thigh, rest_hinge, bent - start, hinge)
    shin_turn = aim_rotation(shin, rest_hinge, target - bent, hinge)
    sole = rotations.about("x", -offset[:, 3])
    local[:, hip] = rotations.multiply(rotations.conjugate(parent), thigh_turn)
    local[:, knee] = rotations.multiply(rotations.conjugate(thigh_turn), shin_turn)
    local[:, ankle] = rotations.multiply(rotations.conjugate(shin_turn), sole)
    return np.asarray(stretch)


def loop_clip(
    name: str,
    anim: AnimationTracks,
    bound: Skeleton,
    feet: Sequence[str],
    morphs: Sequence[str] = (),
) -> Clip:
    """Return the looping clip of the tracks: its last frame equals its first.

    Parameters
    ----------
    morphs : names of the morph targets that the clip sets
    """
    pose = solve_poses(anim, bound, feet)
    again = np.append(np.arange(anim.frames), 0)
    scales = None if pose.scales is None else pose.scales[again]
    turns = rotations.continuous(pose.rotations[again])
    off = np.zeros(anim.frames)
    shown = [anim.morphs.get(morph, off)[again] for morph in morphs]
    face = np.stack(shown, axis=1) if morphs else None
    return Clip(name, FRAME_RATE_HZ, Pose(pose.translations[again], turns, scales, face))


def swing_tail(
    anim: AnimationTracks,
    joints: Sequence[str],
    up: Array,
    left: Array,
    tip: float,
    hertz: float,
    drag: float,
    damping: tuple[float, float],
) -> None:
    """Swing a tail from its root; every joint follows the one before it like a damped spring.

    Parameters
    ----------
    joints : from the root of the tail to its tip
    up, left : rotation of the first joint, (frames,) [rad]; up lifts the tail
    tip : rotation of the last joint over that of the first
    hertz : natural frequency at the root, which falls towards the tip [Hz]
    drag : factor of the delay of all joints; 1 is the natural tail
    damping : of the movement up and down, and of that from side to side
    """
    for number, joint in enumerate(joints):
        share = 1 + (tip - 1) * number / (len(joints) - 1)
        if number:
            natural = hertz / (drag * (1 + 0.12 * number))
            up = spring_follow(up, anim.seconds, natural, damping[0])
            left = spring_follow(left, anim.seconds, natural, damping[1])
        anim.turn(joint, up=-share * up, left=-share * left)

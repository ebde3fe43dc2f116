"""Strength and apex of beat gestures.

Source: Fernández-Baena 2015, section 4.2 and 4.4.2 (M4).
"""

import math
from collections.abc import Mapping
from typing import Literal

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.smoothing import gaussian_smooth

ARM_MASSES = {"LowerArm": 2.0, "UpperArm": 3.0, "Shoulder": 3.0}
"""Mass that each joint of an arm moves (M4)."""

HEAD_MASSES = {"neck": 3.0, "head": 2.0}
"""The same of a body without arms."""

Variant = Literal["mean", "total"]
"""Kinetic energy as the mean over time, or summed over time."""

SPEED_CUTOFF_HZ = 6.0
"""Where the speed of a hand is low-passed to half of its power [Hz]."""

APEX_CUTOFF_HZ = 10.0
"""The same where stops are looked for: recoils are short [Hz]."""

APEX_AFTER_S = 0.1
"""How long after the end of a stroke its apex may be [s]."""

RECOILS = 0.4
"""A hand that is slowest at less than this share of the greatest speed of its stroke recoils."""

APEX_SPEED = 0.15
"""A hand that has slowed down to this share of the greatest speed of its stroke stops."""

BIMANUAL_APEX_S, BIMANUAL_GSI = 0.1, 1.0
"""A stroke of both hands is coordinated if its apices and strengths differ by no more."""


def masses(anatomy: Anatomy, side: str) -> dict[int, float]:
    """Return the masses that count for one hand, by joint; a side is "left" or "right".

    Without arms, as on four legs, they are those of neck and head.
    """
    own = anatomy.joints
    arm = {own[side + part]: mass for part, mass in ARM_MASSES.items() if side + part in own}
    return arm or {own[part]: mass for part, mass in HEAD_MASSES.items() if part in own}


def kinetic_energies(turns: Array, masses: Array, rate: float, variant: Variant = "mean") -> Array:
    """Return the energy of each joint of a motion, (joints,).

    KE_j = mean of m_j |ω_j|² over time, ω_j in degrees a second from relative rotation vectors; the
    total is that times the duration [s]. Slowed down w times, the mean is w² times smaller, the
    total w times.

    Parameters
    ----------
    turns
        Local rotations, (frames, joints, 4), at least two frames.
    masses
        Mass that each joint moves, (joints,).
    rate
        Frame rate [Hz].
    """
    between = rotations.multiply(rotations.conjugate(turns[:-1]), turns[1:])
    spins = np.degrees(rotations.to_rotation_vector(between)) * rate
    energies: Array = masses * np.einsum("fji,fji->fj", spins, spins).mean(0)
    return energies if variant == "mean" else energies * (len(turns) - 1) / rate


def features(turns: Array, masses: Array, rate: float) -> Array:
    """Return the feature vector ln(1 + KE_j) of a motion, (joints,).

    The distance of two motions is that of their features (FMDistance).
    """
    return np.log1p(kinetic_energies(turns, masses, rate))


def gesture_strength(
    turns: Array, masses: Mapping[int, float], rate: float, variant: Variant = "mean"
) -> float:
    """Return the GSI of a stroke: ln of the sum of the energies of joints.

    `turns` (frames, joints, 4) are local rotations of all joints, `masses` go by joint.
    """
    joints = [*masses]
    energies = kinetic_energies(turns[:, joints], np.array([*masses.values()]), rate, variant)
    return math.log(max(float(energies.sum()), 1e-9))


def bimanual_strength(strengths: tuple[float, float], apices: tuple[float, float]) -> float:
    """Return the GSI of a stroke of both hands, from GSI and apex [s] of each.

    It is the larger one; of a coordinated stroke, the sum of both energies.

    >>> round(bimanual_strength((10.0, 10.0), (0.5, 0.55)) - 10.0, 4)  # ln 2
    0.6931
    >>> bimanual_strength((10.0, 8.5), (0.5, 0.55))
    10.0
    """
    apart = abs(apices[0] - apices[1]), abs(strengths[0] - strengths[1])
    if apart[0] <= BIMANUAL_APEX_S and apart[1] <= BIMANUAL_GSI:
        return float(np.logaddexp(*strengths))
    return max(strengths)


def hand_paths(poses: Pose, skeleton: Skeleton, anatomy: Anatomy) -> dict[str, Array]:
    """Return where each hand is in the axes of the hips, (frames, 3) [m], by side.

    What legs and hips do does not count. On four legs it is the head, on both sides.

    Raises
    ------
    CharacterError
        If there is neither a hand nor a head.
    """
    placed = poses.globals(skeleton)
    hips = placed[:, anatomy.joint("hips") or 0]
    ends = {side: anatomy.joint(f"{side}Hand") for side in SIDES}
    if all(end is None for end in ends.values()):
        ends = dict.fromkeys(SIDES, anatomy.joint("head"))
    known = {side: end for side, end in ends.items() if end is not None}
    if not known:
        raise CharacterError("gestures need hands or a head; name them in the character's file")
    return {
        side: np.einsum("fba,fb->fa", hips[:, :3, :3], placed[:, end, :3, 3] - hips[:, :3, 3])
        for side, end in known.items()
    }


def hand_speed(path: Array, rate: float, cutoff_hz: float = SPEED_CUTOFF_HZ) -> Array:
    """Return the low-passed speed of a hand, (frames,) [m/s], from its path (frames, 3)."""
    if len(path) < 2:
        return np.zeros(len(path))
    # A Gaussian of this deviation halves the power at the cut-off: exp(−(2π f σ)²) = ½.
    deviation = math.sqrt(math.log(2.0)) / (2 * math.pi * cutoff_hz) * rate
    speed: Array = np.linalg.norm(np.gradient(path, axis=0), axis=1) * rate
    return np.maximum(gaussian_smooth(speed, deviation), 0.0)


def find_apex(path: Array, rate: float, stroke: tuple[int, int]) -> int:
    """Return the frame of the apex of a stroke: where the hand stops.

    That is looked for until 0.1 s after the end of the stroke; in a stroke without a stop it is the
    slowest frame.
    """
    first, last = stroke
    speed = hand_speed(path, rate, APEX_CUTOFF_HZ)
    top = first + int(np.argmax(speed[first : last + 1]))
    last = min(last + round(APEX_AFTER_S * rate), len(path) - 1)
    return find_stop(speed, top, last)


def find_stop(speed: Array, top: int, last: int) -> int:
    """Return the first frame after a peak of a hand's speed, (frames,), in which the hand stops.

    There it has slowed down to `APEX_SPEED` of that speed, or, if it recoils at once, to `RECOILS`.
    """
    part = speed[top : last + 1]
    after = np.append(part[1:], np.inf)
    turns = (part < after) & (part < RECOILS * part[0])
    stopped = np.flatnonzero((part < APEX_SPEED * part[0]) | turns)
    return top + int(stopped[0] if len(stopped) else np.argmin(part))

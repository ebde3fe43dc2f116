"""Inverse kinematics of a leg over all frames at once: the ankle to a place, the foot as it was."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from characters import rotations
from characters.pose import Array, Pose
from characters.retargeting.body import Body, Leg, turns_of
from characters.retargeting.transfer import ankle, place

_STRAIGHTEST = 0.9995  # part of a leg's length that it may reach: beyond, the knee would snap


def bend(pose: Pose, body: Body, leg: Leg, target: Array) -> Pose:
    """Return poses (frames, joints, …) whose ankle is at a target (frames, 3) [m].

    The knee keeps the side to which it bends; the law of cosines says how far. Targets and
    places are in the skeleton's own axes.
    """
    skeleton = body.skeleton
    globals_ = pose.globals(skeleton)
    turns = turns_of(globals_)
    hip, knee = globals_[:, leg.upper, :3, 3], globals_[:, leg.lower, :3, 3]
    shin_turn, thigh_turn = _turns(body, hip, knee, ankle(globals_, body, leg), target)
    whole = rotations.multiply(thigh_turn, shin_turn)
    own = pose.rotations.copy()
    parents = skeleton.parents
    above = _global(turns, parents[leg.upper])
    own[:, leg.upper] = _relative(above, rotations.multiply(thigh_turn, turns[:, leg.upper]))
    above = rotations.multiply(thigh_turn, _global(turns, parents[leg.lower]))
    own[:, leg.lower] = _relative(above, rotations.multiply(whole, turns[:, leg.lower]))
    if leg.attached:
        above = rotations.multiply(whole, _global(turns, parents[leg.foot]))
        own[:, leg.foot] = _relative(above, turns[:, leg.foot])
    bent = replace(pose, translations=pose.translations.copy(), rotations=rotations.continuous(own))
    if not leg.attached:
        place(bent, body, leg.foot, ankle(bent.globals(skeleton), body, leg))
    return bent


def _turns(body: Body, hip: Array, knee: Array, at: Array, target: Array) -> tuple[Array, Array]:
    """Return how the shin turns against the thigh, and then both, (frames, 4) each."""
    thigh, shin, reach = hip - knee, at - knee, target - hip
    long, short, far = (np.linalg.norm(v, axis=-1) for v in (thigh, shin, reach))
    far = np.clip(far, np.abs(long - short) * 1.0005 + 1e-9, _STRAIGHTEST * (long + short))
    across = np.cross(thigh, shin)
    size = np.linalg.norm(across, axis=-1, keepdims=True)
    axis = _hinge(across, size[:, 0] > 1e-4 * long * short, thigh, body)
    bent = np.arctan2(size[:, 0], np.einsum("ij,ij->i", thigh, shin))
    goal = np.arccos(np.clip((long**2 + short**2 - far**2) / (2 * long * short), -1.0, 1.0))
    shin_turn = rotations.about(axis, goal - bent)
    reached = knee + rotations.rotate(shin_turn, shin) - hip
    return shin_turn, rotations.between(reached, reach)


def _hinge(across: Array, bends: NDArray[np.bool_], thigh: Array, body: Body) -> Array:
    """Return about which axis the knee bends, (frames, 3): while straight, as when it last bent."""
    if not bends.any():  # the shin goes backward
        backward = rotations.rotate(rotations.conjugate(body.upright), [-1.0, 0.0, 0.0])
        axis = np.broadcast_to(backward, across.shape)
    else:
        known = np.flatnonzero(bends)
        frames = np.arange(len(across))
        later = known[np.minimum(np.searchsorted(known, frames), len(known) - 1)]
        earlier = known[np.maximum(np.searchsorted(known, frames, side="right") - 1, 0)]
        nearest = np.where(np.abs(later - frames) < np.abs(earlier - frames), later, earlier)
        axis = across[nearest]
    along = np.einsum("ij,ij->i", axis, thigh) / np.einsum("ij,ij->i", thigh, thigh)
    return np.asarray(axis - along[:, None] * thigh)


def _global(turns: Array, joint: int) -> Array:
    """Return a joint's rotation, (frames, 4); that of the world above the roots."""
    return turns[:, joint] if joint >= 0 else np.broadcast_to(rotations.IDENTITY, (len(turns), 4))


def _relative(above: Array, turn: Array) -> Array:
    return rotations.multiply(rotations.conjugate(above), turn)

"""Inverse kinematics of a leg over all frames at once: the ankle to a place, the foot as it was."""

from dataclasses import replace

import numpy as np

from characters.retargeting.body import Body, Leg, turns_of
from characters.retargeting.transfer import ankle, place
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose

_STRAIGHTEST = 0.9995  # part of a leg's length that it may reach: beyond, the knee would snap
_FOLDED = 0.35  # likewise: the least, unless the clip folds it more
_BENDS = 1e-3  # sine of the angle from which on a leg is known to bend
_USUAL = 0.15  # likewise: what bends less, bends rather to the side to which it usually does


def bend(pose: Pose, body: Body, leg: Leg, target: Array) -> Pose:
    """Return poses (frames, joints, …) whose ankle is at a target (frames, 3) [m].

    The knee keeps the side to which it bends; the law of cosines says how far. Targets and
    places are in the skeleton's own axes.
    """
    skeleton = body.skeleton
    globals_ = pose.globals(skeleton)
    turns = turns_of(globals_)
    hip, knee = globals_[:, leg.upper, :3, 3], globals_[:, leg.lower, :3, 3]
    joints = hip, knee, ankle(globals_, body, leg)
    shin_turn, thigh_turn = _turns(leg, body, turns, joints, target)
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


def _turns(
    leg: Leg, body: Body, turns: Array, joints: tuple[Array, Array, Array], target: Array
) -> tuple[Array, Array]:
    """Return how the shin turns against the thigh, and then both, (frames, 4) each."""
    hip, knee, at = joints
    thigh, shin = hip - knee, at - knee
    long, short = (np.linalg.norm(v, axis=-1) for v in (thigh, shin))
    reach = _away(target - hip, at - hip, _FOLDED * (long + short))
    far = np.linalg.norm(reach, axis=-1)
    far = np.clip(far, np.abs(long - short) * 1.0005 + 1e-9, _STRAIGHTEST * (long + short))
    up = thigh / long[:, None]
    side = _side(up, shin / short[:, None], turns[:, leg.upper], body)
    cosine = np.clip((long**2 + short**2 - far**2) / (2 * long * short), -1.0, 1.0)[:, None]
    bent = short[:, None] * (cosine * up + np.sqrt(1.0 - cosine**2) * side)
    return rotations.between(shin, bent), rotations.between(knee + bent - hip, reach)


def _away(reach: Array, own: Array, least: Array) -> Array:
    """Return where an ankle is to be, seen from the hip, (frames, 3): not too near to the hip.

    What is goes toward where the ankle is in the clip, up to that far from the hip: near to the
    hip the direction of the leg is any, and it would spin.
    """
    step = own - reach
    a = np.maximum(np.einsum("ij,ij->i", step, step), 1e-12)
    b = np.einsum("ij,ij->i", reach, step)
    c = np.einsum("ij,ij->i", reach, reach) - least**2
    part = (np.sqrt(np.maximum(b * b - a * c, 0.0)) - b) / a
    return np.asarray(reach + np.where(c < 0, np.clip(part, 0.0, 1.0), 0.0)[:, None] * step)


def _side(up: Array, shin: Array, turns: Array, body: Body) -> Array:
    """Return to which side of the thigh the shin bends, (frames, 3).

    Where the leg is straight, and where it is stretched a little beyond, it is the side to which
    it bends in the other frames, seen from the thigh: else the knee would snap over and back.
    """
    away = shin - np.einsum("ij,ij->i", shin, up)[:, None] * up
    usual = rotations.rotate(rotations.conjugate(turns), away).mean(0)
    size = float(np.linalg.norm(usual))
    if size > _BENDS:
        known = rotations.rotate(turns, usual / size)
    else:  # the shin goes backward
        backward = rotations.rotate(rotations.conjugate(body.upright), [0.0, 0.0, -1.0])
        known = np.broadcast_to(backward, away.shape)
    away = np.where(np.einsum("ij,ij->i", away, known)[:, None] < 0, -away, away) + _USUAL * known
    away -= np.einsum("ij,ij->i", away, up)[:, None] * up
    return np.asarray(away / np.maximum(np.linalg.norm(away, axis=-1, keepdims=True), 1e-12))


def _global(turns: Array, joint: int) -> Array:
    """Return a joint's rotation, (frames, 4); that of the world above the roots."""
    return turns[:, joint] if joint >= 0 else np.broadcast_to(rotations.IDENTITY, (len(turns), 4))


def _relative(above: Array, turn: Array) -> Array:
    return rotations.multiply(rotations.conjugate(above), turn)

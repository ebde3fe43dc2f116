"""How the bundled explorer waits: breathing, shifting its weight, looking about, blinking."""

import numpy as np

from characters import rotations
from characters.authoring.human_motion import FOOT, SIDES, bent_elbow, hang_arm, turned
from characters.authoring.ik import aim
from characters.authoring.rig import Puppet
from characters.authoring.shapes import Array
from characters.clip import Clip
from characters.pose import Skeleton

RATE = 30.0
DURATION = 9.0
BREATHS = 3
TOE_OUT = 0.14
STRAP = np.array([0.165, 1.03, 0.145])
"""Where the left wrist is when the hand holds its strap, in the rest pose [m]."""

GRIP = ((-0.85, 0.5, -0.2), (0.4, 0.85, 0.0))
"""Where the fingers and the thumb of that hand point."""

BLINKS = (1.25, 4.3, 4.62, 7.5)
"""When the eyes are closed, the third a moment after the second [s]."""


def idle(skeleton: Skeleton) -> Clip:
    """Return a loop of nine seconds on planted feet."""
    frames = round(DURATION * RATE)
    time = np.arange(frames + 1) / RATE
    puppet = Puppet(skeleton, frames + 1)
    weight = _weight(time)
    breath = np.sin(2 * np.pi * BREATHS * time / DURATION)
    look, nod = _gaze(time)
    _stand(puppet, weight, breath)
    _hold_trunk(puppet, weight, breath, look, nod)
    _hold_arms(puppet, weight, breath, time)
    _take_straps(puppet, _glance(time, 4.6, 7.3, 0.75))
    return Clip("idle", RATE, puppet.pose, loop=True, root_motion=True)


def _weight(time: Array) -> Array:
    """Return where the weight is, −1 on the right leg … 1 on the left: held, then shifted."""
    phase = 2 * np.pi * (time / DURATION - 0.08)
    return np.asarray(np.tanh(2.2 * np.sin(phase)) / np.tanh(2.2))


def _gaze(time: Array) -> tuple[Array, Array]:
    """Return yaw and pitch of the head's glances, in degrees."""
    left = _glance(time, 2.1, 3.6, 0.42)
    right = _glance(time, 5.6, 7.0, 0.38)
    up = _glance(time, 5.75, 6.9, 0.5)
    drift = np.sin(2 * np.pi * time / DURATION + 0.7)
    return 24 * left - 19 * right + 2.5 * drift, 4 * left - 7 * up + 2 * drift


def _glance(time: Array, begin: float, end: float, ramp: float) -> Array:
    """Return 0, then 1 between two times, with soft borders and a touch of overshoot."""
    rise, fall = (np.clip((time - t) / ramp, 0.0, 1.0) for t in (begin, end))
    held = _soft(rise) - _soft(fall)
    settle = np.exp(-3.5 * np.clip(time - begin - ramp, 0.0, None))
    return np.asarray(held * (1 + 0.1 * settle * np.sin(np.pi * rise)))


def _soft(u: Array) -> Array:
    return np.asarray(u**3 * (u * (6 * u - 15) + 10))


def _blinks(time: Array) -> Array:
    """Return how far the lids are closed, 0…1: quickly shut, slowly open."""
    since = time[:, None] - np.array(BLINKS)
    shut = np.where(since < 0, 1 + since / 0.07, 1 - since / 0.13)
    return np.asarray(_soft(np.clip(shut, 0.0, 1.0)).max(axis=1))


def _stand(puppet: Puppet, weight: Array, breath: Array) -> None:
    """Carry the pelvis over the standing leg, the other hip dropped, and plant both feet."""
    side = 0.042 * weight
    drop = -0.016 + 0.006 * np.abs(weight) + 0.002 * breath
    puppet.shift("hips", np.stack([side, drop, -0.008 + 0 * side], axis=-1))
    puppet.turn("hips", turned(1, -4 * weight, 3.6 * weight))
    for name, sign in SIDES:
        still = np.ones((len(weight), 3))
        ankle = still * [sign * 0.118, FOOT.ankle, -0.012 + 0.014 * sign]
        facing = rotations.about("y", sign * TOE_OUT * still[:, 0])
        puppet.place_foot(name, ankle, facing, np.zeros(len(weight)))


def _hold_trunk(puppet: Puppet, weight: Array, breath: Array, look: Array, nod: Array) -> None:
    """Breathe, balance over the pelvis, and let the shoulders follow the head a little."""
    behind = np.roll(look[:-1], 5)  # the chest turns after the head
    follow = np.append(behind, behind[0])
    puppet.turn("spine1", turned(-0.6 * breath, 1.5 * weight + 0.05 * follow, -2.4 * weight))
    puppet.turn("spine2", turned(1.0 - 0.9 * breath, 1.5 * weight + 0.07 * follow, -2.4 * weight))
    puppet.turn("chest", turned(1.5 - 1.3 * breath, 0.08 * follow, -0.8 * weight))
    gaze = turned(-8 + nod + 0.5 * breath, look, 2.2 * weight - 0.10 * look)
    above = rotations.multiply(rotations.conjugate(puppet.facing("chest")), gaze)
    puppet.turn("neck", rotations.slerp(rotations.IDENTITY, above, 0.4))
    puppet.face("head", gaze)


def _hold_arms(puppet: Puppet, weight: Array, breath: Array, time: Array) -> None:
    """Let the arms hang, lifted by each breath and swaying after the shift of weight."""
    behind = np.roll(weight[:-1], 7)
    late = np.append(behind, behind[0])
    for side, sign in SIDES:
        slow = np.sin(2 * np.pi * 2 * time / DURATION + 1.3 * sign)
        lifted = np.roll(breath[:-1], 3)
        lift = np.append(lifted, lifted[0])
        puppet.turn(f"{side}Shoulder", turned(0, 0, sign * (1.6 * breath + 1.0)))
        hang_arm(puppet, side, sign, 3 + 2 * slow - 2 * lift, 24 + 2.2 * sign * late - 1.2 * lift)
        bend = 19 + 4 * slow + 2.5 * lift
        puppet.turn(f"{side}ForeArm", bent_elbow(puppet, side, sign, bend, 12 + 3 * slow))
        puppet.turn(f"{side}Hand", turned(-4 + 3 * slow, 0, -sign * (3 + 1.5 * lift)))


def _take_straps(puppet: Puppet, taken: Array) -> None:
    """Raise both hands to the straps of the backpack as far as `taken` says, 0…1."""
    for side, sign in SIDES:
        flip = np.array([sign, 1.0, 1.0])
        hand, elbow = puppet.places(f"{side}Hand"), puppet.places(f"{side}ForeArm")
        chest, turned_chest = puppet.places("chest"), puppet.facing("chest")
        strap = chest + rotations.rotate(turned_chest, STRAP * flip - puppet.rest("chest"))
        arc = 4 * taken * (1 - taken)
        t = taken[:, None]
        wrist = hand + (strap - hand) * t + arc[:, None] * flip * [0.06, 0.0, 0.05]
        out = rotations.rotate(turned_chest, flip * [0.9, -0.6, -0.25])
        hanging = elbow - 0.5 * (puppet.places(f"{side}Arm") + hand)
        hanging /= np.linalg.norm(hanging, axis=1, keepdims=True)
        grasp = rotations.rotate(turned_chest[:, None], np.array(GRIP) * flip)
        rest = puppet.rest(f"{side}Hand") - puppet.rest(f"{side}ForeArm")
        grip = aim(rest, [0.0, 0.0, 1.0], grasp[:, 0], grasp[:, 1])
        facing = rotations.slerp(puppet.facing(f"{side}Hand"), grip, taken)
        puppet.place_hand(side, wrist, facing, hanging + (out - hanging) * t)

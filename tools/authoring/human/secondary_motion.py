"""Secondary motion of the bundled explorer: backpack and hood.

Each is a damped spring on an accelerated mount. Its response to a repeating motion has a closed
form (`spring_follow`), so loops stay loops. Hair and strings are spring bones instead: see the file
`human.toml` beside the character.
"""

import numpy as np

from cubeling.characters.skeleton import rotations
from tools.authoring.human.limbs import rotation_deg
from tools.authoring.modelling.curves import soft_limited, spring_follow
from tools.authoring.modelling.rig import PosedRig
from tools.authoring.modelling.shapes import Array

GRAVITY_M_S2 = 9.81


def add_secondary_motion(rig: PosedRig, seconds: float, aside: float = 0.0) -> None:
    """Add the secondary motion of a body whose last frame equals its first.

    Parameters
    ----------
    seconds : duration of the motion
    aside : centripetal acceleration of the path, to the left [m/s²]
    """
    back = _felt_acceleration(rig, "chest", (0.0, 1.03, -0.2), seconds, aside)
    _swing_backpack(rig, back, seconds)
    flop = soft_limited(-0.9 * spring_follow(back[:, 1] - 0.5 * back[:, 2], seconds, 2.6, 0.35), 14)
    rig.turn("Hood", rotation_deg(x=_close_loop(-_soft_positive(flop, 4.0))))


def _swing_backpack(rig: PosedRig, pull: Array, seconds: float) -> None:
    """Let the backpack bounce and swing away from the back, but hardly into it."""
    bounce = soft_limited(-spring_follow(pull[:, 1], seconds, 3.4, 0.3) * 0.0009, 0.018)
    away = soft_limited(spring_follow(1.2 * pull[:, 2] - 0.5 * pull[:, 1], seconds, 2.8, 0.3), 9)
    sway = soft_limited(spring_follow(pull[:, 0], seconds, 2.4, 0.3) * -0.6, 6)
    rig.shift("Backpack", _close_loop(bounce)[:, None] * [0.0, 1.0, 0.0])
    rig.turn(
        "Backpack", rotation_deg(x=_close_loop(_soft_positive(away, 2.0)), z=_close_loop(sway))
    )


def _soft_positive(angle: Array, soft: float) -> Array:
    """Return an angle that is hardly negative, with a rounded kink [degrees]."""
    return np.asarray((angle + np.hypot(angle, soft)) / 2 - soft / 2)


def _felt_acceleration(
    rig: PosedRig, joint: str, point: tuple[float, float, float], seconds: float, aside: float
) -> Array:
    """Return the acceleration of a point in the axes of its joint, (frames − 1, 3) [m/s²].

    It includes the change of gravity in these axes as the joint leans.
    """
    facing = rig.facing(joint)
    place = rig.places(joint) + rotations.rotate(facing, point - rig.rest(joint))
    place, facing = place[:-1], facing[:-1]
    step = seconds / len(place)
    change = np.roll(place, -1, axis=0) - 2 * place + np.roll(place, 1, axis=0)
    felt = change / step**2 + [aside, GRAVITY_M_S2, 0.0]
    felt = rotations.rotate(rotations.conjugate(facing), felt)
    return np.asarray(felt - [0.0, GRAVITY_M_S2, 0.0])


def _close_loop(curve: Array) -> Array:
    return np.append(curve, curve[0])

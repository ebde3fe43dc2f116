"""Fingers that are never quite still: they curl and open a little, slowly, each in its own time."""

import math

import numpy as np

from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.smoothing import low_pass

CURL_DEG = (4.0, 5.0, 3.0)
"""Amplitude of the curl of a knuckle and of the joints after it [degrees]."""

THUMB_SHARE = 0.5
"""Part of that which a thumb curls."""

TALKING_SHARE = 1.6
"""Their size and pace while one speaks ÷ those in silence."""

LAG_S = 0.5
"""Time constant with which they go over from one to the other [s]."""

SLOWEST_HZ, FASTEST_HZ = 0.06, 0.21
"""Rates of their waves [Hz]."""

HAND_SHARE = 0.7
"""Size of the wave that the fingers of a hand share ÷ that of each finger's own."""


class FingersLayer:
    """Curls the fingers of a body that has some; it comes before what gives hands a shape."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        hands = character.upper_body.shapes.hands.values()
        fingers = [
            (hand, name, joints)
            for hand in hands
            if hand is not None
            for name, joints in hand.fingers.items()
        ]
        skeleton = character.skeleton
        frames = skeleton.rest.globals(skeleton)[:, :3, :3]
        turned, axes, owners = [], [], []
        for number, (hand, name, joints) in enumerate(fingers):
            along, _, palm = hand.axes
            axis = np.cross(along, palm)
            share = THUMB_SHARE if name == "Thumb" else 1.0
            for joint, degrees in zip(joints, CURL_DEG, strict=False):
                turn = frames[joint] / np.linalg.norm(frames[joint], axis=0)
                axes.append(math.radians(share * degrees) * (axis @ turn))
                owners.append(number)
                turned.append(joint)
        self._joints = np.array(turned, np.intp)
        halves = 0.5 * np.array(axes).reshape(-1, 3)
        pure = np.concatenate([halves, np.zeros((len(halves), 1))], axis=1)
        # What is multiplied from the right by half a rotation vector, as a matrix for columns.
        self._halves = rotations.multiply(np.eye(4), pure[:, None]).swapaxes(1, 2).copy()
        self._squares = np.vecdot(halves, halves)[:, None]
        rng = np.random.default_rng([seed, 6])
        # A wave for each finger, then one for each hand.
        rates = math.tau * rng.uniform(SLOWEST_HZ, FASTEST_HZ, len(fingers) + 2)
        phases = rng.uniform(0.0, math.tau, len(fingers) + 2)
        shared = [len(fingers) + (fingers[number][0].side == "right") for number in owners]
        # For each joint that of its finger and that of its hand, (2, joints).
        waves = np.array([owners, shared], np.intp)
        self._rates, self._phases = rates[waves], phases[waves]
        self._time, self._size = 0.0, 1.0

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with its fingers curled."""
        wanted = TALKING_SHARE if context.speaking.talking else 1.0
        self._size = low_pass(self._size, wanted, context.elapsed, LAG_S)
        self._time += context.elapsed * context.expressivity.tempo * self._size
        size = self._size * context.rest * context.expressivity.amplitude
        if not len(self._joints) or size < 1e-3:
            return pose
        own_waves, shared_waves = np.sin(self._rates * self._time + self._phases)
        sines = (size * (own_waves + HAND_SHARE * shared_waves))[:, None]
        local = pose.rotations.copy()
        own = local.take(self._joints, 0)
        # Half angles so small are their sines, to a thousandth.
        across = np.vecdot(self._halves, own[:, None])
        local[self._joints] = np.sqrt(1.0 - self._squares * sines * sines) * own + sines * across
        return pose.with_rotations(local)

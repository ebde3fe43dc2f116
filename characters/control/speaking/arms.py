"""Arms that live while one speaks: elbows leave the ribs, and a resting hand takes part."""

import math
from collections.abc import Sequence

import numpy as np

from cubeling.characters.body.axes import body_axes
from cubeling.characters.control.speaking.beats import pulses, syllable_swing
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.smoothing import smoothstep
from cubeling.characters.speech.speech import Accent, Syllable

ARM_MOVEMENTS = ("swing forward", "swing out", "bend elbow", "bend wrist")
"""What one arm does [degrees each]."""

OPEN_DEG = np.array([4.0, 9.0, 14.0, 0.0])
"""How an arm is held while one speaks, beside how it hangs."""

STROKE_DEG = np.array([3.5, 2.5, 11.0, -7.0])
"""How far it is raised and brought down with the strongest accent."""

SWING_DEG = np.array([0.8, 0.0, 4.0, 5.0])
"""How far it goes from one loud syllable to the next."""

DRIFT_DEG = np.array([1.6, 1.2, 3.0, 2.0])
"""Amplitude of its slow waves."""

DRIFT_HZ = 0.12, 0.38
"""Slowest and fastest wave [Hz]."""

STROKE_KEYS = ((-0.55, 0.0), (-0.2, 1.0), (0.0, -0.35), (0.6, 0.0))
"""A beat of a resting hand, from the accent [s]: up, down through the accent, and back."""

LEAD_S, TAIL_S = 0.3, 0.9
"""From how long before a speech to how long after it the arms live [s]."""

JOIN_S = 1.5
"""How long they take to that: quicker, an arm at rest swings out before the first word [s]."""


def arm_movement(
    times: Array,
    accents: Sequence[Accent],
    syllables: Sequence[Syllable],
    end: float,
    rng: np.random.Generator,
) -> Array:
    """Return what the left and the right arm do at `times` [s] of a speech, (times, 8) [degrees].

    `end` is that of its sound [s].
    """
    strengths = np.array([each.strength for each in accents])
    # One hand leads in each beat; the other one joins in.
    shares = rng.uniform(0.35, 1.0, (len(accents), 2))
    strokes = strengths[:, None, None] * shares[..., None] * STROKE_DEG
    swings = np.concatenate([SWING_DEG, SWING_DEG * rng.uniform(0.5, 0.8)])
    rates = math.tau * rng.uniform(*DRIFT_HZ, 2 * len(ARM_MOVEMENTS))
    phases = rng.uniform(0.0, math.tau, 2 * len(ARM_MOVEMENTS))
    here = smoothstep(((times + LEAD_S) / JOIN_S).clip(0.0, 1.0))
    here *= smoothstep(((end + TAIL_S - times) / TAIL_S).clip(0.0, 1.0))
    held = np.tile(OPEN_DEG, 2) + np.sin(np.outer(times, rates) + phases) * np.tile(DRIFT_DEG, 2)
    held += np.outer(syllable_swing(times, syllables), swings)
    sizes = strokes.reshape(len(accents), 2 * len(ARM_MOVEMENTS))
    found: Array = here[:, None] * held
    return found + pulses(times, [each.time for each in accents], sizes, STROKE_KEYS)


class ArmJoints:
    """The joints of one body's arms that a speech turns."""

    def __init__(self, skeleton: Skeleton, anatomy: Anatomy) -> None:
        places = skeleton.rest.globals(skeleton)[:, :3, 3]
        rows: list[tuple[int, Array]] = []
        for arm, side in enumerate(SIDES if anatomy.kind == "humanoid" else ()):
            chain = [anatomy.joint(side + part) for part in ("UpperArm", "LowerArm", "Hand")]
            joints = [joint for joint in chain if joint is not None]
            if len(joints) < len(chain):
                continue
            upper, lower, hand = joints
            bones = places[lower] - places[upper], *[places[hand] - places[lower]] * 2
            for joint, bone, forward in zip(joints, bones, (0, 2, 3), strict=True):
                # A turn about bone × ahead brings the bone ahead, whether arms rest down or out.
                ahead = np.cross(bone, [0.0, 0.0, 1.0])
                weights = np.zeros((2, len(ARM_MOVEMENTS), 3))
                weights[arm, forward] = ahead / max(float(np.linalg.norm(ahead)), 1e-9)
                if joint == upper:
                    weights[arm, 1, 2] = 1.0 if side == "left" else -1.0
                rows.append((joint, weights))
        self._joints = np.array([joint for joint, _ in rows], np.intp)
        axes = body_axes(skeleton, self._joints)
        weights = np.array([each for _, each in rows]).reshape(len(rows), 2 * len(ARM_MOVEMENTS), 3)
        # From what both arms do [degrees] to rotation vectors in the joints' frames.
        self._vectors = np.radians(np.einsum("jab,jdb->jad", axes, weights))

    def turn(self, pose: Pose, degrees: Array) -> Pose:
        """Return a pose with its arms turned by what they do, (8,) [degrees]."""
        if not len(self._joints):
            return pose
        turns = rotations.from_rotation_vector(self._vectors @ degrees)
        local = pose.rotations.copy()
        local[self._joints] = rotations.multiply(local.take(self._joints, 0), turns)
        return pose.with_rotations(local)

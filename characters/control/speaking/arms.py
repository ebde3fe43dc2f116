"""Arms that live while one speaks: elbows leave the ribs, and a resting hand takes part."""

import math
from collections.abc import Sequence

import numpy as np

from cubeling.characters.body.axes import body_axes
from cubeling.characters.control.speaking.beats import Pulses, SyllableSwing
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.smoothing import smoothstep
from cubeling.characters.speech.speech import Accent, Syllable

DOFS = ("swing forward", "swing out", "bend elbow", "bend wrist")
"""What one arm does [degrees each]."""

OPEN_DEG = np.array([4.0, 12.0, 12.0, 0.0])
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

LEAD_S, TAIL_S = 0.5, 0.9
"""From how long before a speech to how long after it the arms live [s]."""


class SpeakingArms:
    """The arms in one speech, planned for the whole of it."""

    def __init__(
        self,
        accents: Sequence[Accent],
        syllables: Sequence[Syllable],
        end: float,
        rng: np.random.Generator,
    ) -> None:
        self.end = end + TAIL_S
        """When they rest again [s]."""
        strengths = np.array([each.strength for each in accents])
        # One hand leads in each beat; the other one joins in.
        shares = rng.uniform(0.35, 1.0, (len(accents), 2))
        sizes = strengths[:, None, None] * shares[..., None] * STROKE_DEG
        self._strokes = Pulses(
            [each.time for each in accents], sizes.reshape(len(accents), 2 * len(DOFS)), STROKE_KEYS
        )
        self._swing = SyllableSwing(syllables)
        self._swings = np.stack([SWING_DEG, SWING_DEG * rng.uniform(0.5, 0.8)])
        self._rates = math.tau * rng.uniform(*DRIFT_HZ, (2, len(DOFS)))
        self._phases = rng.uniform(0.0, math.tau, (2, len(DOFS)))

    def at(self, time: float) -> Array:
        """Return what the left and right arm do at a time of the speech [s], (2, 4) [degrees]."""
        here = smoothstep(min(max((time + LEAD_S) / LEAD_S, 0.0), 1.0))
        here *= smoothstep(min(max((self.end - time) / TAIL_S, 0.0), 1.0))
        turns: Array = np.sin(self._rates * time + self._phases) * DRIFT_DEG
        turns += OPEN_DEG
        turns *= here
        turns += self._strokes.at(time).reshape(2, -1)
        turns += self._swings * self._swing.at(time)
        return turns


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
                weights = np.zeros((2, len(DOFS), 3))
                weights[arm, forward] = ahead / max(float(np.linalg.norm(ahead)), 1e-9)
                if joint == upper:
                    weights[arm, 1, 2] = 1.0 if side == "left" else -1.0
                rows.append((joint, weights))
        self._joints = np.array([joint for joint, _ in rows], np.intp)
        axes = body_axes(skeleton, self._joints)
        weights = np.array([each for _, each in rows]).reshape(len(rows), 2 * len(DOFS), 3)
        # From what both arms do [degrees] to rotation vectors in the joints' frames.
        self._vectors = np.radians(np.einsum("jab,jdb->jad", axes, weights))

    def turn(self, pose: Pose, degrees: Array) -> Pose:
        """Return a pose with its arms turned by what they do, (2, 4) [degrees]."""
        if not len(self._joints):
            return pose
        turns = rotations.from_rotation_vector(self._vectors @ degrees.ravel())
        local = pose.rotations.copy()
        local[self._joints] = rotations.multiply(local[self._joints], turns)
        return Pose(pose.translations, local, pose.scales, pose.morphs)

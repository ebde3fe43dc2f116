"""Stances and faces that a command's behaviour asks for."""

import math

import numpy as np

from cubeling.characters.behaviour.intents import GazeIntent, Influence
from cubeling.characters.behaviour.realization.face_names import FaceNames
from cubeling.characters.behaviour.realization.planned_values import PlannedValues
from cubeling.characters.behaviour.realization.stances import StanceJoints
from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.control.layers.posture import posture_share
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.smoothing import damped_spring

TURN_SHARES: dict[Influence, tuple[float, float]] = {
    "SHOULDER": (0.0, 0.45),
    "WAIST": (0.12, 0.55),
    "WHOLE": (0.12, 0.55),
}
"""Shares of the way to what is looked at that pelvis and trunk turn, if they join in."""

QUADRUPED_SHARE = 0.45
"""Part of that which a body on four legs turns: its trunk carries the forelegs."""

MAX_TURN_RAD = math.radians(50.0)
"""How far a body turns at most to look at something, pelvis and trunk together [rad]."""

TURN_LAG_S = 0.5
"""Lag with which it turns [s]."""

STANCE_BLEND_S = 1.0
"""In which time a body leaves a stance for another, or is upright again [s]: as long as a posture
of BML usually takes to come."""

NEGLIGIBLE_RAD = 1e-4
"""Turn that cannot be seen [rad]."""


class StanceLayer:
    """Sits, crouches, leans, turns the trunk to what is looked at, and joins in what is said.

    The feet stay.
    """

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._joints = StanceJoints(character.skeleton, character.anatomy)
        self._values = PlannedValues(StanceJoints.VALUES, STANCE_BLEND_S)
        self._turns = ((0.0, 0.0), (0.0, 0.0))
        self._turning = False
        self._share = QUADRUPED_SHARE if character.anatomy.kind == "quadruped" else 1.0

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose in its stance."""
        behaviour, now = context.command.behaviour, context.command.timestamp
        postures = () if behaviour is None else behaviour.postures
        values = self._values.update(
            tuple((each.key, each.name, each.times) for each in postures),
            lambda time: self._joints.values(postures, time),
            now,
        )
        turns = self._turn_to_gaze(context)
        share, spoken = posture_share(context), context.speaking.stance
        values = values * share
        if spoken is not None:
            values += spoken * self._share
        still = spoken is None and self._values.resting  # else values may be zeros all the same
        if not self._joints.able or not (self._turning or (not still and values.any())):
            return pose
        return self._joints.apply(pose, values, turns[0] * share, turns[1] * share)

    def _turn_to_gaze(self, context: FrameContext) -> tuple[float, float]:
        """Return how far pelvis and trunk turn to what is looked at [rad], to the left."""
        gaze = gaze_of(context)
        shares = (0.0, 0.0) if gaze is None else TURN_SHARES.get(gaze.influence, (0.0, 0.0))
        if not self._turning and not any(shares):
            return 0.0, 0.0
        yaw = 0.0 if gaze is None else self._share * _yaw(context.in_character(gaze.target))
        lag = TURN_LAG_S if gaze is None else lag_of(gaze)
        yaw = min(max(yaw * sum(shares), -MAX_TURN_RAD), MAX_TURN_RAD) / max(sum(shares), 1e-9)
        hips, trunk = (
            damped_spring(*turn, yaw * share, context.elapsed, lag)
            for turn, share in zip(self._turns, shares, strict=True)
        )
        self._turns = hips, trunk
        self._turning = any(shares) or max(map(abs, (*hips, *trunk))) > NEGLIGIBLE_RAD
        return hips[0], trunk[0]


class FaceShiftLayer:
    """Shows expressions and action units; it comes before blinks, emotion and speech."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._names = FaceNames(character.morphs)
        self._values = PlannedValues(len(character.morphs))

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with these expressions."""
        behaviour, now = context.command.behaviour, context.command.timestamp
        faces = () if behaviour is None else behaviour.faces
        weights = self._values.update(
            tuple((each.key, each.names, each.weights, each.times) for each in faces),
            lambda time: self._names.morph_weights(faces, time),
            now,
        )
        if self._values.resting or not weights.any():
            return pose
        shown: Array = weights if pose.morphs is None else pose.morphs + weights
        return pose.with_morphs(np.minimum(shown, 1.0))


def gaze_of(context: FrameContext) -> GazeIntent | None:
    """Return the look that counts in a frame: the last one that has begun and does not relax."""
    behaviour, now = context.command.behaviour, context.command.timestamp
    found = None
    for gaze in () if behaviour is None else behaviour.gazes:
        relax = gaze.times.relax if gaze.times.relax is not None else gaze.times.end
        if gaze.times.start <= now and (relax is None or now < relax):
            found = gaze
    return found


def lag_of(gaze: GazeIntent) -> float:
    """Return the lag with which a head is on a point when a look is `ready` [s].

    A critically damped spring has 98 % of its way behind it after three lags.
    """
    return min(max((gaze.times.ready - gaze.times.start) / 3.0, 0.06), 1.0)


def _yaw(point: Array) -> float:
    """Return the direction of a point in the character frame, to the left [rad]."""
    return math.atan2(float(point[0]), float(point[2]))

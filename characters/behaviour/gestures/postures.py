"""Postures of the whole body at the key frames of a gesture (Huang 2013, section 8.6).

The trunk is turned, the gesture space turns with it, and the upper body reaches for its places.
"""

import math
from collections.abc import Mapping

import numpy as np

from cubeling.characters.behaviour.gestures.body import GestureBody
from cubeling.characters.behaviour.gestures.gathering import KeyFrame
from cubeling.characters.behaviour.gestures.tracks import ORIENTATION, POSITION, SHAPES
from cubeling.characters.ik.reaching import HandTarget, ReachStyle
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose

EASY, STRETCHED = 0.75, 0.95
"""Distances of a wrist from its shoulder ÷ the arm's length: as asked for below, never above."""

STRETCHED_ON_FOUR = 0.8
"""The same for front legs, whose trunk would else stretch after them."""


class KeyPostures:
    """Makes the postures of one gesture of one body."""

    def __init__(self, body: GestureBody, style: ReachStyle) -> None:
        self.body = body
        self.style = style
        self._four_legs = body.character.anatomy.kind == "quadruped"
        upright = body.posture.globals(body.character.skeleton)[body.chest]
        self._joint_from_chest = np.linalg.pinv(upright)
        self._turned_postures: dict[bytes, tuple[Pose, Array]] = {}

    def turn_by(self, row: Array) -> tuple[Pose, Array]:
        """Return the posture with trunk and head turned by a row of the body's track.

        With it comes `character_from_joint` of all joints, (joints, 4, 4).
        """
        key = row.tobytes()
        if key not in self._turned_postures:
            pose = self.body.trunk.turn_by(self.body.posture, row)
            self._turned_postures[key] = pose, pose.globals(self.body.character.skeleton)
        return self._turned_postures[key]

    def chest(self, posed: Array) -> tuple[Array, Array]:
        """Return how the chest is turned from its posture, (3, 3), and the space's middle, (3,)."""
        moved = posed[self.body.chest] @ self._joint_from_chest
        turn = moved[:3, :3]
        return turn, turn @ self.body.space.chest + moved[:3, 3]

    def posture(self, frame: KeyFrame, shapes: Mapping[str, tuple[str, ...]]) -> Pose:
        """Return the whole body at a key frame; `shapes` has a name for each weight of a hand."""
        pose, posed = self.turn_by(frame.parts["body"])
        turn, chest = self.chest(posed)
        targets = {}
        for side in shapes:
            row = frame.parts[side]
            hand = turn @ rotations.to_matrix(rotations.normalize(row[ORIENTATION]))
            fingers, palm = hand[:, 0], hand[:, 2]
            place = self._within_reach(turn @ row[POSITION] + chest, fingers, side, posed)
            targets[side] = HandTarget(place, "reach", palm, fingers)
        if targets:
            pose = self.body.body.reach(
                pose, targets.get("left"), targets.get("right"), self.style
            )  # a new pose, whose fingers may be bent
        for side, names in shapes.items():
            self._shape(pose, side, names, frame.parts[side][SHAPES])
        return pose

    def _within_reach(self, place: Array, fingers: Array, side: str, posed: Array) -> Array:
        """Return where a palm is to be, so that the wrist is not too far from its shoulder, (3,).

        Who gestures shows where something is and need not get there: what is out of reach is
        compressed into the last part of the way, and the torso leans only a little.
        """
        arm = self.body.body.arms[side]
        palm = float(np.linalg.norm(np.subtract(arm.hand.palm, arm.wrist)))
        offset = place - palm * fingers - posed[arm.joints[1], :3, 3]
        distance = float(np.linalg.norm(offset)) / (arm.upper + arm.fore)
        most = STRETCHED_ON_FOUR if self._four_legs else STRETCHED
        beyond = (distance - EASY) / (most - EASY)
        if beyond <= 0.0:
            return place
        taken = EASY + (most - EASY) * -math.expm1(-beyond)
        nearer: Array = place - offset * (1.0 - taken / distance)
        return nearer

    def _shape(self, pose: Pose, side: str, shapes: tuple[str, ...], weights: Array) -> None:
        """Bend the fingers of a pose of our own."""
        postures = [self.body.body.shapes.posture(side, shape) for shape in shapes]
        if len(postures[0].joints):
            turns = rotations.align(
                np.stack([each.rotations for each in postures]), postures[0].rotations
            )
            mixed = np.einsum("s,sji->ji", weights, turns)
            pose.rotations[postures[0].joints] = rotations.normalize(mixed)

"""The body of a character, as far as gestures need it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.behaviour.gestures.place.contacts import ContactPoints
from cubeling.characters.behaviour.gestures.place.space import GestureSpace
from cubeling.characters.behaviour.gestures.style.trunk import TrunkTurns, chest_part
from cubeling.characters.ik.reaching import UpperBody
from cubeling.characters.ik.sitting_up import SittingUp
from cubeling.characters.model.character import Character
from cubeling.characters.model.standing import idle_clips
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Pose

SIDES = {"left": True, "right": False}
"""Sides of hands, and whether they are left."""


@dataclass(frozen=True, eq=False)
class GestureBody:
    """What a character gestures with."""

    character: Character

    posture: Pose
    """How it stands while it gestures; a four-legged one sits up."""

    body: UpperBody
    """Its torso and arms, for reaching."""

    trunk: TrunkTurns
    """Its trunk, shoulders and head."""

    surface: ContactPoints
    """Where it can be touched."""

    space: GestureSpace
    """Its gesture space in the posture."""

    chest: int
    """The joint that carries the gesture space."""

    arms: Mapping[str, NDArray[np.intp]]
    """Joints of collarbone, arm, hand and fingers by side."""

    @classmethod
    def measure(cls, character: Character) -> Self:
        """Return what a character gestures with."""
        skeleton, anatomy = character.skeleton, character.anatomy
        idle = idle_clips(character.clips)
        posture = idle[0].sample(0.0) if idle else skeleton.rest
        sitting = SittingUp.of(skeleton, anatomy)
        if sitting is not None:
            posture = sitting.sit_up(posture, 1.0)
        body = UpperBody.of(skeleton, anatomy)
        surface = ContactPoints(skeleton, anatomy, character.meshes, posture)
        joints = {}
        for side, arm in body.arms.items():
            collarbone, upper, *_ = arm.joints
            below = subtree(skeleton, upper)
            joints[side] = np.array([*([collarbone] if collarbone >= 0 else []), *below], np.intp)
        chest = anatomy.joint(chest_part(anatomy)) if "hips" in anatomy.joints else None
        return cls(
            character,
            posture,
            body,
            TrunkTurns.of(skeleton, anatomy, posture),
            surface,
            _space(character, posture, body),
            0 if chest is None else chest,
            joints,
        )


def _space(character: Character, posture: Pose, body: UpperBody) -> GestureSpace:
    """Return the gesture space of a body in a posture; without arms, one of usual size."""
    if not body.arms:
        height = character.height
        return GestureSpace(np.array([0.0, 0.6 * height, 0.0]), 0.3 * height)
    posed = posture.globals(character.skeleton)
    shoulders = posed[[each.joints[1] for each in body.arms.values()], :3, 3].mean(0)
    return GestureSpace.about(shoulders, arm_length(body))


def arm_length(body: UpperBody) -> float:
    """Return the mean length of its arms, shoulder to wrist [m]."""
    return float(np.mean([each.upper + each.fore for each in body.arms.values()]))

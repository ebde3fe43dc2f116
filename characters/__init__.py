"""Characters: skeletons, motions, and the pictures of them.

Commands come in, posed characters and their pictures go out; this room knows no camera, no cube
and no robot. Start with `Character.load` and `Animator`.
"""

from characters.control.animator import Animator
from characters.control.command import (
    ActionIntent,
    CharacterCommand,
    LocomotionIntent,
    PosedCharacter,
)
from characters.control.controllers import CONTROLLER_CHOICES, choose_controller
from characters.errors import CharacterError, CharacterWarning
from characters.formats import load_motion  # importing formats registers the file readers
from characters.locomotion.footfalls import Footfall, Footfalls
from characters.locomotion.gaits import IDLE_SPEED, RUN_SPEED
from characters.locomotion.paths import ClosedPath
from characters.model.character import Character
from characters.model.mesh import Material, Mesh, Morph
from characters.model.mirroring import mirror_of
from characters.motion.blend import Blend, BlendSpace1D, BlendSpace2D
from characters.motion.clip import Clip
from characters.motion.crossfade import CrossFade
from characters.motion.curves import Adsr, Curve, FadeCurve, Keyed, Product
from characters.motion.layers import AdditiveLayer, MaskedLayer
from characters.motion.mirror import Mirror, Mirrored
from characters.motion.modifiers import Loop, RootOffset, Stretch, TimeCurve, Warped, Window
from characters.motion.motion import Motion, RootDelta
from characters.motion.schedule import Action, LiveSchedule, Schedule
from characters.motion.state_machine import StateMachine
from characters.skeleton.masks import Mask, mask_of
from characters.skeleton.pose import Pose, Skeleton

__all__ = [
    "CONTROLLER_CHOICES",
    "IDLE_SPEED",
    "RUN_SPEED",
    "Action",
    "ActionIntent",
    "AdditiveLayer",
    "Adsr",
    "Animator",
    "Blend",
    "BlendSpace1D",
    "BlendSpace2D",
    "Character",
    "CharacterCommand",
    "CharacterError",
    "CharacterWarning",
    "Clip",
    "ClosedPath",
    "CrossFade",
    "Curve",
    "FadeCurve",
    "Footfall",
    "Footfalls",
    "Keyed",
    "LiveSchedule",
    "LocomotionIntent",
    "Loop",
    "Mask",
    "MaskedLayer",
    "Material",
    "Mesh",
    "Mirror",
    "Mirrored",
    "Morph",
    "Motion",
    "Pose",
    "PosedCharacter",
    "Product",
    "RootDelta",
    "RootOffset",
    "Schedule",
    "Skeleton",
    "StateMachine",
    "Stretch",
    "TimeCurve",
    "Warped",
    "Window",
    "choose_controller",
    "load_motion",
    "mask_of",
    "mirror_of",
]

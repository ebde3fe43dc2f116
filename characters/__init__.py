"""Characters: skeletons, motions, and the pictures of them.

Commands come in, posed characters and their pictures go out; this room knows no camera, no cube
and no robot. Start with `Character.load` and `Animator`.
"""

from cubeling.characters.control.animator import Animator
from cubeling.characters.control.command import (
    ActionIntent,
    CharacterCommand,
    LocomotionIntent,
    PosedCharacter,
)
from cubeling.characters.control.controllers import CONTROLLER_CHOICES, choose_controller
from cubeling.characters.errors import CharacterError, CharacterWarning
from cubeling.characters.formats import load_motion  # importing formats registers the file readers
from cubeling.characters.locomotion.footfalls import Footfall, Footfalls
from cubeling.characters.locomotion.gaits import IDLE_SPEED, RUN_SPEED
from cubeling.characters.locomotion.paths import ClosedPath
from cubeling.characters.model.character import Character
from cubeling.characters.model.mesh import Material, Mesh, Morph
from cubeling.characters.model.mirroring import mirror_of
from cubeling.characters.motion.blend import Blend, BlendSpace1D, BlendSpace2D
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.crossfade import CrossFade
from cubeling.characters.motion.curves import Adsr, Curve, FadeCurve, Keyed, Product
from cubeling.characters.motion.layers import AdditiveLayer, MaskedLayer
from cubeling.characters.motion.mirror import Mirror, Mirrored
from cubeling.characters.motion.modifiers import (
    Loop,
    RootOffset,
    Stretch,
    TimeCurve,
    Warped,
    Window,
)
from cubeling.characters.motion.motion import Motion, RootDelta
from cubeling.characters.motion.schedule import Action, LiveSchedule, Schedule
from cubeling.characters.motion.state_machine import StateMachine
from cubeling.characters.skeleton.masks import Mask, mask_of
from cubeling.characters.skeleton.pose import Pose, Skeleton

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

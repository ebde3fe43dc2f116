"""Characters: skeletons, motions, and the pictures of them.

Commands come in, posed characters and their pictures go out; this room knows no camera, no cube
and no robot. Start with `Character.load` and `Animator`.
"""

from characters.animator import Animator
from characters.blend import Blend, BlendSpace1D, BlendSpace2D
from characters.character import Character
from characters.clip import Clip
from characters.command import CharacterCommand, PosedCharacter
from characters.crossfade import CrossFade
from characters.curves import Adsr, Curve, FadeCurve, Keyed, Product
from characters.errors import CharacterError, CharacterWarning
from characters.layers import Added, Layered
from characters.machine import StateMachine
from characters.masks import Mask, mask_of
from characters.mesh import Material, Mesh, Morph
from characters.mirror import Mirror, Mirrored
from characters.modifiers import Displaced, Loop, Stretch, TimeCurve, Warped, Window
from characters.motion import Motion, Step
from characters.path import ClosedPath
from characters.pose import Pose, Skeleton
from characters.schedule import Action, LiveSchedule, Schedule

__all__ = [
    "Action",
    "Added",
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
    "Displaced",
    "FadeCurve",
    "Keyed",
    "Layered",
    "LiveSchedule",
    "Loop",
    "Mask",
    "Material",
    "Mesh",
    "Mirror",
    "Mirrored",
    "Morph",
    "Motion",
    "Pose",
    "PosedCharacter",
    "Product",
    "Schedule",
    "Skeleton",
    "StateMachine",
    "Step",
    "Stretch",
    "TimeCurve",
    "Warped",
    "Window",
    "mask_of",
]

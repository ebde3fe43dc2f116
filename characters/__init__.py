"""Characters: skeletons, motions, and the pictures of them.

Commands come in, posed characters and their pictures go out; this room knows no camera, no cube
and no robot. Start with `Character.load` and `Animator`.
"""

from characters.animator import Animator
from characters.blend import Blend, BlendSpace1D, BlendSpace2D
from characters.character import Character
from characters.clip import Clip
from characters.command import CharacterCommand, PosedCharacter
from characters.errors import CharacterError
from characters.machine import StateMachine
from characters.mesh import Material, Mesh, Morph
from characters.motion import Motion, Step
from characters.path import ClosedPath
from characters.pose import Pose, Skeleton

__all__ = [
    "Animator",
    "Blend",
    "BlendSpace1D",
    "BlendSpace2D",
    "Character",
    "CharacterCommand",
    "CharacterError",
    "Clip",
    "ClosedPath",
    "Material",
    "Mesh",
    "Morph",
    "Motion",
    "Pose",
    "PosedCharacter",
    "Skeleton",
    "StateMachine",
    "Step",
]

"""Characters: skeletons, motions, and the pictures of them.

Commands come in, posed characters and their pictures go out; this room knows no camera, no cube
and no robot. Start with `Character.load` and `Animator`.
"""

from characters.character import Character
from characters.clip import Clip
from characters.command import CharacterCommand, PosedCharacter
from characters.errors import CharacterError
from characters.mesh import Material, Mesh
from characters.motion import Motion, Step
from characters.pose import Pose, Skeleton

__all__ = [
    "Character",
    "CharacterCommand",
    "CharacterError",
    "Clip",
    "Material",
    "Mesh",
    "Motion",
    "Pose",
    "PosedCharacter",
    "Skeleton",
    "Step",
]

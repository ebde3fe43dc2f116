"""The bundled human: an explorer in a hoodie, with a backpack, and its clips.

Toy proportions, three and a half heads high, keep head, hands and shoes legible at small size.
"""

from cubeling.characters.model.character import Character
from cubeling.characters.model.mesh import Material, Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.human.actions import actions
from tools.authoring.human.eyes import eyeballs
from tools.authoring.human.face import EXPRESSIONS
from tools.authoring.human.head import head_pieces
from tools.authoring.human.idle import idle
from tools.authoring.human.motion import locomotion
from tools.authoring.human.outfit import cords, outfit_meshes, ribbing
from tools.authoring.human.rig import build_human_skeleton
from tools.authoring.human.shoes import soles_and_laces
from tools.authoring.modelling.meshes import join


def build_human() -> Character:
    """Return the character; the result is always the same."""
    skeleton = build_human_skeleton()
    clips = {"idle": idle(skeleton), **locomotion(skeleton), **actions(skeleton)}
    return Character("human", skeleton, clips, _meshes(skeleton), morphs=tuple(EXPRESSIONS))


def _meshes(skeleton: Skeleton) -> tuple[Mesh, ...]:
    """Return the matt body and the glossy eyes."""
    pieces = [*outfit_meshes(skeleton), *head_pieces(skeleton), *cords(skeleton)]
    pieces += [*ribbing(skeleton), *soles_and_laces(skeleton)]
    body = join("explorer", pieces, Material(roughness=0.75))
    return body, join("eyes", eyeballs(skeleton), Material(roughness=0.15))

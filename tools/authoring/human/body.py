"""The bundled explorer's meshes: a young person in a hoodie, with a backpack.

Toy proportions, three and a half heads high, keep head, hands and shoes legible at small size.
"""

from characters.model.mesh import Material, Mesh
from characters.skeleton.pose import Skeleton
from tools.authoring.human.eyes import eyeballs
from tools.authoring.human.head import head_pieces
from tools.authoring.human.outfit import cords, outfit_meshes, ribbing
from tools.authoring.human.shoes import soles_and_laces
from tools.authoring.modelling.meshes import join


def build_human_meshes(skeleton: Skeleton) -> tuple[Mesh, ...]:
    """Return the matt body and the glossy eyes."""
    pieces = [
        *outfit_meshes(skeleton),
        *head_pieces(skeleton),
        *cords(skeleton),
        *ribbing(skeleton),
    ]
    pieces += soles_and_laces(skeleton)
    body = join("explorer", pieces, Material(roughness=0.75))
    return body, join("eyes", eyeballs(skeleton), Material(roughness=0.15))

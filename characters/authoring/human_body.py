"""The bundled explorer's body: a young person in a hoodie, with a backpack.

Toy proportions, three and a half heads high, so that head, hands and shoes read at a hand's height
on the table.
"""

from characters.authoring.human_eyes import eyeballs
from characters.authoring.human_head import head_pieces
from characters.authoring.human_outfit import cords, outfit, ribbing
from characters.authoring.human_shoes import soles_and_laces
from characters.authoring.sculpt import join
from characters.mesh import Material, Mesh
from characters.pose import Skeleton


def build_human_meshes(skeleton: Skeleton) -> tuple[Mesh, ...]:
    """Return the body, matt, and the eyes, glossy."""
    pieces = [*outfit(skeleton), *head_pieces(skeleton), *cords(skeleton), *ribbing(skeleton)]
    pieces += soles_and_laces(skeleton)
    body = join("explorer", pieces, Material(roughness=0.75))
    return body, join("eyes", eyeballs(skeleton), Material(roughness=0.15))

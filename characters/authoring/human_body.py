"""The bundled explorer's body: a young person in a hoodie, with a backpack.

Toy proportions, four heads high, so that head, shoulders and shoes read at a hand's height on the
table.
"""

from characters.authoring.human_head import cowlick, eyelids, eyes, face_lines, head_parts
from characters.authoring.human_outfit import cords, outfit_parts, ribbing
from characters.authoring.sculpt import join, sculpt
from characters.mesh import Material, Mesh
from characters.pose import Skeleton


def build_human_meshes(skeleton: Skeleton) -> tuple[Mesh, ...]:
    """Return the body, matt, and the eyes, glossy."""
    carved = sculpt("explorer", [*head_parts(), *outfit_parts()], skeleton)
    lines = [
        *face_lines(skeleton),
        *eyelids(skeleton),
        *cowlick(skeleton),
        *cords(skeleton),
        *ribbing(skeleton),
    ]
    body = join("explorer", [carved, *lines], Material(roughness=0.75))
    return body, join("eyes", eyes(skeleton), Material(roughness=0.15))

"""Vleo, a baby sauropod that throws kisses and shouts: its mesh, skeleton and clips."""

from characters.authoring.sculpt import join
from characters.authoring.vleo_actions import clips
from characters.authoring.vleo_body import body
from characters.authoring.vleo_effects import effects
from characters.authoring.vleo_face import face, skin_mesh
from characters.authoring.vleo_rig import resting, skeleton
from characters.character import Character
from characters.mesh import Material, Mesh
from characters.pose import Skeleton


def build_vleo() -> Character:
    """Return Vleo, 0.45 m from nose to tail, as it is shipped."""
    bound = skeleton()
    return Character("vleo", resting(bound), clips(bound), (mesh(bound),))


def mesh(bound: Skeleton) -> Mesh:
    """Return Vleo's one mesh, bound to the skeleton's pose."""
    skin = body(bound)
    pieces = [skin_mesh(skin, bound), *face(skin, bound), *effects(bound)]
    return join("Vleo", pieces, Material(roughness=0.55))

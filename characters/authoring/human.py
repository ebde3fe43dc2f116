"""The bundled human: an explorer with a backpack, and all that it knows how to do."""

from characters.authoring.human_actions import actions
from characters.authoring.human_body import build_human_meshes
from characters.authoring.human_face import EXPRESSIONS
from characters.authoring.human_idle import idle
from characters.authoring.human_motion import locomotion
from characters.authoring.human_rig import build_human_skeleton
from characters.character import Character


def build_human() -> Character:
    """Return the character; the same one every time."""
    skeleton = build_human_skeleton()
    clips = {"idle": idle(skeleton), **locomotion(skeleton), **actions(skeleton)}
    return Character(
        "human", skeleton, clips, build_human_meshes(skeleton), morphs=tuple(EXPRESSIONS)
    )

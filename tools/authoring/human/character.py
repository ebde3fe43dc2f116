"""The bundled human: an explorer with a backpack, and its clips."""

from characters.model.character import Character
from tools.authoring.human.actions import actions
from tools.authoring.human.body import build_human_meshes
from tools.authoring.human.face import EXPRESSIONS
from tools.authoring.human.idle import idle
from tools.authoring.human.motion import locomotion
from tools.authoring.human.rig import build_human_skeleton


def build_human() -> Character:
    """Return the character; the result is always the same."""
    skeleton = build_human_skeleton()
    clips = {"idle": idle(skeleton), **locomotion(skeleton), **actions(skeleton)}
    return Character(
        "human", skeleton, clips, build_human_meshes(skeleton), morphs=tuple(EXPRESSIONS)
    )

"""The pose layers, a file each, in the order in which they are applied."""

from cubeling.characters.control.layers.behaviour import FaceShiftLayer, StanceLayer
from cubeling.characters.control.layers.breath import BreathLayer
from cubeling.characters.control.layers.face import FaceLayer
from cubeling.characters.control.layers.foot_lock import FootLockLayer
from cubeling.characters.control.layers.gaze import GazeLayer
from cubeling.characters.control.layers.gestures import GestureLayer
from cubeling.characters.control.layers.layer import FrameContext, LayerFactory, apply_layers
from cubeling.characters.control.layers.posture import PostureLayer
from cubeling.characters.control.layers.reach import ReachLayer
from cubeling.characters.control.layers.sitting_up import SittingUpLayer
from cubeling.characters.control.layers.speech import SpeechLayer
from cubeling.characters.model.character import Character
from cubeling.registry import Registry

FOOT_LAYERS: tuple[LayerFactory, ...] = (FootLockLayer,)
"""What a character needs besides its clips."""

LIVELINESS_LAYERS: tuple[LayerFactory, ...] = (
    SpeechLayer,
    SittingUpLayer,
    StanceLayer,
    GestureLayer,
    PostureLayer,
    ReachLayer,
    GazeLayer,
    FaceShiftLayer,
    FaceLayer,
    BreathLayer,
)
"""What makes it look alive: it speaks, gestures, reaches, looks, feels and breathes."""

DEFAULT_LAYERS: tuple[LayerFactory, ...] = (*FOOT_LAYERS, *LIVELINESS_LAYERS)
"""The layers of every character."""

BODY_LAYERS = Registry[LayerFactory](
    {
        "dependent_joints": "cubeling.characters.control.layers.upper_body:DependentJointsLayer",
        "self_collision": "cubeling.characters.control.layers.upper_body:SelfCollisionLayer",
    }
)
"""What the file beside a character may ask for, by name."""

FOLLOWING_LAYERS = Registry[LayerFactory](
    {
        "constraints": "cubeling.characters.control.layers.constraints:ConstraintLayer",
        "springs": "cubeling.characters.control.layers.springs:SpringLayer",
    }
)
"""What moves after the body, for characters that have it, by the attribute that says so."""


def layers_of(character: Character) -> tuple[LayerFactory, ...]:
    """Return the layers of an `Animator` by default.

    What an action moves along comes first; last come joints that follow others, and what swings.
    """
    asked = {name: (BODY_LAYERS[name],) for name in character.body_layers}
    return (
        *asked.get("dependent_joints", ()),
        *DEFAULT_LAYERS,
        *asked.get("self_collision", ()),
        *(FOLLOWING_LAYERS[name] for name in FOLLOWING_LAYERS if getattr(character, name)),
    )


__all__ = [
    "BODY_LAYERS",
    "DEFAULT_LAYERS",
    "FOOT_LAYERS",
    "LIVELINESS_LAYERS",
    "FootLockLayer",
    "FrameContext",
    "LayerFactory",
    "SpeechLayer",
    "apply_layers",
    "layers_of",
]

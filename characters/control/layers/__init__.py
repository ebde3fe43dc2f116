"""The pose layers, a file each, in the order in which they are applied."""

from cubeling.characters.control.layers.foot_lock import FootLockLayer
from cubeling.characters.control.layers.layer import FrameContext, LayerFactory, apply_layers
from cubeling.characters.control.layers.speech import SpeechLayer
from cubeling.characters.model.character import Character
from cubeling.registry import Registry

_LAYERS = "cubeling.characters.control.layers"

FOOT_LAYERS: tuple[LayerFactory, ...] = (FootLockLayer,)
"""What a character needs besides its clips."""

LIVELINESS = Registry[LayerFactory](
    {
        "speech": f"{_LAYERS}.speech:SpeechLayer",
        "sitting_up": f"{_LAYERS}.gestures.sitting_up:SittingUpLayer",
        "fingers": f"{_LAYERS}.fingers:FingersLayer",
        "stance": f"{_LAYERS}.behaviour:StanceLayer",
        "gestures": f"{_LAYERS}.gestures.layer:GestureLayer",
        "clips": f"{_LAYERS}.clips:ClipLayer",
        "posture": f"{_LAYERS}.posture:PostureLayer",
        "reach": f"{_LAYERS}.reach.layer:ReachLayer",
        "gaze": f"{_LAYERS}.gaze:GazeLayer",
        "face_shift": f"{_LAYERS}.behaviour:FaceShiftLayer",
        "face": f"{_LAYERS}.face:FaceLayer",
        "breath": f"{_LAYERS}.breath:BreathLayer",
    }
)
"""What makes it look alive: it speaks, gestures, reaches, looks, feels and breathes. A new layer is
registered here, at its place in the order."""

LIVELINESS_LAYERS: tuple[LayerFactory, ...] = tuple(LIVELINESS.values())
"""The same, to be made."""

DEFAULT_LAYERS: tuple[LayerFactory, ...] = (*FOOT_LAYERS, *LIVELINESS_LAYERS)
"""The layers of every character."""

BODY_LAYERS = Registry[LayerFactory](
    {
        "dependent_joints": f"{_LAYERS}.upper_body:DependentJointsLayer",
        "self_collision": f"{_LAYERS}.upper_body:SelfCollisionLayer",
    }
)
"""What the file beside a character may ask for, by name."""

FOLLOWING_LAYERS = Registry[LayerFactory](
    {
        "constraints": f"{_LAYERS}.constraints:ConstraintLayer",
        "springs": f"{_LAYERS}.springs:SpringLayer",
    }
)
"""What moves after the body, for characters that have it, by the attribute that says so."""


def layers_of(character: Character) -> tuple[LayerFactory, ...]:
    """Return the layers of an `Animator` by default.

    What gestures and actions move along follows them; last come joints that follow others, and
    what swings.
    """
    asked = {name: (BODY_LAYERS[name],) for name in character.body_layers}
    after_clips = list(LIVELINESS).index("clips") + 1
    return (
        *FOOT_LAYERS,
        *LIVELINESS_LAYERS[:after_clips],
        *asked.get("dependent_joints", ()),
        *LIVELINESS_LAYERS[after_clips:],
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

"""The pose layers, a file each, in the order in which they are applied."""

from characters.control.layers.breath import BreathLayer
from characters.control.layers.face import FaceLayer
from characters.control.layers.foot_lock import FootLockLayer
from characters.control.layers.gaze import GazeLayer
from characters.control.layers.layer import FrameContext, LayerFactory
from characters.control.layers.posture import PostureLayer

FOOT_LAYERS: tuple[LayerFactory, ...] = (FootLockLayer,)
"""What a character needs besides its clips."""

LIVELINESS_LAYERS: tuple[LayerFactory, ...] = (PostureLayer, GazeLayer, FaceLayer, BreathLayer)
"""What makes it look alive: it sways, looks, blinks, breathes and shows its emotion."""

DEFAULT_LAYERS: tuple[LayerFactory, ...] = (*FOOT_LAYERS, *LIVELINESS_LAYERS)
"""The layers of an `Animator` by default."""

__all__ = [
    "DEFAULT_LAYERS",
    "FOOT_LAYERS",
    "LIVELINESS_LAYERS",
    "FootLockLayer",
    "FrameContext",
    "LayerFactory",
]

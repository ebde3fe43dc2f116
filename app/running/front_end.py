"""Where a session is shown and heard, and from where its cameras come."""

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cubeling.app.running.opened_session import OpenCamera
from cubeling.app.ui.screen import Screen

if TYPE_CHECKING:
    import moderngl

    from cubeling.app.sound import Mixer, SoundOutput

OpenScreen = Callable[[tuple[int, int], Path, ExitStack], "tuple[Screen, moderngl.Context]"]
"""Opens a screen for pictures of a width and height [px], with the folder where snapshots go, and
the context to draw in; the stack closes both."""


@dataclass(frozen=True)
class FrontEnd:
    """What a session has instead of a window and a loudspeaker of this computer."""

    open_screen: OpenScreen
    """Opens what shows the pictures."""

    open_loudspeaker: "Callable[[Mixer], SoundOutput]"
    """Opens what the sounds of a mixer are heard on."""

    open_camera: OpenCamera
    """Opens a camera that the player chooses."""

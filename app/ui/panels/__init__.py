"""The panels of the window: what they show, apart from how it is drawn."""

from typing import TYPE_CHECKING

from cubeling.registry import Registry

if TYPE_CHECKING:
    from cubeling.app.ui.panels.content import Panel

PANELS: "Registry[Panel]" = Registry(
    {
        "tracking": "cubeling.app.ui.panels.tracking:TRACKING",
        "scenario": "cubeling.app.ui.panels.scenario:SCENARIO",
        "emotion": "cubeling.app.ui.panels.emotion:EMOTION",
        "serial": "cubeling.app.ui.panels.serial:SERIAL",
        "frame-time": "cubeling.app.ui.panels.frame_time:FRAME_TIME",
        "sound": "cubeling.app.ui.panels.sound:SOUND",
        "speech": "cubeling.app.ui.panels.speech:SPEECH",
    }
)
"""The panels by name, in the order in which the window lists them; a new one is registered here."""

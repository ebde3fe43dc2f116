"""The panels of the window: what they show, apart from how it is drawn.

A new panel is one module: list it in `PANELS`.
"""

from cubeling.app.ui.panels.content import Panel
from cubeling.app.ui.panels.emotion import EMOTION
from cubeling.app.ui.panels.frame_time import FRAME_TIME
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.panels.scenario import SCENARIO
from cubeling.app.ui.panels.serial import SERIAL
from cubeling.app.ui.panels.sound import SOUND
from cubeling.app.ui.panels.speech import SPEECH
from cubeling.app.ui.panels.tracking import TRACKING

PANELS: dict[str, Panel] = {
    panel.name: panel for panel in (TRACKING, SCENARIO, EMOTION, SERIAL, FRAME_TIME, SOUND, SPEECH)
}
"""The panels by name, in the order in which the window lists them."""

__all__ = ["PANELS", "Panel", "SessionMonitor"]

"""How a session sounds."""

from cubeling.app.ui.panels.content import Note, Panel, Slider, Switch, Widget
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.playback.requests import ChangeSound


def content(monitor: SessionMonitor) -> tuple[Widget, ...]:
    """Return the volume, and why nothing is heard."""
    options = monitor.options
    widgets: list[Widget] = [
        Switch("muted", "Silent", options.muted, ChangeSound),
        Slider("volume", "Volume", options.volume, 0.0, 1.0, request=ChangeSound),
    ]
    if monitor.sound_problem:
        widgets.append(Note(monitor.sound_problem, "warning"))
    return tuple(widgets)


SOUND = Panel("sound", "Sound", 232.0, content)

"""The window of a session that plays, with its panels."""

from cubeling.app.ui.window.window import Window

__all__ = ["Window"]

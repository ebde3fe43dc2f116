"""The live window."""

from cubeling.app.ui.window.window import Window

__all__ = ["Window"]

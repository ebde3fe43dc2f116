"""The live window."""

from app.ui.window.window import Window

__all__ = ["Window"]

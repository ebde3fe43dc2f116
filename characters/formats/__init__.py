"""Files that characters and motions are read from and written to."""

from characters.formats.clips import load_clip, load_motion
from characters.formats.performance import Performance

__all__ = ["Performance", "load_clip", "load_motion"]

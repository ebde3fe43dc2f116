"""Files that characters and motions are read from and written to."""

from characters.formats.clips import load_clip

__all__ = ["load_clip"]

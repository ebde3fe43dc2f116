"""File formats of characters and motions.

A format is one module (or folder) with its reader, and one line in `MOTION_READERS` of `loading`
or in `CHARACTER_READERS` of `Character`. A reader is imported when its first file is read.
"""

from cubeling.characters.formats.loading import RecordedMotion, is_motion_only, load_motion

__all__ = ["RecordedMotion", "is_motion_only", "load_motion"]

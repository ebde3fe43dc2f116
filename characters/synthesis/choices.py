"""What a user may choose of synthesis; needs no numpy, as the command line names it."""

from typing import Literal

Alignment = Literal["feet", "full", "turn", "place", "none"]
"""What is taken from a recording of idling: the mean place of the feet and where they face (our own
way); place and orientation of the first frame; its place and heading; its place alone; nothing."""

Database = Literal["aggressive", "neutral", "full"]
"""Which phrases of a gesture library are used: the stronger, the weaker, or all (M9, profiles)."""

DEFAULT_PROFILE = "SP4b"
"""The split profile of motion graphs in evaluation I of the thesis (erratum 4)."""

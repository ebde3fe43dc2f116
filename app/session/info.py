"""What a recorded session says of itself."""

from collections.abc import Mapping
from dataclasses import dataclass

from cubeling.app.session.labels import SessionLabels
from cubeling.app.session.options import SessionOptions


@dataclass(frozen=True)
class SessionInfo:
    """What a recorded session says of itself."""

    options: SessionOptions
    """Its scenario, cube, character …, with itself as the source."""

    frames: int
    """Camera frames in the file."""

    duration: float
    """From the first to the last camera frame [s]; the robot's line may be recorded for longer."""

    played: Mapping[str, str]
    """What was played, resolved: the keys are those of `app.running.recording.provenance.played`.
    Empty for sessions that say only what was asked for."""

    labels: SessionLabels
    """Who played, and under which condition, as it was corrected since."""

    has_video: bool
    """Whether its pictures are those of the camera; else it is replayed from where the cube was."""

    first_part: str
    """Name of the file that a recording in parts began with; "" for the beginning of one."""

    clock_zero: str
    """When the timestamps of a live camera were 0, in UTC by ISO 8601; "" for other sources."""

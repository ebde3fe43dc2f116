"""What the user asks of a session: the settings from the command line to the session."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, kw_only=True)
class SessionOptions:
    """The settings of one session. They do not change once the session is open."""

    scenario: str
    """Name of the scenario."""

    source: str
    """URI of the frames, as `tracking.open_source` takes it."""

    cube: str | None = None
    """A bundled cube or a .toml file; None for the scenario's own."""

    character: str | None = None
    """A bundled character or a .glb file; None for the scenario's own."""

    intrinsics: Path | None = None
    """The camera's calibration file; None to take the source's intrinsics or to guess them."""

    speed_map: str = "corrected"
    """One of `SPEED_MAPS`, for `follow` and `sketch`."""

    turns: float = 2.0
    """Full turns of the cube from the least to the greatest intensity, for `companion`."""

    personality: str | None = None
    """A bundled personality or a .toml file; None for the scenario's own."""

    look: str = "auto"
    """What the character's eyes follow: one of `LOOKS`."""

    robot: str = "sim"
    """URL of the robot, as `RobotLine.open` takes it."""

    robot_settings: Path | None = None
    """A .toml file for the robot's driver."""

    record: Path | None = None
    """The .mcap file to record the session to."""

    codec: str = "jpeg"
    """How a recording stores the camera's pictures: "jpeg" or "h264"."""

    output: Path | None = None
    """The .mp4 file to write; None to open a window."""

    pictures: bool = True
    """Whether to draw."""

    salvage: bool = False
    """Whether a source that breaks off counts as finished."""

    start: str = "camera"
    """The channel that a replay starts from: one of `STARTS`."""

    @property
    def windowed(self) -> bool:
        """Whether the session has a window, so that a user watches it."""
        return self.pictures and self.output is None

"""The gaps of a session in which its camera was lost."""

from app.running.summary import Summary
from app.session import Recorder
from tracking import Frame

CAMERA_LOST = "camera lost"
CAMERA_BACK = "camera back"
"""The events of a recording between which no pictures came."""


class Gaps:
    """Notes when the camera was lost and when it came back.

    Parameters
    ----------
    summary
        Where the session's gaps are gathered.
    recorder
        Where they are recorded as events, or None.
    """

    def __init__(self, summary: Summary, recorder: Recorder | None) -> None:
        self._summary, self._recorder = summary, recorder
        self._since: float | None = None

    def lost(self) -> None:
        """Note that the source is lost, from the last frame on; the first call of a gap counts."""
        if self._since is None:
            self._since = self._summary.last
            self._event(CAMERA_LOST, self._since)

    def back(self, frame: Frame) -> None:
        """Note a frame: it ends a gap, if there was one."""
        if self._since is not None:
            self._summary.gaps.append((self._since, frame.timestamp - self._since))
            self._since = None
            self._event(CAMERA_BACK, frame.timestamp)

    def _event(self, what: str, time: float) -> None:
        if self._recorder is not None:
            self._recorder.event(what, time)

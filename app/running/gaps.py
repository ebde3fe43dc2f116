"""The gaps of a session in which its camera was lost."""

from app.running.summary import Summary
from app.session import Recorder
from tracking import Frame

CAMERA_LOST = "camera lost"
CAMERA_BACK = "camera back"
"""The events of a recording between which there are no pictures."""


class CameraGaps:
    """Notes when the camera was lost and when it came back.

    Parameters
    ----------
    summary
        Collects the gaps of the session.
    recorder
        Records their begin and end as events, or None.
    """

    def __init__(self, summary: Summary, recorder: Recorder | None) -> None:
        self._summary, self._recorder = summary, recorder
        self._start: float | None = None

    def begin(self) -> None:
        """Begin a gap at the last frame; further calls within the gap do nothing."""
        if self._start is None:
            self._start = self._summary.last
            self._record(CAMERA_LOST, self._start)

    def end(self, frame: Frame) -> None:
        """End the gap, if there is one, at this frame."""
        if self._start is not None:
            self._summary.gaps.append((self._start, frame.timestamp - self._start))
            self._start = None
            self._record(CAMERA_BACK, frame.timestamp)

    def _record(self, event: str, timestamp: float) -> None:
        if self._recorder is not None:
            self._recorder.event(event, timestamp)

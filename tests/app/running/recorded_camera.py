"""A live camera that shows the frames of a session."""

import itertools

from cubeling.tracking import open_source


class RecordedCamera:
    """What `LiveFrames` has besides `wait` and `health`, which each test adds."""

    live = True
    duration: float | None = None

    def __init__(self, session, count):
        self._session = open_source(str(session))
        self._frames = itertools.islice(self._session, count)
        self.intrinsics = self._session.intrinsics
        self.size, self.rate = self._session.size, self._session.rate

    def __iter__(self):
        raise AssertionError("a session calls `wait`, so that its window stays alive")

    def close(self):
        self._session.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

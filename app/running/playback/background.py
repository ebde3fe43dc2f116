"""Calls on a thread of their own, so that the pictures go on meanwhile."""

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

from cubeling.robot import Closeable

T = TypeVar("T")


class BackgroundCall(Closeable, Generic[T]):
    """Calls a function once, on a thread; its result is fetched, or discarded.

    Parameters
    ----------
    function
        What is called. It must end by itself, in a bounded time.
    discard
        What is done with a result that comes too late to be fetched.
    """

    def __init__(
        self, function: Callable[[], T], discard: Callable[[T], None] = lambda result: None
    ) -> None:
        self._function, self._discard = function, discard
        self._lock = threading.Lock()
        self._result: list[T] = []
        self._error: Exception | None = None
        self._over = self._unwanted = False
        threading.Thread(target=self._run, name="background call", daemon=True).start()

    @property
    def over(self) -> bool:
        """Whether `result` can be called."""
        with self._lock:
            return self._over

    def result(self) -> T:
        """Return what the function returned, or raise its error."""
        with self._lock:
            if self._error is not None:
                raise self._error
            return self._result.pop()

    def close(self) -> None:
        """Discard the result, now or as soon as it is there. A second call does nothing."""
        with self._lock:
            self._unwanted = True
            results, self._result = self._result, []
        for result in results:
            self._discard(result)

    def _run(self) -> None:
        try:
            result = self._function()
        except Exception as error:  # raised again in `result`
            with self._lock:
                self._error, self._over = error, True
            return
        with self._lock:
            self._over = True
            unwanted = self._unwanted
            if not unwanted:
                self._result.append(result)
        if unwanted:
            self._discard(result)

"""Values of the last seconds."""

from collections import deque

import numpy as np
from numpy.typing import NDArray


class Trace:
    """Keeps rows of values for a time; time that goes back, as after a seek, empties it first.

    Parameters
    ----------
    columns
        How many values a row has.
    span
        How long a row is kept [s].
    interval
        Rows that come sooner after the last one are left out [s].
    """

    def __init__(self, columns: int, span: float, interval: float = 0.0) -> None:
        self.span = span
        """How long a row is kept [s]."""
        self._columns, self._interval = columns, interval
        self._rows: deque[tuple[float, ...]] = deque()

    def add(self, timestamp: float, *values: float) -> None:
        """Add a row, and forget those that are too old."""
        rows = self._rows
        if rows and timestamp < rows[-1][0]:
            rows.clear()
        if rows and timestamp - rows[-1][0] < self._interval:
            return
        rows.append((timestamp, *values))
        while timestamp - rows[0][0] > self.span:
            rows.popleft()

    def table(self) -> NDArray[np.float64]:
        """Return the rows (n, 1 + columns): time before the last row, −span…0 [s], and values.

        >>> trace = Trace(1, span=2.0)
        >>> for second in range(5):
        ...     trace.add(second, 10.0 * second)
        >>> trace.table().tolist()
        [[-2.0, 20.0], [-1.0, 30.0], [0.0, 40.0]]
        """
        table = np.array(self._rows, float).reshape(-1, 1 + self._columns)
        if len(table):
            table[:, 0] -= table[-1, 0]
        return table

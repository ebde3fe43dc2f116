"""A copy of everything in a pipeline that changes from frame to frame."""

import io
import pickle
from types import MappingProxyType
from typing import Any

import cv2

SHARED_TYPES = (MappingProxyType, cv2.aruco.ArucoDetector)
"""Types without a state of their own, which cannot be pickled."""


class Checkpoint:
    """A copy of some objects, as they are now.

    Frozen dataclasses (motions, characters, cubes …) do not change, so the copy shares them with
    the original.

    Parameters
    ----------
    content
        Names and objects.

    Raises
    ------
    TypeError, AttributeError, pickle.PicklingError
        An object cannot be copied, such as an open file in the scenario of another package.
    """

    def __init__(self, content: dict[str, Any]) -> None:
        stream = io.BytesIO()
        writer = _Writer(stream)
        writer.dump(content)
        self._data, self._shared = stream.getvalue(), writer.shared

    def content(self) -> dict[str, Any]:
        """Return a new copy of the content."""
        reader = _Reader(io.BytesIO(self._data), self._shared)
        content: dict[str, Any] = reader.load()
        return content


class _Writer(pickle.Pickler):
    def __init__(self, stream: io.BytesIO) -> None:
        super().__init__(stream, pickle.HIGHEST_PROTOCOL)
        self.shared: list[object] = []

    def persistent_id(self, obj: Any) -> int | None:
        settings = getattr(type(obj), "__dataclass_params__", None)  # of a dataclass
        # Classes too: one that was made of a file is in no module.
        shared = isinstance(obj, (type, *SHARED_TYPES))
        if not (settings and settings.frozen) and not shared:
            return None
        self.shared.append(obj)
        return len(self.shared) - 1


class _Reader(pickle.Unpickler):
    def __init__(self, stream: io.BytesIO, shared: list[object]) -> None:
        super().__init__(stream)
        self._shared = shared

    def persistent_load(self, pid: Any) -> object:
        return self._shared[pid]

"""Objects that a `with` statement closes."""

from abc import ABC, abstractmethod
from typing import Self


class Closeable(ABC):
    """Base of objects that their owner closes, best with a `with` statement."""

    @abstractmethod
    def close(self) -> None:
        """Release everything. A second call does nothing."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

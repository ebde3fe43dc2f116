"""A table of what can be chosen by name; each entry is loaded when it is named."""

from collections.abc import Iterator, Mapping, MutableMapping
from importlib import import_module
from typing import Any, Generic, TypeVar

Entry = TypeVar("Entry")


class Registry(MutableMapping[str, Entry], Generic[Entry]):
    """Entries by name, such as the drivers of robots. Asking which names there are loads nothing.

    Parameters
    ----------
    places
        Where each entry is: "package.module:name".

    >>> bases = Registry({"hex": "builtins:hex", "oct": "builtins:oct"})
    >>> list(bases), bases["hex"](10)
    (['hex', 'oct'], '0xa')
    """

    def __init__(self, places: Mapping[str, str]) -> None:
        self._places = dict(places)
        self._loaded: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Entry:
        if name not in self._loaded:
            module, _, attribute = self._places[name].partition(":")
            self._loaded[name] = getattr(import_module(module), attribute)
        entry: Entry = self._loaded[name]
        return entry

    def __setitem__(self, name: str, entry: Entry) -> None:
        self._places.setdefault(name, "")  # keeps the order of the names
        self._loaded[name] = entry

    def __delitem__(self, name: str) -> None:
        del self._places[name]
        self._loaded.pop(name, None)

    def __contains__(self, name: object) -> bool:
        return name in self._places

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)

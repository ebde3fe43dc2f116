"""The program: cube, character and robot in one line."""

from typing import Any


def __getattr__(name: str) -> Any:
    """Load `Playground` when it is asked for: the command line starts without it."""
    if name != "Playground":
        raise AttributeError(f"module 'cubeling.app' has no attribute {name!r}")
    from cubeling.app import scenarios as scenarios  # registers them, for one made from a name
    from cubeling.app.pipeline.playground import Playground

    return Playground

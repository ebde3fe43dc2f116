"""The sessions that come with the package."""

from pathlib import Path

from cubeling.app.errors import AppError

RECORDED_SCENARIOS = ("follow", "sketch", "companion", "reach")
"""The scenarios with a session in `recordings/`, and with a script of the synthetic camera."""


def bundled_session(name: str) -> Path:
    """Return the session of a scenario in `recordings/`."""
    from cubeling import recordings

    for folder in recordings.__path__:
        path = Path(folder) / f"{name}.mcap"
        if path.is_file():
            return path
    raise AppError(f"the bundled recording '{name}.mcap' is missing: clone the repository again")

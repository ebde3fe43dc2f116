"""The sessions that come with the program."""

from pathlib import Path

from app.errors import AppError


def bundled(name: str) -> Path:
    """Return the session in `recordings/` that belongs to a scenario."""
    import recordings

    for folder in recordings.__path__:
        path = Path(folder) / f"{name}.mcap"
        if path.is_file():
            return path
    raise AppError(f"the bundled recording '{name}.mcap' is missing: clone the repository again")

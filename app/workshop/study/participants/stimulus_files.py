"""Where the stimuli of a study are."""

from pathlib import Path

from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.protocol import StimulusSet, pair_members

MEDIA_TYPES = {
    ".png": "image/png",
    ".jpg": "image/jpeg",
    ".gif": "image/gif",
    ".mp4": "video/mp4",
    ".webm": "video/webm",
}
"""What can be shown, by suffix. A name without a suffix is that of the first that is there."""


def names_of(stimuli: StimulusSet, step: PlannedStep) -> list[str]:
    """Return the names of what is shown: from left to right for a pair; none without files."""
    if not stimuli.file:
        return []
    members: tuple[str, ...] = ("",)
    if stimuli.pair:
        members = pair_members(step.stimulus[stimuli.pair], step.first_left)
    return [stimuli.file.format_map({**step.stimulus, "member": each}) for each in members]


def find_file(name: str, folder: Path) -> Path | None:
    """Return the file of a stimulus; None if it is not there, or nothing that can be shown."""
    path = folder / name
    if path.suffix.lower() in MEDIA_TYPES:
        return path if path.is_file() else None
    found = (path.with_name(path.name + suffix) for suffix in MEDIA_TYPES)
    return next((each for each in found if each.is_file()), None)

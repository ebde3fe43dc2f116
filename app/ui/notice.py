"""What the player reads while the camera gives nothing new."""

from dataclasses import dataclass

from tracking import Health


@dataclass(frozen=True)
class Notice:
    """What the player reads while nothing new comes."""

    title: str
    """What is the matter, in a few words."""

    advice: str
    """What to do about it."""


def notice(health: Health) -> Notice | None:
    """Return what to tell of a live source; None where all is well.

    >>> notice(Health("camera 0", "lost", 5.0)).title
    'Camera lost: plug it in again'
    """
    if health.state in ("running", "closed"):
        return None
    if health.name.startswith("http"):
        return Notice("No picture from the phone", "Is its camera app open, and in this network?")
    if health.frozen:
        return Notice("The picture stands still", "Uncover the camera, or plug it in again.")
    return Notice("Camera lost: plug it in again", "The play goes on by itself.")

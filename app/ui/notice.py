"""Notices for the player while the camera delivers no new frames."""

from dataclasses import dataclass

from tracking import Health


@dataclass(frozen=True)
class Notice:
    """A message over the last picture."""

    title: str
    """The problem, in a few words."""

    advice: str
    """What to do about it."""


def notice(health: Health) -> Notice | None:
    """Return a notice about the health of a live source; None if it works.

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

"""Times in which a part of a session was missing: the camera, the robot."""

from dataclasses import dataclass, replace

MAX_GAPS = 5
"""Gaps of camera or robot that are named one by one."""


@dataclass(frozen=True)
class Gap:
    """A time in which a part of the session was missing."""

    part: str
    """ "camera", "robot" or the name of a further robot."""

    start: float
    """Timestamp of the last frame before it [s]."""

    played: float
    """What was played until then [s]."""

    seconds: float = 0.0
    """How long it lasted [s]."""

    back: bool = True
    """Whether the part came back before the end of the session."""

    def until(self, timestamp: float, *, back: bool = True) -> "Gap":
        """Return the gap as it ended at a timestamp [s]."""
        return replace(self, seconds=timestamp - self.start, back=back)


def gaps_line(gaps: list[Gap]) -> str:
    """Return when a part was missing, in one line.

    >>> gaps_line([Gap("robot", 70.0, 12.3, 4.0)])
    '4.0 s: after 12.3 s'
    >>> gaps_line([Gap("camera", 61.0, 3.0, 1.5), Gap("camera", 80.0, 22.0, 8.0, back=False)])
    '9.5 s in all: after 3.0 s for 1.5 s, after 22.0 s until the end'
    """
    total = sum(gap.seconds for gap in gaps)
    if len(gaps) == 1 and gaps[0].back:
        return f"{total:.1f} s: after {gaps[0].played:.1f} s"
    entries = [
        f"after {gap.played:.1f} s " + (f"for {gap.seconds:.1f} s" if gap.back else "until the end")
        for gap in gaps
    ]
    if len(entries) > MAX_GAPS:
        entries = [*entries[: MAX_GAPS - 1], f"and {len(entries) - MAX_GAPS + 1} times more"]
    return f"{total:.1f} s in all: {', '.join(entries)}"

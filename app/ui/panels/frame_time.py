"""Where the time of a frame goes."""

from cubeling.app.ui.palette import (
    ACTION_COLORS,
    ANGRY,
    HAPPY,
    NEUTRAL,
    QUIET,
    ROBOT_COLOR,
    RULE,
    bgr,
)
from cubeling.app.ui.panels.content import Fact, Note, Panel, Share, ShareBar, Widget
from cubeling.app.ui.panels.monitor import SessionMonitor

PARTS = {
    "capture": bgr("#2f6f8f"),
    "tracking": ACTION_COLORS["walk"],
    "gestures": ROBOT_COLOR,
    "appearance": bgr("#8c6bb1"),
    "scenario": HAPPY,
    "animation": ACTION_COLORS["run"],
    "drawing": ACTION_COLORS["kiss"],
    "robot": NEUTRAL,
    "recording": ANGRY,
    "showing": ACTION_COLORS["shout"],
    "sound": bgr("#009e73"),
    "other": QUIET,
    "waiting": RULE,
}
"""The parts of a frame in their order, with their colours. "waiting" is spare."""


def content(monitor: SessionMonitor) -> tuple[Widget, ...]:
    """Return the mean time of each part over the last second, as a stacked bar."""
    means = monitor.times.means()
    if not means:
        return (Note("The first second is being measured."),)
    total = sum(means.values())
    order = [*(part for part in PARTS if part in means), *(means.keys() - PARTS.keys())]
    shares = tuple(
        Share(part, means[part], f"{1e3 * means[part]:.1f} ms", PARTS.get(part, QUIET))
        for part in order
    )
    return (
        Fact("A frame", f"{1e3 * total:.1f} ms, {1 / total:.0f} frames/s" if total else "0 ms"),
        Fact("Quality", monitor.quality),
        ShareBar(shares),
    )


FRAME_TIME = Panel("frame-time", "Frame time", 320.0, content)

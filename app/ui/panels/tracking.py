"""How well the cube is tracked."""

import numpy as np
from rich.text import Text

from cubeling.app.ui.notice import focal_length, lens_notice
from cubeling.app.ui.palette import ACTION_COLORS
from cubeling.app.ui.panels.content import Fact, Note, Panel, Plot, PlotCurve, Tone, Widget
from cubeling.app.ui.panels.monitor import TRACKING_SPAN_S, SessionMonitor
from cubeling.tracking import CubeState, Intrinsics

REFUSALS = {
    "ambiguous": "one face may lean either way",
    "blurred": "its edges are blurred",
    "failed": "the tracker made an error",
    "flat": "the sheet is not folded",
    "jump": "no hand is so fast",
    "searching": "the search goes on",
    "unproved": "it is too small or hidden",
    "unsure": "the pose may be far off",
}
"""Why a pose is not trusted, by `CubeState.refused`."""

SOURCES = {"markers": "markers", "image": "edges and surface", "predicted": "prediction"}
"""What a pose is measured on, by `CubeState.source`."""

MAX_RESIDUAL_PX = 2.0
"""Top of the plot [px]."""

GOOD_SHARE, FAIR_SHARE = 0.95, 0.7
"""Shares of frames with the cube that count as good and as fair."""


MAX_GOOD_DEVIATION = 0.03
"""Standard deviation of a focal length, as a share, above which depth is still a guess."""


def stated_error(state: CubeState) -> tuple[float, float]:
    """Return the standard deviations of the position [mm] and the rotation [°] as they are stated.

    They are those along the worst axis; NaN where there is no pose.
    """
    if state.camera_from_cube is None or not np.isfinite(state.covariance).all():
        return np.nan, np.nan
    position, rotation = (
        float(np.sqrt(max(np.linalg.eigvalsh(block)[-1], 0.0)))
        for block in (state.covariance[:3, :3], state.covariance[3:, 3:])
    )
    return 1e3 * position, float(np.degrees(rotation))


def content(monitor: SessionMonitor) -> tuple[Widget, ...]:
    """Return the tracker's verdict, the errors that it states, and the last seconds."""
    assert monitor.step is not None, "a panel is drawn after the first frame"
    state = monitor.step.state
    table = monitor.tracking.table()
    share = float(table[:, 1].mean())
    span = table[-1, 0] - table[0, 0]
    rate = f"{(len(table) - 1) / span:.0f} frames/s" if span > 0.0 else "no rate yet"
    mm, degrees = stated_error(state)
    error = f"{mm:.1f} mm, {degrees:.2f}°" if state.visible else "none"
    residual = f"{state.reprojection_error:.2f} px"
    tone: Tone = "good" if share >= GOOD_SHARE else "warning" if share >= FAIR_SHARE else "bad"
    widgets: list[Widget] = [
        _verdict(state),
        Fact("Faces", ", ".join(state.faces) or "none"),
        Fact("Measured on", SOURCES[state.source] if state.visible else "nothing"),
        Fact("Residual", residual if np.isfinite(state.reprojection_error) else "none"),
        Fact("Stated error", error),
        Fact("Seen lately", f"{100 * share:.0f} % at {rate}", tone),
        Plot(
            "Residual",
            (PlotCurve("residual", table[:, 0], table[:, 2], ACTION_COLORS["walk"]),),
            TRACKING_SPAN_S,
            0.0,
            MAX_RESIDUAL_PX,
            ((0.0, "0"), (1.0, "1 px")),
            56.0,
        ),
    ]
    if monitor.intrinsics is not None:
        widgets.insert(5, _lens(monitor.intrinsics))
        words = lens_notice(monitor.lens, monitor.intrinsics)
        if words is not None:
            widgets.append(Note(Text.from_markup(words).plain, "warning"))
    return tuple(widgets)


def _lens(intrinsics: Intrinsics) -> Fact:
    deviation = intrinsics.focal_deviation
    guessed = deviation is not None and deviation > MAX_GOOD_DEVIATION
    return Fact("Lens", focal_length(intrinsics), "warning" if guessed else "plain")


def _verdict(state: CubeState) -> Fact:
    if state.visible:
        return Fact("Cube", "found", "good")
    if state.refused:
        return Fact("Cube", REFUSALS.get(state.refused, state.refused), "warning")
    return Fact("Cube", "not in view", "bad")


TRACKING = Panel("tracking", "Tracking", 296.0, content)

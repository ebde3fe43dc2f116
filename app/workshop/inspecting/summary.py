"""The figures of a session as lines, as JSON, and as one page."""

import math
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from cubeling.app.counted import quantity
from cubeling.app.ui.panels.tracking import REFUSALS, SOURCES
from cubeling.app.workshop.inspecting.figures import SessionFigures, Spell
from cubeling.app.workshop.pages.line_plot import line_plot
from cubeling.app.workshop.pages.page import heading, page, pictures, table
from cubeling.app.workshop.pages.report_table import ReportTable, figure, percent
from cubeling.tracking import Frame, open_source

THUMBNAILS, THUMBNAIL_WIDTH_PX = 8, 320
"""Pictures of a page, and their width [px]."""

WHO_PLAYED = ("character", "personality")
"""What is said of who played, of the keys of `SessionFigures.played`."""

MAX_LISTED = 8
"""Gaps, verdicts and the like that are named one by one."""


def lines_of(figures: SessionFigures) -> list[tuple[str, str]]:
    """Return what there is to say about a session: a word, and a line."""
    info, link = figures.info, figures.link
    labels = ", ".join(filter(None, (info.labels.participant, info.labels.condition)))
    who = [f"{key} {figures.played[key]}" for key in WHO_PLAYED if figures.played.get(key)]
    rows = [
        ("session", f"{figures.name}, {_size_line(figures)}"),
        ("played", ", ".join([info.options.scenario, *who])),
        ("video", "" if info.has_video else "none: all was recorded but the camera's pictures"),
        ("by", labels),
        ("notes", info.labels.notes),
        ("duration", f"{info.duration:.1f} s, {quantity(info.frames, 'frame')}{_rate(figures)}"),
        ("gaps", _listed(figures.gaps)),
        ("cube found", _found_line(figures)),
        ("cube lost", _listed(figures.lost)),
        ("found by", _frames(figures.measured_on, SOURCES)),
        ("not found", _frames(figures.verdicts, {"unseen": "it was not in view", **REFUSALS})),
        ("error", _error_line(figures)),
        ("character", _durations(figures, figures.states)),
        ("emotion", _durations(figures, figures.labels)),
        ("link", _link_line(figures)),
        ("refused", ", ".join(link.reasons)),
        ("events", _counts(figures.events)),
        ("wizard", _wizard_line(figures)),
        ("marks", ", ".join(f"{m.at_s:.1f} s {m.words}" for m in figures.marks)),
    ]
    return [(word, line) for word, line in rows if line]


def _size_line(figures: SessionFigures) -> str:
    """Return how large the file is, and what it holds."""
    unpacked = sum(each.unpacked_size for each in figures.channels)
    size, content = f"{figures.size / 1e6:.1f} MB", f"{unpacked / 1e6:.1f} MB"
    return size if size == content else f"{size} on the disk, {content} unpacked"


def _found_line(figures: SessionFigures) -> str:
    return f"in {percent(figures.found_share)} of the frames" if len(figures.visible) else ""


def _wizard_line(figures: SessionFigures) -> str:
    """Return how much a wizard did, how often in error, and how late."""
    acts = figures.acts
    if not acts:
        return ""
    errors = sum(each.undone for each in acts)
    delays = [each.delay_s for each in acts if each.delay_s is not None and not each.undone]
    late = f", {np.median(delays):.2f} s after the cue in the middle" if delays else ""
    return f"{quantity(len(acts), 'act')}, {quantity(errors, 'error')}{late}"


def document_of(figures: SessionFigures) -> dict[str, Any]:
    """Return the figures for JSON; what is not known is None."""
    info, link = figures.info, figures.link
    intervals, error = figures.intervals, figures.errors_px
    return {
        "session": figures.name,
        "bytes": figures.size,
        "video": info.has_video,
        "scenario": info.options.scenario,
        "played": dict(figures.played),
        "participant": info.labels.participant,
        "condition": info.labels.condition,
        "notes": info.labels.notes,
        "clock_zero_utc": info.clock_zero,
        "frames": info.frames,
        "duration_s": round(info.duration, 6),
        "rate_hz": _number(1.0 / np.mean(intervals)) if len(intervals) else None,
        "interval_s": {
            "median": _number(np.median(intervals)) if len(intervals) else None,
            "longest": _number(np.max(intervals)) if len(intervals) else None,
        },
        "gaps": [_spell(each) for each in figures.gaps],
        "tracking": {
            "found_share": _number(figures.found_share),
            "lost": [_spell(each) for each in figures.lost],
            "verdicts": dict(figures.verdicts),
            "measured_on": dict(figures.measured_on),
            "error_px_median": _number(np.median(error)) if len(error) else None,
            "error_px_p95": _number(np.quantile(error, 0.95)) if len(error) else None,
        },
        "states": [_spell(each) for each in figures.states],
        "emotion": {
            "mean": [_number(each) for each in figures.emotion.mean(0)]
            if len(figures.emotion)
            else None,
            "labels": [_spell(each) for each in figures.labels],
        },
        "link": {
            "commands": link.commands,
            "acknowledged": link.acknowledged,
            "refused": link.refused,
            "delay_ms_median": None if link.delay_ms is None else _number(link.delay_ms[0]),
            "delay_ms_p95": None if link.delay_ms is None else _number(link.delay_ms[1]),
            "bytes_sent": link.sent,
            "bytes_received": link.received,
        },
        "events": dict(figures.events),
        "marks": [{"at_s": m.at_s, "kind": m.kind, "name": m.name} for m in figures.marks],
        "acts": [asdict(each) for each in figures.acts],
        "channels": {
            each.topic: {
                "messages": each.messages,
                "unpacked_bytes": each.unpacked_size,
                "rate_hz": _number(each.rate),
            }
            for each in figures.channels
        },
    }


def page_of(figures: SessionFigures, session: Path) -> str:
    """Return the figures as one page, with pictures of the session."""
    return page(figures.name, list(_parts(figures, session)))


def _parts(figures: SessionFigures, session: Path) -> Iterator[str]:
    yield heading(figures.name, 1)
    yield table(ReportTable("In short", ("", ""), tuple(lines_of(figures))), words=True)
    if figures.info.has_video:
        yield heading("Pictures")
        yield pictures(list(_thumbnails(figures, session)))
    yield heading("Over time")
    lost = [(each.at_s, each.at_s + each.seconds) for each in figures.lost]
    if len(figures.emotion):
        yield line_plot(
            [
                ("valence", figures.emotion_times, figures.emotion[:, 0]),
                ("arousal", figures.emotion_times, figures.emotion[:, 1]),
            ],
            "emotion (shaded: the cube was lost)",
            (-1.0, 1.0),
            lost,
        )
    if len(figures.intervals):
        times = np.concatenate([[0.0], np.cumsum(figures.intervals)])
        between = 1000.0 * figures.intervals
        limits = 0.0, float(between.max())
        yield line_plot([("", times[1:], between)], "time between frames [ms]", limits, lost)
    if figures.info.played:
        yield heading("What was played")
        shown = tuple((name, text) for name, text in figures.played.items() if 0 < len(text) < 200)
        yield table(ReportTable("Resolved", ("", ""), shown), words=True)
    yield heading("Channels")
    rows = tuple(
        (c.topic, f"{c.messages}", f"{c.unpacked_size / 1e6:.2f}", figure(c.rate, 1))
        for c in figures.channels
    )
    head = "topic", "messages", "MB unpacked", "Hz"
    yield table(ReportTable(f"What the file holds: {_size_line(figures)}", head, rows))


def _thumbnails(figures: SessionFigures, session: Path) -> Iterator[tuple[bytes, str]]:
    count = figures.info.frames
    wanted = {round(i * (count - 1) / max(THUMBNAILS - 1, 1)) for i in range(THUMBNAILS)}
    with open_source(str(session)) as source:
        first: Frame | None = None
        for index, frame in enumerate(source):
            first = frame if first is None else first
            if index in wanted:
                height, width = frame.image.shape[:2]
                size = THUMBNAIL_WIDTH_PX, round(THUMBNAIL_WIDTH_PX * height / width)
                small = cv2.resize(frame.image, size, interpolation=cv2.INTER_AREA)
                data = cv2.imencode(".jpg", small, (cv2.IMWRITE_JPEG_QUALITY, 80))[1].tobytes()
                yield data, f"{frame.timestamp - first.timestamp:.1f} s"


def _rate(figures: SessionFigures) -> str:
    if not len(figures.intervals):
        return ""
    median, longest = np.median(figures.intervals), figures.intervals.max()
    rate = 1.0 / figures.intervals.mean()
    return f", {rate:.1f} a second ({1000 * median:.1f} ms apart, {1000 * longest:.1f} ms at most)"


def _listed(found: tuple[Spell, ...]) -> str:
    if not found:
        return ""
    total = sum(each.seconds for each in found)
    named = [f"{each.seconds:.2f} s at {each.at_s:.1f} s" for each in found[:MAX_LISTED]]
    more = f" and {len(found) - MAX_LISTED} more" if len(found) > MAX_LISTED else ""
    return f"{quantity(len(found), 'time')}, {total:.1f} s in all: {', '.join(named)}{more}"


def _counts(found: tuple[tuple[str, int], ...]) -> str:
    return ", ".join(f"{word or 'nothing'} {count}" for word, count in found[:MAX_LISTED])


def _frames(found: tuple[tuple[str, int], ...], words: dict[str, str]) -> str:
    """Return how many frames there are of what is in `words`: "markers in 748 frames, …"."""
    named = [(words[key], quantity(count, "frame")) for key, count in found if key in words]
    return ", ".join(f"{word} in {frames}" for word, frames in named[:MAX_LISTED])


def _durations(figures: SessionFigures, found: tuple[Spell, ...]) -> str:
    return ", ".join(f"{what} {s:.1f} s" for what, s in figures.shares(found).items())


def _error_line(figures: SessionFigures) -> str:
    error = figures.errors_px
    if not len(error):
        return ""
    median, slow = np.median(error), np.quantile(error, 0.95)
    return f"{median:.2f} px in the median, {slow:.2f} px at the 95th percentile"


def _link_line(figures: SessionFigures) -> str:
    link = figures.link
    if not link.sent and not link.received:
        return ""
    delay = ""
    if link.delay_ms is not None:
        delay = f", {link.delay_ms[0]:.0f} ms in the median, {link.delay_ms[1]:.0f} ms at the 95th"
    asked = quantity(link.commands, "command")
    return (
        f"{asked}, {link.acknowledged:,} acknowledged{delay}, {link.refused:,} refused; "
        f"{link.sent:,} bytes sent, {link.received:,} received"
    )


def _number(value: float | np.floating[Any]) -> float | None:
    return round(float(value), 6) if math.isfinite(value) else None


def _spell(spell: Spell) -> dict[str, Any]:
    what = {"what": spell.what} if spell.what else {}
    return {"at_s": spell.at_s, "seconds": spell.seconds, **what}

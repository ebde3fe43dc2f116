"""Lab Streaming Layer: streams that a lab's recorder lines up with its other instruments.

Stamps are in LSL's own clock, at the moments when the frames were taken. No stream has a nominal
rate: cameras leave frames out, and a recorder would spread the stamps of a regular stream evenly.
"""

import math
import time
from collections.abc import Callable, Sequence

import pylsl

from cubeling.app.bridges.channels import COLUMNS
from cubeling.app.pipeline.scenario import EmotionTarget, Inputs
from cubeling.app.pipeline.step import Step
from cubeling.app.running.instrument import Instrument
from cubeling.app.workshop.exporting.column import Column
from cubeling.characters import Character
from cubeling.tracking import CubeControls, CubeState

SOURCE_ID = "cubeling"
"""How the ids of our streams begin: a recorder finds a stream again that was away."""

MAX_MARKERS_AT_ONCE = 16
"""So many markers are taken in a frame; others wait."""

MAX_MARKER_CHARS = 200
"""Of a longer marker the beginning is taken."""

MARK_EVENT = "mark "
"""How the events of marks begin."""

NUMBER_STREAMS = {
    "cube": (CubeState, ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw", "vx_m_s", "vy_m_s", "vz_m_s",
                         "wx_rad_s", "wy_rad_s", "wz_rad_s", "reprojection_error_px"), "MoCap"),
    "controls": (CubeControls, ("heading_rad", "turns", "x_m", "z_m"), "Control"),
    "emotion": (EmotionTarget, ("valence", "arousal"), "Emotion"),
}  # fmt: skip
"""Streams of numbers, a sample each frame: of which message, which of its columns, and the type of
the content by the conventions of XDF."""

TEXT_STREAMS = ("actions", "events", "marks")
"""Streams of texts, a sample whenever something happens."""


class LslOut(Instrument):
    """Offers the streams of a session, whose names begin with `name`."""

    def __init__(self, name: str = "Cubeling") -> None:
        self._columns = {
            stream: tuple(each for each in COLUMNS[kind] if each.name in names)
            for stream, (kind, names, _) in NUMBER_STREAMS.items()
        }
        self._kinds = {kind: stream for stream, (kind, _, _) in NUMBER_STREAMS.items()}
        self._outlets = {
            stream: pylsl.StreamOutlet(_numbers_info(name, stream, self._columns[stream], content))
            for stream, (_, _, content) in NUMBER_STREAMS.items()
        }
        self._outlets |= {
            stream: pylsl.StreamOutlet(_texts_info(name, stream)) for stream in TEXT_STREAMS
        }
        self._acting = ""

    def follow(self, step: Step, cast: Sequence[Character], taken: float) -> Inputs:
        """Push a sample of each stream of numbers, and an action that begins or ends."""
        stamp = lsl_time(taken)
        for message in (step.state, step.controls, step.emotion):
            stream = self._kinds[type(message)]
            cells = [column.value(message) for column in self._columns[stream]]
            numbers = [math.nan if cell is None else float(cell) for cell in cells]
            self._outlets[stream].push_sample(numbers, stamp)
        acting = step.command.activity if step.command.visible else "hidden"
        if acting != self._acting:
            self._acting = acting
            self._outlets["actions"].push_sample([acting], stamp)
        return Inputs()

    def happen(self, event: str, taken: float) -> None:
        """Push a mark or another event."""
        stream = "marks" if event.startswith(MARK_EVENT) else "events"
        self._outlets[stream].push_sample([event], lsl_time(taken))

    def close(self) -> None:
        """End the streams; a second call does nothing."""
        self._outlets.clear()  # pylsl ends a stream with its object


class LslIn(Instrument):
    """Takes the markers of a stream as marks.

    It looks for the stream by its name, also while the session runs. `on_problem` is called with
    one line when the stream is there, and when it has been lost.
    """

    def __init__(self, name: str, on_problem: Callable[[str], None]) -> None:
        self._name, self._on_problem = name, on_problem
        self._resolver = pylsl.ContinuousResolver(prop="name", value=name)
        self._inlet: pylsl.StreamInlet | None = None

    def follow(self, step: Step, cast: Sequence[Character], taken: float) -> Inputs:
        """Return the marks that have come since the last frame."""
        if self._inlet is None:
            found = self._resolver.results()
            if not found:
                return Inputs()
            self._inlet = pylsl.StreamInlet(found[0], max_buflen=10, recover=True)
            self._on_problem(f"LSL: marks come from the stream {self._name}")
        marks: list[str] = []
        try:
            while len(marks) < MAX_MARKERS_AT_ONCE:
                sample, _ = self._inlet.pull_sample(timeout=0.0)
                if sample is None:
                    break
                text = " ".join(str(sample[0])[:MAX_MARKER_CHARS].split())
                marks += [text] if text.isprintable() and text else []
        except pylsl.LostError:
            self._inlet = None
            self._on_problem(f"LSL: the stream {self._name} is lost; looking for it")
        return Inputs(marks=tuple(marks))

    def close(self) -> None:
        """Let go of the stream; a second call does nothing."""
        self._inlet = None


def lsl_time(monotonic: float) -> float:
    """Return a time of `time.monotonic` in LSL's clock [s].

    On Linux both count since the start of the computer, elsewhere they need not.
    """
    before = time.monotonic()
    now = pylsl.local_clock()
    between = (before + time.monotonic()) / 2.0  # in the middle, whichever call was slow
    return float(now + (monotonic - between))


def _numbers_info(
    name: str, stream: str, columns: Sequence[Column], content: str
) -> pylsl.StreamInfo:
    """Describe a stream of numbers: its channels with their units, as in XDF's metadata."""
    info = pylsl.StreamInfo(
        f"{name} {stream}",
        content,
        len(columns),
        pylsl.IRREGULAR_RATE,
        pylsl.cf_double64,
        f"{SOURCE_ID}:{name}:{stream}",
    )
    channels = info.desc().append_child("channels")
    for column in columns:
        channel = channels.append_child("channel")
        channel.append_child_value("label", column.name)
        channel.append_child_value("unit", column.unit or "none")
        channel.append_child_value("type", content)
        channel.append_child_value("description", column.meaning)
    _describe(info)
    return info


def _texts_info(name: str, stream: str) -> pylsl.StreamInfo:
    """Describe a stream of texts."""
    info = pylsl.StreamInfo(
        f"{name} {stream}",
        "Markers",
        1,
        pylsl.IRREGULAR_RATE,
        pylsl.cf_string,
        f"{SOURCE_ID}:{name}:{stream}",
    )
    _describe(info)
    return info


def _describe(info: pylsl.StreamInfo) -> None:
    acquisition = info.desc().append_child("acquisition")
    acquisition.append_child_value("manufacturer", "Cubeling")

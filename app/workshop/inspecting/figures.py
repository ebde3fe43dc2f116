"""The figures of a recorded session: rates, gaps, tracking, actions, emotion, and the link."""

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.scenarios import find_scenario
from cubeling.app.session import Mark, SessionFile, SessionInfo, WizardAct
from cubeling.app.session.encoding import IMAGE_TOPIC
from cubeling.app.workshop.moods import read_robot_traces
from cubeling.characters import PosedCharacter
from cubeling.tracking import CubeState

Array = NDArray[np.float64]

GAP_FACTOR, MIN_GAP_S = 2.5, 0.1
"""An interval between frames is a gap if it is so many times the usual one, and at least so long
[s]."""


@dataclass(frozen=True)
class Spell:
    """Something that lasted for a while."""

    at_s: float
    """When it began, from the first frame [s]."""

    seconds: float
    """How long it lasted [s]."""

    what: str = ""
    """Its name: of a state, or of an emotion."""


@dataclass(frozen=True)
class ChannelFigures:
    """How much there is on a channel."""

    topic: str
    messages: int
    unpacked_size: int
    """All its messages together [bytes]; those of several channels are compressed as one."""

    rate: float
    """Messages a second of the session."""


@dataclass(frozen=True)
class LinkFigures:
    """How the line to the robot was."""

    commands: int = 0
    """Emotions and actions that it was asked, without repetitions."""

    acknowledged: int = 0
    """Emotions that it acknowledged, and actions that it took."""

    refused: int = 0
    reasons: tuple[str, ...] = ()
    """Why it refused, each once."""

    delay_ms: tuple[float, float] | None = None
    """From command to acknowledgement: the median and the 95th percentile [ms]."""

    sent: int = 0
    """What went to the robot, its frames and what they are wrapped in [bytes]."""

    received: int = 0
    """What came from it [bytes]."""


@dataclass(frozen=True)
class SessionFigures:
    """What there is in a session. Times are from its first frame [s]."""

    name: str
    info: SessionInfo
    played: Mapping[str, str]
    """What was played, resolved, as in `info`; what it does not say is as it was computed now, or
    as the scenario has it."""

    size: int
    """Size of its file [bytes]."""

    channels: tuple[ChannelFigures, ...]
    intervals: Array
    """Between frames [s]."""

    gaps: tuple[Spell, ...]
    """Where frames are missing."""

    times: Array
    """Of the frames in which the cube was looked for, (n,)."""

    visible: NDArray[np.bool_]
    """Whether it was found, (n,)."""

    lost: tuple[Spell, ...]
    """Where it was not."""

    verdicts: tuple[tuple[str, int], ...]
    """Why poses were trusted or refused, with the number of frames, the most frequent first."""

    measured_on: tuple[tuple[str, int], ...]
    """What poses were measured on, in the same way."""

    errors_px: Array
    """Reprojection errors of the poses that were found [px]."""

    states: tuple[Spell, ...]
    """What the character did."""

    emotion: Array
    """Valence and arousal in each frame, (m, 2)."""

    emotion_times: Array
    """Their times, (m,)."""

    labels: tuple[Spell, ...]
    """The words for them."""

    link: LinkFigures
    events: tuple[tuple[str, int], ...]
    """What happened besides marks, by its name, with how often."""

    marks: tuple[Mark, ...] = field(default=())
    acts: tuple[WizardAct, ...] = field(default=())
    """What a wizard did."""

    @property
    def found_share(self) -> float:
        """Share of the frames in which the cube was found, 0…1; NaN without any."""
        return float(self.visible.mean()) if len(self.visible) else float("nan")

    def shares(self, spells: tuple[Spell, ...]) -> dict[str, float]:
        """Return how long each thing lasted in all [s], the longest first."""
        seconds: Counter[str] = Counter()
        for spell in spells:
            seconds[spell.what] += spell.seconds  # type: ignore[assignment] # any number adds
        return dict(seconds.most_common())


def read_figures(path: Path, complete: Path, *, salvage: bool = False) -> SessionFigures:
    """Read the figures of a session.

    Parameters
    ----------
    path
        The session.
    complete
        The same with every channel: itself, or one that was computed of it.
    salvage
        Whether to take the intact part of a session that was cut off, instead of refusing it.

    Raises
    ------
    AppError
        It is no session, or was cut off.
    """
    with SessionFile(path, salvage=salvage) as session:
        info, marks, events = session.info, session.marks, session.events
        acts = session.wizard_acts
        frames = np.array([time for _, time, _ in session.messages(IMAGE_TOPIC)])
        channels = tuple(_channels(session))
    first = float(frames[0]) if len(frames) else 0.0
    with SessionFile(complete, salvage=salvage) as session:
        computed = session.info.played
        states = _read(session, "/cube/state", CubeState)
        posed = _read(session, "/character/pose", PosedCharacter)
        felt = _read(session, "/robot/emotion", EmotionTarget)
    times = np.array([time - first for time, _ in states])
    visible = np.array([state.visible for _, state in states], bool)
    hidden = [(t - first, "" if state.visible else "lost") for t, state in states]
    return SessionFigures(
        name=path.name,
        info=info,
        played={**_own_of(info.options.scenario), **_asked(info), **(info.played or computed)},
        size=path.stat().st_size,
        channels=channels,
        intervals=np.diff(frames),
        gaps=_gaps(frames - first),
        times=times,
        visible=visible,
        lost=tuple(spell for spell in spells(hidden) if spell.what),
        verdicts=_counted(str(state.verdict) for _, state in states),
        measured_on=_counted(str(state.source) for _, state in states if state.visible),
        errors_px=np.array(
            [
                s.reprojection_error
                for _, s in states
                if s.visible and np.isfinite(s.reprojection_error)
            ]
        ),
        states=spells([(time - first, pose.state) for time, pose in posed]),
        emotion=np.array([(f.emotion.valence, f.emotion.arousal) for _, f in felt]).reshape(-1, 2),
        emotion_times=np.array([time - first for time, _ in felt]),
        labels=spells([(time - first, target.emotion.label) for time, target in felt]),
        link=_link(complete),
        events=_counted(event for _, event in events if not event.startswith("mark ")),
        marks=marks,
        acts=acts,
    )


def spells(changes: list[tuple[float, str]]) -> tuple[Spell, ...]:
    """Return what lasted how long, from times and what was then; the last one has no length.

    >>> [each.what for each in spells([(0.0, "a"), (1.0, "a"), (2.0, "b")])]
    ['a', 'b']
    """
    found: list[tuple[float, str]] = []
    for time, what in changes:
        if not found or found[-1][1] != what:
            found.append((time, what))
    ends = [*(time for time, _ in found[1:]), *(time for time, _ in changes[-1:])]
    return tuple(
        Spell(round(time, 3), round(end - time, 3), what)
        for (time, what), end in zip(found, ends, strict=True)
    )


def _own_of(scenario: str) -> dict[str, str]:
    """Return the character and personality of a scenario; nothing of one that is not here."""
    try:
        found = find_scenario(scenario)
    except AppError:
        return {}
    return {"character": found.character, "personality": found.personality}


def _asked(info: SessionInfo) -> dict[str, str]:
    """Return what was asked for instead, which older sessions say."""
    options = info.options
    asked = {"character": options.character, "personality": options.personality}
    return {name: text for name, text in asked.items() if text}


def _read(session: SessionFile, topic: str, kind: type[Any]) -> list[tuple[float, Any]]:
    return [(time, message) for _, time, message in session.decode_messages({topic: kind})]


def _channels(session: SessionFile) -> Iterator[ChannelFigures]:
    counts: Counter[str] = Counter()
    sizes: Counter[str] = Counter()
    for topic, _, data in session.messages():
        counts[topic] += 1
        sizes[topic] += len(data)
    seconds = max(session.info.duration, 1e-9)
    for topic in sorted(counts):
        yield ChannelFigures(topic, counts[topic], sizes[topic], counts[topic] / seconds)


def _gaps(frames: Array) -> tuple[Spell, ...]:
    intervals = np.diff(frames)
    if not len(intervals):
        return ()
    least = max(GAP_FACTOR * float(np.median(intervals)), MIN_GAP_S)
    where = np.flatnonzero(intervals > least)
    return tuple(Spell(round(float(frames[i]), 3), round(float(intervals[i]), 3)) for i in where)


def _counted(words: Iterator[str]) -> tuple[tuple[str, int], ...]:
    return tuple(Counter(words).most_common())


def _link(path: Path) -> LinkFigures:
    traces = read_robot_traces(path)
    events = traces.events
    refused = [event.reason for event in events if event.what == "refused"]
    sizes: Counter[str] = Counter()
    with SessionFile(path) as session:
        for _, _, data in session.messages("/robot/wire"):
            line = json.loads(data)
            sizes[line["direction"]] += len(line["hex"]) // 2
    delays = 1000.0 * traces.delays
    return LinkFigures(
        commands=sum(event.what in ("commanded", "asked") for event in events),
        acknowledged=sum(event.what in ("acknowledged", "taken") for event in events),
        refused=len(refused),
        reasons=tuple(dict.fromkeys(refused)),
        delay_ms=(float(np.median(delays)), float(np.quantile(delays, 0.95)))
        if len(delays)
        else None,
        sent=sizes["tx"],
        received=sizes["rx"],
    )

"""BodySpeech: what the character says, and how its face and hands say it."""

from cubeling.app.ui.palette import ACTION_COLORS, QUIET
from cubeling.app.ui.panels.content import (
    Choice,
    Fact,
    Note,
    Panel,
    Plot,
    PlotCurve,
    Slider,
    Widget,
)
from cubeling.app.ui.panels.monitor import SPEECH_SPAN_S, SessionMonitor
from cubeling.app.ui.playback.requests import ChangeSpeech
from cubeling.characters.speech import DATABASES, RANGES, SpeechProfile, viseme_sets

SLIDERS = {
    "gesture_emphasis": "Gestures",
    "face_emphasis": "Face",
    "liveliness": "Whole body",
    "cube_emphasis": "Emphasis by the cube",
    "accent_threshold": "Accents from",
    "accent_distance": "Between accents [s]",
    "threshold": "Gestures' unlikeness",
}
"""The numbers that can be changed while it plays, with their names."""

MAX_SHOWN = 1.5
"""Right end of sliders whose values may be larger."""


def content(monitor: SessionMonitor) -> tuple[Widget, ...]:
    """Return what is said, its accents, and the profile."""
    if monitor.voice_problem:
        return (Note(monitor.voice_problem, "warning"),)
    profile = monitor.profile
    return (_text_note(monitor), _plot(monitor), *_graph(monitor), *_settings(monitor, profile))


def _text_note(monitor: SessionMonitor) -> Widget:
    step = monitor.step
    speech = None if step is None else step.command.speech
    return Note("Nothing is being said." if speech is None else speech.utterance.text, "plain")


def _plot(monitor: SessionMonitor) -> Widget:
    times, loudness, accents = monitor.speech.table().T
    curves = (
        PlotCurve("loudness", times, loudness, QUIET),
        PlotCurve("accents", times, accents, ACTION_COLORS["shout"], 3.0),
    )
    return Plot("Speech", curves, SPEECH_SPAN_S, 0.0, 1.0)


def _graph(monitor: SessionMonitor) -> tuple[Widget, ...]:
    """Return what is known of the gesture graph, once something has been said."""
    graph = monitor.gesture_graph
    if graph is None:
        return (Fact("Gestures", "by the head alone", "quiet"),)
    return (
        Fact("Gestures", f"{len(graph.nodes)} of {len(graph.library.phrases)} phrases"),
        Fact("Branching factor", f"{graph.branching:.1f} at {graph.threshold:g}"),
    )


def _settings(monitor: SessionMonitor, profile: SpeechProfile) -> tuple[Widget, ...]:
    free = monitor.speaks
    sliders = [
        Slider(name, words, getattr(profile, name), *_range(name), free, ChangeSpeech)
        for name, words in SLIDERS.items()
    ]
    widgets: list[Widget] = [
        Choice("database", "Gesture database", profile.database, DATABASES, free, ChangeSpeech),
        Choice("visemes", "Visemes", profile.visemes, tuple(viseme_sets()), free, ChangeSpeech),
        *sliders,
    ]
    if free:
        language = Choice(
            "language", "Language", monitor.language, monitor.languages, free, ChangeSpeech
        )
        return language, *widgets
    return (*widgets, Note("What a recording says stays as it was said."))


def _range(name: str) -> tuple[float, float]:
    low, high = RANGES[name]
    return low, min(high, MAX_SHOWN)


SPEECH = Panel("speech", "Speech", 316.0, content)

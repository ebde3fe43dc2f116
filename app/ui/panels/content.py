"""What a panel consists of, apart from how it is drawn."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.palette import Color
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.playback.requests import ChangeSetting, SessionRequest

Tone = Literal["plain", "good", "warning", "bad", "quiet"]
"""How a value is meant."""


@dataclass(frozen=True)
class Fact:
    """A line with a name and a value."""

    name: str

    value: str
    """The value with its unit."""

    tone: Tone = "plain"
    """How it is meant."""


@dataclass(frozen=True)
class Note:
    """A sentence over the width of a panel."""

    text: str
    """It is wrapped at the panel's width."""

    tone: Tone = "quiet"
    """How it is meant."""


@dataclass(frozen=True)
class PlotCurve:
    """A value over time."""

    name: str
    """What it is, for the legend."""

    times: NDArray[np.float64]
    """(n,) [s], from −span to 0, which is now."""

    values: NDArray[np.float64]
    """(n,); NaN leaves a gap."""

    color: Color

    width: float = 2.0
    """Width of its line [design units]."""


@dataclass(frozen=True)
class Plot:
    """Curves over the same last seconds."""

    title: str

    curves: tuple[PlotCurve, ...]
    """The first one lies below the others."""

    span: float
    """How much time it shows [s]."""

    low: float
    """Value at the bottom."""

    high: float
    """Value at the top."""

    marks: tuple[tuple[float, str], ...] = ()
    """Values with a line and a word."""

    height: float = 70.0
    """Height of the plot [design units]."""


@dataclass(frozen=True)
class Share:
    """A part of a whole."""

    name: str

    amount: float
    """How much of it there is."""

    value: str
    """The amount with its unit."""

    color: Color


@dataclass(frozen=True)
class ShareBar:
    """A stacked bar with a legend."""

    shares: tuple[Share, ...]
    """From left to right."""


@dataclass(frozen=True)
class Choice:
    """A setting that has one of several values."""

    setting: str
    """The option that it changes."""

    name: str

    value: str
    """The one that is chosen now."""

    choices: tuple[str, ...]
    """What can be chosen."""

    enabled: bool = True
    """Whether it can be changed now."""

    request: Callable[[str, str], SessionRequest] = ChangeSetting
    """Asks the session to change it, from its name and its new value."""


@dataclass(frozen=True)
class Slider:
    """A setting with a number."""

    setting: str
    """The option that it changes."""

    name: str

    value: float
    """Where it stands now, `low`…`high`."""

    low: float

    high: float

    enabled: bool = True
    """Whether it can be changed now."""

    request: Callable[[str, float], SessionRequest] = ChangeSetting
    """Asks the session to change it, from its name and its new value."""


@dataclass(frozen=True)
class Switch:
    """A setting that is on or off."""

    setting: str
    """The option that it changes."""

    name: str

    value: bool
    """Whether it is on."""

    request: Callable[[str, bool], SessionRequest]
    """Asks the session to change it, from its name and its new value."""


@dataclass(frozen=True)
class LogLines:
    """The last messages, newest last."""

    rows: tuple[tuple[str, str, str], ...]
    """When, from whom and what."""

    length: int
    """How many rows have a place, so that the panel does not change its size."""


Widget = Fact | Note | Plot | ShareBar | Choice | Slider | Switch | LogLines


@dataclass(frozen=True)
class Panel:
    """A panel of the window. To add one, write a module and list it in `app.ui.panels.PANELS`."""

    name: str
    """Its name on the command line."""

    title: str

    width: float
    """Its width [design units]."""

    content: Callable[[SessionMonitor], tuple[Widget, ...]]
    """What it shows now; called some times a second while it is open, after the first frame."""

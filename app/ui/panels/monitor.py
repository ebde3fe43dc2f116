"""What the panels show of a session: its last steps, its robot, its times."""

from collections import deque
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.frame_times import FrameTimes
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.session import SessionOptions
from cubeling.app.ui.panels.wire_log import WireLog
from cubeling.characters.rendering import FULL
from cubeling.characters.speech import DEFAULT_PROFILE
from cubeling.tracking import Intrinsics, LensEstimate

if TYPE_CHECKING:
    from cubeling.app.pipeline.playground import Playground
    from cubeling.characters.motion import GestureGraph

EMOTION_SPAN_S, EMOTION_INTERVAL_S = 60.0, 0.1
"""How long emotions are kept, and the least time between two of them."""

SPEECH_SPAN_S = 6.0
"""How long loudness and accents are kept."""

ACCENT_SHOWN_S = 0.05
"""An accent is shown for so long before and after its time."""

FULL_LOUDNESS = 0.25
"""Root mean square of samples that fills the plot."""

TRACKING_SPAN_S = 10.0
"""How long the tracker's results are kept."""


class SessionMonitor:
    """Collects what the panels show, frame by frame; bounded in memory and in time.

    Parameters
    ----------
    options
        Of the session.
    times
        How long each part of a frame takes.
    """

    def __init__(self, options: SessionOptions, times: FrameTimes) -> None:
        self.options = options
        """Of the session, with what the player has changed since."""
        self.times = times
        """How long each part of a frame takes."""
        self.fixed = False
        """Whether the scenario and its settings stay as they are now."""
        self.sound_problem = ""
        """Why nothing is heard, "" if nothing is wrong."""
        self.wire = WireLog()
        """The robot's line."""
        self.emotions = Trace(4, EMOTION_SPAN_S, EMOTION_INTERVAL_S)
        """Valence and arousal of the character and of the robot; NaN while the robot has none."""
        self.tracking = Trace(2, TRACKING_SPAN_S)
        """Of each frame: whether the cube was visible, 0 or 1, and its reprojection error [px]."""
        self.speech = Trace(2, SPEECH_SPAN_S)
        """Of each frame: how loud speech is, and the strength of the accent in it, both 0…1."""
        self.gesture_graph: GestureGraph | None = None
        """What the gestures of the last speech were chosen from; None without gestures."""
        self.profile = DEFAULT_PROFILE
        """How the next line is said with the body."""
        self.speaks = False
        """Whether a voice speaks, so that the profile can be changed."""
        self.language = ""
        """The language of the voice."""
        self.languages: tuple[str, ...] = ()
        """The languages that can be chosen."""
        self.voice_problem = ""
        """Why nothing is said, "" if nothing is wrong."""
        self.step: Step | None = None
        """The last step."""
        self.robot = RobotView("none", 0.0, "neutral")
        """The robot at the last step."""
        self.lens = LensEstimate()
        """What the cube has shown of the lens."""
        self.quality = FULL.name
        """How finely characters are drawn."""
        self.intrinsics: Intrinsics | None = None
        """Of the camera, as well as play has told them; None before the first step."""

    def update(self, step: Step, robot: RobotView, playground: "Playground") -> None:
        """Take what a frame gave; who has the session keeps the other attributes up to date."""
        self.step, self.robot = step, robot
        self.lens, self.intrinsics = playground.tracked.lens, playground.tracked.measured_intrinsics
        self.quality = playground.quality.name
        now, state, feels = step.frame.timestamp, step.state, step.emotion.emotion
        shown = robot.shown
        theirs = (np.nan, np.nan) if shown is None else (shown.valence, shown.arousal)
        self.emotions.add(now, feels.valence, feels.arousal, *theirs)
        error = state.reprojection_error if state.visible else np.nan
        self.tracking.add(now, float(state.visible), error)
        self._listen(step, playground)

    def _listen(self, step: Step, playground: "Playground") -> None:
        """Take what is said in a frame."""
        now, line, speech = step.frame.timestamp, step.line, step.command.speech
        if line is None or speech is None:
            self.speech.add(now, 0.0, 0.0)
            return
        at = round((now - speech.start) * line.rate)
        heard = line.samples[at : at + line.rate // 30]
        loudness = float(np.sqrt(np.mean(heard * heard))) if len(heard) else 0.0
        accents = [
            each.strength
            for each in line.utterance.accents
            if abs(speech.start + each.time - now) < ACCENT_SHOWN_S
        ]
        self.speech.add(now, min(loudness / FULL_LOUDNESS, 1.0), max(accents, default=0.0))
        gestures = playground.character.gestures
        self.gesture_graph = None if gestures is None else speech.profile.planner(gestures).graph


class Trace:
    """Keeps rows of values for a time; time that goes back, as after a seek, empties it first.

    Parameters
    ----------
    columns
        How many values a row has.
    span
        How long a row is kept [s].
    interval
        Rows that come sooner after the last one are left out [s].
    """

    def __init__(self, columns: int, span: float, interval: float = 0.0) -> None:
        self.span = span
        """How long a row is kept [s]."""
        self._columns, self._interval = columns, interval
        self._rows: deque[tuple[float, ...]] = deque()

    def add(self, timestamp: float, *values: float) -> None:
        """Add a row, and forget those that are too old."""
        rows = self._rows
        if rows and timestamp < rows[-1][0]:
            rows.clear()
        if rows and timestamp - rows[-1][0] < self._interval:
            return
        rows.append((timestamp, *values))
        while timestamp - rows[0][0] > self.span:
            rows.popleft()

    def table(self) -> NDArray[np.float64]:
        """Return the rows (n, 1 + columns): time before the last row, −span…0 [s], and values.

        >>> trace = Trace(1, span=2.0)
        >>> for second in range(5):
        ...     trace.add(second, 10.0 * second)
        >>> trace.table().tolist()
        [[-2.0, 20.0], [-1.0, 30.0], [0.0, 40.0]]
        """
        table = np.array(self._rows, float).reshape(-1, 1 + self._columns)
        if len(table):
            table[:, 0] -= table[-1, 0]
        return table

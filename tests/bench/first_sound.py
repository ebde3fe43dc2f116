"""How long after Enter a reply is heard: `python -m tests.bench.first_sound [--lines 30]`.

A whole session runs in real time at 30 frames a second: the dialogue, the voice and its analysis,
the animation, the mixer. Somebody begins to type, and presses Enter 0.3 s later. The loudspeaker is
a stand-in that asks the mixer for blocks of 10 ms as a device does, and keeps when it was given
each: the first block of the reply that is not silent counts, and the latency of a real device
(`LATENCY_S`) is added. Nothing is drawn, unless `--draw` asks for it.

Half of the lines are spoken by a voice that runs, half by one whose program must start first.

Exits with 1 if the median of either is above `MAX_MEDIAN_S`.
"""

import argparse
import sys
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.cubes.tracked_cube import TrackedCube
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.running.front_end import FrontEnd
from cubeling.app.running.opened_session import OpenedSession, open_camera
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionOptions
from cubeling.app.sound import Mixer
from cubeling.app.sound.loudspeaker import LATENCY_S
from cubeling.app.sound.synthesis import SAMPLE_RATE
from cubeling.app.speaking.speaker import LiveSpeaker
from cubeling.app.ui.screen import NullScreen
from cubeling.tracking import CubeState, Frame
from cubeling.tracking.synthetic import open_synthetic
from tests.app.scripted import VARIANCE, Blank

MAX_MEDIAN_S = 0.2
"""The bar: from Enter to the first sound [s]."""

BLOCK_S = 0.01
"""Length of what a device asks for at once [s]."""

AUDIBLE = 1e-3
"""Amplitude from which on a block counts as sound."""

TYPING_S, LISTEN_S, GIVE_UP_S = 0.3, 0.4, 5.0
"""From the first letter to Enter, from the first sound to the next line, and longest wait [s]."""

LINES = (
    "hello", "how old are you", "tell me a joke", "i like triceratops", "are you sad", "yes",
    "what do you eat", "i am afraid of the dark", "do you know t rex", "tell me about eggs",
    "can you fly", "why is the sky blue", "i went to the museum", "xyzzy", "you are nice",
)  # fmt: skip


class LiveScript(Blank):
    """Black pictures that come in real time, as from a camera."""

    live = True
    duration: float | None = None

    def __iter__(self) -> Iterator[Frame]:
        began = time.monotonic()
        for frame in super().__iter__():
            time.sleep(max(began + frame.index / self.rate - time.monotonic(), 0.0))
            yield Frame(frame.image, time.monotonic() - began, frame.index)


class StampingLoudspeaker:
    """A device that asks for blocks at its own pace, and keeps when one began to sound."""

    playing, problem = True, ""

    def __init__(self, mixer: Mixer) -> None:
        mixer.start = lambda cue: None  # type: ignore[method-assign]  # speech alone is measured
        self._mixer, self._ended = mixer, threading.Event()
        self.began: float | None = None
        """When sound came after silence, the last time [s]."""
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        due, silent = time.monotonic(), True
        while not self._ended.wait(max(due - time.monotonic(), 0.0)):
            block = self._mixer.render(round(BLOCK_S * SAMPLE_RATE))
            sounds = bool(np.abs(block).max() > AUDIBLE)
            if sounds and silent:
                heard = int((np.abs(block).max(axis=1) > AUDIBLE).argmax()) / SAMPLE_RATE
                self.began = time.monotonic() + heard
            silent = not sounds
            due += BLOCK_S

    def close(self) -> None:
        """End the thread."""
        self._ended.set()
        self._thread.join(1.0)


class Typist(NullScreen):
    """Types one line after the other, and keeps how long each answer takes."""

    attended = True

    def __init__(self, count: int) -> None:
        self.took: dict[str, list[float]] = {"warm": [], "cold": []}
        self.missed = 0
        self.loudspeaker: StampingLoudspeaker | None = None
        self.session: OpenedSession | None = None
        self._count, self._number = count, 0
        self._begun: float | None = None
        self._entered: float | None = None
        self._free = time.monotonic() + 4.0  # it speaks first
        self.closed = False

    @property
    def _kind(self) -> str:
        return "cold" if self._number % 2 else "warm"

    def show(self, step, robot):
        now, device = time.monotonic(), self.loudspeaker
        if self._entered is not None and device is not None:
            heard = device.began is not None and device.began > self._entered
            if heard or now - self._entered > GIVE_UP_S:
                if heard and device.began is not None:
                    self.took[self._kind].append(device.began - self._entered + LATENCY_S)
                self.missed += not heard
                self._entered, self._free = None, now + LISTEN_S
                self._number += 1
                self.closed = self._number >= self._count
        elif self._begun is not None and now - self._begun >= TYPING_S:
            self._begun, self._entered = None, time.monotonic()
            return Inputs(typed=LINES[self._number // 2 % len(LINES)])
        elif self._begun is None and self._entered is None and now >= self._free:
            self._begun = now
            if self._kind == "cold":
                self._stop_voice()
            return Inputs(hush=True)
        return Inputs()

    def _stop_voice(self) -> None:
        assert self.session is not None
        assert isinstance(self.session.speaker, LiveSpeaker)
        voice = self.session.speaker._voice
        if voice is not None:
            voice.close()


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Measure how soon a reply is heard.")
    parser.add_argument("--lines", type=int, default=60)
    parser.add_argument("--draw", action="store_true", help="draw the pictures, too")
    wanted = parser.parse_args()
    script = open_synthetic("talk?rate=30&size=640x360&frames=100000")
    screen = Typist(wanted.lines)

    def track(_: TrackedCube, frame: Frame, markers: object) -> CubeState:
        pose, still = script.truth(0), np.zeros(6)
        return CubeState(True, pose, still, VARIANCE, "markers", (), 0.1, frame.timestamp)

    def open_screen(size, folder, closing):
        if not wanted.draw:
            return screen, None
        from cubeling.characters.rendering import create_context

        context = create_context()
        closing.callback(context.release)
        return screen, context

    def open_loudspeaker(mixer: Mixer) -> StampingLoudspeaker:
        screen.loudspeaker = StampingLoudspeaker(mixer)
        return screen.loudspeaker

    front = FrontEnd(open_screen, open_loudspeaker, open_camera)
    options = SessionOptions(scenario="talk", source="script", robot="none")
    with (
        pytest.MonkeyPatch.context() as patch,
        open_session(options, source=LiveScript(script), front_end=front) as session,
    ):
        patch.setattr(TrackedCube, "track", track)
        screen.session = session
        summary = run(session)
        problem = session.speaker.problem
    table = Table("voice", "lines", "median [ms]", "95 % [ms]", "longest [ms]", title="first sound")
    late = False
    for kind, took in screen.took.items():
        if not took:
            continue
        median, high = (1e3 * float(np.quantile(took, share)) for share in (0.5, 0.95))
        late |= median > 1e3 * MAX_MEDIAN_S
        table.add_row(
            kind, f"{len(took)}", f"{median:.0f}", f"{high:.0f}", f"{1e3 * max(took):.0f}"
        )
    console = Console()
    console.print(table, f"{screen.missed} lines without a sound", *filter(None, [problem]))
    console.print(f"{summary.frames} frames; the device's {1e3 * LATENCY_S:.0f} ms are in it")
    return 1 if late or screen.missed or not all(screen.took.values()) else 0


if __name__ == "__main__":
    sys.exit(main())

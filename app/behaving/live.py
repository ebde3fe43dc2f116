"""A character that performs blocks while it plays: in a window, or without one."""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cubeling.app.behaving.camera import FollowingCamera
from cubeling.app.behaving.player import BehaviourFrame, BehaviourPlayer
from cubeling.app.behaving.recording import SETTLE_S, placed_pose
from cubeling.app.behaving.server import BlockServer
from cubeling.app.sound.bank import SoundBank
from cubeling.app.sound.loudspeaker import Loudspeaker
from cubeling.app.sound.mixer import Mixer
from cubeling.app.sound.session_sound import SPEECH_GAIN, at_sample_rate
from cubeling.app.sound.synthesis import SAMPLE_RATE
from cubeling.app.speaking.speech_video import AZIMUTH_RAD, ELEVATION_RAD
from cubeling.app.speaking.view import View
from cubeling.app.thread_turns import often_switching
from cubeling.characters import Character
from cubeling.characters.behaviour import feedback_xml
from cubeling.characters.rendering import PortraitRenderer
from cubeling.characters.speech import blood_of

MAX_FRAME_DOCUMENTS = 16
"""Documents that are read and scheduled for one frame; others wait for the next one."""

MAX_FRAME_BYTES = 1 << 12
"""Size of the documents that are read for a frame besides the first one [B]: that may be long, and
short ones of others do not wait for a flood of such."""


class Output(Protocol):
    """Shows the frames of a player and lets them sound."""

    @property
    def closed(self) -> bool:
        """Whether the user has closed it."""
        ...

    def show(self, player: BehaviourPlayer, frame: BehaviourFrame) -> None:
        """Show a frame of the player, once; it may take as long as the display does."""
        ...


class NoOutput:
    """Shows nothing, for clients that want feedback only."""

    closed = False

    def show(self, player: BehaviourPlayer, frame: BehaviourFrame) -> None:
        """Do nothing: the feedback goes to the clients alone."""


class PictureScreen(Protocol):
    """What pictures are shown in: a `PictureWindow`."""

    @property
    def closed(self) -> bool:
        """Whether the user has closed it."""
        ...

    def show_picture(self, picture: NDArray[np.uint8]) -> None:
        """Show a picture, (height, width, 3) BGR."""
        ...

    def poll(self) -> None:
        """Process the window's events, so that it can be closed."""
        ...


class WindowOutput:
    """Shows the character in a window and lets its voice sound; see `open`."""

    @staticmethod
    @contextmanager
    def open(character: Character, size: tuple[int, int], view: View) -> "Iterator[WindowOutput]":
        """Open the window and the loudspeaker, and close them afterwards.

        Raises
        ------
        AppError
            There is no display.
        """
        from cubeling.app.ui.window.picture_window import (
            PictureWindow,  # needs a display's libraries
        )

        with ExitStack() as closing:
            window = PictureWindow(size, "Cubeling: behave")
            closing.callback(window.close)
            renderer = PortraitRenderer(window.context, size)
            closing.callback(renderer.release)
            mixer = Mixer(SoundBank())
            closing.callback(Loudspeaker(mixer).close)
            yield WindowOutput(character, window, renderer, mixer, view)

    def __init__(
        self,
        character: Character,
        window: PictureScreen,
        renderer: PortraitRenderer,
        mixer: Mixer,
        view: View,
    ) -> None:
        self._character, self._window, self._renderer = character, window, renderer
        self._voice = VoiceOutput(mixer)
        self._camera = FollowingCamera(character, view)

    @property
    def closed(self) -> bool:
        """Whether the user has closed the window."""
        return bool(self._window.closed)

    def show(self, player: BehaviourPlayer, frame: BehaviourFrame) -> None:
        """Draw a frame, and let what begins with it sound."""
        self._voice.update(player, frame)
        pose, now = placed_pose(frame.posed), frame.realized.now
        picture = self._renderer.portrait(
            self._character,
            pose,
            azimuth=AZIMUTH_RAD,
            elevation=ELEVATION_RAD,
            focus=self._camera.focus(pose, now),
            blood=blood_of(player.emotion),
        )
        self._window.show_picture(picture)
        self._window.poll()


class VoiceOutput:
    """Lets the voice sound from where it is; what is cut off falls silent."""

    def __init__(self, mixer: Mixer) -> None:
        self._mixer = mixer
        self._key = ""

    def update(self, player: BehaviourPlayer, frame: BehaviourFrame) -> None:
        """Begin or end what is said."""
        sayings = frame.realized.sayings
        key = sayings[-1].key if sayings else ""
        if key == self._key:
            return
        self._key = key
        line = player.line_of(sayings[-1]) if sayings else None
        if line is None:
            self._mixer.say(np.zeros(0))
            return
        late = max(round((frame.realized.now - sayings[-1].start) * SAMPLE_RATE), 0)
        self._mixer.say(SPEECH_GAIN * at_sample_rate(line)[late:])


def play_live(
    player: BehaviourPlayer,
    server: BlockServer,
    output: Output,
    rate: float,
    clock: Callable[[], float] = time.monotonic,
) -> None:
    """Perform what clients send, until the output is closed or the program is interrupted.

    Parameters
    ----------
    player
        The character; it has not been used before.
    server
        From where blocks come; it also gets the feedback. The caller closes it.
    output
        What shows the frames.
    rate
        Frames a second at most.
    clock
        The time [s].
    """
    player.director.prepare()
    player.settle(SETTLE_S, rate)
    with often_switching():
        _play_frames(player, server, output, rate, clock)


def _play_frames(
    player: BehaviourPlayer,
    server: BlockServer,
    output: Output,
    rate: float,
    clock: Callable[[], float],
) -> None:
    begin = clock()
    frames = 0
    while not output.closed:
        due = begin + frames / rate
        left = math.inf
        for _ in range(MAX_FRAME_DOCUMENTS):
            document = server.next_document(due - clock(), left)
            if document is None:
                break
            player.director.accept(document)
            left = MAX_FRAME_BYTES if left == math.inf else left - len(document)
        time.sleep(max(due - clock(), 0.0))
        now = clock() - begin
        frames = max(frames, math.floor(now * rate)) + 1
        frame = player.update(now)
        if frame.feedback:
            server.send("\n".join(map(feedback_xml, frame.feedback)))
        output.show(player, frame)

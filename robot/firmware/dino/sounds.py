"""Sounds for a piezo buzzer, and the voice that plays them."""

from .board import Board

SOUNDS = (
    # name, (Hz at the begin, Hz at the end, ms); 0 Hz is silence
    ("breath", ((180, 240, 700), (0, 0, 300), (240, 160, 1000))),
    ("purr", ((90, 110, 500), (110, 90, 500)) * 3),
    ("growl", ((140, 80, 500), (150, 70, 500), (120, 60, 500))),
    ("chirp", ((1800, 2600, 150), (0, 0, 100), (2200, 3000, 250))),
    ("smack", ((900, 2400, 120), (0, 0, 80), (1400, 700, 400))),
    ("roar", ((200, 420, 500), (420, 300, 700), (300, 100, 600))),
)
"""Every sound, in the order of the catalogue: the same names as the simulated robot's."""


class Voice:
    """Plays one sound at a time.

    Parameters
    ----------
    board
        Has the buzzer.
    buzzer
        Whether there is one.
    """

    def __init__(self, board: Board, buzzer: bool) -> None:
        self._board = board
        self._buzzer = buzzer
        self.sound = -1
        """Which one plays, an index; -1 for none."""
        self._time = 0
        self._hertz = 0

    def names(self) -> list[str]:
        """Return what it can play."""
        return [name for name, _ in SOUNDS] if self._buzzer else []

    def play(self, index: int) -> None:
        """Begin with a sound."""
        self.sound, self._time = index, 0
        self._glide()

    def end(self) -> None:
        """Be silent."""
        self.sound = -1
        self._sound_at(0)

    def advance(self, elapsed: int) -> None:
        """Play on for `elapsed` ms."""
        if self.sound >= 0:
            self._time += elapsed
            self._glide()

    def _glide(self) -> None:
        time = self._time
        for begin, end, length in SOUNDS[self.sound][1]:
            if time < length:
                self._sound_at(begin + (end - begin) * time // length)
                return
            time -= length
        self.end()

    def _sound_at(self, hertz: int) -> None:
        if hertz != self._hertz:
            self._hertz = hertz
            self._board.tone(hertz)

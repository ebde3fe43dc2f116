"""Sounds for a piezo buzzer, and their player."""

from .board import RobotBoard

SOUNDS = (
    # name, (Hz at the beginning, Hz at the end, ms); 0 Hz is silence
    ("breath", ((180, 240, 700), (0, 0, 300), (240, 160, 1000))),
    ("purr", ((90, 110, 500), (110, 90, 500)) * 3),
    ("growl", ((140, 80, 500), (150, 70, 500), (120, 60, 500))),
    ("chirp", ((1800, 2600, 150), (0, 0, 100), (2200, 3000, 250))),
    ("smack", ((900, 2400, 120), (0, 0, 80), (1400, 700, 400))),
    ("roar", ((200, 420, 500), (420, 300, 700), (300, 100, 600))),
)
"""The sounds in the order of the catalogue, with the names of the simulated robot's."""


class SoundPlayer:
    """Plays one sound at a time, if the board has a buzzer."""

    def __init__(self, board: RobotBoard, buzzer: bool) -> None:
        self._board = board
        self._buzzer = buzzer
        self.sound = -1
        """Index of the sound that is played; -1 for none."""
        self._time = 0
        self._hertz = 0

    def names(self) -> list[str]:
        """Return the names of the sounds."""
        return [name for name, _ in SOUNDS] if self._buzzer else []

    def play(self, index: int) -> None:
        """Start a sound by its index in `SOUNDS`; one that is playing ends."""
        self.sound, self._time = index, 0
        self._update_tone()

    def end(self) -> None:
        """End the sound, if one is playing, and switch the buzzer off."""
        self.sound = -1
        self._set_tone(0)

    def advance(self, elapsed: int) -> None:
        """Advance by `elapsed` ms."""
        if self.sound >= 0:
            self._time += elapsed
            self._update_tone()

    def _update_tone(self) -> None:
        time = self._time
        for begin, end, length in SOUNDS[self.sound][1]:
            if time < length:
                self._set_tone(begin + (end - begin) * time // length)
                return
            time -= length
        self.end()

    def _set_tone(self, hertz: int) -> None:
        if hertz != self._hertz:
            self._hertz = hertz
            self._board.tone(hertz)

"""The layer of the player over a picture, with a clock, without a window."""

from datetime import datetime

import numpy as np
import pytest

from cubeling.app.ui.playback.layer import PlaybackLayer
from cubeling.app.ui.playback.requests import WindowRequest
from cubeling.app.ui.playback.status import SessionStatus

PICTURE = np.full((360, 640, 3), 90, np.uint8)

WIDTH = 1280.0
"""Of the window, in units of the canvas."""

NOW = datetime(2026, 5, 4, 15, 3, 9)


class Desk:
    """A layer with a clock, which notes what the window was asked for."""

    def __init__(self, folder):
        self.time = 0.0
        self.asked: list[WindowRequest] = []
        actions = {
            request: lambda request=request: self.asked.append(request)
            for request in (WindowRequest.QUIT, WindowRequest.PANELS, WindowRequest.FULL_SCREEN)
        }
        self.layer = PlaybackLayer(
            ("follow", "sketch"),
            folder,
            actions,
            lambda: PICTURE,
            lambda: self.time,
            lambda: NOW,
        )

    def report(self, **status):
        self.layer.report(SessionStatus(scenario="follow", **status))

    def press(self, *keys):
        for key in keys:
            shift, _, name = key.rpartition(" ")
            self.layer.press(name, shift=bool(shift))

    def shown(self):
        cards = self.layer.cards((640, 360))
        shown = np.zeros((360 + round(self.layer.strip_height / 2), 640, 3), np.uint8)
        shown[:360] = PICTURE
        for card in cards:
            card.blend_over(shown)
        return shown


@pytest.fixture
def desk(tmp_path):
    return Desk(tmp_path / "kept")

"""Blocks performed in a window, on a screen of the test's own."""

import numpy as np
import pytest

from cubeling.app.behaving.live import VoiceOutput, WindowOutput
from cubeling.app.behaving.recording import placed_pose
from cubeling.app.sound import SAMPLE_RATE
from cubeling.app.sound.bank import SoundBank
from cubeling.app.sound.mixer import Mixer
from cubeling.characters.rendering import create_context
from cubeling.characters.rendering.portrait import PortraitRenderer
from tests.app.behaving.players import HUMAN, block, player

SIZE = (160, 120)


class Screen:
    """What a window is, without one."""

    def __init__(self):
        self.closed = False
        self.pictures = []

    def show_picture(self, picture):
        self.pictures.append(picture)

    def poll(self):
        self.closed = len(self.pictures) == 3


@pytest.fixture
def renderer():
    context = create_context()
    made = PortraitRenderer(context, SIZE)
    yield made
    made.release()
    context.release()


def test_frames_are_drawn_until_the_window_is_closed(renderer):
    screen, playing = Screen(), player()
    output = WindowOutput(HUMAN, screen, renderer, Mixer(SoundBank()), "body")
    playing.director.accept(block('<head lexeme="SHAKE"/>'))
    number = 0
    while not output.closed:
        output.show(playing, playing.update(number / 5.0))
        number += 1
    assert len(screen.pictures) == 3
    assert screen.pictures[0].shape == (120, 160, 3)
    assert not np.array_equal(screen.pictures[0], screen.pictures[2])


def test_a_voice_sounds_from_where_it_is_and_is_silent_when_it_is_cut_off():
    playing, mixer = player(), Mixer(SoundBank())
    output = VoiceOutput(mixer)
    playing.director.accept(block('<speech id="s" start="0.1"><text>One two three</text></speech>'))
    heard = []
    for number in range(12):
        if number == 6:
            playing.director.accept(block("", "c", 'composition="REPLACE"'))
        output.update(playing, playing.update(number / 10.0))
        heard.append(np.abs(mixer.render(SAMPLE_RATE // 10)).mean())
    sounding = [number for number, level in enumerate(heard) if level > 0.05]
    assert sounding == [1, 2, 3, 4, 5]


def test_a_pose_is_placed_where_the_character_has_gone():
    playing = player()
    playing.director.accept(block('<locomotion target="0.2,0,0.2"/>'))
    poses = [placed_pose(playing.update(number / 10.0).posed) for number in range(40)]
    assert np.linalg.norm(poses[-1].translations[0]) > 1.0

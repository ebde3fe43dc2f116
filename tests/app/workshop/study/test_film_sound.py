"""The sound of a film that a study shows: heard from its beginning, until it is gone."""

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.sound import SAMPLE_RATE
from cubeling.app.ui.video_file import VideoFile
from cubeling.app.workshop.study.window.film_sound import FilmSounds, sound_of

TONE_HZ = 440.0
GREY = np.full((80, 80, 3), 120, np.uint8)


def film(path, seconds=0.8, *, sound=True):
    """Write a film with a tone in its second half."""
    done = 0

    def tone(count):
        nonlocal done
        times = (done + np.arange(count)) / SAMPLE_RATE
        done += count
        wave = 0.5 * np.sin(2 * np.pi * TONE_HZ * times) * (times >= seconds / 2)
        return np.repeat(wave[:, None], 2, 1).astype(np.float32)

    with VideoFile(path, (80, 80), 25.0, tone if sound else None) as video:
        for number in range(round(25 * seconds)):
            video.write(GREY, number / 25.0)
    return path


class Renderer:
    """What is heard, block by block, as a device asks for it."""

    problem = ""

    def __init__(self, mixer):
        self.mixer, self.playing = mixer, True

    def close(self):
        self.playing = False


@pytest.fixture
def heard():
    opened = []

    def open_renderer(mixer):
        opened.append(Renderer(mixer))
        return opened[-1]

    with FilmSounds(lambda line: None, open_renderer) as sounds:
        yield sounds, opened


def test_a_film_is_heard_with_its_pictures_and_falls_silent_with_them(heard, tmp_path):
    sounds, opened = heard
    samples = sound_of(film(tmp_path / "a.mp4"))
    assert len(samples) / SAMPLE_RATE == pytest.approx(0.8, abs=0.06)
    sounds.prepare([samples])
    sounds.play(0, 1, samples)
    block = opened[0].mixer.render(round(0.6 * SAMPLE_RATE))
    loud = np.abs(block).max(1) > 0.1
    assert np.argmax(loud) / SAMPLE_RATE == pytest.approx(0.4, abs=0.01)
    np.testing.assert_allclose(block[:, 0], block[:, 1])
    spectrum = np.abs(np.fft.rfft(block[-4800:, 0]))
    assert np.argmax(spectrum) * SAMPLE_RATE / 4800 == pytest.approx(TONE_HZ, abs=10.0)
    sounds.hush(1)
    opened[0].mixer.render(2048)
    assert not opened[0].mixer.render(2048).any()


def test_each_of_two_films_is_heard_on_its_side(heard, tmp_path):
    sounds, opened = heard
    samples = sound_of(film(tmp_path / "a.mp4"))
    for place, louder in ((0, 0), (1, 1)):
        sounds.prepare([samples])
        sounds.play(place, 2, samples)
        power = np.square(opened[0].mixer.render(len(samples))).sum(0)
        assert np.argmax(power) == louder
        assert power.max() > 3 * power.min()


def test_silent_films_open_no_loudspeaker(heard, tmp_path):
    sounds, opened = heard
    sounds.prepare([sound_of(film(tmp_path / "a.mp4", sound=False))])
    assert not opened


def test_a_missing_loudspeaker_is_said_once(tmp_path):
    class Missing(Renderer):
        problem = "the library PortAudio is missing"

        def __init__(self, mixer):
            super().__init__(mixer)
            self.playing = False

    told: list[str] = []
    with FilmSounds(told.append, Missing) as sounds:
        for _ in range(2):
            sounds.prepare([np.ones(9)])
            sounds.play(0, 1, np.ones(9))
    assert told == ["films are shown without their sound: the library PortAudio is missing"]


def test_a_film_that_cannot_be_read_is_refused_in_one_line(tmp_path):
    path = tmp_path / "a.mp4"
    path.write_bytes(b"no film")
    with pytest.raises(AppError, match=r"the sound of '.*a.mp4' cannot be read"):
        sound_of(path)
